"""rosidl_runtime_py.set_message: fill a message from a dictionary."""

from __future__ import annotations

import array
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.messages.snapshot import type_name

__all__ = ["set_message_fields"]


Stamp = Callable[[Any], None]  # called with a time, which it writes into a field
_MESSAGES = re.compile(r"(sequence<)?(?P<element>\w+/(msg/)?\w+)(, *\d+)?(>|\[\d+\])$")


def set_message_fields(
    msg: Any, values: Mapping[str, Any], expand_header_auto: bool = False, expand_time_now: bool = False
) -> list[Stamp]:
    """Store a dictionary's values, with nested dictionaries for nested messages, in the fields of a message.

    With the `expand_…` options, return a function for each header given as `auto` and each time given as `now`. It
    stores the time that it is called with.

    Raise TypeError if a message is not given as a dictionary, AttributeError for an unknown field, and ValueError for a
    value that does not fit.
    """
    stamps: list[Stamp] = []
    _fill(msg, values, (expand_header_auto, expand_time_now), stamps)
    return stamps


def _fill(msg: Any, values: Any, expand: tuple[bool, bool], stamps: list[Stamp]) -> None:
    if not isinstance(values, Mapping):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    types = msg.get_fields_and_field_types()
    for name, value in values.items():
        old = getattr(msg, name)
        kind = type_name(type(old)) if hasattr(old, "get_fields_and_field_types") else ""
        if expand[0] and value == "auto" and kind.startswith("std_msgs/") and kind.endswith("Header"):
            stamps.append(_stamp(old, "stamp"))
        elif (
            expand[1] and value == "now" and kind.startswith("builtin_interfaces/") and kind.endswith("Time")
        ):
            stamps.append(_stamp(msg, name))
        else:
            setattr(msg, name, _filled(old, value, types[name], expand, stamps))


def _filled(old: Any, value: Any, kind: str, expand: tuple[bool, bool], stamps: list[Stamp]) -> Any:
    """Return a value in the type of the field whose value is `old`."""
    if isinstance(old, array.array):
        return array.array(old.typecode, value)
    if isinstance(old, np.ndarray):
        return np.array(value, dtype=old.dtype)
    if found := _MESSAGES.match(kind):
        element = class_of("ros2", found["element"].replace("/msg/", "/"))
        return [_made(element(), one, expand, stamps) for one in value]
    if hasattr(old, "get_fields_and_field_types"):
        return _made(type(old)(), value, expand, stamps)
    return value if type(value) is type(old) else type(old)(value)


def _made(message: Any, value: Any, expand: tuple[bool, bool], stamps: list[Stamp]) -> Any:
    """Return the value if it is a message, or `message` filled with the values of a dictionary."""
    if isinstance(value, type(message)):
        return value
    _fill(message, value, expand, stamps)
    return message


def _stamp(holder: Any, name: str) -> Stamp:
    return lambda time: setattr(holder, name, time)
