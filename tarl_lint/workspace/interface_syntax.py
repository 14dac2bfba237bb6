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
# ending → the number of sections, which lines of dashes separate
SECTIONS: Final = {".msg": 1, ".srv": 2, ".action": 3}


def mistakes(text: str, ending: str) -> Iterator[tuple[int, str]]:
    """Yield the line and the reason of each line that is not a definition; line 0 is the whole file."""
    sections = 1
    for number, line in enumerate(text.splitlines(), 1):
        code = line.strip()
        if code.startswith("---"):
            sections += 1
        elif constant := _CONSTANT.fullmatch(code):
            if not _has_value(*constant.groups()):
                yield number, f"`{code[:60]}` is a constant without a value of its type"
        else:
            code = code.partition("#")[0].strip()
            if code and not _FIELD.fullmatch(code):
                yield number, f"`{code[:60]}` is neither a field nor a constant"
    wanted = SECTIONS[ending]
    if sections != wanted:
        yield 0, f"it has {sections - 1} lines of dashes in place of {wanted - 1}"


def _has_value(kind: str, text: str) -> bool:
    """Return whether the text is a value of the type; the text of a string may be empty and contain #."""
    if kind.partition("<=")[0] in ("string", "wstring"):
        return True
    value = text.partition("#")[0].strip()
    if kind == "bool":
        return bool(value)
    try:
        if _WHOLE.fullmatch(kind):
            int(value, 0 if value[:2].lower() in ("0x", "0b", "0o") else 10)
        elif kind in _REAL:
            float(value)
        else:
            return False  # only primitive types have constants
    except ValueError:
        return False
    return True
