"""Fields of messages, named by dotted paths such as `pose.pose.position.x` and `ranges.0`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

_INDEX = re.compile(r"\[\s*(-?\d+)\s*\]")


def dotted(field: str) -> str:
    """Return a field with indices as in Python, such as `ranges[0]` or `poses[-1].x`, as a dotted path."""
    return _INDEX.sub(r".\1", field).removeprefix(".")


def field_value(message: Any, field: str) -> Any:
    """Follow a dotted path; a number indexes a sequence (`ranges.0`).

    Raise AttributeError or IndexError if the message has no such field or element, and KeyError if a mapping has none.
    """
    for part in field.split("."):
        if isinstance(message, Mapping):
            message = message[part]
        elif part.lstrip("-").isdigit() and hasattr(message, "__getitem__"):
            message = message[int(part)]
        else:
            message = getattr(message, part)
    return message
