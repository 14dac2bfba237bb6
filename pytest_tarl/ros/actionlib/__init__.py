"""actionlib, implemented on the topics of its protocol (goal, cancel, …) so that a test's world can take part."""

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
    """Raise for a name that the stand-in lacks."""
    raise refuse("actionlib", name)
