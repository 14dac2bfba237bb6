"""actionlib, built on the topics of its protocol (goal, cancel, …), so that a test's world can take part."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.actionlib.client import (
    GoalManager,
    SimpleActionClient,
    SimpleClientGoalState,
    SimpleGoalState,
)
from pytest_tarl.ros.actionlib.goal_client import ActionClient, ClientGoalHandle
from pytest_tarl.ros.actionlib.goal_server import ActionServer, ServerGoalHandle
from pytest_tarl.ros.actionlib.goal_states import CommState, TerminalState
from pytest_tarl.ros.actionlib.protocol import ActionException, GoalID, GoalIDGenerator, GoalStatus
from pytest_tarl.ros.actionlib.server import SimpleActionServer

__all__ = [
    "ActionClient", "ActionException", "ActionServer", "ClientGoalHandle", "CommState", "GoalID", "GoalIDGenerator",
    "GoalManager", "GoalStatus", "ServerGoalHandle", "SimpleActionClient", "SimpleActionServer",
    "SimpleClientGoalState", "SimpleGoalState", "TerminalState", "get_name_of_constant",
]  # fmt: skip


def get_name_of_constant(C: Any, n: int) -> str:  # noqa: N803 (actionlib's names)
    """Return the name of the constant of a class with the value `n`, or "No such constant"."""
    return next(
        (name for name, value in vars(C).items() if type(value) is int and value == n), "No such constant"
    )
