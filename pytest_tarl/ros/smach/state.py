"""smach's base class of all states: outcomes, keys, and requests to end early."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


class State:
    """A state with its outcomes and userdata keys; subclasses implement `execute`."""

    def __init__(
        self,
        outcomes: Iterable[str] = (),
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
        io_keys: Iterable[str] = (),
    ) -> None:
        self._outcomes = set(outcomes)
        self._input_keys = {*input_keys, *io_keys}
        self._output_keys = {*output_keys, *io_keys}
        self._preempt_requested = False

    def execute(self, ud: Any) -> Any:
        """Do the state's work, and return its outcome."""
        raise NotImplementedError

    def register_outcomes(self, new_outcomes: Iterable[str]) -> None:
        """Add outcomes."""
        self._outcomes |= set(new_outcomes)

    def get_registered_outcomes(self) -> tuple[str, ...]:
        """Return the outcomes."""
        return tuple(sorted(self._outcomes))

    def register_io_keys(self, keys: Iterable[str]) -> None:
        """Add keys that the state reads and writes."""
        self.register_input_keys(keys)
        self.register_output_keys(keys)

    def register_input_keys(self, keys: Iterable[str]) -> None:
        """Add keys that the state reads."""
        self._input_keys |= set(keys)

    def get_registered_input_keys(self) -> tuple[str, ...]:
        """Return the keys that the state reads."""
        return tuple(sorted(self._input_keys))

    def register_output_keys(self, keys: Iterable[str]) -> None:
        """Add keys that the state writes."""
        self._output_keys |= set(keys)

    def get_registered_output_keys(self) -> tuple[str, ...]:
        """Return the keys that the state writes."""
        return tuple(sorted(self._output_keys))

    def request_preempt(self) -> None:
        """Ask the state to end."""
        self._preempt_requested = True

    def service_preempt(self) -> None:
        """Confirm that the state ends as requested."""
        self._preempt_requested = False

    def recall_preempt(self) -> None:
        """Withdraw the request to end."""
        self._preempt_requested = False

    def preempt_requested(self) -> bool:
        """Return whether the state was asked to end."""
        return self._preempt_requested
