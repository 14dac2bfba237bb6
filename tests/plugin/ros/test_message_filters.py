"""Message filters: which messages come out together, and which a cache keeps."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ros import message_filters
from pytest_tarl.ros.rclpy.time import Duration

SECOND = 10**9


def stamped(seconds: float, name: str = "") -> Any:
    """Return a message with a header."""
    sec, nanosec = divmod(round(seconds * SECOND), SECOND)
    return SimpleNamespace(header=SimpleNamespace(stamp=SimpleNamespace(sec=sec, nanosec=nanosec)), name=name)


def fed(synchronizer: Any, sources: list[Any], *messages: tuple[int, float]) -> list[tuple[float, ...]]:
    """Send messages, given by source and stamp; return the stamps of the sets that come out."""
    found: list[tuple[float, ...]] = []
    synchronizer.registerCallback(
        lambda *parts: found.append(
            tuple(p.header.stamp.sec + p.header.stamp.nanosec / SECOND for p in parts)
        )
    )
    for source, seconds in messages:
        sources[source].signalMessage(stamped(seconds))
    return found


def sources(count: int) -> list[message_filters.SimpleFilter]:
    return [message_filters.SimpleFilter() for _ in range(count)]


def test_messages_with_equal_stamps_come_out_together_and_once() -> None:
    two = sources(2)
    made = message_filters.TimeSynchronizer(two, 3)
    messages = [(0, 1.0), (0, 2.0), (1, 2.0), (1, 1.0), (1, 2.0), (0, 3.0), (1, 3.5), (1, 3.0)]
    assert fed(made, two, *messages) == [(2.0, 2.0), (1.0, 1.0), (3.0, 3.0)]


def test_a_queue_forgets_its_oldest_message() -> None:
    two = sources(2)
    made = message_filters.TimeSynchronizer(two, 2)
    messages = [(0, 3.0), (0, 2.0), (0, 4.0), (1, 2.0), (1, 3.0), (1, 4.0)]
    assert fed(made, two, *messages) == [(3.0, 3.0), (4.0, 4.0)]


@pytest.mark.parametrize(
    ("messages", "expected"),
    [
        ([(0, 1.0), (1, 1.1)], [(1.0, 1.1)]),
        ([(0, 1.0), (1, 1.101)], []),
        ([(0, 1.0), (0, 1.06), (1, 1.04)], [(1.06, 1.04)]),  # the nearest
        ([(0, 1.0), (0, 1.1), (1, 1.05)], [(1.0, 1.05)]),  # of two equally near messages, the older one
        ([(0, 1.0), (1, 1.05), (1, 1.0)], [(1.0, 1.05)]),  # each message once
    ],
)
def test_messages_within_the_slop_come_out_together(
    messages: list[tuple[int, float]], expected: list[tuple[float, ...]]
) -> None:
    two = sources(2)
    assert fed(message_filters.ApproximateTimeSynchronizer(two, 5, 0.1), two, *messages) == expected


def test_all_messages_of_a_set_lie_within_the_slop() -> None:
    three = sources(3)
    made = message_filters.ApproximateTimeSynchronizer(three, 5, Duration(seconds=0.1))
    messages = [(0, 1.0), (1, 1.12), (1, 1.14), (2, 1.08), (0, 1.06)]
    assert fed(made, three, *messages) == [(1.06, 1.12, 1.08)]


def test_messages_without_a_header_need_permission() -> None:
    (one,) = sources(1)
    message_filters.ApproximateTimeSynchronizer([one], 5, 0.1)
    with pytest.raises(TypeError, match="non-stamped"):
        one.signalMessage(SimpleNamespace(data=1))


def test_callbacks_get_their_own_arguments_and_have_numbers() -> None:
    (one,) = sources(1)
    seen: list[Any] = []
    assert [one.registerCallback(lambda *got: seen.append(got), at, "x") for at in (7, 8)] == [0, 1]
    one.signalMessage("m")
    assert seen == [("m", 7, "x"), ("m", 8, "x")]


def test_a_cache_keeps_the_newest_messages_by_stamp() -> None:
    (one,) = sources(1)
    cache, passed = message_filters.Cache(one, 3), list[str]()
    cache.registerCallback(lambda message: passed.append(message.name))
    assert (cache.getLast(), cache.getOldestTime(), cache.getLatestTime()) == (None, None, None)
    for seconds, name in ((2.0, "b"), (4.0, "d"), (3.0, "c"), (1.0, "a")):
        one.signalMessage(stamped(seconds, name))

    def at(seconds: float) -> Any:
        return stamped(seconds).header.stamp

    assert passed == ["b", "d", "c", "a"]
    assert [message.name for message in cache.getInterval(at(0.0), at(9.0))] == ["b", "c", "d"]
    assert [message.name for message in cache.getInterval(at(2.0), at(3.0))] == ["b", "c"]
    assert [cache.getElemAfterTime(at(t)).name for t in (0.0, 2.0, 2.5)] == ["b", "b", "c"]
    assert [cache.getElemBeforeTime(at(t)).name for t in (2.0, 2.5, 9.0)] == ["b", "b", "d"]
    assert (cache.getElemAfterTime(at(4.1)), cache.getElemBeforeTime(at(1.9))) == (None, None)
    assert (cache.getLast().name, cache.getOldestTime().sec, cache.getLastestTime().sec) == ("d", 2, 4)
    assert len(message_filters.Cache(one).getInterval(at(0.0), at(9.0))) == 0
