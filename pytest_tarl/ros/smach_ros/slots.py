"""Goals, requests, results and responses built from userdata or by a function."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import deepcopy
from typing import Any

from pytest_tarl.ros.smach.callbacks import declare_interface
from pytest_tarl.ros.smach.state import State
from pytest_tarl.ros.smach.userdata import Remapper


def declare(state: State, callbacks: Iterable[Any], read: Iterable[str], written: Iterable[str]) -> None:
    """Add the keys of slots, and those declared by callbacks, to a state."""
    state.register_input_keys(read)
    state.register_output_keys(written)
    for callback in callbacks:
        declare_interface(state, callback)


def build(
    state: State,
    ud: Any,
    message: Any,
    key: str | None,
    slots: Sequence[str],
    callback: tuple[Callable[..., Any] | None, Sequence[Any], Mapping[str, Any]],
) -> Any:
    """Return `ud[key]` or a copy of `message`, with slots from `ud`; a callback may replace it."""
    made = ud[key] if key is not None else deepcopy(message)
    for slot in slots:
        setattr(made, slot, ud[slot])
    function, args, kwargs = callback
    if function is None:
        return made
    returned = function(view(state, ud, function), made, *args, **kwargs)
    return made if returned is None else returned


def view(state: State, ud: Any, callback: Any) -> Any:
    """Return the userdata with the keys of a callback or, without declared keys, of the state."""
    read = getattr(callback, "_smach_input_keys", state.get_registered_input_keys())
    written = getattr(callback, "_smach_output_keys", state.get_registered_output_keys())
    return Remapper(ud, read, written)


def store(ud: Any, message: Any, key: str | None, slots: Sequence[str]) -> None:
    """Store a message under `key` in userdata, and its `slots` under their names."""
    if key is not None:
        ud[key] = message
    for slot in slots:
        ud[slot] = getattr(message, slot)


def seconds(duration: Any) -> float | None:
    """Return a rospy Duration or a number of seconds as a float; None means no limit."""
    if duration is None:
        return None
    return float(duration.to_sec() if hasattr(duration, "to_sec") else duration)
