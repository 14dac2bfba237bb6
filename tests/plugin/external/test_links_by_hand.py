"""What the links create in rclpy and rospy, with stand-ins for the libraries."""

from __future__ import annotations

import socket
import sys
import warnings
from collections.abc import Callable
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.external import link as module
from pytest_tarl.external import link_ros1
from pytest_tarl.external.link import DEPTH, IDLE, Link
from pytest_tarl.external.link_ros1 import LinkROS1
from pytest_tarl.external.plain import filled, to_plain
from pytest_tarl.ros import message_type
from pytest_tarl.ros.messages import find_class
from tests.plugin.external.test_link_ros1 import End, Linked, linked  # noqa: F401 (a fixture)

FLOAT = "std_msgs/msg/Float64"
Noted = list[tuple[Any, ...]]


class Part:
    """A stand-in for a context, node, executor or profile of rclpy that records its calls."""

    def __init__(self, log: Noted, kind: str, *given: Any, **options: Any) -> None:
        self.log, self.kind, self.options = log, kind, options
        self.services: list[tuple[str, list[str]]] = []
        log.append((kind, given, options))

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def noted(*given: Any, **options: Any) -> Any:
            self.log.append((f"{self.kind}.{name}", given, options))
            return Part([], name, *given)

        return noted

    def get_service_names_and_types(self) -> list[tuple[str, list[str]]]:
        return self.services


@pytest.fixture
def log(monkeypatch: pytest.MonkeyPatch) -> Noted:
    """Put a stand-in for rclpy into `sys.modules`; return its recorded calls."""
    noted: Noted = []

    def put(name: str, **contents: Any) -> None:
        made = ModuleType(name)
        vars(made).update(contents)
        monkeypatch.setitem(sys.modules, name, made)

    def part(kind: str) -> Callable[..., Part]:
        return lambda *given, **options: Part(noted, kind, *given, **options)

    put("rclpy")
    put("rclpy.context", Context=part("context"))
    put("rclpy.executors", SingleThreadedExecutor=part("executor"))
    put("rclpy.node", Node=part("node"))
    put("rclpy.qos", QoSProfile=part("profile"), ReliabilityPolicy=SimpleNamespace(RELIABLE="reliable"))
    monkeypatch.setattr(module, "_class", lambda kind: f"class of {kind}")
    return noted


def names(log: Noted) -> list[str]:
    return [one[0] for one in log]


def test_link_node_has_its_own_context_and_domain(log: Noted) -> None:
    made = Link(7, "/clock", print)
    context, init, node, executor = log[:4]
    assert (context[0], init) == (
        "context",
        ("context.init", (), {"args": [], "domain_id": 7, "initialize_logging": False}),
    )
    assert node[:2] == ("node", ("tarl_link",))
    own = node[2].pop("context")
    assert node[2] == {
        "use_global_arguments": False,
        "start_parameter_services": False,
        "enable_rosout": False,
    }
    assert (executor[0], executor[2]["context"]) == ("executor", own)
    assert names(log)[4:] == ["executor.add_node", "node.create_guard_condition"]
    assert (made._wanted, made._handled) == ({"/clock": None}, 0)
    made.close()
    assert names(log)[-3:] == ["executor.shutdown", "node.destroy_node", "context.try_shutdown"]


def test_waking_triggers_the_guard_condition(log: Noted) -> None:
    made = Link(7, "/clock", print)
    seen: Noted = []
    made._waker = Part(seen, "waker")
    made.wake()
    assert names(seen) == ["waker", "waker.trigger"]


def test_topic_is_received_with_the_offered_quality(log: Noted) -> None:
    made = Link(7, "/clock", print)
    made.subscribe(["/odom"])
    log.clear()
    offered = SimpleNamespace(reliability="best effort", durability="volatile")
    made._listen("/other", FLOAT, offered)
    assert log == []
    for topic in ("/odom", "/clock", "/odom"):
        made._listen(topic, FLOAT, offered)
    assert names(log) == ["profile", "node.create_subscription"] * 2
    assert log[0][2] == {"depth": DEPTH, "reliability": "best effort", "durability": "volatile"}
    assert log[1][1][:2] == (f"class of {FLOAT}", "/odom")
    assert log[1][1][2].__name__ == "heard"
    assert log[3][1][1:3] == ("/clock", made._on_clock)
    assert made._wanted["/odom"] is not None


def test_commands_are_reliable_and_durable_as_wanted(log: Noted) -> None:
    made = Link(7, "/clock", print)
    log.clear()
    for _ in range(2):
        made._offer("/cmd", FLOAT, SimpleNamespace(durability="transient", reliability="best effort"))
    assert names(log) == ["profile", "node.create_publisher"]
    assert log[0][2] == {"depth": DEPTH, "reliability": "reliable", "durability": "transient"}
    assert log[1][1][:2] == (f"class of {FLOAT}", "/cmd")
    assert [*made._publishers] == ["/cmd"]


def test_service_client_is_created_once_the_service_exists(log: Noted) -> None:
    made = Link(7, "/clock", print)
    log.clear()
    made._node.services = [("/other", ["a/srv/B"])]
    assert made._client("/step") is None
    made._node.services.append(("/step", ["std_srvs/srv/Empty", "b/srv/C"]))
    first = made._client("/step")
    assert made._client("/step") is first
    assert log == [("node.create_client", ("class of std_srvs/srv/Empty", "/step"), {})]


def test_long_message_queue_delays_an_answer_only_briefly(log: Noted) -> None:
    said: list[dict[str, Any]] = []
    made = Link(7, "/clock", said.append)
    spins: list[float] = []

    def spin_once(seconds: float) -> None:
        spins.append(seconds)
        if len(spins) == 1:
            made._answers.append({"kind": "answer"})
        made._handled += 1  # there is always one more message

    made._executor = SimpleNamespace(spin_once=spin_once)
    made.spin(0.5)
    assert (len(spins), said) == (1 + DEPTH * IDLE, [{"kind": "answer"}])


def test_classes_are_found_by_the_name_of_their_type() -> None:
    seen = SimpleNamespace(Float64="class")
    sys.modules["made_up_msgs.msg"] = seen  # type: ignore[assignment]
    sys.modules["made_up_msgs"] = ModuleType("made_up_msgs")
    try:
        assert module._class("made_up_msgs/msg/Float64") == "class"
        assert module._message_class("made_up_msgs", "Float64") == "class"
    finally:
        del sys.modules["made_up_msgs.msg"], sys.modules["made_up_msgs"]


# ROS 1


def test_event_ends_the_wait_of_a_link(linked: Linked) -> None:  # noqa: F811
    link, said, _ = linked
    waits: list[tuple[float, bool]] = []
    wait = link._arrival.wait
    link._arrival.wait = lambda seconds: waits.append((seconds, link._arrival.is_set())) or wait(0.0)  # type: ignore[assignment, func-returns-value, method-assign, misc]
    link.spin(0.5)
    link._put({"kind": "one"})
    link._put({"kind": "two"})
    link.spin(0.25)
    link.wake()
    link.spin(0.125)
    link.spin(0.0)
    assert waits == [(0.5, False), (0.25, True), (0.125, True), (0.0, False)]
    assert said == [{"kind": "one"}, {"kind": "two"}]


def test_publisher_is_made_once_without_a_warning(
    linked: Linked,  # noqa: F811
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    link, _, _ = linked
    made: list[str] = []

    class Warning1(End):
        def __init__(self, name: str, kind: Any, **options: Any) -> None:
            super().__init__(name, kind, **options)
            warnings.warn("no queue_size", SyntaxWarning, stacklevel=2)
            made.append(name)

    monkeypatch.setattr(sys.modules["rospy"], "Publisher", Warning1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for topic, kind in (("/cmd", "*"), ("/cmd", "std_msgs/Float64"), ("/cmd", "std_msgs/Float64")):
            link._offer(topic, kind)
    assert made == ["/cmd"]


def test_wanted_topic_is_received_once(linked: Linked) -> None:  # noqa: F811
    link, _, _ = linked
    link._listen("/odom", "std_msgs/Float64")
    assert "/odom" not in link._wanted
    link.subscribe(["/odom"])
    link._listen("/odom", "*")
    assert link._wanted["/odom"] is None
    link._listen("/odom", "std_msgs/Float64")
    first = link._wanted["/odom"]
    assert (first.kind, first.options) == (message_type("std_msgs/Float64"), {"tcp_nodelay": True})
    link.subscribe(["/odom"])
    link._listen("/odom", "std_msgs/Float64")
    assert link._wanted["/odom"] is first


def test_service_proxy_is_made_once_the_master_knows_it(linked: Linked) -> None:  # noqa: F811
    link, _, master = linked
    assert link._proxy("/step") is None
    master.services["/step"] = "own_srvs/Step"
    first = link._proxy("/step")
    assert (first.name, first.kind) == ("/step", "own_srvs/Step")
    master.services.clear()
    assert link._proxy("/step") is first
    master.services["/odd"] = "own_srvs/Odd"
    with pytest.raises(LookupError, match=r"type own_srvs/Odd, but its package is not installed"):
        link._proxy("/odd")


def test_closing_is_possible_after_the_node_has_ended(
    linked: Linked,  # noqa: F811
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    link, _, _ = linked
    told: list[str] = []

    def shut_down(why: str) -> None:
        told.append(why)
        raise RuntimeError

    monkeypatch.setattr(sys.modules["rospy"], "signal_shutdown", shut_down)
    link.close()
    assert told == ["the episode is over"]


def test_topic_nodes_exclude_the_node_of_tarl() -> None:
    assert link_ros1._others(["/sim", "/tarl_link", "/tarl_link2"]) == ["/sim", "/tarl_link2"]
    ends = [SimpleNamespace(node_name=name) for name in ("tarl_link", "sim")]
    assert module._others(ends) == ends[1:]


def test_server_is_asked_for_its_service_type(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: Noted = []

    class Connection:
        def __enter__(self) -> str:
            return "connection"

        def __exit__(self, *_: Any) -> None:
            calls.append(("closed",))

    def connect(place: tuple[str, int], limit: float) -> Connection:
        calls.append((place, limit))
        return Connection()

    def read(connection: str, buffer: Any, size: int) -> dict[str, str]:
        calls.append((connection, buffer.getvalue(), size))
        return {"type": "own_srvs/Step"}

    network: Any = ModuleType("rosgraph.network")
    network.write_ros_handshake_header = lambda connection, header: calls.append((connection, header))
    network.read_ros_handshake_header = read
    monkeypatch.setitem(sys.modules, "rosgraph", ModuleType("rosgraph"))
    monkeypatch.setitem(sys.modules, "rosgraph.network", network)
    monkeypatch.setattr(socket, "create_connection", connect)
    assert link_ros1._service_type("/step", "rosrpc://robot:4711") == "own_srvs/Step"
    header = {"probe": "1", "md5sum": "*", "callerid": "/tarl_link", "service": "/step"}
    assert calls == [
        (("robot", 4711), 5.0),
        ("connection", header),
        ("connection", b"", 2048),
        ("closed",),
    ]
    link_ros1._service_type("/step", "odd")
    assert calls[4] == (("", 0), 5.0)


def test_ros1_link_keeps_the_order_of_topics(linked: Linked) -> None:  # noqa: F811
    link: LinkROS1 = linked[0]
    link._known = {"kind": "graph"}
    link.subscribe(["/b", "/a", "/b"])
    assert ([*link._wanted], link._known) == (["/clock", "/b", "/a"], {})


# plain data


@pytest.mark.parametrize(("kind", "generation"), [("", "ros1"), ("msg/", "ros2")])
@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("std_msgs/{}Float64MultiArray", {"data": [1.0, 2.5]}),
        ("std_msgs/{}ByteMultiArray", {"data": []}),
        ("sensor_msgs/{}JointState", {"name": ["a", "b"], "position": [0.5, 1.0]}),
        ("sensor_msgs/{}Imu", {"orientation_covariance": [1.0] * 9, "orientation": {"x": 0.5}}),
        (
            "diagnostic_msgs/{}DiagnosticArray",
            {"status": [{"name": "a", "values": [{"key": "k", "value": "v"}]}]},
        ),
        ("std_msgs/{}Header", {"frame_id": "map"}),
        ("std_msgs/{}Empty", {}),
    ],
)
def test_given_fields_are_set_and_others_default(
    kind: str, generation: Any, name: str, data: dict[str, Any]
) -> None:
    made: Any = message_type(name.format(kind))()
    before = to_plain(made)
    same = filled(made, data, lambda package, short: find_class(generation, package, short))
    assert same is made
    after = to_plain(made)

    def check(expected: Any, found: Any) -> None:
        if isinstance(expected, dict):
            for key, value in expected.items():
                check(value, found[key])
        elif isinstance(expected, list):
            assert len(expected) == len(found)
            for one, other in zip(expected, found, strict=True):
                check(one, other)
        else:
            assert expected == found

    check(data, after)
    untouched = {key: value for key, value in after.items() if key not in data}
    assert untouched == {key: value for key, value in before.items() if key not in data}


def test_times_of_ros_1_are_filled_like_messages() -> None:
    header: Any = message_type("std_msgs/Header")()
    filled(header, {"stamp": {"secs": 3, "nsecs": 4}, "seq": 9}, lambda *_: None)
    assert (header.stamp.secs, header.stamp.nsecs, header.seq) == (3, 4, 9)
    assert to_plain(header)["stamp"] == {"secs": 3, "nsecs": 4}
