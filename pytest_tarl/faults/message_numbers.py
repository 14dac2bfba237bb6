"""Change numbers in a message; fields are written as for sensors, such as `pose.pose.position.x` or `ranges.0`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.field_paths import field_value


def altered(message: Any, field: str, change: Callable[[float], float]) -> Any:
    """Return a copy of a message in which every number of a field is changed; integers stay integers.

    Raise AttributeError, IndexError, KeyError or TypeError if the field is missing or not a number.
    """
    copy = deepcopy(message)
    store(copy, field, _changed(field_value(copy, field), change))
    return copy


def store(message: Any, field: str, value: Any) -> None:
    """Set a field of a message, in place."""
    path, _, last = field.rpartition(".")
    holder = field_value(message, path) if path else message
    if isinstance(holder, Mapping):
        holder[last] = value  # type: ignore[index]
    elif last.lstrip("-").isdigit() and hasattr(holder, "__getitem__"):
        if isinstance(holder, tuple):
            values = list(holder)
            values[int(last)] = value
            store(message, path, type(holder)(values))
        else:
            holder[int(last)] = value
    else:
        setattr(holder, last, value)


def no_such_field(name: str, kind: str, topic: str, field: str, message: Any) -> SettingsError:
    """Return the error for a fault of a field that is missing from the messages or not a number."""
    return SettingsError(
        f"faults.{kind} of {name!r}: a message on {topic} ({type(message).__name__}) has no number {field!r}. Correct "
        "the field in the marker."
    )


def _changed(value: Any, change: Callable[[float], float]) -> Any:
    if isinstance(value, bool) or value is None or isinstance(value, str | bytes):
        raise TypeError("not a number")
    if isinstance(value, int):
        return round(change(float(value)))
    if isinstance(value, float):
        return change(value)
    if hasattr(value, "dtype"):
        return _changed_array(value, change)
    changed = [_changed(one, change) for one in value]
    if hasattr(value, "typecode"):
        return type(value)(value.typecode, changed)
    return tuple(changed) if isinstance(value, tuple) else changed


def _changed_array(value: Any, change: Callable[[float], float]) -> Any:
    """Return a changed numpy array or scalar with the same type."""
    import numpy as np

    changed = np.array([change(float(one)) for one in np.ravel(value)]).reshape(np.shape(value))
    whole = np.issubdtype(value.dtype, np.integer)
    return (np.rint(changed) if whole else changed).astype(value.dtype)[()]
