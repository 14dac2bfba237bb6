"""actionlib's SimpleActionServer: one goal at a time; a newer goal preempts the older one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.actionlib import protocol
from pytest_tarl.ros.actionlib.protocol import ActionServers, ActionTypes, Publisher, Subscriber
from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.rospy.exceptions import ROSException
from pytest_tarl.ros.rospy.log import logerr, logwarn
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.rospy.timing import Time, get_rostime
from pytest_tarl.ros.scheduler import Task

_REPLACED = "This goal was canceled because another goal was received by the simple action server"
_TOO_OLD = (
    "This goal handle was canceled by the action server because its timestamp is before the timestamp of the last "
    "cancel request"
)


class SimpleActionServer:
    """Runs `execute_cb(goal)` in a task of the server, or announces goals by callbacks."""

    def __init__(
        self,
        name: str,
        ActionSpec: Any,  # noqa: N803 (actionlib's name)
        execute_cb: Callable[[Any], Any] | None = None,
        auto_start: bool = True,
    ) -> None:
        self._node = this_node("SimpleActionServer")
        self._name = self._node.resolve(name)
        self._types = ActionTypes(ActionSpec)
        self._execute_cb = execute_cb
        self._goal_callback: Callable[[], Any] | None = None
        self._preempt_callback: Callable[[], Any] | None = None
        self._current: Any = None  # ActionGoal messages
        self._next: Any = None
        self._status: dict[str, int] = {}
        self._preempt_requested = False
        self._cancelled_until = Time()  # latest stamp of any cancel request
        self._worker: Task | None = None
        self._started = False
        if auto_start:
            self.start()

    def start(self) -> None:
        """Start accepting goals."""
        if self._started:
            return
        self._started = True
        self._result_pub = Publisher(f"{self._name}/result", self._types.action_result, queue_size=50)
        self._feedback_pub = Publisher(f"{self._name}/feedback", self._types.action_feedback, queue_size=50)
        self._status_pub = Publisher(f"{self._name}/status", message_type("actionlib_msgs/GoalStatusArray"),
                                     latch=True, queue_size=50)  # fmt: skip
        Subscriber(f"{self._name}/goal", self._types.action_goal, self._take_goal)
        Subscriber(f"{self._name}/cancel", message_type("actionlib_msgs/GoalID"), self._take_cancel)
        process = self._node.process
        servers = process.ros.part(ActionServers)
        servers.names.add(self._name)
        process.at_end(lambda: servers.names.discard(self._name))
        if self._execute_cb is not None:
            self._worker = process.scheduler.spawn(process, self._execute_goals)

    def register_goal_callback(self, cb: Callable[[], Any] | None) -> None:
        """Register a callback for a goal that can be accepted."""
        if self._execute_cb is not None:
            logwarn(
                "Cannot call SimpleActionServer.register_goal_callback() because an executeCallback exists"
            )
        else:
            self._goal_callback = cb

    def register_preempt_callback(self, cb: Callable[[], Any] | None) -> None:
        """Register a callback for a preemption request."""
        self._preempt_callback = cb

    def accept_new_goal(self) -> Any:
        """Accept the newest goal; preempt the active one."""
        if self._next is None:
            logerr("Attempting to accept the next goal when a new goal is not available")
            return None
        if self.is_active():
            self.set_preempted(None, _REPLACED)
        self._current, self._next = self._next, None
        self._preempt_requested = False
        self._set(self._current.goal_id, protocol.ACTIVE)
        return self._current.goal

    def is_new_goal_available(self) -> bool:
        """Return whether a new goal is waiting."""
        return self._next is not None

    def is_preempt_requested(self) -> bool:
        """Return whether the current goal is to be preempted."""
        return self._preempt_requested

    def is_active(self) -> bool:
        """Return whether a goal is active."""
        status = None if self._current is None else self._status.get(self._current.goal_id.id)
        return status in (protocol.ACTIVE, protocol.PREEMPTING)

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        """End the goal as succeeded."""
        self._end(protocol.SUCCEEDED, result, text)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """End the goal as aborted."""
        self._end(protocol.ABORTED, result, text)

    def set_preempted(self, result: Any = None, text: str = "") -> None:
        """End the goal as preempted."""
        self._end(protocol.PREEMPTED, result, text)

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback to the client."""
        message = self._types.action_feedback()
        self._address(message, self._current.goal_id)
        message.feedback = feedback
        self._feedback_pub.publish(message)

    def get_default_result(self) -> Any:
        """Return an empty result."""
        return self._types.result()

    def _take_goal(self, message: Any) -> None:
        self._set(message.goal_id, protocol.PENDING)
        if Time() < message.goal_id.stamp <= self._cancelled_until:
            self._end_goal(message, protocol.RECALLED, None, _TOO_OLD)
            return
        if self._next is not None:
            self._end_goal(self._next, protocol.RECALLED, None,
                           _REPLACED)  # fmt: skip
        self._next = message
        if self.is_active():
            self._request_preempt()
        if self._goal_callback is not None:
            self._goal_callback()
        if self._worker is not None:
            self._node.process.scheduler.wake(self._worker)

    def _take_cancel(self, message: Any) -> None:
        """Cancel the goal with the message's ID, goals sent up to its stamp, or, without either, all goals."""

        def meant(goal_id: Any) -> bool:
            earlier = bool(message.stamp) and goal_id.stamp <= message.stamp
            return earlier or message.id == goal_id.id or not (message.id or message.stamp)

        self._cancelled_until = max(self._cancelled_until, message.stamp)
        if self._next is not None and meant(self._next.goal_id):
            goal, self._next = self._next, None
            self._end_goal(goal, protocol.RECALLED, None, "")
        if self.is_active() and meant(self._current.goal_id):
            self._request_preempt()

    def _request_preempt(self) -> None:
        self._preempt_requested = True
        self._set(self._current.goal_id, protocol.PREEMPTING)
        if self._preempt_callback is not None:
            self._preempt_callback()

    def _execute_goals(self) -> None:
        process = self._node.process
        while not process.ending:
            if self._next is None:
                process.scheduler.wait()
                continue
            goal = self.accept_new_goal()
            self._execute(goal)

    def _execute(self, goal: Any) -> None:
        if self._execute_cb is None:
            return
        try:
            self._execute_cb(goal)
        except Exception as error:
            if isinstance(error, ROSException) or getattr(error, "tarl_shutdown", False):
                raise
            logerr("Exception in your execute callback: %s", error)
            self.set_aborted(None, f"Exception in execute callback: {error}")
        if self.is_active() and not self._node.process.ending:
            logwarn("Your executeCallback did not set the goal to a terminal status. Setting it to ABORTED.")
            self.set_aborted(None, "No terminal state was set.")

    def _end(self, status: int, result: Any, text: str) -> None:
        if self._current is None:
            logerr("Attempting to end a goal when there is none")
            return
        self._end_goal(self._current, status, result, text)

    def _end_goal(self, goal: Any, status: int, result: Any, text: str) -> None:
        self._set(goal.goal_id, status, text)
        message = self._types.action_result()
        self._address(message, goal.goal_id, text)
        # in actionlib, 0 and '' also count as no result
        message.result = result or self._types.result()
        self._result_pub.publish(message)

    def _address(self, message: Any, goal_id: Any, text: str = "") -> None:
        message.header.stamp = get_rostime()
        message.status.goal_id, message.status.text = goal_id, text
        message.status.status = self._status[goal_id.id]

    def _set(self, goal_id: Any, status: int, text: str = "") -> None:
        self._status[goal_id.id] = status
        array: Any = message_type("actionlib_msgs/GoalStatusArray")()
        array.header.stamp = get_rostime()
        array.status_list = [message_type("actionlib_msgs/GoalStatus")(goal_id, status, text)]
        self._status_pub.publish(array)
