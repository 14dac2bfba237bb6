"""Stand-in for rclpy: same names, virtual clock, no middleware."""

# ruff: noqa: ARG001 (signatures are rclpy's)

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse
from pytest_tarl.ros.rclpy import exceptions, executors, logging, parameter, qos, task
from pytest_tarl.ros.rclpy.context import Context, this_context
from pytest_tarl.ros.rclpy.executors import Executor, SingleThreadedExecutor
from pytest_tarl.ros.rclpy.node import Node
from pytest_tarl.ros.rclpy.parameter import Parameter
from pytest_tarl.ros.rclpy.task import Future

__all__ = [
    "Context", "Future", "Node", "Parameter", "create_node", "exceptions", "executors", "get_default_context",
    "get_global_executor", "init", "logging", "ok", "parameter", "qos", "shutdown", "spin", "spin_once",
    "spin_until_future_complete", "task", "try_shutdown",
]  # fmt: skip


def init(*, args: list[str] | None = None, context: Any = None, **_: Any) -> Context:
    """Bring ROS up in this program; what is returned brings it down at the end of a `with`."""
    found = this_context("init")
    found.init(args)
    return found


def shutdown(*, context: Any = None, uninstall_handlers: bool | None = None) -> None:
    """Bring ROS down. Raises RCLError if it is."""
    this_context("shutdown").shutdown()


def try_shutdown(*, context: Any = None, uninstall_handlers: bool | None = None) -> None:
    """Bring ROS down unless it is."""
    this_context("try_shutdown").try_shutdown()


def ok(*, context: Any = None) -> bool:
    """Tell whether ROS is up."""
    return this_context("ok").ok()


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context of this program."""
    return this_context("get_default_context")


def create_node(node_name: str, **options: Any) -> Node:
    """Create a node."""
    return Node(node_name, **options)


def get_global_executor() -> Executor:
    """Return the executor that the spin functions use."""
    context = this_context("get_global_executor")
    if context.executor is None:
        context.executor = SingleThreadedExecutor()
    found: Executor = context.executor
    return found


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run the node's callbacks until ROS is shut down."""
    executor = executor or get_global_executor()
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        executor.remove_node(node)


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one callback of the node, waiting up to `timeout_sec` for it."""
    executor = executor or get_global_executor()
    executor.add_node(node)
    try:
        executor.spin_once(timeout_sec)
    finally:
        executor.remove_node(node)


def spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run the node's callbacks until a future is done."""
    executor = executor or get_global_executor()
    executor.add_node(node)
    try:
        executor.spin_until_future_complete(future, timeout_sec)
    finally:
        executor.remove_node(node)


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    raise refuse("rclpy", name)
