"""`rosbag`: read and write ROS 1 bags with the package `rosbags`."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from pytest_tarl.ros.genpy_dynamic import generate_dynamic
from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.ros1 import field_class
from pytest_tarl.ros.messages.ros1_wire import WireError, deserialize, full_text, serialize
from pytest_tarl.ros.messages.times import Time
from pytest_tarl.ros.missing import unsupported

__all__ = [
    "Bag",
    "BagMessage",
    "Compression",
    "ROSBagException",
    "ROSBagFormatException",
    "ROSBagUnindexedException",
]


class Compression:
    """The names of bag compressions."""

    NONE, BZ2, LZ4 = "none", "bz2", "lz4"


class ROSBagException(Exception):  # noqa: N818 (these names are rosbag's)
    """A bag cannot be used."""


class ROSBagFormatException(ROSBagException):
    """A file is not a bag."""


class ROSBagUnindexedException(ROSBagException):
    """A bag was not closed."""


class BagMessage(NamedTuple):
    """A message in a bag."""

    topic: str
    message: Any
    timestamp: Time


class TopicTuple(NamedTuple):
    """A topic in a bag: type, number of messages and of connections."""

    msg_type: str
    message_count: int
    connections: int
    frequency: float | None


class TypesAndTopicsTuple(NamedTuple):
    """The types in a bag with their checksums, and its topics."""

    msg_types: dict[str, str]
    topics: dict[str, TopicTuple]


class Bag:
    """A bag opened for reading (`r`) or writing (`w`). Raise ROSBagException if it cannot be read."""

    def __init__(self, f: Any, mode: str = "r", compression: str = "none", **_: Any) -> None:  # noqa: ARG002
        if not isinstance(f, str | Path):
            raise unsupported("rosbag.Bag of an open file")
        if mode not in ("r", "w"):
            raise unsupported(f"rosbag.Bag(mode={mode!r})")
        self._path, self._mode = Path(f), mode
        self._connections: dict[tuple[str, str], Any] = {}
        self._classes: dict[str, Any] = {}
        self._bag: Any = _opened(self._path, mode)

    @property
    def filename(self) -> str:
        """Return the path given to the constructor."""
        return str(self._path)

    @property
    def mode(self) -> str:
        """Return `r` or `w`."""
        return self._mode

    def __enter__(self) -> Bag:
        """Return the bag."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the bag."""
        self.close()

    def __iter__(self) -> Iterator[BagMessage]:
        """Yield all messages."""
        return self.read_messages()

    def close(self) -> None:
        """Close the file."""
        if self._bag is not None:
            self._bag.close()
            self._bag = None

    def read_messages(
        self,
        topics: Any = None,
        start_time: Any = None,
        end_time: Any = None,
        connection_filter: Callable[..., bool] | None = None,
        raw: bool = False,
        return_connection_header: bool = False,
    ) -> Iterator[BagMessage]:
        """Yield topic, message and time in order of time, optionally of some topics and within inclusive limits.

        Raise UnsupportedApiError for connection filters and connection headers.
        """
        if connection_filter is not None or return_connection_header:
            raise unsupported("read_messages(connection_filter=…, return_connection_header=True)")
        wanted = [topics] if isinstance(topics, str) else topics
        bag = self._open()
        connections = [one for one in bag.connections if wanted is None or one.topic in wanted]
        first = start_time.to_nsec() if start_time is not None else None
        last = end_time.to_nsec() + 1 if end_time is not None else None
        for connection, nanoseconds, data in (
            bag.messages(connections, start=first, stop=last) if connections else ()
        ):
            stamp = Time(nanoseconds // 10**9, nanoseconds % 10**9)
            kind = self._class(connection)
            message = (
                (kind._type, bytes(data), kind._md5sum, (0, 0), kind) if raw else _decoded(kind, bytes(data))
            )
            yield BagMessage(connection.topic, message, stamp)

    def write(self, topic: str, msg: Any, t: Any = None, raw: bool = False, **_: Any) -> None:
        """Write a message at time `t` (default: now). Raise UnsupportedApiError for `raw`."""
        if raw:
            raise unsupported("rosbag.Bag.write(raw=True)")
        from pytest_tarl.ros.rospy.timing import Time as RospyTime

        kind, stamp = type(msg), t if t is not None else RospyTime.now()
        bag, key = self._open(), (topic, kind._type)
        if key not in self._connections:
            self._connections[key] = bag.add_connection(
                topic, kind._type.replace("/", "/msg/"), msgdef=full_text(kind), md5sum=kind._md5sum
            )
        bag.write(self._connections[key], stamp.to_nsec(), serialize(msg))

    def flush(self) -> None:
        """Do nothing: the file is complete once the bag is closed."""

    def get_start_time(self) -> float:
        """Return the time of the first message in seconds."""
        return float(self._open().start_time / 1e9)

    def get_end_time(self) -> float:
        """Return the time of the last message in seconds."""
        return float((self._open().end_time - 1) / 1e9)

    def get_message_count(self, topic_filters: Any = None) -> int:
        """Return the number of messages, optionally of some topics only."""
        wanted = [topic_filters] if isinstance(topic_filters, str) else topic_filters
        return sum(one.msgcount for one in self._open().connections if wanted is None or one.topic in wanted)

    def get_type_and_topic_info(self, topic_filters: Any = None) -> TypesAndTopicsTuple:
        """Return the types and topics of the bag."""
        wanted = [topic_filters] if isinstance(topic_filters, str) else topic_filters
        chosen = [one for one in self._open().connections if wanted is None or one.topic in wanted]
        seconds = self.get_end_time() - self.get_start_time()
        types, topics = {}, dict[str, TopicTuple]()
        for one in chosen:
            name, before = one.msgtype.replace("/msg/", "/"), topics.get(one.topic)
            types[name] = one.digest
            count = one.msgcount + (before.message_count if before else 0)
            frequency = count / seconds if seconds > 0 else None
            topics[one.topic] = TopicTuple(name, count, (before.connections if before else 0) + 1, frequency)
        return TypesAndTopicsTuple(types, topics)

    def _open(self) -> Any:
        if self._bag is None:
            raise ValueError("I/O operation on closed bag")
        return self._bag

    def _class(self, connection: Any) -> Any:
        """Return a connection's message class: the known one if checksums match, otherwise one built from the bag."""
        name = connection.msgtype.replace("/msg/", "/")
        if name not in self._classes:
            known = find_class("ros1", *name.split("/"))
            if known is None or known._md5sum != connection.digest:
                known = generate_dynamic(name, connection.msgdef.data)[name]
            self._classes[name] = known
        return self._classes[name]


def _decoded(kind: Any, data: bytes) -> Any:
    try:
        return deserialize(kind, data, field_class)
    except WireError as problem:
        raise ROSBagException(str(problem)) from problem


def _opened(path: Path, mode: str) -> Any:
    try:
        from rosbags.rosbag1 import Reader, ReaderError, Writer, WriterError
    except ImportError:
        raise unsupported('rosbag without the package `rosbags` (pip install "tarl[ros]")') from None
    if mode == "r" and not path.exists():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    try:
        bag: Any = Reader(path) if mode == "r" else Writer(path)
        bag.open()
    except (ReaderError, WriterError) as problem:
        raise (ROSBagUnindexedException if "index" in str(problem) else ROSBagFormatException)(
            str(problem)
        ) from problem
    return bag
