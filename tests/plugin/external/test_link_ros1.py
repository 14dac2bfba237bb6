"""The link to a simulator of ROS 1, with stand-ins for rospy and its master."""

from __future__ import annotations

import os
import sys
import threading
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.external import link_ros1
from pytest_tarl.external.link_ros1 import PAUSE, LinkROS1
from pytest_tarl.ros import message_type


class Master:
    """A master with publishers, subscribers and services by name."""

    def __init__(self) -> None:
        self.publishing: list[tuple[str, list[str]]] = []
        self.subscribing: list[tuple[str, list[str]]] = []
        self.kinds = dict.fromkeys(("/odom", "/cmd", "/clock", "/own", "/rosout", "/odd"), "std_msgs/Float64")
        self.services: dict[str, str] = {}
        self.gone = False

    def getSystemState(self) -> Any:  # noqa: N802 (rosgraph's name)
        if self.gone:
            raise OSError
        return self.publishing, self.subscribing, []

    def getTopicTypes(self) -> list[tuple[str, str]]:  # noqa: N802
        return list(self.kinds.items())

    def lookupService(self, service: str) -> str:  # noqa: N802
        return self.services[service]


class End:
    """A publisher, subscriber or service proxy of rospy."""

    def __init__(self, name: str, kind: Any, heard: Any = None, **options: Any) -> None:
        self.name, self.kind, self.data_class, self.heard, self.options = name, kind, kind, heard, options
        self.connections, self.sent = 1, list[Any]()
        self.impl = SimpleNamespace(connections=[])
        self.request_class = message_type("std_msgs/Float64")

    def get_num_connections(self) -> int:
        return self.connections

    def publish(self, message: Any) -> None:
        self.sent.append(message)

    def __call__(self, request: Any) -> Any:
        if request.data < 0:
            raise ValueError("transport error completing service call" if request.data < -1 else "refused")
        return message_type("std_msgs/Float64")(data=2 * request.data)


@pytest.fixture
def linked(monkeypatch: pytest.MonkeyPatch) -> tuple[LinkROS1, list[dict[str, Any]], Master]:
    """Return a link, the events that it passes on, and its master."""
    started: list[Any] = []
    rospy: Any = ModuleType("rospy")
    rospy.init_node = lambda name, **options: started.append((name, options))
    rospy.Publisher = rospy.Subscriber = rospy.ServiceProxy = End
    rospy.signal_shutdown = started.append
    master, rosgraph = Master(), SimpleNamespace()
    rosgraph.Master = lambda name: master if name == "/tarl_link" else None
    message = SimpleNamespace(
        get_message_class=lambda kind: message_type(kind) if kind != "own_msgs/Odd" else None,
        get_service_class=lambda kind: kind if kind == "own_srvs/Step" else None,
    )
    for name, module in (("rospy", rospy), ("rosgraph", rosgraph), ("roslib", SimpleNamespace(message=message)),
                         ("roslib.message", message)):  # fmt: skip
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(link_ros1, "_service_type", lambda service, uri: uri)
    monkeypatch.setattr(link_ros1, "PAUSE", 0.0)
    said: list[dict[str, Any]] = []
    made = LinkROS1("/clock", said.append)
    assert started[0][0] == "tarl_link"
    assert started[0][1]["disable_signals"] is started[0][1]["disable_rosout"] is True
    return made, said, master


Linked = tuple[LinkROS1, list[dict[str, Any]], Master]


def test_changes_of_the_graph_are_reported_once(linked: Linked) -> None:
    link, said, master = linked
    master.publishing = [
        ("/odom", ["/sim"]),
        ("/clock", ["/sim"]),
        ("/rosout", ["/sim"]),
        ("/own", ["/tarl_link"]),
    ]
    master.subscribing = [
        ("/cmd", ["/sim"]),
        ("/own", ["/tarl_link"]),
        ("/rosout", ["/log"]),
        ("/odd", ["/sim"]),
    ]
    master.kinds["/odd"] = "*"
    link.look()
    link.look()
    event = {
        "kind": "graph",
        "published": ["/clock", "/odom"],
        "subscribed": ["/cmd"],
        "connected": ["/clock"],
    }
    assert said == [event]
    link.subscribe(["/odom", "/clock"])
    link.look()
    assert said[1]["connected"] == ["/clock", "/odom"]
    link._publishers["/cmd"].connections = 0
    link._wanted["/odom"].connections = 0
    link.look()
    assert (said[2]["subscribed"], said[2]["connected"], len(said)) == ([], ["/clock"], 3)
    assert link._publishers["/cmd"].options == {"tcp_nodelay": True, "queue_size": None}
    master.gone = True
    link.look()
    assert len(said) == 3


def test_a_topic_is_received_once_its_type_is_known(linked: Linked) -> None:
    link, _, master = linked
    link.subscribe(["/odom"])
    master.publishing, master.kinds = [("/odom", ["/sim"])], {}
    link.look()
    assert link._wanted["/odom"] is None
    master.kinds = {"/odom": "std_msgs/Float64"}
    link.look()
    first = link._wanted["/odom"]
    link.look()
    assert link._wanted["/odom"] is first
    master.publishing.append(("/new", ["/sim"]))
    master.kinds["/new"] = "own_msgs/Odd"
    link.subscribe(["/new"])
    with pytest.raises(LookupError, match="own_msgs/Odd, but its package is not installed"):
        link.look()


def test_messages_and_the_clock_are_passed_on_in_order(linked: Linked) -> None:
    link, said, master = linked
    link.subscribe(["/odom"])
    master.publishing = [("/odom", ["/sim"]), ("/clock", ["/sim"])]
    link.look()
    said.clear()
    link._wanted["/odom"].heard(message_type("std_msgs/Float64")(data=1.5))
    link._wanted["/clock"].heard(SimpleNamespace(clock=SimpleNamespace(to_nsec=lambda: 7)))
    assert said == []
    link.spin(60.0)  # ends at once, because something arrived
    assert [one["kind"] for one in said] == ["message", "clock"]
    assert (said[0]["topic"], said[0]["type"], said[0]["data"], said[1]["time"]) == (
        "/odom", "std_msgs/Float64", {"data": 1.5}, 7
    )  # fmt: skip
    assert said[0]["sent"] > 0
    link.spin(0.0)
    assert len(said) == 2
    link.wake()
    link.spin(60.0)


def test_messages_are_sent_only_to_topics_with_a_publisher(linked: Linked) -> None:
    link, _, master = linked
    master.subscribing = [("/cmd", ["/sim"])]
    link.look()
    link.send("/other", {"data": 1.0})
    assert link._sent is False
    link.send("/cmd", {"data": 2.5})
    assert ([one.data for one in link._publishers["/cmd"].sent], link._sent) == ([2.5], True)


def answers(link: LinkROS1, said: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Wait for the threads of calls; return the answers."""
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and getattr(thread, "_target", None) == link._answer:
            thread.join()
    link.spin(0.0)
    return [one for one in said if one["kind"] == "answer"]


def test_call_waits_for_its_service_and_earlier_commands(
    linked: Linked, monkeypatch: pytest.MonkeyPatch
) -> None:
    link, said, master = linked
    pauses: list[float] = []
    monkeypatch.setattr(link_ros1, "sleep", pauses.append)
    link.call({"id": 7, "service": "/step", "request": {"data": 1.5}})
    assert (answers(link, said), len(link._calls), pauses) == ([], 1, [])
    master.services["/step"] = "own_srvs/Step"
    link.look()
    (answer,) = answers(link, said)
    assert (answer["id"], answer["response"], link._calls) == (7, {"data": 3.0}, [])
    assert answer["asked"] > 0
    link._sent = True
    link.call({"id": 8, "service": "/step", "request": {"data": -1.0}})
    assert answers(link, said)[1]["error"] == "refused"
    assert (pauses, link._sent) == ([0.0], False)


def test_a_broken_connection_does_not_count_as_an_answer(linked: Linked) -> None:
    link, said, master = linked
    master.services["/step"] = "own_srvs/Step"
    link.call({"id": 7, "service": "/step", "request": {"data": -2.0}})
    assert answers(link, said) == []
    link.close()


@pytest.mark.parametrize(
    ("load", "cores", "expected"),
    [(0.5, 2, PAUSE), (2.0, 2, PAUSE), (12.0, 2, 6 * PAUSE), (12.0, 4, 3 * PAUSE)],
)
def test_call_after_a_command_waits_longer(
    monkeypatch: pytest.MonkeyPatch, load: float, cores: int, expected: float
) -> None:
    monkeypatch.setattr(os, "getloadavg", lambda: (load, 0.0, 0.0), raising=False)
    monkeypatch.setattr(link_ros1, "available", lambda: cores)
    assert link_ros1._pause() == pytest.approx(expected)


def test_the_pause_is_shortest_if_the_load_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown() -> tuple[float, float, float]:
        raise OSError

    monkeypatch.setattr(os, "getloadavg", unknown, raising=False)
    assert link_ros1._pause() == PAUSE
