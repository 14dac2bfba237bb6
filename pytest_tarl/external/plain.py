"""Messages of ROS 2 as plain data, as they travel between the test and the guardian."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

_NESTED = re.compile(r"(?:sequence<)?(\w+)/(?:\w+/)?(\w+)")
Find = Callable[[str, str], Any]  # (package, name) → message class


def to_plain(value: Any) -> Any:
    """Return a message, a sequence or a value as dictionaries, lists, numbers and strings."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: to_plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if hasattr(value, "tolist"):  # numpy's arrays and those of the standard library
        return value.tolist()
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if isinstance(value, (list, tuple)):
        return [to_plain(one) for one in value]
    return value


def filled(message: Any, data: dict[str, Any], find: Find) -> Any:
    """Set the fields of a message from plain data, and return it."""
    kinds = message.get_fields_and_field_types()
    for name, value in data.items():
        now = getattr(message, name)
        nested = _NESTED.match(kinds[name])
        if hasattr(now, "get_fields_and_field_types"):
            filled(now, value, find)
        elif nested and isinstance(value, list):
            setattr(message, name, [filled(find(*nested.groups())(), one, find) for one in value])
        elif isinstance(now, bytes):
            setattr(message, name, bytes(value))
        else:
            setattr(message, name, value)
    return message
