"""rclpy's actions: goals, feedback, results and cancellation between an episode's nodes."""

from __future__ import annotations

from pytest_tarl.ros.rclpy.action.client import ActionClient
from pytest_tarl.ros.rclpy.action.handles import CancelResponse, GoalResponse
from pytest_tarl.ros.rclpy.action.server import ActionServer

__all__ = ["ActionClient", "ActionServer", "CancelResponse", "GoalResponse"]
