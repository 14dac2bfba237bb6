"""State machines: one state runs at a time, and its outcome selects the next."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from pytest_tarl.ros.smach.container import Container
from pytest_tarl.ros.smach.errors import InvalidStateError, InvalidTransitionError
from pytest_tarl.ros.smach.log import is_shutdown, loginfo, logwarn
from pytest_tarl.ros.smach.userdata import UserData

Transitions = Mapping[str, str | None]


class StateMachine(Container):
    """States whose outcomes lead to another state, or to an outcome of the machine."""

    def __init__(
        self,
        outcomes: Iterable[str],
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
    ) -> None:
        super().__init__(outcomes, input_keys, output_keys)
        self._transitions: dict[str, dict[str, str | None]] = {}
        # last state added by add_auto, and its outcomes still to be connected
        self._chained: tuple[str, list[str]] | None = None
        self._preempted: Any = None  # state that was asked to end

    @staticmethod
    def add(
        label: str,
        state: Any,
        transitions: Transitions | None = None,
        remapping: Mapping[str, str] | None = None,
    ) -> Any:
        """Add a state to the open machine. An outcome without a transition ends the machine."""
        return StateMachine.opened()._add(label, state, transitions, remapping)

    @staticmethod
    def add_auto(
        label: str,
        state: Any,
        connector_outcomes: Iterable[str],
        transitions: Transitions | None = None,
        remapping: Mapping[str, str] | None = None,
    ) -> Any:
        """Add a state whose `connector_outcomes` lead to the next state that is added."""
        machine: StateMachine = StateMachine.opened()
        added = machine._add(label, state, transitions, remapping)
        machine._chained = (label, list(connector_outcomes))
        return added

    def _add(
        self, label: str, state: Any, transitions: Transitions | None, remapping: Mapping[str, str] | None
    ) -> Any:
        added = self.insert(label, state, remapping)
        unknown = set(transitions or {}) - set(state.get_registered_outcomes())
        if unknown:
            del self._states[label]
            raise InvalidTransitionError(
                f"The transitions of state '{label}' name outcomes that it does not have: {sorted(unknown)}"
            )
        self._transitions[label] = {**dict.fromkeys(state.get_registered_outcomes()), **(transitions or {})}
        for outcome, target in self._transitions[label].items():
            if target is None and outcome in self._outcomes:
                self._transitions[label][outcome] = outcome
        if not self._initial_labels:
            self._initial_labels = [label]
        if self._chained is not None:
            before, outcomes = self._chained
            self._transitions[before].update(dict.fromkeys(outcomes, label))
            self._chained = None
        return added

    def check_consistency(self) -> None:
        """Raise InvalidTransitionError if an outcome leads nowhere or the initial state is missing."""
        known = {*self._states, *self._outcomes}
        lost = [
            f"'{label}':'{outcome}'" + (f" → '{target}'" if target else "")
            for label, transitions in self._transitions.items()
            for outcome, target in transitions.items()
            if target not in known
        ]
        missing = [label for label in self._initial_labels if label not in self._states]
        if not self._initial_labels:
            raise InvalidTransitionError("State machine failed consistency check: No initial state set.")
        if lost or missing:
            raise InvalidTransitionError(
                "State machine failed consistency check: "
                + "; ".join(
                    [*(f"transition {one} leads to no state or outcome" for one in lost),
                     *(f"initial state '{one}' is not in the machine" for one in missing)]
                )
            )  # fmt: skip

    def get_internal_edges(self) -> list[tuple[str, str, str]]:
        """Return (outcome, from, to) for each transition; `to` is "None" if the outcome leads nowhere."""
        return [
            (outcome, label, str(target))
            for label, transitions in self._transitions.items()
            for outcome, target in transitions.items()
        ]

    def execute(self, parent_ud: Any = None) -> str | None:
        """Run the machine from its initial state; return its outcome, or None if the node ends."""
        self.check_consistency()
        given = UserData() if parent_ud is None else parent_ud
        self.userdata.merge(given, self.get_registered_input_keys(), {})
        label = self._initial_labels[0]
        self._is_running, self._active = True, [label]
        loginfo(
            f"State machine starting in initial state '{label}' with userdata: \n\t{self.userdata.keys()}"
        )
        self.call_back("start", [label])
        outcome: str | None = None
        try:
            while outcome is None and not is_shutdown():
                label, outcome = self._update(label)
        finally:
            self._is_running, self._preempted = False, None
        if outcome is not None:
            self.call_back("termination", [label], outcome)
            for key in self.get_registered_output_keys():
                if key in self.userdata:
                    given[key] = self.userdata[key]
        self._active = []
        return outcome

    def _update(self, label: str) -> tuple[str, str | None]:
        """Execute a state. Return it with the machine's outcome, or the next state with None."""
        if self.preempt_requested():
            self._pass_on_preempt(label)
        result = self.run_child(label)
        if self._preempted is not None:
            if self._preempted.preempt_requested():
                logwarn(f"State '{label}' has not handled the request to end.")
                self._preempted.recall_preempt()
            self._preempted = None
            self.service_preempt()
        target = self._transitions[label][result]
        if target in self._states:
            loginfo(f"State machine transitioning '{label}':'{result}'-->'{target}'")
            self._active = [str(target)]
            self.call_back("transition", [target])
            return str(target), None
        if target not in self._outcomes:
            raise InvalidTransitionError(
                f"Outcome '{result}' of state '{label}' with transition target '{target}' is neither a registered "
                "state nor a registered container outcome."
            )
        loginfo(f"State machine terminating '{label}':'{result}':'{target}'")
        return label, target

    def _pass_on_preempt(self, label: str) -> None:
        self._preempted = self._states[label]
        self._preempted.request_preempt()

    def request_preempt(self) -> None:
        """Ask the machine and its current state to end."""
        super().request_preempt()
        if self._active:
            self._pass_on_preempt(self._active[0])

    def get_initial_states(self) -> list[str]:
        """Return the label of the state that runs first. Raise InvalidStateError if the machine is empty."""
        if not self._initial_labels:
            raise InvalidStateError("The machine has no states.")
        return list(self._initial_labels)


class Sequence(StateMachine):
    """A machine in which `connector_outcome` leads from each state to the next."""

    def __init__(
        self,
        outcomes: Iterable[str],
        connector_outcome: str,
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
    ) -> None:
        super().__init__(outcomes, input_keys, output_keys)
        self._connector = connector_outcome

    @staticmethod
    def add(
        label: str,
        state: Any,
        transitions: Transitions | None = None,
        remapping: Mapping[str, str] | None = None,
    ) -> Any:
        """Add the next state; after the last state, `connector_outcome` ends the sequence."""
        sequence: Sequence = Sequence.opened()
        added = sequence._add(label, state, transitions, remapping)
        if sequence._connector in state.get_registered_outcomes() and sequence._connector not in (
            transitions or {}
        ):
            sequence._chained = (label, [sequence._connector])
        return added
