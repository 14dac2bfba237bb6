"""rclpy's actions: goals, feedback, results and cancelling between the nodes of an episode."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse
from pytest_tarl.ros.rclpy.action.client import ActionClient
from pytest_tarl.ros.rclpy.action.handles import CancelResponse, GoalResponse
from pytest_tarl.ros.rclpy.action.server import ActionServer

__all__ = ["ActionClient", "ActionServer", "CancelResponse", "GoalResponse"]


def __getattr__(name: str) -> Any:
    """Raise an error for a name that the stand-in lacks."""
    raise refuse("rclpy.action", name)
