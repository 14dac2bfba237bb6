"""Iterator: a container that runs its state once for each item."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from pytest_tarl.ros.smach.container import Container
from pytest_tarl.ros.smach.errors import InvalidTransitionError
from pytest_tarl.ros.smach.log import is_shutdown
from pytest_tarl.ros.smach.userdata import UserData


class Iterator(Container):
    """Runs a state for each item of `it`, which the state reads as `it_label`."""

    def __init__(
        self,
        outcomes: Iterable[str],
        input_keys: Iterable[str],
        output_keys: Iterable[str],
        it: Any = (),
        it_label: str = "it_data",
        exhausted_outcome: str = "exhausted",
    ) -> None:
        super().__init__([*outcomes, exhausted_outcome], input_keys, output_keys)
        self._items, self._key, self._exhausted = it, it_label, exhausted_outcome
        self._loop: list[str] = []
        self._break: list[str] = []
        self._final: dict[str, str] = {}

    @staticmethod
    def set_contained_state(
        label: str,
        state: Any,
        loop_outcomes: Iterable[str] = (),
        break_outcomes: Iterable[str] = (),
        final_outcome_map: Mapping[str, str] | None = None,
    ) -> None:
        """Set the open iterator's state, the outcomes on which it continues, and those that end it."""
        iterator: Iterator = Iterator.opened()
        iterator._states.clear()
        iterator.insert(label, state, None)
        iterator._loop, iterator._break = list(loop_outcomes), list(break_outcomes)
        iterator._final = dict(final_outcome_map or {})

    def set_iteritems(self, it: Any, it_label: str) -> None:
        """Set the items, and the key of the current item."""
        self._items, self._key = it, it_label

    def check_consistency(self) -> None:
        """Raise InvalidTransitionError if there is no state, or if the iterator lacks a final outcome."""
        if not self._states:
            raise InvalidTransitionError("No contained state of the iterator was set.")
        for outcome in self._break:
            if self._final.get(outcome, outcome) not in self._outcomes:
                raise InvalidTransitionError(
                    f"The iterator has no outcome '{self._final.get(outcome, outcome)}'."
                )

    def get_initial_states(self) -> list[str]:
        """Return the label of the state."""
        return list(self._states)

    def execute(self, parent_ud: Any = None) -> str | None:
        """Run the state for each item; return the outcome, or None if the node ends."""
        self.check_consistency()
        given = UserData() if parent_ud is None else parent_ud
        self.userdata.merge(given, self.get_registered_input_keys(), {})
        label = next(iter(self._states))
        self._is_running, self._active = True, [label]
        self.call_back("start", [label])
        outcome = self._exhausted
        for item in self._items() if callable(self._items) else self._items:
            if is_shutdown():
                return None
            if self.preempt_requested():
                self._states[label].request_preempt()
            self.userdata[self._key] = item
            result = self.run_child(label)
            self.call_back("transition", [label])
            if result in self._break or (self._loop and result not in self._loop):
                outcome = self._final.get(result, result)
                break
        self._is_running, self._active = False, []
        if self.preempt_requested():
            self.service_preempt()
        self.call_back("termination", [label], outcome)
        for key in self.get_registered_output_keys():
            if key in self.userdata:
                given[key] = self.userdata[key]
        return outcome
