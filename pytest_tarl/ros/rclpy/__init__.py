"""Stand-in for rclpy, with the same names, a virtual clock and no middleware."""

# ruff: noqa: ARG001 (signatures are rclpy's)

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.rclpy import (
    callback_groups,
    context,
    exceptions,
    executors,
    logging,
    node,
    parameter,
    qos,
    signals,
    task,
    time,
    timer,
    topics,
    utilities,
)
from pytest_tarl.ros.rclpy import services as service
from pytest_tarl.ros.rclpy.context import Context, this_context
from pytest_tarl.ros.rclpy.executors import Executor, SingleThreadedExecutor
from pytest_tarl.ros.rclpy.node import Node
from pytest_tarl.ros.rclpy.parameter import Parameter
from pytest_tarl.ros.rclpy.qos import QoSProfile, qos_profile_rosout_default
from pytest_tarl.ros.rclpy.signals import (
    SignalHandlerOptions,
    install_signal_handlers,
    uninstall_signal_handlers,
)
from pytest_tarl.ros.rclpy.task import Future
from pytest_tarl.ros.rclpy.utilities import (
    get_default_context,
    get_rmw_implementation_identifier,
    ok,
    shutdown,
    try_shutdown,
)

# as in rclpy, `import rclpy` is enough for rclpy.duration.Duration
clock = duration = clock_type = time
publisher = subscription = topics
client = service

__all__ = [
    "Context", "Executor", "Future", "Node", "Parameter", "QoSProfile", "SignalHandlerOptions",
    "callback_groups", "client", "clock", "clock_type", "context", "create_node", "duration", "exceptions",
    "executors", "get_default_context", "get_global_executor", "get_rmw_implementation_identifier", "init",
    "install_signal_handlers", "logging", "node", "ok", "parameter", "publisher", "qos",
    "qos_profile_rosout_default", "service", "shutdown", "signals", "spin", "spin_once",
    "spin_until_future_complete", "subscription", "task", "time", "timer", "try_shutdown",
    "uninstall_signal_handlers", "utilities",
]  # fmt: skip


def init(*, args: list[str] | None = None, context: Any = None, **_: Any) -> Context:
    """Initialise ROS in this program; as a context manager, also shut it down on exit."""
    found = this_context("init")
    found.init(args)
    return found


def create_node(node_name: str, **options: Any) -> Node:
    """Create a node."""
    return Node(node_name, **options)


def get_global_executor() -> Executor:
    """Return the executor that the spin functions use."""
    found = this_context("get_global_executor")
    if found.executor is None:
        found.executor = SingleThreadedExecutor()
    executor: Executor = found.executor
    return executor


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run callbacks of the node until ROS is shut down."""
    executor = executor or get_global_executor()
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        executor.remove_node(node)


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one callback of the node, waiting up to `timeout_sec` for one to become ready."""
    executor = executor or get_global_executor()
    executor.add_node(node)
    try:
        executor.spin_once(timeout_sec)
    finally:
        executor.remove_node(node)


def spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run callbacks of the node until a future is done."""
    executor = executor or get_global_executor()
    executor.add_node(node)
    try:
        executor.spin_until_future_complete(future, timeout_sec)
    finally:
        executor.remove_node(node)
