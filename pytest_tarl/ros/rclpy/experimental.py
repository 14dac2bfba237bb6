"""rclpy.experimental: its executor is faster on a robot; here, it is a single-threaded executor."""

from __future__ import annotations

from pytest_tarl.ros.rclpy.executors import SingleThreadedExecutor

__all__ = ["EventsExecutor"]


class EventsExecutor(SingleThreadedExecutor):
    """Runs one callback at a time."""
