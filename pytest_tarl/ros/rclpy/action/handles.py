"""Goal handles of server and client, and the directory that connects both."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.messages.snapshot import snapshot
from pytest_tarl.ros.rclpy.exceptions import RCLError

if TYPE_CHECKING:
    from pytest_tarl.ros.process import Network
    from pytest_tarl.ros.rclpy.action.client import ActionClient
    from pytest_tarl.ros.rclpy.action.server import ActionServer
    from pytest_tarl.ros.rclpy.task import Future

UNKNOWN, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(7)  # action_msgs/GoalStatus
_NEXT = {  # state → states that may follow
    ACCEPTED: (EXECUTING, CANCELING),
    EXECUTING: (CANCELING, SUCCEEDED, ABORTED),
    CANCELING: (SUCCEEDED, CANCELED, ABORTED),
}


class GoalResponse(Enum):
    """The result of a goal callback."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """The result of a cancel callback."""

    REJECT = 1
    ACCEPT = 2


class ActionDirectory:
    """The action servers of one episode, and the number of goals so far."""

    def __init__(self, ros: Network) -> None:
        self.servers: dict[str, ActionServer] = {}
        self._ros = ros
        self._goals = 0

    def new_goal_id(self) -> Any:
        """Return a new unique_identifier_msgs/UUID. UUIDs are consecutive numbers, so that runs can be reproduced."""
        self._goals += 1
        made: Any = find_class("ros2", "unique_identifier_msgs", "UUID")
        return made(uuid=list(self._goals.to_bytes(16, "big")))


def goal_key(goal_id: Any) -> bytes:
    """Return a goal's id as a hashable key."""
    return bytes(int(part) for part in goal_id.uuid)


class ServerGoalHandle:
    """A goal that a server has accepted."""

    def __init__(self, server: ActionServer, client: ActionClient, goal_id: Any, request: Any) -> None:
        self.action_server = server
        self.client = client
        self.goal_id = goal_id
        self.request = request
        self.status = ACCEPTED
        self.result: Future | None = None

    @property
    def is_active(self) -> bool:
        """Return whether the goal has not ended."""
        return self.status in _NEXT

    @property
    def is_cancel_requested(self) -> bool:
        """Return whether the server has accepted a cancel request."""
        return self.status == CANCELING

    def execute(self, execute_callback: Callable[[ServerGoalHandle], Any] | None = None) -> None:
        """Schedule the execute callback."""
        if not self.is_cancel_requested:
            self.move_to(EXECUTING)
        self.action_server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Send feedback to the client. Raise TypeError for a message of another type."""
        if not isinstance(feedback, self.action_server.action_type.Feedback):
            raise TypeError(f"Expected {self.action_server.action_type.Feedback}, got {type(feedback)}")
        carrier = self.action_server.action_type.Impl.FeedbackMessage()
        carrier.goal_id, carrier.feedback = self.goal_id, snapshot(feedback)
        self.client.feedback_arrives(carrier)

    def succeed(self) -> None:
        """End the goal as succeeded."""
        self.move_to(SUCCEEDED)

    def abort(self) -> None:
        """End the goal as aborted."""
        self.move_to(ABORTED)

    def canceled(self) -> None:
        """End the goal as canceled."""
        self.move_to(CANCELED)

    def destroy(self) -> None:
        """Discard the handle."""
        self.status = UNKNOWN

    def move_to(self, status: int) -> None:
        """Change the state. Raise RCLError for a transition that ROS does not allow."""
        if status not in _NEXT.get(self.status, ()):
            raise RCLError(
                f"Failed to update goal state: goal_handle attempted invalid transition from state {self.status} "
                f"to {status}"
            )
        self.status = status
        self.client.status_arrives(self.goal_id, status)


class ClientGoalHandle:
    """A goal that a client sent and the server has answered."""

    def __init__(self, client: ActionClient, goal_id: Any, *, accepted: bool, stamp: Any) -> None:
        self._client = client
        self.goal_id = goal_id
        self.accepted = accepted
        self.stamp = stamp
        self.status = UNKNOWN

    def __repr__(self) -> str:
        return f"ClientGoalHandle <id={goal_key(self.goal_id).hex()}, accepted={self.accepted}, status={self.status}>"

    def get_result_async(self) -> Future:
        """Request the result; the future's result has `status` and `result`."""
        return self._client.result_of(self)

    def get_result(self) -> Any:
        """Wait for the result; another task must spin."""
        return self._client.block_on(self.get_result_async())

    def cancel_goal_async(self) -> Future:
        """Ask the server to cancel the goal; the future's result is an action_msgs/CancelGoal response."""
        return self._client.cancel(self)

    def cancel_goal(self) -> Any:
        """Ask the server to cancel the goal, and wait for its answer; another task must spin."""
        return self._client.block_on(self.cancel_goal_async())
