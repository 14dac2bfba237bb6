"""The topics and services of an episode, without nodes."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RecordingError, UnsupportedApiError
from pytest_tarl.ros import message_type
from pytest_tarl.ros.bus import Bus, _compatible
from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.scheduler import Scheduler, current_task
from pytest_tarl.ros.services import Reply, ServiceDirectory
from tests.plugin.ros.conftest import Program

STRING = message_type("std_msgs/String")


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


def test_each_subscriber_gets_its_own_copy_of_a_message(bus: Bus, program: Program) -> None:
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


def test_latched_message_reaches_later_subscribers(bus: Bus, program: Program, clock: Scheduler) -> None:
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


def test_invalid_world_message_is_a_test_error(bus: Bus) -> None:
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


def test_node_message_reaches_the_world_before_other_nodes(
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


def test_a_latched_message_of_a_node_keeps_its_publisher(
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


def test_only_the_endpoints_of_the_ended_process_are_disconnected(
    bus: Bus, program: Program, clock: Scheduler
) -> None:
    other = Program(clock)
    ends = Subscriber(program), Subscriber(other)
    for one in ends:
        bus.attach(one, bus.topic("/a"))
    bus.disconnect(program)
    assert bus.topic("/a").subscriptions == [ends[1]]


def test_world_error_is_raised_in_the_test(bus: Bus, program: Program, clock: Scheduler) -> None:
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


def test_an_error_about_different_types_names_the_node(bus: Bus, program: Program) -> None:
    bus.attach(Subscriber(program, message_type("std_msgs/Float64")), bus.topic("/a"))
    with pytest.raises(
        RecordingError,
        match="/a carries std_msgs/String, but node 'program' subscribes to it as std_msgs/Float64",
    ):
        bus.publish("/a", STRING(data="x"))


def test_qos_profiles_decide_whether_two_ros2_endpoints_connect() -> None:
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


def test_only_the_current_endpoint_can_be_removed(clock: Scheduler) -> None:
    directory = ServiceDirectory(clock)
    old, new = Endpoint(), Endpoint()
    directory.add("/s", old)  # type: ignore[arg-type]
    directory.add("/s", new)  # type: ignore[arg-type]
    directory.remove("/s", old)  # type: ignore[arg-type]
    assert directory.find("/s") is new
    directory.remove("/s", new)  # type: ignore[arg-type]
    assert "/s" not in directory


def test_task_waits_for_a_service_or_a_timeout(clock: Scheduler, program: Program) -> None:
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


def test_reply_ends_with_a_response_or_a_refusal() -> None:
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
