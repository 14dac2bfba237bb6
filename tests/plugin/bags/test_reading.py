"""Opening bags: formats, types, reasons for a refusal, and what of a damaged bag counts."""

from __future__ import annotations

import struct
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from pytest_tarl.bags import reading
from pytest_tarl.bags.channels import Channel, Recorded
from pytest_tarl.bags.reading import Bag, opened
from pytest_tarl.errors import LogError
from tests.plugin.missions import NUMBER, write_bag

START = 1_700_000_000 * 10**9
STEPS = [
    (0.0, [("/level", NUMBER, {"data": 1.5})]),
    (0.5, [("/gauge", "std_msgs/msg/Float32", {"data": 2.5})]),
    (2.0, [("/level", NUMBER, {"data": 3.5})]),
]


@pytest.mark.parametrize("ending", [".bag", ".mcap", ".db3", ""])
def test_bag_messages_are_ordered_by_time(tmp_path: Path, ending: str) -> None:
    bag = opened(write_bag(tmp_path / f"a{ending}", iter(STEPS)))
    assert (bag.start, bag.notes) == (START, [])
    assert bag.kind == ("ros1" if ending == ".bag" else "ros2")
    assert {name: (one.topic, one.type, one.latched) for name, one in bag.channels.items()} == {
        "/level": ("/level", NUMBER, False),
        "/gauge": ("/gauge", "std_msgs/msg/Float32", False),
    }
    found = [(one.time - START, one.topic, bag.decode(one.topic, one.data).data) for one in bag.messages()]
    assert found == [(0, "/level", 1.5), (5 * 10**8, "/gauge", 2.5), (2 * 10**9, "/level", 3.5)]


def test_a_type_that_the_bag_defines_is_read(tmp_path: Path) -> None:
    channel = Channel("/a", "my_msgs/msg/Pair", "float64 x\nfloat64 y\n")
    bag = Bag(tmp_path, "ros1", {"/a": channel}, lambda: iter(()), 0)
    assert bag.decode("/a", struct.pack("<dd", 1.0, 2.0)).y == 2.0
    idl = Channel(
        "/b", "my_msgs/msg/One", "module my_msgs { module msg { struct One { double x; }; }; };", idl=True
    )
    bag = Bag(tmp_path, "ros2", {"/b": idl}, lambda: iter(()), 0)
    assert bag.decode("/b", b"\x00\x01\x00\x00" + struct.pack("<d", 4.0)).x == 4.0


def test_undefined_type_comes_from_the_ros_version_of_the_bag(tmp_path: Path) -> None:
    """The header of ROS 1 begins with a counter."""
    channels = {"/h": Channel("/h", "std_msgs/msg/Header")}
    stamp, frame = struct.pack("<iI", 3, 4), struct.pack("<I", 3) + b"map"
    bag = Bag(tmp_path, "ros1", channels, lambda: iter(()), 0)
    found = bag.decode("/h", struct.pack("<I", 9) + stamp + frame)
    assert (found.seq, found.stamp.sec, found.stamp.nanosec, found.frame_id) == (9, 3, 4, "map")
    bag = Bag(tmp_path, "ros2", channels, lambda: iter(()), 0)
    found = bag.decode("/h", b"\x00\x01\x00\x00" + stamp + struct.pack("<I", 4) + b"map\x00")
    assert (found.stamp.sec, found.stamp.nanosec, found.frame_id) == (3, 4, "map")
    assert not hasattr(found, "seq")


def test_an_undefined_type_is_a_key_error(tmp_path: Path) -> None:
    bag = Bag(tmp_path, "ros1", {"/a": Channel("/a", "my_msgs/msg/Odd")}, lambda: iter(()), 0)
    with pytest.raises(KeyError, match="my_msgs/msg/Odd"):
        bag.decode("/a", b"")


def test_messages_before_the_damage_are_used_with_a_note(tmp_path: Path) -> None:
    def source() -> Iterator[Recorded]:
        yield Recorded(START, "/a", b"")
        yield Recorded(START + 2_500_000_000, "/a", b"")
        raise ValueError("torn")

    bag = Bag(tmp_path / "a.bag", "ros1", {}, source, START)
    assert len(list(bag.messages())) == 2
    assert bag.notes == ["a.bag cannot be read after 2.5 s (torn); only the messages before that are used."]


def test_damage_before_the_first_message_is_noted(tmp_path: Path) -> None:
    def source() -> Iterator[Recorded]:
        raise OSError("gone")
        yield

    bag = Bag(tmp_path / "a.bag", "ros1", {}, source, START)
    assert list(bag.messages()) == []
    assert bag.notes == ["a.bag cannot be read after 0.0 s (gone); only the messages before that are used."]


@pytest.mark.parametrize(
    ("name", "told"),
    [("gone.bag", "gone.bag: no such bag"), ("a.txt", "a.txt is not a bag: --tarl-bag takes")],
)
def test_files_that_are_not_bags_are_refused(tmp_path: Path, name: str, told: str) -> None:
    (tmp_path / "a.txt").write_text("")
    with pytest.raises(LogError, match=told):
        opened(tmp_path / name)


def test_without_rosbags_the_command_that_installs_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_bag(tmp_path / "a.bag", iter(STEPS))
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(LogError, match=r"`rosbags`: run pip install"):
        opened(path)


def test_note_on_a_truncated_bag_states_duration_and_messages(tmp_path: Path) -> None:
    folder = write_bag(tmp_path / "run", iter(STEPS))
    (folder / "metadata.yaml").unlink()
    bag = opened(folder)
    assert bag.notes == ["run was cut off: only its first 2.0 s with 3 messages are used."]
    assert (bag.start, sorted(bag.channels)) == (START, ["/gauge", "/level"])
    assert [one.time - START for one in bag.messages()] == [0, 5 * 10**8, 2 * 10**9]


def test_empty_channels_are_dropped_and_messages_sorted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    contents = {
        "b.mcap": [Channel("/a", "B"), Recorded(1, "/a", b"1"), Channel("/c", "C")],
        "a.mcap": [Channel("/a", "A"), Recorded(3, "/a", b"3"), Recorded(2, "/a", b"2")],
        "notes.txt": [Recorded(0, "/a", b"0")],
    }
    for name in contents:
        (tmp_path / name).write_text("")
    monkeypatch.setattr(reading, "walk", lambda path: iter(contents[path.name]))
    bag = reading._salvaged(tmp_path, "ros2", "torn")
    assert [one.time for one in bag.messages()] == [1, 2, 3]
    assert bag.channels == {"/a": Channel("/a", "A")}  # files in the order of their names
    assert bag.start == 1


def test_bag_without_a_whole_message_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    path.write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(
        LogError, match=r"^a\.bag cannot be read \(.+\), and no whole message was found in it\."
    ):
        opened(path)


def test_a_bag_without_messages_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LogError, match=r"^a\.bag holds no messages\."):
        opened(write_bag(tmp_path / "a.bag", iter([])))
