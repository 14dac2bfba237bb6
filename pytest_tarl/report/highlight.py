"""Convert Python lines and patches to highlighted HTML; pygments escapes all untrusted text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

Kind = Literal["file", "hunk", "added", "removed", "kept", "remark"]
_HUNK = re.compile(r"@@ -(\d+)(?:,(\d+))? \+(\d+)(?:,(\d+))? @@")


@dataclass(frozen=True, slots=True)
class PatchLine:
    """One line of a diff: old and new line number, and HTML."""

    kind: Kind
    old: int | None
    new: int | None
    html: str


def code_html(code: str) -> str:
    """Return Python as highlighted HTML without a surrounding element."""
    marked: str = highlight(code, PythonLexer(stripnl=False, ensurenl=False), HtmlFormatter(nowrap=True))
    return marked.removesuffix("\n")


def patch_lines(diff: str) -> Iterator[PatchLine]:
    """Yield the lines of a unified diff with their line numbers."""
    old = new = old_left = new_left = 0
    for line in diff.splitlines():
        sign, text = line[:1], line[1:]
        if old_left <= 0 and new_left <= 0:
            if hunk := _HUNK.match(line):
                old, new = int(hunk[1]), int(hunk[3])
                old_left, new_left = (int(count) if count else 1 for count in (hunk[2], hunk[4]))
            yield PatchLine("hunk" if hunk else "file", None, None, code_free(line))
        elif sign == "+":
            yield PatchLine("added", None, new, code_html(text))
            new, new_left = new + 1, new_left - 1
        elif sign == "-":
            yield PatchLine("removed", old, None, code_html(text))
            old, old_left = old + 1, old_left - 1
        elif sign == "\\":
            yield PatchLine("remark", None, None, code_free(line))
        else:
            yield PatchLine("kept", old, new, code_html(text))
            old, new, old_left, new_left = old + 1, new + 1, old_left - 1, new_left - 1


def code_free(text: str) -> str:
    """Escape a line that is not code for HTML."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
