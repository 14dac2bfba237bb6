"""actionlib's ActionServer: several goals at a time, each with its own handle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from pytest_tarl.ros.actionlib import protocol
from pytest_tarl.ros.actionlib.protocol import ActionServers, ActionTypes, Publisher, Subscriber
from pytest_tarl.ros.messages import message_type
from pytest_tarl.ros.rospy.log import logerr, logwarn
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.rospy.timing import Duration, Time, get_rostime
from pytest_tarl.ros.rospy.timing import Timer as PeriodicTimer

# seconds between two publications of all states (actionlib's default)
_PERIOD: Final = 0.2
# seconds for which the state of an ended goal is still published (actionlib's default)
_KEPT: Final = 5.0
_TOO_OLD: Final = (
    "This goal handle was canceled by the action server because its timestamp is before the timestamp of the last "
    "cancel request"
)
_WAITING: Final = (protocol.PENDING, protocol.RECALLING)
_RUNNING: Final = (protocol.ACTIVE, protocol.PREEMPTING)


class ServerGoalHandle:
    """A goal of the server: its state, and the node's transitions."""

    def __init__(self, server: ActionServer, message: Any) -> None:
        self.action_server = server
        self.goal = message
        self._status = protocol.PENDING
        self._text = ""
        self.ended: Any = None  # when the goal ended

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and self.goal.goal_id.id == other.goal.goal_id.id

    def __hash__(self) -> int:
        return hash(self.goal.goal_id.id)

    def get_goal(self) -> Any:
        """Return the goal."""
        return self.goal.goal

    def get_goal_id(self) -> Any:
        """Return the goal's ID, an actionlib_msgs/GoalID."""
        return self.goal.goal_id

    def get_goal_status(self) -> Any:
        """Return the goal's state, an actionlib_msgs/GoalStatus."""
        return message_type("actionlib_msgs/GoalStatus")(self.goal.goal_id, self._status, self._text)

    def get_default_result(self) -> Any:
        """Return an empty result."""
        return self.action_server.get_default_result()

    def set_accepted(self, text: str = "") -> None:
        """Accept the goal; if its cancellation was requested, it becomes PREEMPTING."""
        after = {protocol.PENDING: protocol.ACTIVE, protocol.RECALLING: protocol.PREEMPTING}
        self._change(after, "an active", "pending or recalling", text)

    def set_canceled(self, result: Any = None, text: str = "") -> None:
        """End the goal: as RECALLED if it was not accepted, otherwise as PREEMPTED."""
        after = dict.fromkeys(_WAITING, protocol.RECALLED) | dict.fromkeys(_RUNNING, protocol.PREEMPTED)
        self._end(after, "a cancelled", "pending, recalling, active, or preempting", result, text)

    def set_rejected(self, result: Any = None, text: str = "") -> None:
        """Reject the goal."""
        after = dict.fromkeys(_WAITING, protocol.REJECTED)
        self._end(after, "a rejected", "pending or recalling", result, text)

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        """End the goal as aborted."""
        after = dict.fromkeys(_RUNNING, protocol.ABORTED)
        self._end(after, "an aborted", "active or preempting", result, text)

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        """End the goal as succeeded."""
        after = dict.fromkeys(_RUNNING, protocol.SUCCEEDED)
        self._end(after, "a succeeded", "active or preempting", result, text)

    def set_cancel_requested(self) -> bool:
        """Note a cancel request; return whether the goal can still be cancelled."""
        after = {protocol.PENDING: protocol.RECALLING, protocol.ACTIVE: protocol.PREEMPTING}.get(self._status)
        if after is None:
            return False
        self._status = after
        self.action_server.publish_status()
        return True

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback to the client."""
        self.action_server.publish_feedback(self.get_goal_status(), feedback)

    def _change(self, after: dict[int, int], kind: str, needed: str, text: str) -> bool:
        if self._status not in after:
            logerr(f"To transition to {kind} state, the goal must be in a {needed} state, it is currently in state: "
                   f"{self._status}")  # fmt: skip
            return False
        self._status, self._text = after[self._status], text
        self.action_server.publish_status()
        return True

    def _end(self, after: dict[int, int], kind: str, needed: str, result: Any, text: str) -> None:
        if self._change(after, kind, needed, text):
            self.ended = get_rostime()
            result = result or self.get_default_result()  # in actionlib, 0 and '' also count as no result
            self.action_server.publish_result(self.get_goal_status(), result)


class ActionServer:
    """Passes goals and cancel requests to callbacks, with the goal's handle."""

    def __init__(
        self,
        ns: str,
        ActionSpec: Any,  # noqa: N803 (actionlib's name)
        goal_cb: Callable[[ServerGoalHandle], Any],
        cancel_cb: Callable[[ServerGoalHandle], Any] = lambda _: None,
        auto_start: bool = True,
    ) -> None:
        self._node = this_node("ActionServer")
        self.ns = self._node.resolve(ns)
        self._types = ActionTypes(ActionSpec)
        self.goal_callback, self.cancel_callback = goal_cb, cancel_cb
        self._goals: list[ServerGoalHandle] = []
        self._last_cancel = Time()
        self.started = False
        if auto_start:
            logwarn("You've passed in true for auto_start to the python action server, you should always pass in "
                    "false to avoid race conditions.")  # fmt: skip
            self.start()

    def register_goal_callback(self, cb: Callable[[ServerGoalHandle], Any]) -> None:
        """Register the callback for new goals."""
        self.goal_callback = cb

    def register_cancel_callback(self, cancel_cb: Callable[[ServerGoalHandle], Any]) -> None:
        """Register the callback for cancel requests."""
        self.cancel_callback = cancel_cb

    def start(self) -> None:
        """Start accepting goals."""
        if self.started:
            return
        statuses = message_type("actionlib_msgs/GoalStatusArray")
        self.status_pub = Publisher(f"{self.ns}/status", statuses, latch=True, queue_size=50)
        self.result_pub = Publisher(f"{self.ns}/result", self._types.action_result, queue_size=50)
        self.feedback_pub = Publisher(f"{self.ns}/feedback", self._types.action_feedback, queue_size=50)
        self.goal_sub = Subscriber(f"{self.ns}/goal", self._types.action_goal, self._take_goal)
        ids = message_type("actionlib_msgs/GoalID")
        self.cancel_sub = Subscriber(f"{self.ns}/cancel", ids, self._take_cancel)
        self.status_timer = PeriodicTimer(Duration(_PERIOD), lambda _: self.publish_status())
        process = self._node.process
        servers = process.ros.part(ActionServers)
        servers.names.add(self.ns)
        process.at_end(lambda: servers.names.discard(self.ns))
        self.started = True
        self.publish_status()

    def stop(self) -> None:
        """Accept no more goals, and end all publications and subscriptions."""
        self.started = False
        self.status_timer.shutdown()
        self._node.process.ros.part(ActionServers).names.discard(self.ns)
        for one in (self.goal_sub, self.cancel_sub, self.status_pub, self.result_pub, self.feedback_pub):
            one.unregister()

    def get_default_result(self) -> Any:
        """Return an empty result."""
        return self._types.result()

    def publish_result(self, status: Any, result: Any) -> None:
        """Publish the result of a goal."""
        message = self._types.action_result()
        message.header.stamp, message.status, message.result = get_rostime(), status, result
        self.result_pub.publish(message)
        self.publish_status()

    def publish_feedback(self, status: Any, feedback: Any) -> None:
        """Publish feedback on a goal."""
        message = self._types.action_feedback()
        message.header.stamp, message.status, message.feedback = get_rostime(), status, feedback
        self.feedback_pub.publish(message)

    def publish_status(self) -> None:
        """Publish the states of all goals, except those that ended more than five seconds ago."""
        if not self.started:
            return
        now = get_rostime()
        self._goals = [one for one in self._goals if one.ended is None or now - one.ended <= Duration(_KEPT)]
        message: Any = message_type("actionlib_msgs/GoalStatusArray")()
        message.header.stamp = now
        message.status_list = [one.get_goal_status() for one in self._goals]
        self.status_pub.publish(message)

    def _take_goal(self, message: Any) -> None:
        handle = ServerGoalHandle(self, message)
        if handle in self._goals:
            return
        self._goals.append(handle)
        if Time() < message.goal_id.stamp <= self._last_cancel:
            handle.set_canceled(None, _TOO_OLD)
        else:
            self.goal_callback(handle)

    def _take_cancel(self, message: Any) -> None:
        """Cancel the goal with the message's ID, goals sent up to its stamp, or, without either, all goals."""
        for handle in tuple(self._goals):
            goal_id = handle.get_goal_id()
            earlier = message.stamp != Time() and goal_id.stamp <= message.stamp
            everything = not message.id and message.stamp == Time()
            if (everything or earlier or message.id == goal_id.id) and handle.set_cancel_requested():
                self.cancel_callback(handle)
        self._last_cancel = max(self._last_cancel, message.stamp)


__all__ = ["ActionServer", "ServerGoalHandle"]
