"""message_filters for both ROS generations: subscribers, time synchronisers, cache-free."""

# ruff: noqa: ARG002 (signatures are message_filters' own)

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pytest_tarl.ros.clock import NANOSECONDS, nanoseconds

__all__ = ["ApproximateTimeSynchronizer", "SimpleFilter", "Subscriber", "TimeSynchronizer"]


class SimpleFilter:
    """Something that messages come out of."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:  # noqa: N802 (message_filters' name)
        """Have a function called with what comes out; return a number for it."""
        number = len(self.callbacks)
        self.callbacks[number] = (cb, args)
        return number

    def signalMessage(self, *msg: Any) -> None:  # noqa: N802
        """Let messages come out."""
        for callback, args in list(self.callbacks.values()):
            callback(*(msg + args))


class Subscriber(SimpleFilter):
    """A subscription as a filter: `Subscriber(topic, type)` in ROS 1, `Subscriber(node, type, topic)` in ROS 2."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        if hasattr(args[0], "create_subscription"):
            node, message_type, topic, *rest = args
            self.topic = topic
            profile = kwargs.pop("qos_profile", rest[0] if rest else 10)
            self.sub = node.create_subscription(message_type, topic, self.callback, profile, **kwargs)
        else:
            from pytest_tarl.ros.rospy.topics import Subscriber as RospySubscriber

            self.topic = args[0]
            self.sub = RospySubscriber(*args, **{**kwargs, "callback": self.callback})

    def callback(self, msg: Any) -> None:
        """Pass a message on."""
        self.signalMessage(msg)

    def getTopic(self) -> str:  # noqa: N802
        """Return the topic."""
        return str(self.topic)

    def unregister(self) -> None:
        """Stop receiving."""
        end = getattr(self.sub, "unregister", None) or self.sub.destroy
        end()


class TimeSynchronizer(SimpleFilter):
    """Passes messages on together when their stamps are equal."""

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        self.queue_size = queue_size
        self.queues: list[dict[int, Any]] = [{} for _ in fs]
        for index, source in enumerate(fs):
            source.registerCallback(self._add, index)

    def _add(self, message: Any, index: int) -> None:
        stamp = _stamp(message)
        self._keep(index, stamp, message)
        if all(stamp in queue for queue in self.queues):
            self.signalMessage(*(queue.pop(stamp) for queue in self.queues))

    def _keep(self, index: int, stamp: int, message: Any) -> None:
        queue = self.queues[index]
        queue[stamp] = message
        while len(queue) > self.queue_size:
            del queue[min(queue)]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Passes messages on together when their stamps differ by no more than `slop` seconds."""

    def __init__(
        self,
        fs: Sequence[SimpleFilter],
        queue_size: int,
        slop: float,
        allow_headerless: bool = False,
        reset: bool = False,
        **_: Any,
    ) -> None:
        super().__init__(fs, queue_size)
        self.slop = nanoseconds(slop)
        self.allow_headerless = allow_headerless

    def _add(self, message: Any, index: int) -> None:
        stamp = _stamp(message) if hasattr(message, "header") or not self.allow_headerless else _now()
        self._keep(index, stamp, message)
        chosen = [self._nearest(queue, stamp) for queue in self.queues]
        if None in chosen:
            return
        stamps = [s for s in chosen if s is not None]
        if max(stamps) - min(stamps) <= self.slop:
            self.signalMessage(*(queue.pop(s) for queue, s in zip(self.queues, stamps, strict=True)))

    def _nearest(self, queue: dict[int, Any], stamp: int) -> int | None:
        near = [other for other in queue if abs(other - stamp) <= self.slop]
        return min(near, key=lambda other: (abs(other - stamp), other), default=None)


def _stamp(message: Any) -> int:
    stamp = message.header.stamp
    if hasattr(stamp, "nsecs"):
        return int(stamp.secs) * NANOSECONDS + int(stamp.nsecs)
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def _now() -> int:
    from pytest_tarl.ros.process import current_process

    return current_process("message_filters").scheduler.time


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    from pytest_tarl.ros.missing import refuse

    raise refuse("message_filters", name)
