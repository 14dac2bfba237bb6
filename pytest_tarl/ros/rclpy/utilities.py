"""rclpy.utilities: the context, ROS arguments, and the name of the middleware."""

# ruff: noqa: ARG001 (signatures are rclpy's)

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pytest_tarl.ros import names
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.rclpy.context import Context, this_context

__all__ = [
    "get_default_context", "get_rmw_implementation_identifier", "ok", "remove_ros_args", "shutdown",
    "timeout_sec_to_nsec", "try_shutdown",
]  # fmt: skip


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context of this program."""
    return this_context("get_default_context")


def ok(*, context: Any = None) -> bool:
    """Return whether ROS is initialised and not shut down."""
    own = this_context("ok")
    asked()
    return own.ok()


def shutdown(*, context: Any = None, uninstall_handlers: bool | None = None) -> None:
    """Shut ROS down. Raise RuntimeError if it is not running."""
    this_context("shutdown").shutdown()


def try_shutdown(*, context: Any = None, uninstall_handlers: bool | None = None) -> None:
    """Shut ROS down, unless it already is."""
    this_context("try_shutdown").try_shutdown()


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return a command line without ROS arguments."""
    return list(names.parse_ros2(current_process("rclpy.utilities").argv if args is None else args).rest)


def get_rmw_implementation_identifier() -> str:
    """Return a dummy name: there is no middleware."""
    return "rmw_tarl_inprocess"


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Convert a timeout to nanoseconds; None becomes -1."""
    return -1 if timeout_sec is None or timeout_sec < 0 else int(float(timeout_sec) * 1_000_000_000)
