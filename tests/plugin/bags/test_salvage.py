"""Truncated bags: the records of hand-made files of each format, up to every possible cut."""

from __future__ import annotations

import bz2
import sqlite3
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.bags import salvage
from pytest_tarl.bags.channels import Channel, Recorded
from pytest_tarl.bags.salvage import walk


def sized(data: bytes) -> bytes:
    return struct.pack("<I", len(data)) + data


def fields(**values: bytes) -> bytes:
    return sized(b"".join(sized(name.encode() + b"=" + value) for name, value in values.items()))


def connection(number: int, topic: str, kind: str = "std_msgs/Bool", **more: bytes) -> bytes:
    about = fields(type=kind.encode(), message_definition=b"bool data", **more)
    return fields(op=b"\x07", conn=struct.pack("<I", number), topic=topic.encode()) + about


def message(number: int, seconds: int, rest: int, data: bytes) -> bytes:
    time = struct.pack("<II", seconds, rest)
    return fields(op=b"\x02", conn=struct.pack("<I", number), time=time) + sized(data)


def chunk(data: bytes, compression: str = "none") -> bytes:
    packed = bz2.compress(data) if compression == "bz2" else data
    return fields(op=b"\x05", compression=compression.encode()) + sized(packed)


def other(data: bytes = b"index") -> bytes:
    return fields(op=b"\x04") + sized(data)


def bag(tmp_path: Path, *records: bytes, name: str = "a.bag") -> Path:
    path = tmp_path / name
    path.write_bytes(b"#ROSBAG V2.0\n" + b"".join(records))
    return path


BOOL = Channel("/a", "std_msgs/msg/Bool", "bool data")


def test_ros1_bag_has_messages_inside_and_outside_chunks(tmp_path: Path) -> None:
    inside = connection(7, "/b", "my_msgs/sub/Odd", latching=b"1") + message(7, 1, 5, b"xy")
    path = bag(
        tmp_path,
        other(),
        connection(3, "/a"),
        message(3, 2, 0, b"z"),
        chunk(inside),
        other(),
        message(7, 3, 1, b""),
    )
    assert list(walk(path)) == [
        BOOL,
        Recorded(2_000_000_000, "/a", b"z"),
        Channel("/b", "my_msgs/msg/sub/Odd", "bool data", latched=True),
        Recorded(1_000_000_005, "/b", b"xy"),
        Recorded(3_000_000_001, "/b", b""),
    ]
    assert list(walk(path.replace(tmp_path / "a.bag.active"))) != []


@pytest.mark.parametrize("latching", [b"0", b""])
def test_only_a_connection_with_the_latching_field_is_latched(tmp_path: Path, latching: bytes) -> None:
    (found,) = walk(bag(tmp_path, connection(3, "/a", latching=latching)))
    assert isinstance(found, Channel)
    assert found.latched is False


def test_all_whole_records_of_a_truncated_bag_are_read(tmp_path: Path) -> None:
    records = [connection(3, "/a"), message(3, 1, 0, b"one"), message(3, 2, 0, b"two")]
    whole = bag(tmp_path, *records).read_bytes()
    expected = [BOOL, Recorded(10**9, "/a", b"one"), Recorded(2 * 10**9, "/a", b"two")]
    ends = [len(whole) - len(b"".join(records[count:])) for count in range(1, 4)]
    for cut in range(len(whole) + 1):
        (tmp_path / "a.bag").write_bytes(whole[:cut])
        assert list(walk(tmp_path / "a.bag")) == expected[: sum(end <= cut for end in ends)]


def test_the_whole_records_of_a_truncated_chunk_are_read(tmp_path: Path) -> None:
    inside = connection(3, "/a") + message(3, 1, 0, b"one") + message(3, 2, 0, b"two")
    path = bag(tmp_path, chunk(inside))
    path.write_bytes(path.read_bytes()[:-1])
    assert [one.data for one in walk(path) if isinstance(one, Recorded)] == [b"one"]


def test_reading_continues_after_a_truncated_chunk(tmp_path: Path) -> None:
    inside = connection(3, "/a") + message(3, 1, 0, b"one")[:-1]
    found = list(walk(bag(tmp_path, chunk(inside), message(3, 2, 0, b"two"))))
    assert found == [BOOL, Recorded(2 * 10**9, "/a", b"two")]


def test_reading_ends_at_an_unknown_compression(tmp_path: Path) -> None:
    inside = connection(3, "/a") + message(3, 1, 0, b"one")
    found = list(walk(bag(tmp_path, chunk(inside, "bz2"))))
    assert found == [BOOL, Recorded(10**9, "/a", b"one")]
    assert list(walk(bag(tmp_path, chunk(inside, "zip"), connection(3, "/a")))) == []


def test_reading_ends_at_a_message_of_an_unknown_connection(tmp_path: Path) -> None:
    assert list(walk(bag(tmp_path, message(3, 1, 0, b"one"), connection(3, "/a")))) == []


@pytest.mark.parametrize("name", ["a.txt", "bag", "a.active", "a.bag.gz"])
def test_files_with_other_names_have_no_contents(tmp_path: Path, name: str) -> None:
    assert list(walk(bag(tmp_path, connection(3, "/a"), name=name))) == []


def test_files_without_the_magic_bytes_have_no_contents(tmp_path: Path) -> None:
    path = bag(tmp_path, connection(3, "/a"))
    path.write_bytes(path.read_bytes().replace(b"V2.0", b"V1.2"))
    assert list(walk(path)) == []
    mcap_file(tmp_path, schema(1, "a", "ros2msg", "")).write_bytes(b"\x89MCAP1\r\n")
    assert list(walk(tmp_path / "a.mcap")) == []
    assert list(walk(tmp_path / "gone.bag")) == []


# MCAP


def record(operation: int, data: bytes) -> bytes:
    return bytes([operation]) + struct.pack("<Q", len(data)) + data


def text(*values: str) -> bytes:
    return b"".join(sized(value.encode()) for value in values)


def schema(number: int, name: str, encoding: str, definition: str) -> bytes:
    return record(3, struct.pack("<H", number) + text(name, encoding, definition))


def channel(number: int, of: int, topic: str, profiles: str = "") -> bytes:
    metadata = text("offered_qos_profiles", profiles) if profiles else b""
    return record(4, struct.pack("<HH", number, of) + text(topic, "cdr") + sized(metadata))


def recorded(number: int, time: int, data: bytes) -> bytes:
    return record(5, struct.pack("<HIQQ", number, 4, time, time + 99) + data)


def mcap_chunk(data: bytes, compression: str = "", packed: bytes | None = None) -> bytes:
    body = data if packed is None else packed
    return record(
        6, struct.pack("<QQQI", 1, 2, len(data), 0) + text(compression) + struct.pack("<Q", len(body)) + body
    )


def mcap_file(tmp_path: Path, *records: bytes) -> Path:
    path = tmp_path / "a.mcap"
    path.write_bytes(b"\x89MCAP0\r\n" + b"".join(records))
    return path


HEAD = (schema(1, "std_msgs/msg/Bool", "ros2msg", "bool data"), channel(5, 1, "/a"))


def test_mcap_channels_have_their_definitions(tmp_path: Path) -> None:
    path = mcap_file(
        tmp_path,
        record(1, b"header"),
        *HEAD,
        schema(2, "my/msg/B", "ros2idl", "struct B {}"),
        channel(6, 2, "/b", "- durability: transient_local\n"),
        channel(7, 0, "/c"),
        recorded(5, 12, b"one"),
        record(7, b"index"),
        recorded(6, 15, b"two"),
    )
    assert list(walk(path)) == [
        BOOL,
        Channel("/b", "my/msg/B", "struct B {}", idl=True, latched=True),
        Channel("/c", ""),
        Recorded(12, "/a", b"one"),
        Recorded(15, "/b", b"two"),
    ]


def test_whole_records_of_a_truncated_mcap_are_read(tmp_path: Path) -> None:
    records = [*HEAD, recorded(5, 1, b"one"), recorded(5, 2, b"two")]
    whole = mcap_file(tmp_path, *records).read_bytes()
    expected = [BOOL, Recorded(1, "/a", b"one"), Recorded(2, "/a", b"two")]
    ends = [len(whole) - len(b"".join(records[count:])) for count in (2, 3, 4)]
    for cut in range(len(whole) + 1):
        (tmp_path / "a.mcap").write_bytes(whole[:cut])
        assert list(walk(tmp_path / "a.mcap")) == expected[: sum(end <= cut for end in ends)]


@pytest.mark.parametrize("lost", [0, 1])
def test_whole_records_of_a_truncated_chunk_are_read(tmp_path: Path, lost: int) -> None:
    inside = b"".join((*HEAD, recorded(5, 1, b"one"), recorded(5, 2, b"two")))
    path = mcap_file(tmp_path, mcap_chunk(inside), recorded(5, 3, b"three"))
    if lost:
        end = len(recorded(5, 3, b"three")) + lost
        path.write_bytes(path.read_bytes()[:-end])
    found = [one.data for one in walk(path) if isinstance(one, Recorded)]
    assert found == ([b"one"] if lost else [b"one", b"two", b"three"])


@pytest.mark.parametrize(("name", "module"), [("lz4", "lz4.frame"), ("zstd", "zstandard"), ("bz2", "bz2")])
def test_compressed_chunks_of_an_mcap_are_read(tmp_path: Path, name: str, module: str) -> None:
    library: Any = pytest.importorskip(module)
    inside = b"".join((*HEAD, recorded(5, 1, b"one")))
    path = mcap_file(tmp_path, mcap_chunk(inside, name, library.compress(inside)))
    assert [one.data for one in walk(path) if isinstance(one, Recorded)] == [b"one"]


def test_an_unknown_compression_is_refused() -> None:
    with pytest.raises(ValueError, match="zip is not supported"):
        salvage._decompressor("zip")
    assert salvage._inflated(b"x", "none") == salvage._inflated(b"x", "") == b"x"


@pytest.mark.parametrize(
    ("profiles", "latched"),
    [("durability:1", True), ("{durability: 1}", True), ("depth: 1", False), ("durability: volatile", False)],
)
def test_a_transient_local_channel_is_latched(tmp_path: Path, profiles: str, latched: bool) -> None:
    _, found = (None, *walk(mcap_file(tmp_path, HEAD[0], channel(5, 1, "/a", profiles))))
    assert isinstance(found, Channel)
    assert found.latched is latched


# SQLite


def database(path: Path, definitions: Iterable[tuple[str, str, str]] | None) -> Path:
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE topics (id INTEGER, name TEXT, type TEXT)")
        base.execute("CREATE TABLE messages (topic_id INTEGER, timestamp INTEGER, data BLOB)")
        base.executemany(
            "INSERT INTO topics VALUES (?, ?, ?)",
            [(4, "/a", "std_msgs/msg/Bool"), (9, "/b", "my/msg/B")],
        )
        base.executemany("INSERT INTO messages VALUES (?, ?, ?)", [(9, 20, b"two"), (4, 10, b"one")])
        if definitions is not None:
            base.execute(
                "CREATE TABLE message_definitions (topic_type, encoding, encoded_message_definition)"
            )
            base.executemany("INSERT INTO message_definitions VALUES (?, ?, ?)", definitions)
    base.close()
    return path


@pytest.mark.parametrize("defined", [True, False])
def test_database_keeps_topics_and_messages_in_writing_order(tmp_path: Path, defined: bool) -> None:
    definitions = [("std_msgs/msg/Bool", "ros2msg", "bool data"), ("my/msg/B", "ros2idl", "struct B {}")]
    path = database(tmp_path / "a.db3", definitions if defined else None)
    assert list(walk(path)) == [
        Channel("/a", "std_msgs/msg/Bool", "bool data" if defined else ""),
        Channel("/b", "my/msg/B", "struct B {}" if defined else "", idl=defined),
        Recorded(20, "/b", b"two"),
        Recorded(10, "/a", b"one"),
    ]


def test_a_damaged_database_has_no_contents(tmp_path: Path) -> None:
    (tmp_path / "a.db3").write_bytes(b"no database, but long enough to be one" * 100)
    assert list(walk(tmp_path / "a.db3")) == []
