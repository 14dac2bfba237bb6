"""A container as an action server."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from pytest_tarl.ros.actionlib.server import SimpleActionServer


class ActionServerWrapper:
    """Runs a container for each goal of an action; the container's outcome decides how the goal ends."""

    def __init__(
        self,
        server_name: str,
        action_spec: Any,
        wrapped_container: Any,
        succeeded_outcomes: Iterable[str] = (),
        aborted_outcomes: Iterable[str] = (),
        preempted_outcomes: Iterable[str] = (),
        goal_key: str = "action_goal",
        feedback_key: str = "action_feedback",
        result_key: str = "action_result",
        goal_slots_map: Mapping[str, str] | None = None,
        feedback_slots_map: Mapping[str, str] | None = None,
        result_slots_map: Mapping[str, str] | None = None,
        expand_goal_slots: bool = False,
        pack_result_slots: bool = False,
    ) -> None:
        self.wrapped_container = wrapped_container
        self._name, self._spec = server_name, action_spec
        self._succeeded, self._aborted = set(succeeded_outcomes), set(aborted_outcomes)
        self._preempted = set(preempted_outcomes)
        self._goal_key, self._feedback_key, self._result_key = goal_key, feedback_key, result_key
        self._feedback_map = dict(feedback_slots_map or {})
        self._goal_map, self._result_map = dict(goal_slots_map or {}), dict(result_slots_map or {})
        self._expand, self._pack = expand_goal_slots, pack_result_slots
        self._server: Any = None
        wrapped_container.register_start_cb(lambda *_: self._publish_feedback())
        wrapped_container.register_transition_cb(lambda *_: self._publish_feedback())

    def run_server(self) -> None:
        """Start the server."""
        self._server = SimpleActionServer(self._name, self._spec, self.execute_cb, auto_start=False)
        self._server.register_preempt_callback(self.preempt_cb)
        self._server.start()

    def preempt_cb(self) -> None:
        """Ask the container to end."""
        if self.wrapped_container.is_running():
            self.wrapped_container.request_preempt()

    def execute_cb(self, goal: Any) -> None:
        """Run the container for a goal."""
        values = self.wrapped_container.userdata
        result = self._spec().action_result.result
        values[self._goal_key], values[self._result_key] = goal, result
        values[self._feedback_key] = self._spec().action_feedback.feedback
        for slot in goal.__slots__ if self._expand else self._goal_map:
            values[self._goal_map.get(slot, slot)] = getattr(goal, slot)
        outcome = self.wrapped_container.execute()
        for slot in result.__slots__ if self._pack else self._result_map:
            key = self._result_map.get(slot, slot)
            if key in values:
                setattr(result, slot, values[key])
        result = values[self._result_key]
        if outcome in self._succeeded:
            self._server.set_succeeded(result)
        elif outcome in self._preempted:
            self._server.set_preempted(result)
        else:
            self._server.set_aborted(
                result, "" if outcome in self._aborted else f"Outcome {outcome} has no meaning."
            )

    def _publish_feedback(self) -> None:
        values = self.wrapped_container.userdata
        if self._server is None or not self._server.is_active() or self._feedback_key not in values:
            return
        feedback = values[self._feedback_key]
        for slot, key in self._feedback_map.items():
            if key in values:
                setattr(feedback, slot, values[key])
        self._server.publish_feedback(feedback)
