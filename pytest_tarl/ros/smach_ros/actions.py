"""A state that sends a goal to an action server and waits for the result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from pytest_tarl.ros.actionlib.client import SimpleActionClient
from pytest_tarl.ros.actionlib.protocol import GoalStatus
from pytest_tarl.ros.rospy.log import logerr, logwarn
from pytest_tarl.ros.rospy.node import is_shutdown
from pytest_tarl.ros.rospy.timing import Duration, get_time
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach_ros import slots

_LOOK = 0.1  # seconds between two checks whether the state must end


class SimpleActionState(State):
    """Sends a goal; its outcomes are "succeeded", "aborted", "preempted" and those that `result_cb` may return."""

    def __init__(
        self,
        action_name: str,
        action_spec: Any,
        goal: Any = None,
        goal_key: str | None = None,
        goal_slots: Sequence[str] = (),
        goal_cb: Callable[..., Any] | None = None,
        goal_cb_args: Sequence[Any] = (),
        goal_cb_kwargs: Mapping[str, Any] | None = None,
        result_key: str | None = None,
        result_slots: Sequence[str] = (),
        result_cb: Callable[..., Any] | None = None,
        result_cb_args: Sequence[Any] = (),
        result_cb_kwargs: Mapping[str, Any] | None = None,
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
        outcomes: Iterable[str] = (),
        exec_timeout: Any = None,
        cancel_timeout: Any = None,
        server_wait_timeout: Any = None,
        **options: Any,
    ) -> None:
        super().__init__(["succeeded", "aborted", "preempted", *outcomes], input_keys, output_keys)
        self._name, self._client = action_name, SimpleActionClient(action_name, action_spec)
        empty = action_spec().action_goal.goal
        if callable(goal) and goal_cb is None:  # an older form of the call passes the callback as `goal`
            goal, goal_cb = None, goal
        self._goal = empty if goal is None else goal
        self._goal_key, self._goal_slots = goal_key, list(goal_slots)
        self._goal_cb = (goal_cb, tuple(goal_cb_args), dict(goal_cb_kwargs or {}))
        self._result_key, self._result_slots = result_key, list(result_slots)
        self._result_cb = (result_cb, tuple(result_cb_args), dict(result_cb_kwargs or {}))
        self._limit = slots.seconds(exec_timeout)
        wait = slots.seconds(server_wait_timeout)
        self._wait = 60.0 if wait is None else wait
        end = slots.seconds(options.get("preempt_timeout", cancel_timeout))
        self._end = 60.0 if end is None else end
        callbacks = [one for one in (goal_cb, result_cb) if one is not None]
        read = [*self._goal_slots, *([goal_key] if goal_key is not None else [])]
        slots.declare(
            self, callbacks, read, [*self._result_slots, *([result_key] if result_key is not None else [])]
        )

    def execute(self, ud: Any) -> str:
        """Send the goal, wait for the result, and return the outcome."""
        if self.preempt_requested():
            self.service_preempt()
            return "preempted"
        if not self._client.wait_for_server(Duration(self._wait)):
            logerr(f"Action server {self._name} did not answer within {self._wait} s")
            return "aborted"
        goal = slots.build(self, ud, self._goal, self._goal_key, self._goal_slots, self._goal_cb)
        self._client.send_goal(goal)
        preempted = self._wait_for_result()
        status, result = self._client.get_state(), self._client.get_result()
        if result is not None:
            slots.store(ud, result, self._result_key, self._result_slots)
        function, args, kwargs = self._result_cb
        if function is not None:
            chosen = function(slots.view(self, ud, function), status, result, *args, **kwargs)
            if chosen is not None and chosen in self.get_registered_outcomes():
                return str(chosen)
        if status == GoalStatus.SUCCEEDED:
            return "succeeded"
        if status == GoalStatus.PREEMPTED and preempted:
            self.service_preempt()
            return "preempted"
        return "aborted"

    def _wait_for_result(self) -> bool:
        """Wait for the goal to end; cancel it on request or after the time limit.

        Return whether the end was requested.
        """
        began, cancelled, requested = get_time(), None, False
        while not is_shutdown() and not self._client.wait_for_result(Duration(_LOOK)):
            now = get_time()
            if cancelled is None and self.preempt_requested():
                requested, cancelled = True, now
                self._client.cancel_goal()
            elif cancelled is None and self._limit is not None and now - began > self._limit:
                logwarn(f"Action {self._name} timed out after {self._limit} s")
                cancelled = now
                self._client.cancel_goal()
            elif cancelled is not None and now - cancelled > self._end:
                logwarn(f"Action {self._name} did not end within {self._end} s after it was cancelled")
                break
        return requested
