"""Escape untrusted text for a terminal: it must not move the cursor, set colours or reverse the writing direction."""

from __future__ import annotations

import re
from collections.abc import Iterable

# control characters, marks of writing direction (Boucher & Anderson 2021), line separators
_COMMANDS = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff]"
)
_SURROGATES = re.compile("[\ud800-\udfff]")


def printable(text: str) -> str:
    """Escape a string of one or more lines; undecodable bytes become question marks."""
    return _SURROGATES.sub("\ufffd", _COMMANDS.sub(_escaped, text.replace("\r\n", "\n")))


def printable_line(text: str) -> str:
    """Escape a string including its line breaks, so that a name cannot fake lines of output."""
    return printable(text).replace("\n", "\\n")


def print_lines(lines: Iterable[str]) -> None:
    """Print lines that contain untrusted text: code, topics, headers of patches."""
    print("\n".join(map(printable_line, lines)))


def _escaped(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"
