"""Write lines to a stream: plain, or coloured on a terminal. rich is imported only for colours."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Final, TextIO

from tarl_lint.report.line import ASCII, Glyphs, Line, Style, plain

_COLOURS: Final[Mapping[Style, str]] = {
    "": "",
    "place": "bold",
    "strong": "bold",
    "explicit": "bold red",
    "implicit": "bold yellow",
    "hazard": "bold magenta",
    "error": "bold red",
    "data": "red",
    "control": "yellow",
    "quiet": "bright_black",
}
# Text from linted files must not control the terminal: names of files, topics and code may contain anything.
_STEERING: Final = (0x061C, *range(0x200E, 0x2010), *range(0x2028, 0x202F), *range(0x2066, 0x206A), 0xFEFF)
_CONTROLS: Final = {
    **{n: f"\\x{n:02x}" for n in (*range(32), *range(127, 160)) if chr(n) not in "\n\t"},
    **{n: f"\\u{n:04x}" for n in _STEERING},  # direction marks and line separators
}


def harmless(text: str) -> str:
    """Return a string with control characters and direction marks escaped, for a terminal."""
    return text.translate(_CONTROLS)


def wants_colour(stream: TextIO, environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether to use colours: on a capable terminal without NO_COLOR (https://no-color.org)."""
    if environment.get("NO_COLOR") or environment.get("TERM") == "dumb":
        return False
    return bool(environment.get("FORCE_COLOR")) or stream.isatty()


def glyphs_for(stream: TextIO) -> Glyphs:
    """Return the signs that the encoding of a stream supports."""
    glyphs = Glyphs()
    try:
        "".join((glyphs.bar, glyphs.data, glyphs.control, glyphs.context, glyphs.arrow, glyphs.dots)).encode(
            stream.encoding or "ascii"
        )
    except (UnicodeEncodeError, LookupError):
        return ASCII
    return glyphs


def width_of(stream: TextIO) -> int:
    """Return the width of the terminal behind a stream, 0 if there is none."""
    if not stream.isatty():
        return 0
    import shutil

    return shutil.get_terminal_size().columns


def write(lines: Iterable[Line], stream: TextIO, *, colour: bool) -> None:
    """Write lines as they are yielded; escape characters that the stream cannot encode."""
    if colour and _write_coloured(lines, stream):
        return
    encoding = stream.encoding or "utf-8"
    for line in lines:
        text = harmless(plain(line)) + "\n"
        stream.write(text.encode(encoding, "backslashreplace").decode(encoding))


def _write_coloured(lines: Iterable[Line], stream: TextIO) -> bool:
    """Write with rich; return False, without output, if it is not installed."""
    try:
        from rich.console import Console
        from rich.text import Text
    except ImportError:
        return False
    console = Console(file=stream, force_terminal=True, highlight=False, soft_wrap=True, legacy_windows=False)
    for line in lines:
        console.print(Text.assemble(*((harmless(text), _COLOURS[style]) for text, style in line)))
    return True
