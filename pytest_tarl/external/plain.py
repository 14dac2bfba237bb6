"""Convert ROS messages to and from plain data."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

_NESTED = re.compile(r"(?:sequence<)?(\w+)/(?:\w+/)?(\w+)")
Find = Callable[[str, str], Any]  # (package, name) → message class


def to_plain(value: Any) -> Any:
    """Convert a message to dictionaries, lists, numbers and strings."""
    kinds = _fields(value)
    if kinds is not None:
        return {name: to_plain(getattr(value, name)) for name in kinds}
    if hasattr(value, "tolist"):  # arrays of numpy or of the module `array`
        return value.tolist()
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if isinstance(value, (list, tuple)):
        return [to_plain(one) for one in value]
    return value


def filled(message: Any, data: dict[str, Any], find: Find) -> Any:
    """Set a message's fields from plain data, and return the message."""
    kinds = _fields(message) or {}
    for name, value in data.items():
        now = getattr(message, name)
        nested = _NESTED.match(kinds[name])
        if _fields(now) is not None:
            filled(now, value, find)
        elif nested and isinstance(value, list):
            setattr(message, name, [filled(find(*nested.groups())(), one, find) for one in value])
        elif isinstance(now, bytes):
            setattr(message, name, bytes(value))
        else:
            setattr(message, name, value)
    return message


def _fields(value: Any) -> Mapping[str, str] | None:
    """Return the names and types of a message's fields; None if the value is not a message.

    In ROS 1, times and durations count as messages.
    """
    if hasattr(value, "get_fields_and_field_types"):
        return dict(value.get_fields_and_field_types())
    if hasattr(value, "_slot_types"):
        return dict(zip(value.__slots__, value._slot_types, strict=True))
    if hasattr(value, "secs") and hasattr(value, "nsecs"):
        return {"secs": "int32", "nsecs": "int32"}
    return None
