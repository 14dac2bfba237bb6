"""Common parts of the client and the server of a ROS 1 action."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.rospy.topics import Publisher, Subscriber

if TYPE_CHECKING:
    from pytest_tarl.ros.process import Network

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, PREEMPTING, RECALLING, RECALLED, LOST = range(10)
TERMINAL = (PREEMPTED, SUCCEEDED, ABORTED, REJECTED, RECALLED, LOST)


def __getattr__(name: str) -> Any:
    """Build GoalStatus and GoalID on first use."""
    if name in ("GoalStatus", "GoalID", "GoalStatusArray"):
        return message_type(f"actionlib_msgs/{name}")
    raise AttributeError(name)


class ActionServers:
    """The actions that nodes of an episode serve, and the number of goals so far."""

    def __init__(self, ros: Network) -> None:
        self._ros = ros
        self.names: set[str] = set()
        self.goals = 0

    def ready(self, name: str) -> bool:
        """Return whether a node serves an action, or the world subscribes to its goals."""
        return name in self.names or bool(self._ros.bus.topic(f"{name}/goal").listeners)


class ActionTypes:
    """The message classes of an action, derived from its action class."""

    def __init__(self, spec: Any) -> None:
        example = spec()
        self.action_goal = type(example.action_goal)
        self.action_result = type(example.action_result)
        self.action_feedback = type(example.action_feedback)
        self.goal = type(example.action_goal.goal)
        self.result = type(example.action_result.result)
        self.feedback = type(example.action_feedback.feedback)


__all__ = ["ActionServers", "ActionTypes", "Publisher", "Subscriber"]
