"""actionlib's ActionClient: several goals at a time, each with its own handle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.actionlib import protocol
from pytest_tarl.ros.actionlib.goal_states import CommState, TerminalState, steps
from pytest_tarl.ros.actionlib.protocol import (
    TERMINAL,
    ActionServers,
    ActionTypes,
    Publisher,
    Subscriber,
    wait_until,
)
from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.rospy.log import logerr, logwarn
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.rospy.timing import Time, get_rostime


class ClientGoalHandle:
    """A goal that was sent: its states, its result, and how to cancel it."""

    def __init__(self, client: ActionClient, goal_id: Any, on_change: Any, on_feedback: Any) -> None:
        self._client, self._id = client, goal_id.id
        self._on_change, self._on_feedback = on_change, on_feedback
        self._state = CommState.WAITING_FOR_GOAL_ACK
        self._status: Any = message_type("actionlib_msgs/GoalStatus")(goal_id, protocol.PENDING, "")
        self._result: Any = None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and self._id == other._id

    def __hash__(self) -> int:
        return hash(self._id)

    def cancel(self) -> None:
        """Ask the server to cancel the goal."""
        self._client.publish_cancel(Time(), self._id)
        self._go(CommState.WAITING_FOR_CANCEL_ACK)

    def get_comm_state(self) -> int:
        """Return the communication state, a number of CommState."""
        asked()
        return self._state

    def get_goal_status(self) -> int:
        """Return the last status from the server, a number of actionlib_msgs/GoalStatus."""
        asked()
        return int(self._status.status)

    def get_goal_status_text(self) -> str:
        """Return the server's text for the last status."""
        return str(self._status.text)

    def get_result(self) -> Any:
        """Return the result; None if there is none yet."""
        return self._result

    def get_terminal_state(self) -> int:
        """Return the status in which the goal ended; if it has not ended, log an error and return LOST."""
        if self._state != CommState.DONE:
            logwarn("Asking for the terminal state when we're in [%s]", CommState.to_string(self._state))
        if self._status.status in TERMINAL:
            return int(self._status.status)
        logerr("Asking for a terminal state, but the goal status is %d", self._status.status)
        return TerminalState.LOST

    def take_status(self, status: Any) -> None:
        """Process a status from the server."""
        if status.goal_id.id == self._id and self._state != CommState.DONE:
            self._status = status
            for state in steps(self._state, status.status):
                self._go(state)

    def take_result(self, message: Any) -> None:
        """Store the result and end the goal."""
        if message.status.goal_id.id == self._id and self._state != CommState.DONE:
            self._result = message.result
            self.take_status(message.status)
            self._go(CommState.DONE)

    def take_feedback(self, message: Any) -> None:
        """Pass feedback to the callback."""
        mine = message.status.goal_id.id == self._id and self._state != CommState.DONE
        if mine and self._on_feedback is not None:
            self._on_feedback(self, message.feedback)

    def _go(self, state: int) -> None:
        self._state = state
        if self._on_change is not None:
            self._on_change(self)


class ActionClient:
    """Sends goals and tracks each of them until its end."""

    def __init__(self, ns: str, ActionSpec: Any) -> None:  # noqa: N803 (actionlib's name)
        self._node = this_node("ActionClient")
        self.ns = self._node.resolve(ns)
        self._types = ActionTypes(ActionSpec)
        self._servers = self._node.process.ros.part(ActionServers)
        self._goals: list[ClientGoalHandle] = []
        self.pub_goal = Publisher(f"{self.ns}/goal", self._types.action_goal, queue_size=10)
        self.pub_cancel = Publisher(f"{self.ns}/cancel", message_type("actionlib_msgs/GoalID"), queue_size=10)
        statuses = message_type("actionlib_msgs/GoalStatusArray")
        self.status_sub = Subscriber(f"{self.ns}/status", statuses, self._take_status)
        self.result_sub = Subscriber(f"{self.ns}/result", self._types.action_result, self._take_result)
        self.feedback_sub = Subscriber(
            f"{self.ns}/feedback", self._types.action_feedback, self._take_feedback
        )

    def send_goal(
        self,
        goal: Any,
        transition_cb: Callable[[ClientGoalHandle], Any] | None = None,
        feedback_cb: Callable[[ClientGoalHandle, Any], Any] | None = None,
    ) -> ClientGoalHandle:
        """Send a goal and return its handle; `transition_cb(handle)` is called whenever its state changes."""
        self._servers.goals += 1
        message = self._types.action_goal()
        now = get_rostime()
        message.header.stamp = message.goal_id.stamp = now
        message.goal_id.id = f"{self._node.name}-{self._servers.goals}-{now.to_sec():.3f}"
        message.goal = goal
        handle = ClientGoalHandle(self, message.goal_id, transition_cb, feedback_cb)
        self._goals.append(handle)
        self.pub_goal.publish(message)
        return handle

    def wait_for_server(self, timeout: Any = None) -> bool:
        """Wait for a server; return whether one appeared in time. None or zero waits without limit."""
        return wait_until(self._node.process, lambda: self._servers.ready(self.ns), timeout, poll=True)

    wait_for_action_server_to_start = wait_for_server

    def cancel_all_goals(self) -> None:
        """Ask the server to cancel every goal."""
        self.publish_cancel(Time(), "")

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Ask the server to cancel all goals sent up to a given time."""
        self.publish_cancel(time, "")

    def publish_cancel(self, stamp: Any, goal_id: str) -> None:
        """Publish a cancel request."""
        self.pub_cancel.publish(message_type("actionlib_msgs/GoalID")(stamp, goal_id))

    def stop(self) -> None:
        """End all publications and subscriptions."""
        for one in (self.pub_goal, self.pub_cancel, self.status_sub, self.result_sub, self.feedback_sub):
            one.unregister()

    def _take_status(self, message: Any) -> None:
        for status in message.status_list:
            if status.status not in TERMINAL:  # a terminal state counts only once the result arrives
                for goal in tuple(self._goals):
                    goal.take_status(status)

    def _take_result(self, message: Any) -> None:
        for goal in tuple(self._goals):
            goal.take_result(message)
        self._goals = [one for one in self._goals if one.get_comm_state() != CommState.DONE]

    def _take_feedback(self, message: Any) -> None:
        for goal in tuple(self._goals):
            goal.take_feedback(message)
