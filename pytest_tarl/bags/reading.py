"""Open a bag of ROS 1 or ROS 2, complete or truncated."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pytest_tarl.bags.channels import Channel, Recorded
from pytest_tarl.bags.salvage import walk
from pytest_tarl.errors import LogError
from pytest_tarl.extras import install_command

if TYPE_CHECKING:
    from rosbags.rosbag1 import Reader as Reader1
    from rosbags.rosbag2 import Reader as Reader2

Kind = Literal["ros1", "ros2"]
ENDINGS = (".bag", ".bag.active", ".mcap", ".db3")


@dataclass
class Bag:
    """A recorded mission: its channels by topic, and its messages.

    `notes` are sentences for the user; reading messages can add more.
    """

    path: Path
    kind: Kind
    channels: Mapping[str, Channel]
    source: Callable[[], Iterator[Recorded]]
    start: int  # time of the first message (ns)
    notes: list[str] = field(default_factory=list)

    def messages(self) -> Iterator[Recorded]:
        """Yield the messages in order of time, up to the first one that cannot be read."""
        last = self.start
        try:
            for one in self.source():
                last = one.time
                yield one
        except _unreadable() as problem:
            seconds = (last - self.start) / 1e9
            self.notes.append(
                f"{self.path.name} cannot be read after {seconds:.1f} s ({problem}); "
                "only the messages before that are used."
            )

    def decode(self, topic: str, data: bytes) -> Any:
        """Return a message as an object of `rosbags`. Raise KeyError for an undefined type."""
        name = self.channels[topic].type
        store = self._stores[0] if name in self._stores[0].fielddefs else self._stores[1]
        return (
            store.deserialize_ros1(data, name) if self.kind == "ros1" else store.deserialize_cdr(data, name)
        )

    @cached_property
    def _stores(self) -> tuple[Any, Any]:
        """Return the bag's own type definitions, and the standard ones of its ROS generation."""
        from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

        own, usual = (
            get_typestore(Stores.EMPTY),
            get_typestore(Stores.ROS1_NOETIC if self.kind == "ros1" else Stores.LATEST),
        )
        types: dict[str, Any] = {}
        for one in self.channels.values():
            if one.definition:
                types |= (
                    get_types_from_idl(one.definition)
                    if one.idl
                    else get_types_from_msg(one.definition, one.type)
                )
        own.register(types)
        return own, usual


def opened(path: Path) -> Bag:
    """Open a bag. Raise LogError, with the reason, if no message can be read."""
    if not path.exists():
        raise LogError(f"{path}: no such bag.")
    if not path.is_dir() and not path.name.endswith(ENDINGS):
        raise LogError(
            f"{path} is not a bag: --tarl-bag takes .bag, .mcap, .db3 and the folder of a ROS 2 recording."
        )
    _require()
    kind: Kind = "ros1" if path.name.endswith((".bag", ".bag.active")) else "ros2"
    try:
        bag = _whole(path, kind)
    except _unreadable() as problem:
        bag = _salvaged(path, kind, str(problem).replace(str(path), path.name).rstrip("."))
    if not bag.channels:
        raise LogError(f"{path.name} holds no messages.")
    return bag


def _require() -> None:
    try:
        import rosbags.rosbag2  # noqa: F401
    except ImportError as error:
        raise LogError(f"Reading bags needs `rosbags`: run {install_command('ros')}.") from error


def _unreadable() -> tuple[type[Exception], ...]:
    """Return the exceptions that a damaged bag can raise."""
    from rosbags.rosbag1 import ReaderError as Error1
    from rosbags.rosbag2 import ReaderError as Error2

    return (Error1, Error2, *_of_databases(), OSError, EOFError, ValueError, AssertionError, IndexError, KeyError,
            TypeError, struct.error, RuntimeError)  # fmt: skip


def _of_databases() -> Iterator[type[Exception]]:
    """Yield the exceptions of all database libraries with which versions of rosbags read .db3 files."""
    for name in ("apsw", "sqlite3"):
        with suppress(ImportError):
            yield import_module(name).Error


@contextmanager
def _reading(path: Path, kind: Kind) -> Iterator[Reader1 | Reader2]:
    reader = _reader(path, kind)
    try:
        reader.open()
    except BaseException:
        with suppress(*_unreadable(), AttributeError):  # rosbags 0.11.0 leaves a damaged .mcap file open
            reader.close()
        raise
    try:
        yield reader
    finally:
        reader.close()


def _reader(path: Path, kind: Kind) -> Reader1 | Reader2:
    if kind == "ros1":
        from rosbags.rosbag1 import Reader as Reader1

        return Reader1(path)
    from rosbags.rosbag2 import Reader as Reader2

    return Reader2(path)


def _whole(path: Path, kind: Kind) -> Bag:
    """Open a bag with its index."""
    with _reading(path, kind) as reader:
        channels = {one.topic: _channel(one) for one in reader.connections if one.msgcount}
        start = reader.start_time

    def source() -> Iterator[Recorded]:
        with _reading(path, kind) as reader:
            for connection, time, data in reader.messages():
                yield Recorded(time, connection.topic, bytes(data))

    return Bag(path, kind, channels, source, start)


def _channel(connection: Any) -> Channel:
    definition, offered = connection.msgdef, getattr(connection.ext, "offered_qos_profiles", ())
    return Channel(
        connection.topic,
        connection.msgtype,
        definition.data,
        definition.format.name == "IDL",
        bool(getattr(connection.ext, "latching", 0))
        or any(one.durability.name == "TRANSIENT_LOCAL" for one in offered),
    )


def _salvaged(path: Path, kind: Kind, reason: str) -> Bag:
    """Open the readable part of a truncated bag. Raise LogError if nothing is readable."""
    files = (
        [path] if not path.is_dir() else sorted(one for one in path.iterdir() if one.name.endswith(ENDINGS))
    )
    channels: dict[str, Channel] = {}
    times: list[int] = []
    heard: set[str] = set()
    for one in _walked(files):
        if isinstance(one, Channel):
            channels.setdefault(one.topic, one)
        else:
            times.append(one.time)
            heard.add(one.topic)
    if not times:
        raise LogError(f"{path.name} cannot be read ({reason}), and no whole message was found in it.")
    span = (max(times) - min(times)) / 1e9
    return Bag(
        path,
        kind,
        {topic: one for topic, one in channels.items() if topic in heard},
        lambda: iter(
            sorted((one for one in _walked(files) if isinstance(one, Recorded)), key=lambda one: one.time)
        ),
        min(times),
        [f"{path.name} was cut off: only its first {span:.1f} s with {len(times)} messages are used."],
    )


def _walked(files: Sequence[Path]) -> Iterator[Channel | Recorded]:
    for file in files:
        yield from walk(file)
