"""Read a truncated bag up to its last complete record.

A killed recorder writes no index, and `rosbags` cannot read a bag without one. Formats: rosbag 2.0
(wiki.ros.org/Bags/Format/2.0), MCAP (mcap.dev/spec), SQLite.
"""

from __future__ import annotations

import bz2
import sqlite3
import struct
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, suppress
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

from pytest_tarl.bags.channels import Channel, Recorded

Walk = Iterator[Channel | Recorded]
_ROS1_MAGIC = b"#ROSBAG V2.0\n"
_MCAP_MAGIC = b"\x89MCAP0\r\n"
_MESSAGE, _CHUNK, _CONNECTION = 2, 5, 7  # record types of rosbag 2.0
_SCHEMA, _CHANNEL, _MCAP_MESSAGE, _MCAP_CHUNK = 3, 4, 5, 6  # record types of MCAP


class CutOffError(Exception):
    """A file ends in the middle of a record."""


def walk(path: Path) -> Walk:
    """Yield a file's channels and messages up to the damage, each channel before its messages."""
    walks: dict[str, Callable[[Path], Walk]] = {".bag": _walk_bag, ".mcap": _walk_mcap, ".db3": _walk_db3}
    found = walks.get(".bag" if path.name.endswith(".bag.active") else path.suffix)
    if found is not None:
        with suppress(
            CutOffError, sqlite3.Error, OSError, EOFError, ValueError, KeyError, struct.error, RuntimeError
        ):
            yield from found(path)


def _take(file: BinaryIO, size: int) -> bytes:
    data = file.read(size)
    if len(data) < size:
        raise CutOffError
    return data


def _sized(file: BinaryIO, length: str = "<I") -> bytes:
    (size,) = struct.unpack(length, _take(file, struct.calcsize(length)))
    return _take(file, size)


def _walk_bag(path: Path) -> Walk:
    with path.open("rb") as file:
        if file.read(len(_ROS1_MAGIC)) == _ROS1_MAGIC:
            yield from _bag_records(file, {})


def _bag_records(file: BinaryIO, topics: dict[bytes, str]) -> Walk:
    while True:
        header = _fields(_sized(file))
        operation = header["op"][0]
        if operation == _CHUNK:
            yield from _bag_chunk(file, header["compression"].decode(), topics)
            continue
        data = _sized(file)
        if operation == _CONNECTION:
            about = _fields(data)
            topics[header["conn"]] = topic = header["topic"].decode()
            yield Channel(
                topic,
                about["type"].decode().replace("/", "/msg/", 1),
                about["message_definition"].decode(),
                latched=about.get("latching") == b"1",
            )
        elif operation == _MESSAGE:
            seconds, rest = struct.unpack("<II", header["time"])
            yield Recorded(seconds * 10**9 + rest, topics[header["conn"]], data)


def _bag_chunk(file: BinaryIO, compression: str, topics: dict[bytes, str]) -> Walk:
    (size,) = struct.unpack("<I", _take(file, 4))
    data = file.read(size)
    with suppress(CutOffError):
        yield from _bag_records(BytesIO(_inflated(data, compression)), topics)
    if len(data) < size:
        raise CutOffError


def _fields(text: bytes) -> Mapping[str, bytes]:
    """Return the fields of a rosbag 2.0 header."""
    file, found = BytesIO(text), {}
    while file.tell() < len(text):
        name, _, value = _sized(file).partition(b"=")
        found[name.decode()] = value
    return found


def _walk_mcap(path: Path) -> Walk:
    with path.open("rb") as file:
        if file.read(len(_MCAP_MAGIC)) == _MCAP_MAGIC:
            yield from _mcap_records(file, {}, {})


def _mcap_records(
    file: BinaryIO, schemas: dict[int, tuple[str, str, str]], channels: dict[int, Channel]
) -> Walk:
    while True:
        operation = _take(file, 1)[0]
        (size,) = struct.unpack("<Q", _take(file, 8))
        data = file.read(size)
        # the beginning of a truncated chunk can still be read
        if len(data) < size and operation != _MCAP_CHUNK:
            raise CutOffError
        record = BytesIO(data)
        if operation == _SCHEMA:
            (key,) = struct.unpack("<H", _take(record, 2))
            name, encoding, text = (_sized(record).decode() for _ in range(3))
            schemas[key] = name, encoding, text
        elif operation == _CHANNEL:
            key, schema = struct.unpack("<HH", _take(record, 4))
            topic, _ = (_sized(record).decode() for _ in range(2))
            name, encoding, text = schemas.get(schema, ("", "", ""))
            latched = _transient(_sized(record).decode(errors="replace"))
            channels[key] = Channel(topic, name, text, encoding.endswith("idl"), latched)
            yield channels[key]
        elif operation == _MCAP_MESSAGE:
            key, _, time, _ = struct.unpack("<HIQQ", _take(record, 22))
            yield Recorded(time, channels[key].topic, record.read())
        elif operation == _MCAP_CHUNK:
            _take(record, 28)  # skip the times, the size and the checksum
            compression = _sized(record).decode()
            _take(record, 8)  # skip the size of the remaining chunk data
            with suppress(CutOffError):
                yield from _mcap_records(BytesIO(_inflated(record.read(), compression)), schemas, channels)


def _transient(profiles: str) -> bool:
    """Return whether a recorded QoS text says "transient local"."""
    flat = profiles.replace(" ", "")
    return "durability:1" in flat or "durability:transient_local" in flat


def _inflated(data: bytes, compression: str) -> bytes:
    """Decompress as much of a chunk as there is; its end may be missing."""
    if compression in ("", "none"):
        return data
    return bytes(_decompressor(compression).decompress(data))


_ZSTANDARD = ("zstandard", "ZstdDecompressor")  # the library that rosbags 0.11.0 uses


def _decompressor(compression: str) -> Any:
    """Return a streaming decompressor from the library that the installed `rosbags` depends on.

    Raise ValueError for an unsupported compression.
    """
    if compression == "bz2":
        return bz2.BZ2Decompressor()
    homes = {
        "lz4": (("lz4.frame", "LZ4FrameDecompressor"),),
        "zstd": (
            ("compression.zstd", "ZstdDecompressor"),
            ("backports.zstd", "ZstdDecompressor"),
            _ZSTANDARD,
        ),
    }
    for module, name in homes.get(compression, ()):
        with suppress(ImportError):
            made = getattr(import_module(module), name)()
            return made.decompressobj() if (module, name) == _ZSTANDARD else made
    raise ValueError(f"{compression} is not supported here")


def _walk_db3(path: Path) -> Walk:
    """Yield the contents of an SQLite bag in the order in which messages were written."""
    with closing(sqlite3.connect(f"{path.resolve().as_uri()}?immutable=1", uri=True)) as database:
        database.execute("PRAGMA writable_schema=ON")  # otherwise SQLite refuses to read a truncated file
        texts: dict[str, tuple[str, str]] = {}
        with suppress(sqlite3.Error):  # recordings from before 2023 do not have this table
            query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
            texts = {name: (encoding, text) for name, encoding, text in database.execute(query)}
        topics = {}
        for number, topic, kind in database.execute("SELECT id, name, type FROM topics"):
            topics[number] = topic
            encoding, text = texts.get(kind, ("", ""))
            yield Channel(topic, kind, text, encoding.endswith("idl"))
        for number, time, data in database.execute("SELECT topic_id, timestamp, data FROM messages"):
            yield Recorded(time, topics[number], data)
