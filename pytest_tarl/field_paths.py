"""Fields of messages, named by dotted paths such as `pose.pose.position.x` and `ranges.0`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

_INDEX = re.compile(r"\[\s*(-?\d+)\s*\]")


def dotted(field: str) -> str:
    """Return a field with Python indices, such as `ranges[0]` or `poses[-1].x`, as a dotted path."""
    return _INDEX.sub(r".\1", field).removeprefix(".")


def field_value(message: Any, field: str) -> Any:
    """Follow a dotted path; a number indexes a sequence (`ranges.0`).

    Raise AttributeError or IndexError if the message does not have the field or element, and KeyError if a mapping does
    not.
    """
    for part in field.split("."):
        if isinstance(message, Mapping):
            message = message[part]
        elif part.lstrip("-").isdigit() and hasattr(message, "__getitem__"):
            message = message[int(part)]
        else:
            message = getattr(message, part)
    return message
