"""The subscriptions of the observer, with stand-ins for rospy and rclpy."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import Sensor, Signal
from pytest_tarl.errors import LogError
from pytest_tarl.observing import listeners
from pytest_tarl.observing.listeners import Topics, watched

PLACE = Sensor("place", topic="/place", field="x", low=0, high=10, bins=5)
SPEED = Sensor("speed", topic="/speed", field="x", low=0, high=2, bins=2)


def test_topic_type_comes_from_the_command_line_or_recording() -> None:
    topics = Topics(
        {"/r": "a/msg/A", "/place": "b/msg/B"}, reward="/r", mission="/m", own={"/place": "c/msg/C"}
    )
    assert [topics.type_of(one) for one in ("/r", "/place", "/m")] == [
        "a/msg/A",
        "c/msg/C",
        "std_msgs/msg/String",
    ]
    assert Topics({}, reward="/r").type_of("/r") == "std_msgs/msg/Float64"
    with pytest.raises(LogError, match=r"The type of /other is unknown.*/other:TYPE"):
        topics.type_of("/other")


class Told:
    """An observer that notes what the listeners pass on."""

    sensors = (PLACE, Sensor("inner"), SPEED)
    signals = (Signal("tilt", topic="/t", field="x"), Signal("own"))

    def __init__(self) -> None:
        self.log: list[Any] = []

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *given: self.log.append((name, *given))


TOPICS = Topics(
    {"/place": "a_msgs/msg/A", "/speed": "a_msgs/A", "/t": "a_msgs/msg/B"},
    reward="/reward",
    mission="/mission",
)


@pytest.fixture
def library(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Put stand-ins of rospy, rclpy and message packages into `sys.modules`; return them."""
    log: list[Any] = []

    class Node:
        def __init__(self, name: str) -> None:
            log.append(("node", name))

        def create_subscription(self, *given: Any) -> None:
            log.append(("subscription", *given))

    class Publisher:
        def publish(self, *given: Any, **named: Any) -> str:
            log.append(("publish", given, named))
            return "sent"

    def profile(**given: Any) -> Any:
        return ("profile", given)

    modules: dict[str, dict[str, Any]] = {
        "rospy": {
            "init_node": lambda *given, **named: log.append(("init", given, named)),
            "Subscriber": lambda *given: log.append(("subscription", *given)),
            "Publisher": Publisher,
        },
        "rclpy": {},
        "rclpy.node": {"Node": Node},
        "rclpy.publisher": {"Publisher": Publisher},
        "rclpy.qos": {
            "QoSProfile": profile,
            "ReliabilityPolicy": SimpleNamespace(BEST_EFFORT="best effort"),
        },
        "a_msgs": {},
        "a_msgs.msg": {"A": int, "B": float},
        "std_msgs": {},
        "std_msgs.msg": {"Float64": str, "String": bytes},
    }
    made: dict[str, Any] = {}
    for name, contents in modules.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(contents)
        monkeypatch.setitem(sys.modules, name, made[name])
    return {**made, "log": log}


def subscriptions(log: list[Any]) -> dict[str, tuple[Any, Any]]:
    """Return class and listener of each topic; the two libraries give them in a different order."""
    found = {}
    for _, one, other, listener, *_ in (each for each in log if each[0] == "subscription"):
        topic, kind = (one, other) if isinstance(one, str) else (other, one)
        found[topic] = kind, listener
    return found


@pytest.mark.parametrize("name", ["rospy", "rclpy"])
def test_each_topic_is_passed_on_to_the_observer(library: dict[str, Any], name: str) -> None:
    observer: Any = Told()
    log = library["log"]
    node, begin = library["rclpy.node"].Node, library["rospy"].init_node
    make = node.__init__
    with watched(name, observer, TOPICS, idle=False):
        assert log == []
        if name == "rospy":
            library["rospy"].init_node("robot", anonymous=True)
        else:
            node("robot")
        first = len(log)
        if name == "rclpy":
            node("other")  # only the program's first node subscribes
            assert len(log) == first + 1
        assert library[name] is sys.modules[name]
        publisher = library["rospy"].Publisher()
        publisher.publish(1)
    found = subscriptions(log)
    assert {topic: kind for topic, (kind, _) in found.items()} == {
        "/place": int,
        "/speed": int,
        "/t": float,
        "/reward": str,
        "/mission": bytes,
    }
    assert first == 6
    for topic, data in (("/place", 1), ("/speed", 2), ("/t", 3)):
        found[topic][1](data)
    found["/reward"][1](SimpleNamespace(data="0.5"))
    found["/mission"][1](SimpleNamespace(data=7))
    assert observer.log == [
        ("told", PLACE, 1),
        ("told", SPEED, 2),
        ("signalled", observer.signals[0], 3),
        ("step", 0.5),
        ("order", "7"),
    ]
    if name == "rclpy":
        assert log[1][4] == ("profile", {"depth": 1000, "reliability": "best effort"})
    else:
        assert log[0] == ("init", ("robot",), {"anonymous": True})
    assert (library["rospy"].init_node, node.__init__) == (begin, make)


@pytest.mark.parametrize("name", ["rospy", "rclpy"])
def test_published_messages_mark_the_node_as_active(library: dict[str, Any], name: str) -> None:
    observer: Any = Told()
    kind = library["rospy" if name == "rospy" else "rclpy.publisher"].Publisher
    before = kind.publish
    with suppress(ValueError), watched(name, observer, Topics(TOPICS.types), idle=True):
        assert kind().publish(1, latch=True) == "sent"
        raise ValueError
    assert (observer.log, library["log"]) == ([("active",)], [("publish", (1,), {"latch": True})])
    assert kind.publish is before


def test_topics_without_a_name_are_not_subscribed(library: dict[str, Any]) -> None:
    observer: Any = Told()
    found = listeners._listeners(observer, Topics(TOPICS.types))
    assert [topic for topic, _, _ in found] == ["/place", "/speed", "/t"]


@pytest.mark.parametrize("name", ["rospy", "rclpy"])
def test_the_library_is_imported_before_any_message_type(
    library: dict[str, Any], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    imported: list[str] = []

    def importing(module: str) -> ModuleType:
        imported.append(module)
        return sys.modules[module]

    monkeypatch.setattr(listeners, "import_module", importing)
    observer: Any = Told()
    with watched(name, observer, TOPICS, idle=False):
        assert imported[:2] == [name, "a_msgs.msg"]
