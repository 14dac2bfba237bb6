"""Check the syntax of message, service and action definitions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

_TYPE: Final = r"[A-Za-z]\w*(?:/[A-Za-z]\w*)?(?:<=\d+)?(?:\[(?:<=)?\d*\])?"
_FIELD: Final = re.compile(rf"{_TYPE}\s+[A-Za-z]\w*(?:\s+\S.*)?")
_CONSTANT: Final = re.compile(rf"({_TYPE})\s+[A-Za-z]\w*\s*=(.*)")
_WHOLE: Final = re.compile(r"u?int(?:8|16|32|64)|byte|char")
_REAL: Final = frozenset({"float32", "float64"})
_TEXT: Final = frozenset({"string", "wstring"})
# file ending → number of sections; lines of dashes separate the sections
SECTIONS: Final = {".msg": 1, ".srv": 2, ".action": 3}


def mistakes(text: str, ending: str) -> Iterator[tuple[int, str]]:
    """Yield line and reason of each invalid line; line 0 is the file."""
    sections = 1
    for number, line in enumerate(text.splitlines(), 1):
        code = line.strip()
        if code.startswith("---"):
            sections += 1
        elif found := _CONSTANT.fullmatch(code):
            if not _has_value(*found.groups()):
                yield number, f"`{code[:60]}` is a constant without a value of its type"
        else:
            code = code.partition("#")[0].strip()
            if code and not _FIELD.fullmatch(code):
                yield number, f"`{code[:60]}` is neither a field nor a constant"
    wanted = SECTIONS[ending]
    if sections != wanted:
        yield 0, f"it has {sections - 1} lines of dashes in place of {wanted - 1}"


def _has_value(kind: str, text: str) -> bool:
    """Return whether the text is a value of the type; only the value of a string may contain #."""
    try:
        constant(kind, text.partition("#")[0].strip())
    except ValueError:
        return False
    return True


def constant(kind: str, text: str) -> str | bool | float:
    """Return the value of a constant or default, such as 31 for `uint8` and `0x1F`.

    Raises:
        ValueError: The text is not a value of the type, or the type is not primitive.
    """
    if kind.partition("<=")[0] in _TEXT:
        return text.strip("'\"")
    if kind in _REAL:
        return float(text)
    if kind == "bool" and text:
        return text.lower() in ("true", "1")
    if not _WHOLE.fullmatch(kind):
        raise ValueError(f"no constant of type {kind}")
    try:
        return int(text)  # ROS allows leading zeros, which base 0 refuses
    except ValueError:
        return int(text, 0)
