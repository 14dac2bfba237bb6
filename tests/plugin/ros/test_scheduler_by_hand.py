"""The scheduler of an episode, its polling and its locks, without nodes."""

from __future__ import annotations

import threading
from typing import Any

import pytest

from pytest_tarl.errors import NodeError, StuckNodeError
from pytest_tarl.ros import message_type
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.polling import AGAIN, PAUSE, asked
from pytest_tarl.ros.rclpy.executors import _until
from pytest_tarl.ros.scheduler import PATIENCE, Scheduler, Task, current_task, hand_over, running_task
from pytest_tarl.ros.threads import Lock, ReentrantLock
from tests.plugin.ros.conftest import Program

STRING = message_type("std_msgs/String")


# tasks


def test_a_task_runs_at_once_until_it_waits(clock: Scheduler, program: Program) -> None:
    trail: list[Any] = []

    def task() -> None:
        trail.append(clock.time)
        trail.append(clock.wait(5))
        trail.append(clock.time)

    made = clock.spawn(program, task)
    assert (trail, made.done, program.tasks) == ([0], False, [made])
    clock.advance(4)
    assert trail == [0]
    clock.advance(7)
    assert (trail, made.done, program.tasks, clock.time) == ([0, False, 5], True, [], 7)


def test_tasks_wake_in_order_of_time(clock: Scheduler, program: Program) -> None:
    trail: list[tuple[str, int]] = []

    def task(name: str, until: int) -> None:
        clock.wait(until)
        trail.append((name, clock.time))

    for name, until in (("a", 9), ("b", 3), ("c", 9), ("d", 3)):
        clock.spawn(program, task, name, until)
    clock.advance(9)
    assert trail == [("b", 3), ("d", 3), ("a", 9), ("c", 9)]


def test_past_instant_wakes_a_task_at_once(clock: Scheduler, program: Program) -> None:
    clock.advance(10)
    trail: list[int] = []

    def task() -> None:
        clock.wait(3)
        trail.append(clock.time)

    clock.spawn(program, task)
    assert trail == []
    clock.advance(10)
    assert trail == [10]


def test_woken_task_resumes_once(clock: Scheduler, program: Program) -> None:
    trail: list[Any] = []

    def task() -> None:
        trail.append(clock.wait(5))
        trail.append(clock.wait())

    made = clock.spawn(program, task)
    clock.wake(made)
    clock.wake(made)  # it is ready already
    assert trail == []
    clock.settle()
    assert trail == [True]
    clock.advance(9)  # the instant of the first wait is stale
    assert trail == [True]
    clock.wake(made)
    clock.settle()
    assert (trail, made.done) == ([True, True], True)
    clock.wake(made)
    clock.settle()


def test_starting_task_runs_until_it_waits(clock: Scheduler, program: Program) -> None:
    trail: list[str] = []

    def inner() -> None:
        trail.append("inner")

    def outer() -> None:
        clock.spawn(program, inner)
        trail.append("outer")
        clock.wait(1)

    clock.spawn(program, outer)
    clock.settle()
    assert trail == ["outer", "inner"]


def test_a_task_yields_to_tasks_that_are_ready(clock: Scheduler, program: Program) -> None:
    trail: list[str] = []

    def one() -> None:
        clock.spawn(program, lambda: trail.append("other"))
        clock.yield_now()
        trail.append("one")

    clock.spawn(program, one)
    clock.settle()
    assert (trail, clock.time) == (["other", "one"], 0)


def test_alarms_come_before_the_tasks_of_their_instant(clock: Scheduler, program: Program) -> None:
    trail: list[Any] = []

    def task() -> None:
        clock.wait(5)
        trail.append("task")

    clock.spawn(program, task)
    for instant, name in ((5, "first"), (5, "second"), (2, "early"), (8, "late")):
        clock.at(instant, lambda name=name: trail.append((name, clock.time)))  # type: ignore[misc]
    clock.advance(6)
    assert trail == [("early", 2), ("first", 5), ("second", 5), "task"]
    clock.advance(8)
    assert trail[-1] == ("late", 8)


def test_nested_alarms_ring_in_order(clock: Scheduler) -> None:
    trail: list[int] = []
    clock.at(2, lambda: clock.at(3, lambda: trail.append(clock.time)))
    clock.at(4, lambda: trail.append(clock.time))
    clock.advance(5)
    assert trail == [3, 4]


def test_earlier_alarm_rings_first(clock: Scheduler, program: Program) -> None:
    trail: list[str] = []

    def task() -> None:
        clock.wait(2)
        clock.at(3, lambda: trail.append("of the task"))

    clock.spawn(program, task)
    clock.at(4, lambda: trail.append("late"))
    clock.advance(5)
    assert trail == ["of the task", "late"]


def test_single_alarm_rings_at_its_time(clock: Scheduler, program: Program) -> None:
    trail: list[tuple[str, int]] = []

    def task() -> None:
        clock.wait(2)
        clock.at(5, lambda: trail.append(("alarm", clock.time)))
        clock.wait(7)
        trail.append(("task", clock.time))

    clock.spawn(program, task)
    clock.advance(20)
    assert trail == [("alarm", 5), ("task", 7)]
    assert clock.time == 20


def test_a_failure_stops_the_clock(clock: Scheduler, program: Program) -> None:
    trail: list[str] = []

    def fail() -> None:
        clock.failure = ValueError("x")

    def task() -> None:
        clock.wait(4)
        trail.append("task")

    clock.spawn(program, task)
    clock.at(3, fail)
    clock.at(3, lambda: trail.append("alarm"))
    clock.later(lambda: None)
    clock.advance(9)
    assert (trail, clock.time) == ([], 3)
    clock.later(lambda: trail.append("job"))
    clock.settle()
    assert trail == []


def test_jobs_run_outside_tasks_once_the_running_task_waits(clock: Scheduler, program: Program) -> None:
    trail: list[Any] = []

    def task() -> None:
        clock.later(lambda: trail.append(running_task()))
        trail.append("task")
        clock.wait(1)

    clock.spawn(program, task)
    clock.settle()
    assert trail == ["task", None]


def test_task_exception_reaches_its_program(clock: Scheduler, program: Program) -> None:
    def task() -> None:
        raise ValueError("boom")

    made = clock.spawn(program, task)
    assert [str(one) for one in program.errors] == ["boom"]
    assert made.done
    assert program.tasks == []


def test_killed_task_ends_where_it_waits(clock: Scheduler, program: Program) -> None:
    trail: list[str] = []
    waiting: list[Task] = []

    def sleeper() -> None:
        try:
            clock.wait()
        finally:
            trail.append("unwound")

    def starter() -> None:
        waiting.append(clock.spawn(program, lambda: trail.append("began")))
        clock.kill(waiting[0])

    slept = clock.spawn(program, sleeper)
    clock.kill(slept)
    assert (trail, slept.done, program.errors) == (["unwound"], True, [])
    clock.kill(slept)
    clock.spawn(program, starter)
    clock.settle()
    assert (trail, waiting[0].done, program.tasks) == (["unwound"], True, [])


def test_greenlets_are_reused_and_end_with_the_scheduler(clock: Scheduler, program: Program) -> None:
    workers = []
    for _ in range(3):
        made = clock.spawn(program, lambda: None)
        workers.append(made.worker)
    assert len({id(one) for one in workers}) == 1
    clock.close()
    assert workers[0] is not None
    assert workers[0].dead
    assert clock.spawn(program, lambda: None).worker is not workers[0]


def test_only_tasks_can_wait_and_hand_over_control(clock: Scheduler) -> None:
    assert running_task() is None
    for wrong, words in (
        (clock.wait, "only a task can wait"),
        (hand_over, "only a task can hand over"),
        (current_task, "only a task has a current task"),
        (clock.yield_now, "only a task has a current task"),
    ):
        with pytest.raises(RuntimeError, match=words):
            wrong()


def test_the_program_is_entered_before_each_of_its_tasks(clock: Scheduler, program: Program) -> None:
    entered: list[Any] = []
    clock.entering = entered.append
    clock.spawn(program, lambda: clock.wait(1))
    clock.advance(1)
    assert entered == [program, program]


def test_error_names_the_program_that_never_waits(clock: Scheduler, program: Program) -> None:
    assert isinstance(clock.spinning(), StuckNodeError)
    told: list[NodeError] = []
    clock.spawn(program, lambda: told.append(clock.spinning()))
    assert str(told[0]).startswith("spins at")


# polling


def polls(clock: Scheduler, program: Program, count: int) -> int:
    """Return how many times a task that polls `count` times at one instant has waited."""
    waits: list[int] = []

    def task() -> None:
        for _ in range(count):
            before = clock.time
            asked()
            if clock.time != before:
                waits.append(clock.time - before)

    clock.spawn(program, task)
    clock.advance(10**12)
    assert set(waits) <= {PAUSE}
    return len(waits)


@pytest.mark.parametrize(
    ("count", "waits"),
    [
        (PATIENCE - 1, 0),
        (PATIENCE, 1),
        (PATIENCE + AGAIN - 1, 1),
        (PATIENCE + AGAIN, 2),
        (PATIENCE + 5 * AGAIN, 6),
    ],
)
def test_polling_task_waits_after_its_limit(
    count: int, waits: int, clock: Scheduler, program: Program
) -> None:
    assert polls(clock, program, count) == waits


@pytest.mark.parametrize(("ahead", "pauses"), [(1, 0), (0, 1), (None, 0)])
def test_later_wait_resets_the_polling_limit(
    ahead: int | None, pauses: int, clock: Scheduler, program: Program
) -> None:
    before: list[int] = []

    def task() -> None:
        for _ in range(2):
            begun = clock.time
            for _ in range(PATIENCE - 1):
                asked()
            before.append(clock.time - begun)
            clock.wait(None if ahead is None else clock.time + ahead)

    made = clock.spawn(program, task)
    clock.wake(made)
    clock.advance(10**9)
    assert sum(one > 0 for one in before) == pauses
    assert len(before) == 2


def test_a_program_that_ends_refuses_to_wait(clock: Scheduler, program: Program) -> None:
    program.ending = True
    assert polls(clock, program, PATIENCE + AGAIN) == 0
    assert program.refused == 2
    asked()  # outside tasks, nothing happens


def test_seconds_are_rounded_to_whole_nanoseconds() -> None:
    assert (nanoseconds(1.5), nanoseconds(1e-9), nanoseconds(0.4e-9)) == (1_500_000_000, 1, 0)
    assert seconds(1_500_000_000) == 1.5
    assert [_until(7, one) for one in (None, -1, 0, 2e-9)] == [None, None, 7, 9]


# locks


def test_longest_waiting_task_gets_the_lock(clock: Scheduler, program: Program) -> None:
    lock, trail = Lock(clock), list[Any]()

    def task(name: str, hold: int) -> None:
        with lock:
            trail.append((name, clock.time))
            clock.wait(clock.time + hold)

    for name in "abc":
        clock.spawn(program, task, name, 10)
    clock.advance(100)
    assert trail == [("a", 0), ("b", 10), ("c", 20)]
    assert not lock.locked()
    with pytest.raises(RuntimeError, match="release unlocked lock"):
        lock.release()


def test_a_lock_is_awaited_for_a_limited_time(clock: Scheduler, program: Program) -> None:
    lock, trail = Lock(clock), list[Any]()
    assert lock.acquire()
    assert lock.locked()

    def task(*given: Any) -> None:
        trail.append((lock.acquire(*given), clock.time))

    clock.spawn(program, task, False)
    clock.spawn(program, task, True, 2e-9)
    clock.spawn(program, task, True, 0)
    clock.advance(5)
    assert trail == [(False, 0), (False, 0), (False, 2)]
    with pytest.raises(RuntimeError, match=r"call tarl\.step first"):
        lock.acquire()
    assert lock.acquire(False) is False
    clock.spawn(program, task, True, 20e-9)
    clock.advance(8)
    lock.release()
    clock.settle()
    assert trail[-1] == (True, 8)


def test_task_that_stopped_waiting_is_not_woken(clock: Scheduler, program: Program) -> None:
    lock, trail = Lock(clock), list[Any]()
    lock.acquire()
    clock.spawn(program, lambda: trail.append(("impatient", lock.acquire(True, 1e-9))))
    clock.spawn(program, lambda: trail.append(("patient", lock.acquire())))
    clock.advance(3)
    lock.release()
    clock.settle()
    assert trail == [("impatient", False), ("patient", True)]


def test_a_reentrant_lock_is_free_after_as_many_releases(clock: Scheduler, program: Program) -> None:
    lock, trail = ReentrantLock(clock), list[Any]()

    def holder() -> None:
        lock.acquire()
        lock.acquire()
        clock.wait(5)
        lock.release()
        clock.wait(10)
        lock.release()

    def other() -> None:
        with pytest.raises(RuntimeError, match="cannot release un-acquired lock"):
            lock.release()
        trail.append(lock.acquire(False))
        with lock:
            trail.append(clock.time)

    clock.spawn(program, holder)
    clock.spawn(program, other)
    clock.advance(20)
    assert trail == [False, 10]
    assert not lock.locked()


def test_a_condition_restores_the_recursion_count_of_its_lock(clock: Scheduler, program: Program) -> None:
    lock, trail = ReentrantLock(clock), list[Any]()
    condition = threading.Condition(lock)  # type: ignore[arg-type]

    def holder() -> None:
        lock.acquire()
        lock.acquire()
        count = lock._release_save()
        trail.append((count, lock.locked(), lock._is_owned()))
        lock._acquire_restore(count)
        lock.release()
        trail.append(lock.locked())
        lock.release()
        trail.append(lock.locked())

    clock.spawn(program, holder)
    assert trail == [(2, False, False), True, False]
    assert condition is not None
    assert program.errors == []
