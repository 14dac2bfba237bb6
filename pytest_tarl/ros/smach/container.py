"""smach's base class of states that contain states."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import TracebackType
from typing import Any, ClassVar

from pytest_tarl.errors import text_of
from pytest_tarl.ros.smach.errors import (
    InvalidStateError,
    InvalidTransitionError,
    SmachError,
)
from pytest_tarl.ros.smach.log import logerr
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach.userdata import Remapper, UserData


class Container(State):
    """A state with child states. Inside `with container:`, `add` adds states to it."""

    _open: ClassVar[list[Container]] = []

    def __init__(
        self,
        outcomes: Iterable[str] = (),
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
        io_keys: Iterable[str] = (),
    ) -> None:
        super().__init__(outcomes, input_keys, output_keys, io_keys)
        self.userdata = UserData()
        self._states: dict[str, Any] = {}
        self._remappings: dict[str, Mapping[str, str]] = {}
        self._callbacks: dict[str, list[tuple[Callable[..., Any], Sequence[Any]]]] = {}
        self._initial_labels: list[str] = []
        self._active: list[str] = []  # labels of the running states
        self._is_running = False

    def __enter__(self) -> Container:
        Container._open.append(self)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        Container._open.remove(self)
        if error is None:
            try:
                self.check_consistency()
            except SmachError as incomplete:  # only logged here, because execute() raises it again
                logerr(f"Container consistency check failed: {incomplete}")

    @classmethod
    def opened(cls) -> Any:
        """Return the open container.

        Raise InvalidStateError if no container of this class is open.
        """
        if not Container._open:
            raise InvalidStateError("Attempting to add to a container, but no container is currently open.")
        if not isinstance(Container._open[-1], cls):
            raise InvalidStateError(
                f"Attempting to add to a {cls.__name__}, but the open container is a "
                f"{type(Container._open[-1]).__name__}."
            )
        return Container._open[-1]

    def insert(self, label: str, state: Any, remapping: Mapping[str, str] | None) -> Any:
        """Add a state. Raise InvalidStateError if the label is taken, or the state has no `execute`."""
        if label in self._states:
            raise InvalidStateError(
                f"Attempting to add a state with label '{label}', which is in use already."
            )
        if label in self._outcomes:
            raise InvalidStateError(f"Attempting to add a state with label '{label}', which is an outcome.")
        if not hasattr(state, "execute"):
            raise InvalidStateError(f"Attempting to add '{label}', but {state!r} has no method execute.")
        self._states[label] = state
        self._remappings[label] = dict(remapping or {})
        return state

    def check_consistency(self) -> None:
        """Raise InvalidTransitionError if the container is incomplete."""

    def is_running(self) -> bool:
        """Return whether the container is running."""
        return self._is_running

    def get_children(self) -> dict[str, Any]:
        """Return the states by label."""
        return dict(self._states)

    def get_active_states(self) -> list[str]:
        """Return the labels of the running states."""
        return list(self._active)

    def get_initial_states(self) -> list[str]:
        """Return the labels of the states that run first."""
        return list(self._initial_labels)

    def set_initial_state(self, initial_states: Sequence[str], userdata: UserData | None = None) -> None:
        """Set the labels of the first states, and add userdata."""
        self._initial_labels = list(initial_states)
        if userdata is not None:
            self.userdata.update(userdata)

    def get_internal_edges(self) -> list[tuple[str, str, str]]:
        """Return (outcome, from, to) for each transition."""
        return []

    def register_start_cb(self, start_cb: Callable[..., Any], cb_args: Sequence[Any] = ()) -> None:
        """Call a function as `cb(userdata, initial_states, *cb_args)` when the container starts."""
        self._callbacks.setdefault("start", []).append((start_cb, cb_args))

    def register_transition_cb(self, transition_cb: Callable[..., Any], cb_args: Sequence[Any] = ()) -> None:
        """Call a function as `cb(userdata, active_states, *cb_args)` after each transition."""
        self._callbacks.setdefault("transition", []).append((transition_cb, cb_args))

    def register_termination_cb(
        self, termination_cb: Callable[..., Any], cb_args: Sequence[Any] = ()
    ) -> None:
        """Call a function as `cb(userdata, terminal_states, outcome, *cb_args)` when the container ends."""
        self._callbacks.setdefault("termination", []).append((termination_cb, cb_args))

    def call_back(self, when: str, *values: Any) -> None:
        """Call the functions registered for an event; errors are logged, and the container continues."""
        for callback, rest in self._callbacks.get(when, ()):
            self._call_one(when, callback, (*values, *rest))

    def _call_one(self, when: str, callback: Callable[..., Any], values: Sequence[Any]) -> None:
        try:
            callback(self.userdata, *values)
        except Exception as error:
            if getattr(error, "tarl_shutdown", False):
                raise
            logerr(f"A {when} callback of a container raised {type(error).__name__}: {text_of(error)}")

    def run_child(self, label: str) -> str:
        """Execute a state and return its outcome. Raise InvalidTransitionError if it is not declared."""
        state = self._states[label]
        reads, writes = state.get_registered_input_keys(), state.get_registered_output_keys()
        outcome = state.execute(Remapper(self.userdata, reads, writes, self._remappings[label]))
        if outcome not in state.get_registered_outcomes():
            raise InvalidTransitionError(
                f"Attempted to return outcome '{outcome}' from state '{label}' of type '{type(state).__name__}' "
                f"which only has registered outcomes: {list(state.get_registered_outcomes())}"
            )
        return str(outcome)

    def __getitem__(self, key: str) -> Any:
        return self._states[key]

    def __contains__(self, key: str) -> bool:
        return key in self._states
