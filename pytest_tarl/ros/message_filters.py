"""message_filters for both ROS generations: subscribers, caches and synchronisers."""

# ruff: noqa: N802 (names are message_filters')

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

from pytest_tarl.ros.clock import NANOSECONDS, nanoseconds

__all__ = ["ApproximateTimeSynchronizer", "Cache", "SimpleFilter", "Subscriber", "TimeSynchronizer"]


class SimpleFilter:
    """The base of all filters: it sends messages to its callbacks."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:
        """Register a callback for output messages; return its number."""
        number = len(self.callbacks)
        self.callbacks[number] = (cb, args)
        return number

    def signalMessage(self, *msg: Any) -> None:
        """Send messages to the callbacks."""
        for callback, args in list(self.callbacks.values()):
            callback(*(msg + args))


class Subscriber(SimpleFilter):
    """A subscription as a filter: `Subscriber(topic, type)` in ROS 1, `Subscriber(node, type, topic)` in ROS 2."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        if args and hasattr(args[0], "create_subscription"):
            node, message_type, topic, *rest = args
            self.topic = topic
            profile = kwargs.pop("qos_profile", rest[0] if rest else 10)
            self.sub = node.create_subscription(message_type, topic, self.callback, profile, **kwargs)
        else:
            from pytest_tarl.ros.rospy.topics import Subscriber as RospySubscriber

            self.topic = args[0] if args else kwargs["name"]
            self.sub = RospySubscriber(*args, **{**kwargs, "callback": self.callback})

    def callback(self, msg: Any) -> None:
        """Forward a message."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """Return the topic."""
        return str(self.topic)

    def unregister(self) -> None:
        """Stop receiving."""
        end = getattr(self.sub, "unregister", None) or self.sub.destroy
        end()

    unsubscribe = unregister


class Cache(SimpleFilter):
    """Keeps a filter's last messages, ordered by stamp, and forwards them."""

    def __init__(
        self, f: SimpleFilter | None = None, cache_size: int = 1, allow_headerless: bool = False
    ) -> None:
        super().__init__()
        self.cache_size = cache_size
        self.allow_headerless = allow_headerless
        self._kept: list[tuple[int, Any]] = []
        if f is not None:
            self.connectInput(f)

    def connectInput(self, f: SimpleFilter) -> None:
        """Connect to an input filter."""
        f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Add a message."""
        self._kept.append((_time_of(msg, self.allow_headerless), msg))
        self._kept.sort(key=lambda entry: entry[0])
        del self._kept[: -self.cache_size]
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Any, to_stamp: Any) -> list[Any]:
        """Return the messages between two times, both inclusive."""
        low, high = _ns(from_stamp), _ns(to_stamp)
        return [message for stamp, message in self._kept if low <= stamp <= high]

    def getElemAfterTime(self, stamp: Any) -> Any:
        """Return the oldest message at or after a time, or None."""
        return next((message for time, message in self._kept if time >= _ns(stamp)), None)

    def getElemBeforeTime(self, stamp: Any) -> Any:
        """Return the newest message at or before a time, or None."""
        return next((message for time, message in reversed(self._kept) if time <= _ns(stamp)), None)

    def getLastestTime(self) -> Any:
        """Return the newest message's stamp, or None (the name is misspelled in message_filters)."""
        return self._kept[-1][1].header.stamp if self._kept else None

    getLatestTime = getLastestTime  # noqa: N815

    def getOldestTime(self) -> Any:
        """Return the oldest message's stamp, or None."""
        return self._kept[0][1].header.stamp if self._kept else None

    def getLast(self) -> Any:
        """Return the newest message."""
        return self._kept[-1][1] if self._kept else None


class TimeSynchronizer(SimpleFilter):
    """Forwards messages together if their stamps are equal."""

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        self.queue_size = queue_size
        self.queues: list[dict[int, Any]] = []
        self.connectInput(fs)

    def connectInput(self, fs: Sequence[SimpleFilter]) -> None:
        """Connect to input filters."""
        self.queues = [{} for _ in fs]
        for index, source in enumerate(fs):
            source.registerCallback(self._take, index)

    def _take(self, message: Any, index: int) -> None:
        stamp = self._stamp(message)
        queue = self.queues[index]
        queue[stamp] = message
        while len(queue) > self.queue_size:
            del queue[min(queue)]
        self._match(stamp, index)

    def _stamp(self, message: Any) -> int:
        return _time_of(message, False)

    def _match(self, stamp: int, index: int) -> None:  # noqa: ARG002 (index matters to others)
        if all(stamp in queue for queue in self.queues):
            self._signal([stamp] * len(self.queues))

    def _signal(self, stamps: Sequence[int]) -> None:
        self.signalMessage(*(queue.pop(stamp) for queue, stamp in zip(self.queues, stamps, strict=True)))


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Forwards messages together if their stamps differ by at most `slop` seconds."""

    def __init__(
        self,
        fs: Sequence[SimpleFilter],
        queue_size: int,
        slop: float,
        allow_headerless: bool = False,
        reset: bool = False,  # noqa: ARG002 (for clocks that jump back)
        **_: Any,
    ) -> None:
        self.slop = nanoseconds(slop) if isinstance(slop, int | float) else slop.nanoseconds
        self.allow_headerless = allow_headerless
        super().__init__(fs, queue_size)

    def _stamp(self, message: Any) -> int:
        return _time_of(message, self.allow_headerless)

    def _match(self, stamp: int, index: int) -> None:
        """Forward the first set within the slop that contains the new message, trying the nearest stamps first."""
        near = [
            [stamp]
            if i == index
            else sorted((s for s in queue if abs(s - stamp) <= self.slop), key=_distance(stamp))
            for i, queue in enumerate(self.queues)
        ]
        for stamps in product(*near):
            if max(stamps) - min(stamps) <= self.slop:
                self._signal(stamps)
                return


def _distance(stamp: int) -> Callable[[int], tuple[int, int]]:
    return lambda other: (abs(other - stamp), other)


def _time_of(message: Any, allow_headerless: bool) -> int:
    if hasattr(message, "header"):
        return _ns(message.header.stamp)
    if not allow_headerless:
        raise TypeError("Cannot use message filters with non-stamped messages. Use the 'allow_headerless' constructor "
                        "option to auto-assign ROS time to headerless messages.")  # fmt: skip
    from pytest_tarl.ros.process import current_process

    return current_process("message_filters").scheduler.time


def _ns(stamp: Any) -> int:
    if hasattr(stamp, "to_nsec"):
        return int(stamp.to_nsec())
    if hasattr(stamp, "nanoseconds"):
        return int(stamp.nanoseconds)
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)
