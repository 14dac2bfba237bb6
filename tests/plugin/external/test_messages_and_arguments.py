"""Messages as plain data, the arguments of an external simulator, and the link to its topics and services."""

from __future__ import annotations

import array
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.external import arguments
from pytest_tarl.external.arguments import Call, setup
from pytest_tarl.external.domain import DOMAINS, Domain
from pytest_tarl.external.link import Link
from pytest_tarl.external.plain import filled, to_plain
from pytest_tarl.ros import message_type
from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.times import Duration


def pose(kind: str) -> Any:
    """Return an array of two poses, with a header."""
    made: Any = message_type(f"geometry_msgs/{kind}PoseArray")()
    made.header.frame_id = "map"
    made.poses = [message_type(f"geometry_msgs/{kind}Pose")() for _ in range(2)]
    made.poses[1].position.x = 2.5
    return made


@pytest.mark.parametrize(("kind", "generation"), [("", "ros1"), ("msg/", "ros2")])
def test_message_survives_conversion_to_plain_data(kind: str, generation: Any) -> None:
    one = pose(kind)
    data = to_plain(one)
    assert (data["header"]["frame_id"], data["poses"][1]["position"]) == (
        "map",
        {"x": 2.5, "y": 0.0, "z": 0.0},
    )
    again = filled(type(one)(), data, lambda package, name: find_class(generation, package, name))
    assert again == one
    image: Any = message_type(f"sensor_msgs/{kind}Image")()
    image.height, image.data = 2, bytes([1, 2, 255])
    data = to_plain(image)
    assert (data["height"], data["data"]) == (2, [1, 2, 255])
    assert list(filled(type(image)(), data, lambda *_: None).data) == [1, 2, 255]


def test_values_of_fields_are_converted_to_plain_data() -> None:
    assert to_plain(np.array([[1.0, 2.0]])) == [[1.0, 2.0]]
    assert to_plain(array.array("d", [1.5])) == [1.5]
    assert to_plain(bytearray(b"\x01\xff")) == [1, 255]
    assert to_plain((1, "a", [True])) == [1, "a", [True]]
    assert to_plain(Duration(1, 5)) == {"secs": 1, "nsecs": 5}
    assert to_plain(None) is None


def checked(monkeypatch: pytest.MonkeyPatch, installed: tuple[str, ...] = ("rclpy",), **changes: Any) -> Any:
    """Return the checked arguments of a call, on a machine with these libraries."""
    monkeypatch.setattr(arguments.PathFinder, "find_spec", lambda name: name if name in installed else None)
    given: dict[str, Any] = {
        "command": "sim --world 'a b'", "environment": None, "clock": "/clock", "ready": "/odom", "step": None,
        "reset": None, "every_step": (), "timeout": 5.0, "patience": 2.0,
    }  # fmt: skip
    given |= changes
    return setup(given.pop("command"), Path("/p"), **given)


def test_a_command_is_split_as_in_a_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    found = checked(monkeypatch)
    assert (found.command, found.shown, found.ready) == (
        ("sim", "--world", "a b"),
        "sim --world 'a b'",
        ("/odom",),
    )
    assert (found.environment, found.ros, found.timeout, found.patience) == ({}, "ros2", 5.0, 2.0)
    assert checked(monkeypatch, command=[Path("/bin/sim"), "a b"]).command == ("/bin/sim", "a b")
    assert checked(monkeypatch, ready=["/a", "/b"], every_step=["/c"]).every_step == ("/c",)
    assert checked(monkeypatch, environment={"A": "1"}).environment == {"A": "1"}


def test_service_is_given_by_name_or_request(monkeypatch: pytest.MonkeyPatch) -> None:
    found = checked(monkeypatch, step="/step", reset=Call("/reset", {"n": 1}))
    assert (found.step, found.reset) == (Call("/step"), Call("/reset", {"n": 1}))
    found = checked(monkeypatch, step=Call("/step", {"n": 2}), reset="/reset")
    assert (found.step.request, found.reset.request) == ({"n": 2}, {})


@pytest.mark.parametrize("changes", [{"command": ""}, {"command": []}, {"ready": []}])
def test_an_empty_command_and_no_topic_are_refused(monkeypatch: pytest.MonkeyPatch, changes: Any) -> None:
    with pytest.raises(SettingsError, match="needs a command and a topic"):
        checked(monkeypatch, **changes)


def test_ros2_is_used_if_both_are_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert checked(monkeypatch, ("rospy",)).ros == "ros1"
    assert checked(monkeypatch, ("rospy", "rclpy")).ros == "ros2"
    with pytest.raises(SettingsError, match="neither is installed"):
        checked(monkeypatch, ())


def test_each_guardian_has_a_domain_of_its_own() -> None:
    some = [Domain() for _ in range(5)]
    try:
        assert len({one.number for one in some}) == 5
        assert all(one.number in DOMAINS for one in some)
    finally:
        for one in some:
            one.release()


class End:
    """A publisher, subscription or client of the simulator's ROS."""

    def __init__(self, *peers: Any, kind: Any = None) -> None:
        self.msg_type, self.srv_type, self.sent, self.peers = kind, kind, [], peers
        self.ready, self.callbacks = True, []

    def get_publisher_count(self) -> int:
        return len(self.peers)

    def get_subscription_count(self) -> int:
        return len(self.peers)

    def publish(self, message: Any) -> None:
        self.sent.append(message)

    def service_is_ready(self) -> bool:
        return bool(self.ready)

    def call_async(self, request: Any) -> Any:
        self.sent.append(request)
        return SimpleNamespace(add_done_callback=self.callbacks.append)


@pytest.fixture
def linked() -> tuple[Link, list[dict[str, Any]], Any]:
    """Return a link without a node, the events that it passes on, and the node's graph."""
    said: list[dict[str, Any]] = []
    made = Link.__new__(Link)
    node = SimpleNamespace(topics=[], publishers={}, subscriptions={})
    node.get_topic_names_and_types = lambda: node.topics
    node.get_publishers_info_by_topic = lambda topic: node.publishers.get(topic, [])
    node.get_subscriptions_info_by_topic = lambda topic: node.subscriptions.get(topic, [])
    parts: dict[str, Any] = {
        "_node": node, "_say": said.append, "_clock": "/clock", "_wanted": {"/clock": None}, "_publishers": {},
        "_receivers": {}, "_seen": {}, "_sent": Counter(), "_asking": None, "_silent": set(),
        "_clients": {}, "_calls": [], "_known": {}, "_answers": [], "_handled": 0,
    }  # fmt: skip
    for name, value in parts.items():
        setattr(made, name, value)
    made._listen = lambda topic, *_: made._wanted.update({topic: End(1)}) if topic in made._wanted else None  # type: ignore[method-assign]
    made._offer = lambda topic, *_: made._publishers.setdefault(topic, End(*node.subscriptions[topic]))  # type: ignore[method-assign]
    return made, said, node


def info(name: str) -> Any:
    return SimpleNamespace(node_name=name, node_namespace="/", qos_profile=None)


def test_changes_of_the_graph_are_reported_once(linked: tuple[Link, list[dict[str, Any]], Any]) -> None:
    link, said, node = linked
    kind = ["std_msgs/msg/Float64"]
    node.topics = [
        ("/odom", kind),
        ("/cmd", kind),
        ("/rosout", kind),
        ("/clock", kind),
        ("/odd", []),
        ("/own", kind),
    ]
    node.publishers = {
        "/odom": [info("sim")],
        "/rosout": [info("sim")],
        "/clock": [info("sim")],
        "/own": [info("tarl_link")],
    }
    node.subscriptions = {"/cmd": [info("sim")], "/own": [info("tarl_link")]}
    link.look()
    link.look()
    assert said == [
        {"kind": "graph", "published": ["/clock", "/odom"], "subscribed": ["/cmd"], "connected": ["/clock"]}
    ]
    link.subscribe(["/odom", "/clock"])
    link.look()
    assert said[1]["connected"] == ["/clock", "/odom"]
    link._publishers["/cmd"].peers = ()
    link.look()
    assert (len(said), said[2]["subscribed"]) == (3, [])


def test_messages_are_sent_only_to_topics_with_a_publisher(
    linked: tuple[Link, list[dict[str, Any]], Any],
) -> None:
    link, _, _ = linked
    link._publishers["/cmd"] = End(kind=message_type("std_msgs/msg/Float64"))
    link.send("/cmd", {"data": 2.5})
    link.send("/other", {"data": 2.5})
    assert [one.data for one in link._publishers["/cmd"].sent] == [2.5]


def test_a_call_waits_for_its_service(linked: tuple[Link, list[dict[str, Any]], Any]) -> None:
    link, _, _ = linked
    client = End(kind=SimpleNamespace(Request=message_type("std_msgs/msg/Float64")))
    known: dict[str, Any] = {}
    link._client = known.get  # type: ignore[method-assign]
    link.call({"id": 7, "service": "/step", "request": {"data": 1.0}})
    known["/step"], client.ready = client, False
    link._start_calls()
    assert (client.sent, len(link._calls)) == ([], 1)
    client.ready = True
    link._start_calls()
    assert ([one.data for one in client.sent], link._calls) == ([1.0], [])
    answer = SimpleNamespace(
        exception=lambda: None, result=lambda: message_type("std_msgs/msg/Float64")(data=4.0)
    )
    client.callbacks[0](answer)
    client.callbacks[0](SimpleNamespace(exception=lambda: ValueError("no"), result=None))
    first, second = link._answers
    assert (first["id"], first["kind"], first["response"], second["error"]) == (
        7,
        "answer",
        {"data": 4.0},
        "no",
    )
    assert 0 < first["asked"] == second["asked"]


def test_clock_time_and_message_stamp_are_passed_on(
    linked: tuple[Link, list[dict[str, Any]], Any],
) -> None:
    link, said, _ = linked
    link._on_clock(SimpleNamespace(clock=SimpleNamespace(sec=3, nanosec=5)))
    link._on_message("/odom", "std_msgs/msg/Float64")(
        message_type("std_msgs/msg/Float64")(data=1.0), {"source_timestamp": 9}
    )
    assert said == [
        {"kind": "clock", "time": 3_000_000_005},
        {
            "kind": "message",
            "topic": "/odom",
            "type": "std_msgs/msg/Float64",
            "data": {"data": 1.0},
            "sent": 9,
        },
    ]
    assert link._handled == 2


def test_earlier_messages_arrive_before_the_answer(
    linked: tuple[Link, list[dict[str, Any]], Any],
) -> None:
    link, said, _ = linked
    waiting = ["m1", "", "m2", "", "", "m3"]
    limits: list[float] = []

    def spin_once(seconds: float) -> None:
        limits.append(seconds)
        if len(limits) == 1:
            link._answers.append({"kind": "answer"})
            return
        event = waiting.pop(0) if waiting else ""
        if event:
            link._handled += 1
            said.append({"kind": event})

    link._executor = SimpleNamespace(spin_once=spin_once)
    link.spin(0.5)
    assert [one["kind"] for one in said] == ["m1", "m2", "m3", "answer"]
    assert (limits[0], set(limits[1:]), link._answers) == (0.5, {0}, [])
    limits.clear()
    limits.append(0.0)
    link.spin(0.5)
    assert limits == [0.0, 0.5]  # without an answer, one event
