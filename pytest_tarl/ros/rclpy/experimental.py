"""rclpy.experimental: its executor runs callbacks like a single-threaded executor; on a robot, it is faster."""

from __future__ import annotations

from pytest_tarl.ros.rclpy.executors import SingleThreadedExecutor

__all__ = ["EventsExecutor"]


class EventsExecutor(SingleThreadedExecutor):
    """Runs one callback at a time."""
