"""Parameters in the names of topics: marks in a text that stand for values which only the launch determines."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

MARK: Final = "\0"
_MARKED: Final = re.compile(f"{MARK}(\\d+){MARK}")


@dataclass(frozen=True, slots=True)
class ParameterName:
    """A parameter by its name in the code, and its default: None if that is not one known text."""

    name: str
    default: str | None


def substituted(text: str, value: Callable[[int], str | None]) -> str | None:
    """Return a text with each mark replaced by the value of the parameter; None if one has no value."""
    found = {number: value(int(number)) for number in _MARKED.findall(text)}
    if None in found.values():
        return None
    return _MARKED.sub(lambda match: found[match[1]] or "", text)
