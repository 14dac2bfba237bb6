"""Indented JSON, identical to that of `json.dumps(value, indent=1)` but written several times as fast.

Python's own encoder uses generators if it has to indent. On large reports, this took longer than the analysis.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

_quoted = json.encoder.encode_basestring_ascii


@dataclass(frozen=True, slots=True)
class Written:
    """JSON that is already serialised for its nesting level."""

    text: str


def dumped(value: object, level: int = 0) -> str:
    """Return a value as JSON at a nesting level; its containers are lists and dictionaries with string keys."""
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Written):
        return value.text
    if isinstance(value, dict):
        return _wrapped("{}", [f"{_quoted(key)}: {dumped(v, level + 1)}" for key, v in value.items()], level)
    if isinstance(value, (list, tuple)):
        return _wrapped("[]", [dumped(item, level + 1) for item in value], level)
    if type(value) is int:
        return str(value)
    return json.dumps(value)


def _wrapped(brackets: str, parts: list[str], level: int) -> str:
    if not parts:
        return brackets
    inner = "\n" + " " * (level + 1)
    return f"{brackets[0]}{inner}{f',{inner}'.join(parts)}\n{' ' * level}{brackets[1]}"
