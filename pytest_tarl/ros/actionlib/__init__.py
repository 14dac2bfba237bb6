"""actionlib, implemented on the topics of its protocol (goal, cancel, …), so that a test's world can take part."""

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
    "SimpleGoalState", "get_name_of_constant",
]  # fmt: skip


def get_name_of_constant(C: Any, n: int) -> str:  # noqa: N803 (actionlib's names)
    """Return the name of a class's constant with the value `n`, such as a state, or "No such constant"."""
    return next(
        (name for name, value in vars(C).items() if type(value) is int and value == n), "No such constant"
    )


def __getattr__(name: str) -> Any:
    """Raise an error for a name that the stand-in lacks."""
    raise refuse("actionlib", name)
