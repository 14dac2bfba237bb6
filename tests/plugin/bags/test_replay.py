"""The replay of a mission on the virtual clock: steps, rewards, delivered messages, and notes for the user."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.bags.channels import Channel, Recorded
from pytest_tarl.bags.reading import Bag
from pytest_tarl.bags.replay import ALWAYS_THERE, Moment, Replay
from pytest_tarl.errors import SettingsError
from pytest_tarl.ros import Ros, message_type
from pytest_tarl.sensors import Sensor

START = 1_700_000_000 * 10**9  # ns
LEVEL = Sensor("level", topic="level", field="data")
Float64, Float32 = message_type("std_msgs/Float64"), message_type("std_msgs/Float32")


class Mission(Bag):
    """A bag of numbers: (seconds, topic, value)."""

    def __init__(self, messages: Sequence[tuple[float, str, float]], **channels: Any) -> None:
        def source() -> Iterator[Recorded]:
            for time, topic, value in messages:
                yield Recorded(START + round(time * 1e9), topic, str(value).encode())

        known = {topic: Channel(topic, "std_msgs/msg/Float64") for _, topic, _ in messages}
        known |= {f"/{name}": Channel(f"/{name}", **changed) for name, changed in channels.items()}
        super().__init__(Path("mission.bag"), "ros1", known, source, START)
        self.decoded: list[str] = []

    def decode(self, topic: str, data: bytes) -> Any:
        self.decoded.append(topic)
        return SimpleNamespace(data=float(data), __msgtype__=self.channels[topic].type)


class Played:
    """A replay without a node, and what was delivered, rewarded and told."""

    def __init__(
        self,
        bag: Mission,
        dt: float = 0.5,
        sensors: Sequence[Sensor] = (LEVEL,),
        monitor: Any = lambda moment: moment.now,
        ready: Sequence[bool] = (),
        **given: Any,
    ) -> None:
        self.rewards: list[Any] = []
        self.heard: list[tuple[float, str, float]] = []
        self.observed: dict[str, Any] = {}
        answers = iter(ready)
        self.replay = Replay(bag, sensors, monitor, given.get("judge"), **given.get("more", {}))
        self.ros = Ros()
        self.replay.begin(self.ros)
        self.muted_before = self.ros.bus.muted
        self.ros.bus.observe(self._hear)
        given.get("prepare", lambda _: None)(self.ros)
        self.replay.run(
            self.ros,
            dt,
            lambda: next(answers, True),
            self.rewards.append,
            lambda **values: self.observed.update(values),
        )
        self.end = self.ros.now
        self.ros.close()

    def _hear(self, topic: str, message: Any) -> None:
        self.heard.append((round(self.ros.scheduler.time / 1e9 - START / 1e9, 6), topic, message.data))


def test_sensor_messages_are_delivered_at_their_times() -> None:
    bag = Mission([(0.0, "/level", 1.0), (0.3, "/level", 2.0), (0.5, "/level", 3.0), (1.7, "/level", 4.0)])
    played = Played(bag)
    assert played.heard == [
        (0.0, "/level", 1.0),
        (0.3, "/level", 2.0),
        (0.5, "/level", 3.0),
        (1.7, "/level", 4.0),
    ]
    assert played.rewards == [0.5, 1.0, 1.5, 2.0]  # the last step ends after the last message
    assert played.muted_before is True
    assert played.ros.bus.muted is False
    assert (played.replay.begun, played.replay.done) == (True, True)
    assert round(played.end * 10) == (START // 10**9) * 10 + 20


def test_message_at_a_step_end_belongs_to_the_next_step() -> None:
    seen: list[float] = []
    bag = Mission([(0.0, "/level", 1.0), (0.5, "/level", 2.0), (0.9, "/level", 3.0)])
    Played(bag, monitor=lambda moment: seen.append(moment.latest("/level").data) or 0.0)
    assert seen == [1.0, 3.0]


def test_only_the_last_bag_step_ends_the_mission() -> None:
    over: list[bool] = []
    bag = Mission([(0.0, "/level", 1.0), (1.2, "/level", 2.0)])
    Played(bag, monitor=lambda moment: over.append(moment.over) or 0.0)
    assert over == [False, False, True]


def test_steps_before_the_nodes_are_ready_are_not_rewarded() -> None:
    bag = Mission([(0.0, "/level", 1.0), (1.9, "/level", 2.0)])
    assert Played(bag, ready=[False, True, False]).rewards == [1.0, 2.0]


@pytest.mark.parametrize("dt", [0.0, -0.1, 1e-10])
def test_a_step_of_zero_seconds_is_refused(dt: float) -> None:
    with pytest.raises(SettingsError, match=r"tarl\.step\(0\)"):
        Played(Mission([(0.0, "/level", 1.0)]), dt=dt)


def test_topics_without_a_reader_are_not_decoded() -> None:
    bag = Mission([(0.0, "/level", 1.0), (0.0, "/other", 2.0)])
    played = Played(bag)
    assert [topic for _, topic, _ in played.heard] == ["/level"]
    assert bag.decoded == ["/level"]


def test_latched_topics_are_delivered_and_kept_for_later_subscribers() -> None:
    bag = Mission([(0.0, "/map", 1.0)], map={"type": "std_msgs/msg/Float64", "latched": True})
    played = Played(bag)
    assert played.heard == [(0.0, "/map", 1.0)]
    assert [one.data for one in played.ros.bus.topic("/map").kept.values()] == [1.0]
    assert Played(Mission([(0.0, "/level", 1.0)])).ros.bus.topic("/level").kept == {}


def test_topics_of_formulas_are_delivered() -> None:
    requirements: Any = SimpleNamespace(topics=["gauge"], rewarding=False)
    played = Played(Mission([(0.0, "/gauge", 1.0)]), more={"requirements": requirements})
    assert [topic for _, topic, _ in played.heard] == ["/gauge"]


class End:
    """One end of a topic."""

    def __init__(self, kind: Any = None) -> None:
        self.message_type = kind
        self.type = "std_msgs/Float64"
        self.process = SimpleNamespace(label="node")
        self.received: list[Any] = []

    def deliver(self, message: Any, origin: Any = None) -> None:
        self.received.append(message)


def subscribed(topic: str, end: End) -> Any:
    return lambda ros: ros.bus.attach(end, ros.bus.topic(topic))


def test_topics_of_the_node_are_not_delivered() -> None:
    def publishes(ros: Ros) -> None:
        ros.bus.advertise(End(), ros.bus.topic("/level"))  # type: ignore[arg-type]

    assert Played(Mission([(0.0, "/level", 1.0)]), prepare=publishes).heard == []


@pytest.mark.parametrize("kind", [Float64, None])
def test_messages_have_the_class_of_the_subscription(kind: Any) -> None:
    end = End(kind)
    bag = Mission([(0.0, "/odom", 1.0), (0.1, "/odom", 2.0)])
    played = Played(bag, prepare=subscribed("odom", end))
    assert [(type(one), one.data) for one in end.received] == [(Float64, 1.0), (Float64, 2.0)]
    assert played.replay.notes == ["the node published nothing while mission.bag was replayed."]


@pytest.mark.parametrize(
    ("kind", "type_", "said"),
    [
        (
            Float32,
            "std_msgs/msg/Float64",
            "the bag has std_msgs/msg/Float64 there, the node subscribes to it as std_msgs/Float32",
        ),
        (None, "my_msgs/msg/Odd", "the type my_msgs/msg/Odd is unknown here"),
    ],
)
def test_a_topic_of_another_type_is_refused_once(kind: Any, type_: str, said: str) -> None:
    end = End(kind)
    bag = Mission([(0.0, "/odom", 1.0), (0.1, "/odom", 2.0)], odom={"type": type_})
    played = Played(bag, prepare=subscribed("/odom", end))
    assert end.received == []
    assert played.replay.notes[0] == f"mission.bag: /odom was not replayed: {said}."
    assert len(played.replay.notes) == 2
    assert bag.decoded == ["/odom"]


def test_an_undefined_type_is_refused() -> None:
    class Undefined(Mission):
        def decode(self, topic: str, data: bytes) -> Any:
            raise KeyError("my/msg/Part")

    played = Played(Undefined([(0.0, "/level", 1.0)]))
    assert played.replay.notes[0] == "mission.bag: /level was not replayed: my/msg/Part is not defined."


def test_silent_subscribed_topics_are_noted() -> None:
    def listens(ros: Ros) -> None:
        for topic in ("/mode", "/level", "/own", *ALWAYS_THERE):
            ros.bus.attach(End(), ros.bus.topic(topic))  # type: ignore[arg-type]
        ros.bus.advertise(End(), ros.bus.topic("/own"))  # type: ignore[arg-type]
        ros.bus.published["/own"] += 1

    played = Played(Mission([(0.0, "level", 1.0)]), prepare=listens)
    assert played.replay.notes == [
        "mission.bag lacks /mode, which the node subscribes to: it received no message."
    ]


# monitors


def test_newest_message_is_found_with_or_without_a_slash() -> None:
    bag = Mission([(0.0, "level", 1.0)])
    moment = Moment(bag)
    assert moment.latest("/level") is None
    moment.take(Recorded(START, "level", b"1.0"))
    assert moment.latest("/level") is moment.latest("level") is moment.latest("/level/")
    assert bag.decoded == ["level"]
    moment.take(Recorded(START, "level", b"2.0"))
    assert moment.latest("level").data == 2.0
    assert (moment.now, moment.over, moment.latest("/unknown")) == (0.0, False, None)
    moment.observe(anything=1)


def test_a_monitor_class_is_instantiated_for_each_mission() -> None:
    class Watch:
        def __init__(self) -> None:
            self.count = 0

        def __call__(self, moment: Moment) -> Mapping[str, float]:
            self.count += 1
            return {"count": self.count}

    for _ in range(2):
        bag = Mission([(0.0, "/level", 1.0), (0.6, "/level", 1.0)])
        assert Played(bag, monitor=Watch).rewards == [{"count": 1}, {"count": 2}]


def test_a_monitor_can_set_signals() -> None:
    played = Played(Mission([(0.0, "/level", 1.0)]), monitor=lambda moment: moment.observe(speed=3) or 0.0)
    assert played.observed == {"speed": 3}


@pytest.mark.parametrize(("monitor", "calls"), [(True, 1), (False, 0)])
def test_a_monitor_gives_no_reward_if_formulas_give_it(monitor: bool, calls: int) -> None:
    seen: list[float] = []
    requirements: Any = SimpleNamespace(topics=[], rewarding=True)
    watch = (lambda moment: seen.append(moment.now) or 5.0) if monitor else None
    played = Played(Mission([(0.0, "/level", 1.0)]), monitor=watch, more={"requirements": requirements})
    assert played.rewards == [None]
    assert len(seen) == calls


def test_judge_compares_sensors_of_consecutive_steps() -> None:
    seen: list[tuple[Any, Any]] = []

    def judge(before: Mapping[str, Any], after: Mapping[str, Any]) -> float:
        seen.append((before, after))
        return float(len(seen))

    sensors = (LEVEL, Sensor("mood"))  # a sensor without a topic has no value
    bag = Mission([(0.0, "/level", 1.0), (0.6, "/level", 2.0), (1.1, "/level", 3.0)])
    played = Played(bag, sensors=sensors, monitor=None, judge=judge)
    assert played.rewards == [1.0, 2.0, 3.0]
    assert seen == [
        ({"level": 1.0}, {"level": 1.0}),
        ({"level": 1.0}, {"level": 2.0}),
        ({"level": 2.0}, {"level": 3.0}),
    ]


def test_bag_without_monitor_and_judge_has_no_rewards() -> None:
    with pytest.raises(SettingsError, match="A bag holds no rewards: give the marker monitor="):
        Played(Mission([(0.0, "/level", 1.0)]), monitor=None)
