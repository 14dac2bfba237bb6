"""Check the syntax of message, service and action definitions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

_TYPE: Final = r"[A-Za-z]\w*(?:/[A-Za-z]\w*)?(?:<=\d+)?(?:\[(?:<=)?\d*\])?"
_FIELD: Final = re.compile(rf"{_TYPE}\s+[A-Za-z]\w*(?:\s+\S.*)?")
_CONSTANT: Final = re.compile(rf"{_TYPE}\s+[A-Za-z]\w*\s*=.*")
# ending → the number of sections, which lines of dashes separate
SECTIONS: Final = {".msg": 1, ".srv": 2, ".action": 3}


def mistakes(text: str, ending: str) -> Iterator[tuple[int, str]]:
    """Yield the line and the reason of each line that is not a definition; line 0 is the whole file."""
    sections = 1
    for number, line in enumerate(text.splitlines(), 1):
        code = line.strip()
        if code.startswith("---"):
            sections += 1
        elif not _CONSTANT.fullmatch(code):  # the text of a constant may contain #
            code = code.partition("#")[0].strip()
            if code and not _FIELD.fullmatch(code):
                yield number, f"`{code[:60]}` is neither a field nor a constant"
    wanted = SECTIONS[ending]
    if sections != wanted:
        yield 0, f"it has {sections - 1} lines of dashes in place of {wanted - 1}"
