"""Text of others on a terminal: what would move the cursor, change colours or turn the writing is shown, not done."""

from __future__ import annotations

import re

# Control characters, the marks that change the direction of writing (Boucher & Anderson 2021), separators of lines.
_COMMANDS = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff]"
)
_SURROGATES = re.compile("[\ud800-\udfff]")


def printable(text: str) -> str:
    """Return a text of one or more lines that a terminal only shows; bytes that are no text become question marks."""
    return _SURROGATES.sub("\ufffd", _COMMANDS.sub(_escaped, text.replace("\r\n", "\n")))


def printable_line(text: str) -> str:
    """Return a text as one line: a name must not begin lines of its own."""
    return printable(text).replace("\n", "\\n")


def _escaped(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"
