"""Parts of topic names that only the launch determines: marks in a text that stand for parameters and node names."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

MARK: Final = "\0"
DEFAULT: Final = "\0default"  # the value of a parameter that is not set
ARGUMENTS: Final = "\0argv"  # among the values of parameters: the program's command line, a tuple of texts
_MARKED: Final = re.compile(f"{MARK}(\\d+){MARK}")


@dataclass(frozen=True, slots=True)
class ParameterName:
    """A parameter by its name in the code, and its default: None if that is not one known text.

    Other kinds are the node's name, its namespace, and a name after resolving and remapping.
    """

    name: str
    default: str | None = None
    kind: Literal["parameter", "node", "namespace", "resolved"] = "parameter"


def substituted(text: str, value: Callable[[int], str | None]) -> str | None:
    """Return a text with each mark replaced by the value of the parameter; None if one has no value."""
    found = {number: value(int(number)) for number in _MARKED.findall(text)}
    if None in found.values():
        return None
    return _MARKED.sub(lambda match: found[match[1]] or "", text)
