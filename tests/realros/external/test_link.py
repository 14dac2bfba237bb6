"""The order in which the guardian's node passes on what a simulator sent."""

from __future__ import annotations

from importlib.machinery import PathFinder
from time import monotonic
from typing import Any

import pytest

pytestmark = [
    pytest.mark.skipif(
        PathFinder.find_spec("rclpy") is None, reason="rclpy is not installed here: make test-ros2"
    ),
    # a library of rclpy causes this warning
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
LIMIT = 300.0  # s; long enough for a busy machine


def test_answer_does_not_overtake_messages(monkeypatch: pytest.MonkeyPatch) -> None:
    from diagnostic_msgs.srv import SelfTest
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node
    from std_msgs.msg import Float64

    from pytest_tarl.external.domain import Domain
    from pytest_tarl.external.link import Link

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")  # a killed process leaves nothing in /dev/shm
    domain = Domain()  # no other test on this machine uses this domain
    context = Context()
    context.init(args=[], domain_id=domain.number, initialize_logging=False)
    node = Node("sim", context=context, use_global_arguments=False, start_parameter_services=False)
    level = node.create_publisher(Float64, "/level", 100)

    def step(_: Any, response: Any) -> Any:
        for number in range(20):
            level.publish(Float64(data=float(number)))
        return response

    node.create_service(SelfTest, "/step", step)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    events: list[dict[str, Any]] = []
    link = Link(domain.number, "/clock", events.append)
    link.subscribe(["/level"])
    try:
        _until(
            lambda: link.look() or any(one.get("connected") == ["/level"] for one in events), executor, link
        )
        _until(lambda: bool(level.get_subscription_count()), executor, link)
        link.call({"id": 1, "service": "/step", "request": {}})
        started = monotonic()
        while not any(one["kind"] == "answer" for one in events) and monotonic() < started + LIMIT:
            link.look()
            executor.spin_once(0.05)  # the simulator publishes and answers before the link handles a message
            if level.get_subscription_count():
                link.spin(0.01)
    finally:
        link.close()
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
        domain.release()
    kinds = [one["kind"] for one in events if one["kind"] in ("message", "answer")]
    assert kinds == ["message"] * 20 + ["answer"]
    assert all(one["sent"] >= events[-1]["asked"] for one in events if one["kind"] == "message")


def test_step_is_handled_after_sent_commands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from diagnostic_msgs.srv import SelfTest
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node
    from std_msgs.msg import Float64

    from pytest_tarl.external.domain import Domain
    from pytest_tarl.external.link import Link

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")
    domain = Domain()
    context = Context()
    context.init(args=[], domain_id=domain.number, initialize_logging=False)
    node = Node("sim", context=context, use_global_arguments=False)
    handled: list[Any] = []

    def step(_: Any, response: Any) -> Any:
        handled.append("step")
        return response

    node.create_subscription(Float64, "/cmd", lambda message: handled.append(message.data), 10)
    node.create_service(SelfTest, "/step", step)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    events: list[dict[str, Any]] = []
    link = Link(domain.number, "/clock", events.append)
    rounds = 3
    try:
        _until(
            lambda: link.look() or any(one.get("subscribed") == ["/cmd"] for one in events), executor, link
        )
        for number in range(rounds):
            for command in range(5):
                link.send("/cmd", {"data": float(command)})
            link.call({"id": number, "service": "/step", "request": {}})
            _until(
                lambda: link.look() or sum(one["kind"] == "answer" for one in events) > number,  # noqa: B023
                executor,
                link,
            )
    finally:
        link.close()
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
        domain.release()
    assert handled == [0.0, 1.0, 2.0, 3.0, 4.0, "step"] * rounds


def _until(done: Any, executor: Any, link: Any) -> None:
    started = monotonic()
    while not done() and monotonic() < started + LIMIT:
        executor.spin_once(0.01)
        link.spin(0.01)
