"""Writing lines where they go: plain, or in colours on a terminal. Only then is rich imported."""

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
# What is linted must not steer the terminal: names of files, topics and code may hold anything.
_STEERING: Final = (0x061C, *range(0x200E, 0x2010), *range(0x2028, 0x202F), *range(0x2066, 0x206A), 0xFEFF)
_CONTROLS: Final = {
    **{n: f"\\x{n:02x}" for n in (*range(32), *range(127, 160)) if chr(n) not in "\n\t"},
    **{n: f"\\u{n:04x}" for n in _STEERING},  # the order of letters, ends of lines
}


def wants_colour(stream: TextIO, environment: Mapping[str, str] = os.environ) -> bool:
    """Tell whether to colour: on a terminal that can, unless NO_COLOR (https://no-color.org) is set."""
    if environment.get("NO_COLOR") or environment.get("TERM") == "dumb":
        return False
    return bool(environment.get("FORCE_COLOR")) or stream.isatty()


def glyphs_for(stream: TextIO) -> Glyphs:
    """Return the signs that the encoding of a stream can write."""
    glyphs = Glyphs()
    try:
        "".join((glyphs.bar, glyphs.data, glyphs.control, glyphs.context, glyphs.arrow, glyphs.dots)).encode(
            stream.encoding or "ascii"
        )
    except (UnicodeEncodeError, LookupError):
        return ASCII
    return glyphs


def width_of(stream: TextIO) -> int:
    """Return the columns of the terminal behind a stream, 0 where there is none."""
    if not stream.isatty():
        return 0
    import shutil

    return shutil.get_terminal_size().columns


def write(lines: Iterable[Line], stream: TextIO, *, colour: bool) -> None:
    """Write lines as they come; characters that the stream cannot encode are escaped."""
    if colour and _write_coloured(lines, stream):
        return
    encoding = stream.encoding or "utf-8"
    for line in lines:
        text = plain(line).translate(_CONTROLS) + "\n"
        stream.write(text.encode(encoding, "backslashreplace").decode(encoding))


def _write_coloured(lines: Iterable[Line], stream: TextIO) -> bool:
    """Write with rich; return False, with nothing written, where it is not installed."""
    try:
        from rich.console import Console
        from rich.text import Text
    except ImportError:
        return False
    console = Console(file=stream, force_terminal=True, highlight=False, soft_wrap=True, legacy_windows=False)
    for line in lines:
        console.print(Text.assemble(*((text.translate(_CONTROLS), _COLOURS[style]) for text, style in line)))
    return True
