"""actionlib's SimpleActionClient."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.actionlib import protocol
from pytest_tarl.ros.actionlib.protocol import (
    TERMINAL,
    ActionServers,
    ActionTypes,
    Publisher,
    Subscriber,
    wait_until,
)
from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.missing import unsupported
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.rospy.timing import Time, get_rostime
from pytest_tarl.ros.scheduler import Task, current_task


class SimpleGoalState:
    """The simple state of a goal."""

    PENDING, ACTIVE, DONE = range(3)


class SimpleClientGoalState:
    """Goal states, under names that older nodes use."""

    PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, RECALLED, LOST = 0, 1, 2, 3, 4, 5, 8, 9


class GoalManager:
    """Placeholder for actionlib's class: one client cannot have several goals."""

    def __init__(self, *_: Any) -> None:
        raise unsupported("actionlib.GoalManager")


class SimpleActionClient:
    """Sends one goal at a time and tracks it."""

    def __init__(self, ns: str, ActionSpec: Any) -> None:  # noqa: N803 (actionlib's name)
        self._node = this_node("SimpleActionClient")
        self._name = self._node.resolve(ns)
        self._types = ActionTypes(ActionSpec)
        self._servers = self._node.process.ros.part(ActionServers)
        self._goal_id: Any = None
        self._done_cb: Callable[[int, Any], Any] | None = None
        self._active_cb: Callable[[], Any] | None = None
        self._feedback_cb: Callable[[Any], Any] | None = None
        self._state, self._text, self._result, self._done = protocol.LOST, "", None, False
        self._waiting: list[Task] = []
        self._goal_pub = Publisher(f"{self._name}/goal", self._types.action_goal, queue_size=10)
        self._cancel_pub = Publisher(
            f"{self._name}/cancel", message_type("actionlib_msgs/GoalID"), queue_size=10
        )
        Subscriber(f"{self._name}/status", message_type("actionlib_msgs/GoalStatusArray"), self._take_status)
        Subscriber(f"{self._name}/result", self._types.action_result, self._take_result)
        Subscriber(f"{self._name}/feedback", self._types.action_feedback, self._take_feedback)

    def wait_for_server(self, timeout: Any = None) -> bool:
        """Wait for a server; return whether one appeared in time. None or zero waits without limit."""
        return self._wait(lambda: self._servers.ready(self._name), timeout, poll=True)

    def send_goal(
        self,
        goal: Any,
        done_cb: Callable[[int, Any], Any] | None = None,
        active_cb: Callable[[], Any] | None = None,
        feedback_cb: Callable[[Any], Any] | None = None,
    ) -> None:
        """Send a goal, and stop tracking the previous one."""
        self._forget()
        self._done_cb, self._active_cb, self._feedback_cb = done_cb, active_cb, feedback_cb
        self._servers.goals += 1
        message = self._types.action_goal()
        now = get_rostime()
        message.header.stamp = message.goal_id.stamp = now
        message.goal_id.id = f"{self._node.name}-{self._servers.goals}-{now.to_sec():.9f}"
        message.goal = goal
        self._goal_id, self._state = message.goal_id, protocol.PENDING
        self._goal_pub.publish(message)

    def send_goal_and_wait(self, goal: Any, execute_timeout: Any = None, preempt_timeout: Any = None) -> int:
        """Send a goal and wait for its end; after the first timeout, cancel it. Return its state."""
        self.send_goal(goal)
        if not self.wait_for_result(execute_timeout):
            self.cancel_goal()
            self.wait_for_result(preempt_timeout)
        return self.get_state()

    def wait_for_result(self, timeout: Any = None) -> bool:
        """Wait for the goal to end; return whether it ended in time. None or zero waits without limit."""
        if self._goal_id is None:
            return False
        return self._wait(lambda: self._done, timeout)

    def get_result(self) -> Any:
        """Return the result; None if there is none yet."""
        return self._result

    def get_state(self) -> int:
        """Return the goal's state, a number of actionlib_msgs/GoalStatus; LOST if there is no goal."""
        asked()
        if self._goal_id is None:
            return protocol.LOST
        simple = {protocol.PREEMPTING: protocol.ACTIVE, protocol.RECALLING: protocol.PENDING}
        return simple.get(self._state, self._state)

    def get_goal_status_text(self) -> str:
        """Return the server's status text for the goal."""
        return self._text

    def cancel_goal(self) -> None:
        """Ask the server to cancel the goal."""
        if self._goal_id is not None:
            self._cancel_pub.publish(message_type("actionlib_msgs/GoalID")(Time(), self._goal_id.id))

    def cancel_all_goals(self) -> None:
        """Ask the server to cancel every goal."""
        self._cancel_pub.publish(message_type("actionlib_msgs/GoalID")())

    def cancel_goals_at_and_before_time(self, time: Any) -> None:
        """Ask the server to cancel all goals sent up to a given time."""
        self._cancel_pub.publish(message_type("actionlib_msgs/GoalID")(time, ""))

    def stop_tracking_goal(self) -> None:
        """Stop tracking the goal."""
        self._forget()

    def _forget(self) -> None:
        self._goal_id = self._done_cb = self._active_cb = self._feedback_cb = None
        self._state, self._text, self._result, self._done = protocol.LOST, "", None, False

    def _mine(self, status: Any) -> bool:
        return self._goal_id is not None and bool(status.goal_id.id == self._goal_id.id)

    def _take_status(self, message: Any) -> None:
        for status in message.status_list:
            if self._mine(status) and self._state not in TERMINAL:
                began = self._state == protocol.PENDING and status.status == protocol.ACTIVE
                # a terminal state counts only once the result arrives
                if status.status not in TERMINAL:
                    self._state = status.status
                if began and self._active_cb is not None:
                    self._active_cb()

    def _take_feedback(self, message: Any) -> None:
        if self._mine(message.status) and self._feedback_cb is not None:
            self._feedback_cb(message.feedback)

    def _take_result(self, message: Any) -> None:
        if not self._mine(message.status) or self._done:
            return
        self._state, self._text = message.status.status, message.status.text
        self._result, self._done = message.result, True
        for task in self._waiting:
            self._node.process.scheduler.wake(task)
        if self._done_cb is not None:
            self._done_cb(self.get_state(), message.result)

    def _wait(self, condition: Callable[[], bool], timeout: Any, *, poll: bool = False) -> bool:
        task = current_task()
        self._waiting.append(task)
        try:
            return wait_until(self._node.process, condition, timeout, poll=poll)
        finally:
            self._waiting.remove(task)
