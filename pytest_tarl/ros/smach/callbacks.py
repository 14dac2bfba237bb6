"""States that call a function."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from pytest_tarl.ros.smach.state import State

_PARTS = {
    "_smach_outcomes": "register_outcomes",
    "_smach_input_keys": "register_input_keys",
    "_smach_output_keys": "register_output_keys",
}


def cb_interface(
    outcomes: Iterable[str] = (), input_keys: Iterable[str] = (), output_keys: Iterable[str] = ()
) -> Callable[[Any], Any]:
    """Return a decorator that declares a function's outcomes and keys."""

    def declare(function: Any) -> Any:
        function._smach_outcomes = list(outcomes)
        function._smach_input_keys = list(input_keys)
        function._smach_output_keys = list(output_keys)
        return function

    return declare


def has_smach_interface(cb: Any) -> bool:
    """Return whether a function declares its outcomes and keys."""
    return all(hasattr(cb, part) for part in _PARTS)


def declare_interface(state: State, cb: Any) -> None:
    """Add a function's declared outcomes and keys to a state."""
    for part, method in _PARTS.items():
        getattr(state, method)(getattr(cb, part, ()))


class CBState(State):
    """A state that calls `cb(userdata, *cb_args, **cb_kwargs)` and returns its result as the outcome."""

    def __init__(
        self,
        cb: Callable[..., Any],
        cb_args: Sequence[Any] = (),
        cb_kwargs: Mapping[str, Any] | None = None,
        outcomes: Iterable[str] = (),
        input_keys: Iterable[str] = (),
        output_keys: Iterable[str] = (),
        io_keys: Iterable[str] = (),
    ) -> None:
        super().__init__(outcomes, input_keys, output_keys, io_keys)
        self._cb, self._args, self._kwargs = cb, tuple(cb_args), dict(cb_kwargs or {})
        declare_interface(self, cb)

    def execute(self, ud: Any) -> Any:
        """Call the function."""
        return self._cb(ud, *self._args, **self._kwargs)
