"""Concurrence: a container whose states run at the same time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.scheduler import current_task
from pytest_tarl.ros.smach.container import Container
from pytest_tarl.ros.smach.errors import InvalidTransitionError
from pytest_tarl.ros.smach.log import loginfo
from pytest_tarl.ros.smach.userdata import UserData

Outcomes = Mapping[str, str | None]


class Concurrence(Container):
    """Starts all states together. `outcome_cb`, `outcome_map` or the default turns their outcomes into one."""

    def __init__(
        self,
        outcomes: Iterable[str],
        default_outcome: str,
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
        outcome_map: Mapping[str, Mapping[str, str]] | None = None,
        outcome_cb: Callable[[Outcomes], Any] | None = None,
        child_termination_cb: Callable[[Outcomes], Any] | None = None,
    ) -> None:
        super().__init__(outcomes, input_keys, output_keys)
        self._default = default_outcome
        self._map = dict(outcome_map or {})
        self._outcome_cb, self._child_cb = outcome_cb, child_termination_cb
        self._ended: dict[str, str | None] = {}  # outcomes by label; None while a state is running

    @staticmethod
    def add(label: str, state: Any, remapping: Mapping[str, str] | None = None) -> Any:
        """Add a state to the open container."""
        return Concurrence.opened().insert(label, state, remapping)

    def check_consistency(self) -> None:
        """Raise InvalidTransitionError if the default or the map names an unknown outcome or state."""
        for outcome in (self._default, *self._map):
            if outcome not in self._outcomes:
                raise InvalidTransitionError(f"Concurrence has no outcome '{outcome}'.")
        for label in {label for wanted in self._map.values() for label in wanted}:
            if label not in self._states:
                raise InvalidTransitionError(f"The outcome map names a state '{label}' that was not added.")

    def get_initial_states(self) -> list[str]:
        """Return all labels."""
        return list(self._states)

    def get_internal_edges(self) -> list[tuple[str, str, str]]:
        """Return (outcome, from, to) for the states in the outcome map."""
        return [
            (child, label, outcome)
            for outcome, wanted in self._map.items()
            for label, child in wanted.items()
        ]

    def execute(self, parent_ud: Any = None) -> str | None:
        """Run all states; return the outcome, or None if the node ends."""
        self.check_consistency()
        process = current_process("smach.Concurrence")
        given = UserData() if parent_ud is None else parent_ud
        self.userdata.merge(given, self.get_registered_input_keys(), {})
        self._is_running, self._ended = True, dict.fromkeys(self._states)
        self._active = list(self._states)
        loginfo(f"Concurrence starting with userdata: \n\t{self.userdata.keys()}")
        self.call_back("start", list(self._states))
        me = current_task()
        for label in self._states:
            process.scheduler.spawn(process, self._run, label, me)
        while self._active and not process.ending:
            process.scheduler.wait()
        self._is_running = False
        if process.ending:
            process.refuse_to_wait()
            return None
        outcome = self._outcome()
        self.call_back("termination", list(self._states), outcome)
        for key in self.get_registered_output_keys():
            if key in self.userdata:
                given[key] = self.userdata[key]
        if self.preempt_requested():
            self.service_preempt()
        return outcome

    def _run(self, label: str, parent: Any) -> None:
        self._ended[label] = self.run_child(label)
        self._active.remove(label)
        loginfo(f"Concurrent state '{label}' returned outcome '{self._ended[label]}' on termination.")
        self.call_back("transition", list(self._active))
        if self._child_cb is not None and self._active and self._child_cb(dict(self._ended)):
            self._preempt_children()
        current_process("smach.Concurrence").scheduler.wake(parent)

    def _outcome(self) -> str:
        chosen = self._outcome_cb(dict(self._ended)) if self._outcome_cb is not None else None
        if chosen is not None:
            if chosen not in self._outcomes:
                raise InvalidTransitionError(f"outcome_cb returned '{chosen}', which is not an outcome.")
            return str(chosen)
        for outcome, wanted in self._map.items():
            if all(self._ended.get(label) == child for label, child in wanted.items()):
                return outcome
        return self._default

    def _preempt_children(self) -> None:
        for label in self._active:
            self._states[label].request_preempt()

    def request_preempt(self) -> None:
        """Ask the container and its running states to end."""
        super().request_preempt()
        self._preempt_children()
