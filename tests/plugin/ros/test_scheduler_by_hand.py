"""The scheduler, its locks, the bus, the services and the executors of an episode, without nodes."""

from __future__ import annotations

import threading
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import NodeError, RecordingError, StuckNodeError, UnsupportedApiError
from pytest_tarl.ros import message_type
from pytest_tarl.ros.bus import Bus, _compatible
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.polling import AGAIN, PAUSE, asked
from pytest_tarl.ros.rclpy.executors import _until
from pytest_tarl.ros.scheduler import PATIENCE, Scheduler, Task, current_task, hand_over, running_task
from pytest_tarl.ros.services import Reply, ServiceDirectory
from pytest_tarl.ros.threads import Lock, ReentrantLock

STRING = message_type("std_msgs/String")


class Program:
    """A process of tasks that notes how they end."""

    label = "program"

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler = scheduler
        self.tasks: list[Task] = []
        self.ending = False
        self.errors: list[BaseException] = []
        self.refused = 0

    def failed(self, task: Task, error: BaseException) -> None:
        self.errors.append(error)

    def finished(self, task: Task) -> None:
        self.tasks.remove(task)

    def spins(self, place: Any) -> NodeError:
        return NodeError(f"spins at {place}")

    def refuse_to_wait(self) -> None:
        self.refused += 1


@pytest.fixture
def clock() -> Scheduler:
    return Scheduler()


@pytest.fixture
def program(clock: Scheduler) -> Program:
    return Program(clock)


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


def test_tasks_wake_in_the_order_of_their_instants_and_then_of_their_waits(
    clock: Scheduler, program: Program
) -> None:
    trail: list[tuple[str, int]] = []

    def task(name: str, until: int) -> None:
        clock.wait(until)
        trail.append((name, clock.time))

    for name, until in (("a", 9), ("b", 3), ("c", 9), ("d", 3)):
        clock.spawn(program, task, name, until)
    clock.advance(9)
    assert trail == [("b", 3), ("d", 3), ("a", 9), ("c", 9)]


def test_an_instant_that_has_passed_wakes_a_task_without_moving_the_clock(
    clock: Scheduler, program: Program
) -> None:
    clock.advance(10)
    trail: list[int] = []

    def task() -> None:
        clock.wait(3)
        trail.append(clock.time)

    clock.spawn(program, task)
    assert trail == []
    clock.advance(10)
    assert trail == [10]


def test_a_woken_task_resumes_once_and_is_told_so(clock: Scheduler, program: Program) -> None:
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


def test_a_task_that_starts_another_runs_on_until_it_waits(clock: Scheduler, program: Program) -> None:
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


def test_a_task_yields_to_those_that_are_ready(clock: Scheduler, program: Program) -> None:
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


def test_an_alarm_that_an_alarm_sets_is_in_order_as_well(clock: Scheduler) -> None:
    trail: list[int] = []
    clock.at(2, lambda: clock.at(3, lambda: trail.append(clock.time)))
    clock.at(4, lambda: trail.append(clock.time))
    clock.advance(5)
    assert trail == [3, 4]


def test_an_alarm_set_by_a_task_is_not_overtaken_by_a_later_one(clock: Scheduler, program: Program) -> None:
    trail: list[str] = []

    def task() -> None:
        clock.wait(2)
        clock.at(3, lambda: trail.append("of the task"))

    clock.spawn(program, task)
    clock.at(4, lambda: trail.append("late"))
    clock.advance(5)
    assert trail == ["of the task", "late"]


def test_an_alarm_set_by_a_task_rings_at_its_instant_even_if_it_is_the_only_one(
    clock: Scheduler, program: Program
) -> None:
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


def test_jobs_run_outside_of_tasks_once_the_running_one_waits(clock: Scheduler, program: Program) -> None:
    trail: list[Any] = []

    def task() -> None:
        clock.later(lambda: trail.append(running_task()))
        trail.append("task")
        clock.wait(1)

    clock.spawn(program, task)
    clock.settle()
    assert trail == ["task", None]


def test_the_exception_of_a_task_is_passed_to_its_program(clock: Scheduler, program: Program) -> None:
    def task() -> None:
        raise ValueError("boom")

    made = clock.spawn(program, task)
    assert [str(one) for one in program.errors] == ["boom"]
    assert made.done
    assert program.tasks == []


def test_a_killed_task_ends_where_it_waits_and_one_that_never_ran_does_not_begin(
    clock: Scheduler, program: Program
) -> None:
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


def test_greenlets_are_used_again_and_end_with_the_scheduler(clock: Scheduler, program: Program) -> None:
    workers = []
    for _ in range(3):
        made = clock.spawn(program, lambda: None)
        workers.append(made.worker)
    assert len({id(one) for one in workers}) == 1
    clock.close()
    assert workers[0] is not None
    assert workers[0].dead
    assert clock.spawn(program, lambda: None).worker is not workers[0]


def test_only_tasks_can_wait_and_hand_over(clock: Scheduler) -> None:
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


def test_a_task_that_never_waits_is_named_by_its_program(clock: Scheduler, program: Program) -> None:
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
def test_a_polling_task_waits_after_its_patience_and_then_more_often(
    count: int, waits: int, clock: Scheduler, program: Program
) -> None:
    assert polls(clock, program, count) == waits


@pytest.mark.parametrize(("ahead", "pauses"), [(1, 0), (0, 1), (None, 0)])
def test_a_wait_for_a_later_instant_renews_the_patience_of_a_task(
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
    asked()  # outside of tasks, nothing happens


def test_seconds_are_rounded_to_whole_nanoseconds() -> None:
    assert (nanoseconds(1.5), nanoseconds(1e-9), nanoseconds(0.4e-9)) == (1_500_000_000, 1, 0)
    assert seconds(1_500_000_000) == 1.5
    assert [_until(7, one) for one in (None, -1, 0, 2e-9)] == [None, None, 7, 9]


# locks


def test_a_lock_is_given_to_the_task_that_has_waited_longest(clock: Scheduler, program: Program) -> None:
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


def test_a_task_that_gave_up_waiting_is_not_woken_in_place_of_another(
    clock: Scheduler, program: Program
) -> None:
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


def test_a_condition_restores_how_often_its_lock_was_acquired(clock: Scheduler, program: Program) -> None:
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


# the bus


class Subscriber:
    """A node's end of a topic that keeps what it receives."""

    def __init__(self, program: Program, message_type: type | None = None, profile: Any = None) -> None:
        self.process, self.message_type, self.qos_profile = program, message_type, profile
        self.received: list[Any] = []

    def deliver(self, message: Any, origin: Any = None) -> None:
        self.received.append((message, origin))

    @property
    def texts(self) -> list[str]:
        return [message.data for message, _ in self.received]


class Publisher:
    """A node's end of a topic that it publishes on."""

    type = "std_msgs/String"

    def __init__(self, program: Program, profile: Any = None) -> None:
        self.process, self.qos_profile = program, profile
        self.changes: list[Any] = []

    def peers_changed(self, subscription: Any, *, joined: bool) -> None:
        self.changes.append((subscription, joined))


@pytest.fixture
def bus(clock: Scheduler) -> Bus:
    def run(job: Callable[..., None], *given: Any) -> None:
        job(*given)
        clock.settle()

    return Bus(clock, run, ServiceDirectory(clock))


def test_a_message_of_the_world_reaches_every_subscriber_as_a_copy_of_its_own(
    bus: Bus, program: Program
) -> None:
    ends = [Subscriber(program), Subscriber(program, STRING), Subscriber(program)]
    for one in ends:
        bus.attach(one, bus.topic("/a"))
    sent = STRING(data="x")
    bus.publish("a", sent)
    received = [one.received[0][0] for one in ends]
    assert [one.data for one in received] == ["x"] * 3
    assert len({id(one) for one in [*received, sent]}) == 4
    assert bus.topic("a").carried
    assert not bus.topic("b").carried
    assert bus.latest("/a") is None


def test_a_muted_bus_discards_the_messages_of_the_world(bus: Bus, program: Program) -> None:
    one = Subscriber(program)
    bus.attach(one, bus.topic("/a"))
    bus.muted = True
    bus.publish("/a", STRING(data="x"))
    assert one.received == []
    assert not bus.topic("/a").carried


def test_a_latched_message_is_delivered_to_later_subscribers_that_want_it(
    bus: Bus, program: Program, clock: Scheduler
) -> None:
    bus.publish("/a", STRING(data="old"), latch=True)
    bus.publish("/a", STRING(data="new"), latch=True)
    bus.publish("/a", STRING(data="gone"))
    late, uninterested = Subscriber(program), Subscriber(program)
    bus.attach(late, bus.topic("/a"))
    bus.attach(uninterested, bus.topic("/a"), wants_kept=False)
    assert late.received == []
    clock.settle()
    assert (late.texts, uninterested.texts) == (["new"], [])
    assert late.received[0][1] is None
    assert bus.subscribed == {"/a"}


def test_a_message_that_is_not_valid_is_an_error_of_the_test(bus: Bus) -> None:
    with pytest.raises(RecordingError, match=r"^The message published on /a is not valid: "):
        bus.publish("a", "text")
    with pytest.raises(RecordingError, match="is not callable"):
        bus.subscribe("a", 3)  # type: ignore[arg-type]


def test_a_header_without_a_stamp_gets_the_present_time(bus: Bus, program: Program, clock: Scheduler) -> None:
    clock.advance(2_500_000_001)
    one = Subscriber(program)
    bus.attach(one, bus.topic("/a"))
    kind = message_type("geometry_msgs/PointStamped")
    bus.publish("/a", kind())
    stamped = kind()
    stamped.header.stamp.secs = 1
    bus.publish("/a", stamped)
    stamps = [(message.header.stamp.secs, message.header.stamp.nsecs) for message, _ in one.received]
    assert stamps == [(2, 500_000_001), (1, 0)]


def test_a_nodes_message_reaches_the_world_at_once_and_other_nodes_when_it_waits(
    bus: Bus, program: Program, clock: Scheduler
) -> None:
    one, origin, heard, told = Subscriber(program), Publisher(program), list[str](), list[Any]()
    place = bus.topic("/a")
    bus.advertise(origin, place)
    bus.attach(one, place)
    bus.subscribe("/a", lambda message: heard.append(message.data))
    bus.observe(lambda topic, message: told.append((topic, message.data)))
    bus.emitted = lambda topic, message: told.append(("emitted", topic, message.data))
    trail: list[Any] = []

    def node() -> None:
        bus.publish_from(origin, place, STRING(data="x"))
        trail.append((list(heard), one.texts, bus.latest("/a").data))  # type: ignore[union-attr]
        clock.wait(1)
        trail.append(one.texts)

    clock.spawn(program, node)
    clock.advance(1)
    assert trail == [(["x"], [], "x"), ["x"]]
    assert told == [("emitted", "/a", "x"), ("/a", "x")]
    assert one.received[0][1] is origin
    assert origin.changes == [(one, True)]
    assert bus.published == {"/a": 1}


def test_a_kept_message_of_a_node_comes_from_its_publication(
    bus: Bus, program: Program, clock: Scheduler
) -> None:
    origin, place = Publisher(program), bus.topic("/a")
    bus.advertise(origin, place)
    bus.publish_from(origin, place, STRING(data="x"), keep=1)
    bus.publish_from(origin, place, STRING(data="y"))
    one = Subscriber(program)
    bus.attach(one, place)
    clock.settle()
    assert [(message.data, end) for message, end in one.received] == [("x", origin)]
    bus.disconnect(program)
    assert (place.publications, place.subscriptions) == ([], [])
    two = Subscriber(program)
    bus.attach(two, place)
    clock.settle()
    assert [(message.data, end) for message, end in two.received] == [("x", None)]


def test_only_the_ends_of_an_ended_process_are_disconnected(
    bus: Bus, program: Program, clock: Scheduler
) -> None:
    other = Program(clock)
    ends = Subscriber(program), Subscriber(other)
    for one in ends:
        bus.attach(one, bus.topic("/a"))
    bus.disconnect(program)
    assert bus.topic("/a").subscriptions == [ends[1]]


def test_an_error_of_the_world_is_raised_in_the_test(bus: Bus, program: Program, clock: Scheduler) -> None:
    def fail(_: Any) -> None:
        raise ValueError("first" if clock.failure is None else "second")

    bus.subscribe("/a", fail)
    for _ in range(2):
        bus.publish_from(Publisher(program), bus.topic("/a"), STRING(data="x"))
    assert str(clock.failure) == "first"


def test_messages_pass_through_channels_and_arrive_after_their_delays(
    bus: Bus, program: Program, clock: Scheduler
) -> None:
    one = Subscriber(program)
    bus.attach(one, bus.topic("/a"))
    times: list[float] = []

    def twice(message: Any, now: float) -> list[tuple[float, Any]]:
        times.append(now)
        return [(0.0, message), (2.0, STRING(data="late"))]

    def later(message: Any, now: float) -> list[tuple[float, Any]]:
        times.append(now)
        return [(1.0, message)]

    clock.advance(nanoseconds(5.0))
    bus.interpose("/a", twice)
    bus.interpose("/a", later)
    bus.publish("/a", STRING(data="x"))
    assert (one.texts, times) == ([], [5.0, 5.0, 7.0])
    clock.advance(nanoseconds(6.0))
    assert one.texts == ["x"]
    clock.advance(nanoseconds(8.0) - 1)
    assert one.texts == ["x"]
    clock.advance(nanoseconds(8.0))
    assert one.texts == ["x", "late"]


def test_a_type_that_differs_is_named_with_its_node(bus: Bus, program: Program) -> None:
    bus.attach(Subscriber(program, message_type("std_msgs/Float64")), bus.topic("/a"))
    with pytest.raises(
        RecordingError,
        match="/a carries std_msgs/String, but node 'program' subscribes to it as std_msgs/Float64",
    ):
        bus.publish("/a", STRING(data="x"))


def test_profiles_decide_whether_two_ends_of_ros2_connect() -> None:
    yes, no = (SimpleNamespace(satisfies=lambda _, answer=answer: answer) for answer in (True, False))
    end: Any = lambda profile: SimpleNamespace(qos_profile=profile)  # noqa: E731
    assert _compatible(end(yes), end(no))
    assert not _compatible(end(no), end(yes))
    assert _compatible(end(None), end(no))
    assert _compatible(end(no), end(None))
    plain: Any = SimpleNamespace()
    assert _compatible(plain, plain)


def test_an_incompatible_subscription_receives_nothing(bus: Bus, program: Program, clock: Scheduler) -> None:
    no = SimpleNamespace(satisfies=lambda _: False)
    origin, place = Publisher(program, no), bus.topic("/a")
    ends = Subscriber(program, profile="wanted"), Subscriber(program)
    for one in ends:
        bus.attach(one, place)
    bus.publish_from(origin, place, STRING(data="x"))
    clock.settle()
    assert [one.texts for one in ends] == [[], ["x"]]


def test_topics_are_found_by_every_spelling(bus: Bus) -> None:
    assert bus.topic("a") is bus.topic("/a") is bus.topic("//a/")
    assert [one.name for one in bus.topics()] == ["/a"]
    bus.topic("b")
    assert [one.name for one in bus.topics()] == ["/a", "/b"]


def test_without_an_embedded_ros_there_are_no_services(clock: Scheduler) -> None:
    real = Bus(clock, lambda job, *given: job(*given))
    with pytest.raises(UnsupportedApiError, match=r"tarl\.bus\.serve works with --tarl-ros=embedded only"):
        real.serve("s", None, lambda _: None)


# services


class Endpoint:
    service_class, request_type = "kind", STRING

    def __init__(self, answer: str = "") -> None:
        self.answer = answer

    def handle(self, request: Any, answer: Callable[[Any], None]) -> None:
        answer(STRING(data=f"{self.answer}{request.data}"))


def test_an_offered_service_is_created_on_the_first_request(clock: Scheduler) -> None:
    directory, made = ServiceDirectory(clock), list[str]()

    def make() -> None:
        made.append("made")
        directory.add("/s", Endpoint())  # type: ignore[arg-type]

    directory.offer(["/s", "/t"], make)
    assert "/s" in directory
    assert directory.names() == []
    assert directory.find("/s") is directory.find("/s")
    assert made == ["made"]
    directory.withdraw(["/t", "/unknown"])
    assert "/t" not in directory
    assert directory.find("/t") is None


def test_only_the_present_endpoint_of_a_name_can_be_removed(clock: Scheduler) -> None:
    directory = ServiceDirectory(clock)
    old, new = Endpoint(), Endpoint()
    directory.add("/s", old)  # type: ignore[arg-type]
    directory.add("/s", new)  # type: ignore[arg-type]
    directory.remove("/s", old)  # type: ignore[arg-type]
    assert directory.find("/s") is new
    directory.remove("/s", new)  # type: ignore[arg-type]
    assert "/s" not in directory


def test_a_task_waits_for_a_service_until_it_is_served_or_too_late(
    clock: Scheduler, program: Program
) -> None:
    directory, trail = ServiceDirectory(clock), list[Any]()
    going = [True]

    def task(until: int | None) -> None:
        trail.append((directory.wait(current_task(), "/s", until, lambda: going[0]), clock.time))

    clock.spawn(program, task, 3)
    clock.spawn(program, task, None)
    clock.advance(4)
    assert trail == [(False, 3)]
    clock.at(6, lambda: directory.add("/s", Endpoint()))  # type: ignore[arg-type]
    clock.advance(7)
    clock.settle()
    assert trail == [(False, 3), (True, 6)]
    going[0] = False
    clock.spawn(program, task, 99)
    assert trail[-1] == (True, 7)


def test_a_reply_is_done_with_a_response_or_a_reason() -> None:
    reply = Reply("/s")
    assert (reply.done, reply.response, reply.error) == (False, None, "")
    reply.take("answer")
    assert (reply.done, reply.response) == (True, "answer")


def test_a_request_of_the_world_is_answered_at_once(clock: Scheduler) -> None:
    directory = ServiceDirectory(clock)
    directory.add("/s", Endpoint("got "))  # type: ignore[arg-type]
    reply = directory.call("s", STRING(data="x"))
    assert reply is not None
    assert reply.response.data == "got x"
    assert directory.call("t", STRING()) is None
    with pytest.raises(RecordingError, match="The request to /s"):
        directory.call("s", message_type("std_msgs/Float64")())
