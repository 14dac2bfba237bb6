"""Futures, tasks, timers and times of rclpy, one by one and without a node."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ros import message_type
from pytest_tarl.ros.rclpy.exceptions import ROSInterruptException
from pytest_tarl.ros.rclpy.task import Future, Task
from pytest_tarl.ros.rclpy.time import ClockType, Duration, JumpThreshold, Time
from pytest_tarl.ros.rclpy.timer import Rate, Timer, TimerInfo

SECOND = 10**9


class Queue:
    """An executor that keeps tasks and wake-ups."""

    def __init__(self) -> None:
        self.tasks: list[tuple[Any, ...]] = []
        self.woken = 0

    def create_task(self, *task: Any) -> None:
        self.tasks.append(task)

    def wake(self) -> None:
        self.woken += 1


def state(future: Future) -> tuple[bool, bool, bool]:
    return future.done(), future.cancelled(), future.pending()


def test_future_is_pending_until_a_result_or_cancellation() -> None:
    one, two, three = Future(), Future(), Future()
    assert (state(one), one.result(), one.exception()) == ((False, False, True), None, None)
    one.set_result(5)
    two.set_exception(KeyError("x"))
    three.cancel()
    assert [state(each) for each in (one, two, three)] == [
        (True, False, False),
        (True, False, False),
        (False, True, False),
    ]
    assert (one.result(), two.exception().args) == (5, ("x",))  # type: ignore[union-attr]
    with pytest.raises(KeyError):
        two.result()
    one.cancel()
    assert state(one) == (True, False, False)
    three.set_result(1)
    assert state(three) == (True, False, False)


def test_done_callbacks_run_once_each_in_order() -> None:
    seen: list[tuple[str, Any]] = []
    one = Future()
    one.watch(lambda: seen.append(("watch", None)))
    for name in "abc":
        one.add_done_callback(lambda future, name=name: seen.append((name, future.result())))  # type: ignore[misc]
    removed = one._callbacks[1]
    assert [one.remove_done_callback(removed), one.remove_done_callback(removed)] == [True, False]
    assert seen == []
    one.set_result(3)
    assert seen == [("watch", None), ("a", 3), ("c", 3)]
    one.add_done_callback(lambda future: seen.append(("late", future.result())))
    one.watch(lambda: seen.append(("watched", None)))
    one.set_result(4)
    assert seen[3:] == [("late", 3), ("watched", None)]
    queue, owned = Queue(), Future()
    owned.belongs_to(queue)
    owned.add_done_callback(print)
    owned.cancel()
    owned.add_done_callback(repr)
    assert queue.tasks == [(print, owned), (repr, owned)]


def test_a_task_runs_a_function_once() -> None:
    one = Task(lambda a, b: a + b, (1,), {"b": 2})
    assert (one.is_ready(), one.executing()) == (True, False)
    one.run()
    assert (one.result(), one.is_ready(), one.done()) == (3, False, True)


def test_coroutine_waits_for_its_future() -> None:
    queue, awaited = Queue(), Future()

    async def work(add: int) -> int:
        assert one.executing()
        return int(await awaited) + add

    one = Task(work, (1,), executor=queue)
    one.run()
    assert (one.is_ready(), one.pending(), one.executing(), queue.woken) == (False, True, False, 0)
    awaited.set_result(4)
    assert (one.is_ready(), queue.woken) == (True, 1)
    one.run()
    assert (one.result(), one.done()) == (5, True)


def test_cancelling_closes_a_coroutine_object() -> None:
    closed: list[bool] = []

    async def work() -> None:
        try:
            await Future()
        finally:
            closed.append(True)

    one = Task(work())
    one.run()
    one.cancel()
    assert (closed, state(one), one.is_ready()) == ([True], (False, True, False), False)
    one.cancel()
    assert closed == [True]


def test_an_exception_of_a_task_is_kept_and_raised() -> None:
    one = Task(lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        one.run()
    assert (one.done(), type(one.exception()), one.executing()) == (True, ZeroDivisionError, False)


class Clock:
    """A scheduler whose waits end at once, at the requested time."""

    def __init__(self) -> None:
        self.time = 10 * SECOND

    def wait(self, until: int) -> None:
        self.time = until


def node() -> Any:
    made = SimpleNamespace(process=SimpleNamespace(scheduler=Clock(), ending=False), notified=0)
    made.get_clock = lambda: SimpleNamespace(clock_type=ClockType.ROS_TIME)
    made.notify = lambda: setattr(made, "notified", made.notified + 1)
    return made


def test_timer_skips_missed_periods() -> None:
    owner, calls = node(), list[float]()
    clock = owner.process.scheduler
    timer = Timer(owner, 2 * SECOND, lambda: calls.append(clock.time / SECOND), None)
    assert (timer.is_ready(), timer.time_until_next_call(), timer.time_since_last_call()) == (
        False,
        2 * SECOND,
        0,
    )
    for now, due in ((12, 14), (14.5, 16), (20, 22), (27, 28)):
        clock.time = round(now * SECOND)
        assert timer.is_ready()
        timer.run()
        assert (timer.due / SECOND, timer.is_ready()) == (due, False)
    assert calls == [12, 14.5, 20, 27]
    clock.time = 27 * SECOND + 5
    assert (timer.time_since_last_call(), timer.time_until_next_call()) == (5, SECOND - 5)


def test_reset_starts_a_new_period() -> None:
    owner = node()
    timer = Timer(owner, 2 * SECOND, None, None)
    timer.cancel()
    owner.process.scheduler.time = 13 * SECOND
    assert (timer.is_canceled(), timer.is_ready(), timer.time_until_next_call()) == (True, False, None)
    timer.reset()
    assert (timer.is_canceled(), timer.due, owner.notified) == (False, 15 * SECOND, 1)
    assert timer.run() is None
    timer.destroy()
    assert timer.is_canceled()


def test_a_timer_without_a_period_is_always_ready() -> None:
    timer = Timer(node(), 0, None, None)
    timer.run()
    assert timer.is_ready()


def test_callback_gets_the_times_if_it_has_a_parameter() -> None:
    owner, seen = node(), list[TimerInfo]()

    def called(info: TimerInfo) -> None:
        seen.append(info)

    timer = Timer(owner, 2 * SECOND, called, None)
    owner.process.scheduler.time = 13 * SECOND
    timer.run()
    assert (seen[0].expected_call_time, seen[0].actual_call_time) == (
        Time(nanoseconds=12 * SECOND, clock_type=ClockType.ROS_TIME),
        Time(nanoseconds=13 * SECOND, clock_type=ClockType.ROS_TIME),
    )
    timer.callback = lambda: seen.clear()
    timer.run()
    assert seen == []


def test_a_rate_keeps_its_phase_and_skips_missed_cycles() -> None:
    owner = node()
    clock, rate = owner.process.scheduler, Rate(owner, 2.0)
    times = []
    for spent in (0.0, 0.2, 0.5, 1.2, 0.1):
        clock.time += round(spent * SECOND)
        rate.sleep()
        times.append(clock.time / SECOND)
    assert times == [10.5, 11.0, 11.5, 12.7, 13.0]
    owner.process.ending = True
    with pytest.raises(ROSInterruptException):
        rate.sleep()


ROS, STEADY = ClockType.ROS_TIME, ClockType.STEADY_TIME


def test_durations_are_counted_in_nanoseconds() -> None:
    one = Duration(seconds=1.5, nanoseconds=7)
    assert (one.nanoseconds, (one + one).nanoseconds, (one - Duration(seconds=2)).nanoseconds) == (
        1_500_000_007, 3_000_000_014, -499_999_993
    )  # fmt: skip
    assert (one * 2, 0.5 * Duration(nanoseconds=5)) == (one + one, Duration(nanoseconds=2))
    assert (str(one), repr(one)) == ("1500000007 nanoseconds", "Duration(nanoseconds=1500000007)")
    made = Duration(seconds=-1.5).to_msg()
    assert (made.sec, made.nanosec, Duration.from_msg(made)) == (-2, 500_000_000, Duration(seconds=-1.5))
    assert len({one, Duration(nanoseconds=1_500_000_007), Duration()}) == 2
    for wrong in (lambda: one + 1, lambda: one - Time(), lambda: one * "2", lambda: one < 1):
        with pytest.raises(TypeError):
            wrong()


@pytest.mark.parametrize("kind", [Duration, Time])
def test_times_are_ordered(kind: Any) -> None:
    low, high = kind(nanoseconds=1), kind(nanoseconds=2)
    assert [
        low < high,
        low <= high,
        low <= kind(nanoseconds=1),
        high > low,
        high >= low,
        low == kind(nanoseconds=1),
    ] == [True] * 6
    assert [
        low > high,
        low >= high,
        low > kind(nanoseconds=1),
        high < low,
        high <= low,
        low == high,
        low == 1,
    ] == [False] * 7
    for compare in (lambda: low < 1, lambda: low <= 1, lambda: low > 1, lambda: low >= 1):
        with pytest.raises(TypeError):
            compare()


def test_instants_of_different_clocks_are_not_compared() -> None:
    one, other = Time(seconds=3, clock_type=ROS), Time(seconds=3, clock_type=STEADY)
    for wrong in (lambda: one == other, lambda: one < other, lambda: one - other):
        with pytest.raises(TypeError, match="different clock types"):
            wrong()
    assert one + Duration(seconds=1) == Duration(seconds=1) + one == Time(seconds=4, clock_type=ROS)
    assert one - Duration(seconds=1) == Time(seconds=2, clock_type=ROS)
    assert one - Time(seconds=5, clock_type=ROS) == Duration(seconds=-2)
    assert (Time().clock_type, int(ROS), Time(seconds=1.25).seconds_nanoseconds()) == (
        ClockType.SYSTEM_TIME, 1, (1, 250_000_000)
    )  # fmt: skip
    assert repr(one) == "Time(nanoseconds=3000000000, clock_type=ROS_TIME)"
    for wrong in ({"seconds": -1}, {"nanoseconds": -1}):  # type: ignore[assignment]
        with pytest.raises(ValueError, match="must not be negative"):
            Time(**wrong)  # type: ignore[arg-type]
    made: Any = message_type("builtin_interfaces/msg/Time")(sec=3, nanosec=5)
    assert Time.from_msg(made) == Time(seconds=3, nanoseconds=5, clock_type=ROS)
    assert Time.from_msg(made).to_msg() == made
    assert len({one, Time(seconds=3, clock_type=ROS), other}) == 2
    assert JumpThreshold(min_forward=None, min_backward=None).on_clock_change is True
