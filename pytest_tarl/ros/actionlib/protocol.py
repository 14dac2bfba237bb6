"""What client and server of a ROS 1 action have in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.rospy.timing import get_rostime
from pytest_tarl.ros.rospy.topics import Publisher, Subscriber

if TYPE_CHECKING:
    from pytest_tarl.ros.process import Network, Process

LOOK = nanoseconds(0.1)  # polling period while waiting for a server (ns)

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, PREEMPTING, RECALLING, RECALLED, LOST = range(10)
TERMINAL = (PREEMPTED, SUCCEEDED, ABORTED, REJECTED, RECALLED, LOST)


def __getattr__(name: str) -> Any:
    """Build GoalStatus and GoalID on first use."""
    if name in ("GoalStatus", "GoalID", "GoalStatusArray"):
        return message_type(f"actionlib_msgs/{name}")
    raise AttributeError(name)


class ActionException(Exception):  # noqa: N818 (actionlib's name)
    """A class is not an action class."""


class ActionServers:
    """The actions that an episode's nodes serve, and the number of goals so far."""

    def __init__(self, ros: Network) -> None:
        self._ros = ros
        self.names: set[str] = set()
        self.goals = 0

    def ready(self, name: str) -> bool:
        """Return whether a node serves an action, or the world subscribes to its goals."""
        return name in self.names or bool(self._ros.bus.topic(f"{name}/goal").listeners)


class GoalIDGenerator:
    """Generates IDs of goals that are unique within an episode."""

    def __init__(self, name: str | None = None) -> None:
        self._node = this_node("GoalIDGenerator")
        self.set_name(name or self._node.name)

    def set_name(self, name: str) -> None:
        """Set the name with which IDs begin."""
        self.name = name

    def generate_ID(self) -> Any:  # noqa: N802 (actionlib's name)
        """Return an actionlib_msgs/GoalID with the current time."""
        servers = self._node.process.ros.part(ActionServers)
        servers.goals += 1
        now = get_rostime()
        text = f"{self.name}-{servers.goals}-{now.secs}.{now.nsecs}"
        return message_type("actionlib_msgs/GoalID")(now, text)


class ActionTypes:
    """The message classes of an action, found through its action class."""

    def __init__(self, spec: Any) -> None:
        try:
            example = spec()
            self.action_goal = type(example.action_goal)
            self.action_result = type(example.action_result)
            self.action_feedback = type(example.action_feedback)
        except AttributeError:
            raise ActionException(f"Type is not an action spec: {spec}") from None
        self.goal = type(example.action_goal.goal)
        self.result = type(example.action_result.result)
        self.feedback = type(example.action_feedback.feedback)


def wait_until(process: Process, condition: Callable[[], bool], timeout: Any, *, poll: bool = False) -> bool:
    """Wait for a condition; return whether it became true in time. None or zero waits without limit.

    Without `poll`, the caller's task must be woken whenever the condition may have changed.
    """
    clock = process.scheduler
    span = 0 if timeout is None else timeout.to_nsec()
    until = clock.time + span if span > 0 else None
    while not condition() and not process.ending and (until is None or clock.time < until):
        look = clock.time + LOOK if poll else None
        clock.wait(min((i for i in (until, look) if i is not None), default=None))
    if process.ending:
        process.refuse_to_wait()
    return condition()


__all__ = [
    "ActionException",
    "ActionServers",
    "ActionTypes",
    "GoalIDGenerator",
    "Publisher",
    "Subscriber",
    "wait_until",
]
