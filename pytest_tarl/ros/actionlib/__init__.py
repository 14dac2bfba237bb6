"""actionlib on the topics of its protocol (goal, cancel, status, feedback, result), so that a world can take part."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.actionlib.client import (
    GoalManager,
    SimpleActionClient,
    SimpleClientGoalState,
    SimpleGoalState,
)
from pytest_tarl.ros.actionlib.protocol import GoalID, GoalStatus
from pytest_tarl.ros.actionlib.server import SimpleActionServer
from pytest_tarl.ros.missing import refuse

__all__ = [
    "GoalID", "GoalManager", "GoalStatus", "SimpleActionClient", "SimpleActionServer", "SimpleClientGoalState",
    "SimpleGoalState",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    raise refuse("actionlib", name)
