"""rclpy.experimental: its executor runs callbacks as a single-threaded one does, faster on a robot."""

from __future__ import annotations

from pytest_tarl.ros.rclpy.executors import SingleThreadedExecutor

__all__ = ["EventsExecutor"]


class EventsExecutor(SingleThreadedExecutor):
    """Runs one callback at a time."""
