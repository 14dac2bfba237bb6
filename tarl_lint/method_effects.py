"""What a method of a library's object does to the object, told by its name: no more is known of it."""

from __future__ import annotations

import re
from typing import Final

CHANGES: Final = re.compile(
    r"(?:set|add)(?:_|[A-Z])|(?:correct|fit|partial_fit|observe|learn|train)$|[Aa]ccept_?[Ww]aveform"
    r"|(?:update|step|process|feed|push|advance|integrate|transition)(?:_|[A-Z]|$)"
)  # also where the result is used
TELLS: Final = re.compile(
    r"(?:send|publish|emit|log|print|write|say|speak|show|notify|call|draw|plot|display|imshow|save|dump|export|report"
    r"|get|is|has|check|assert|close|stop|shutdown|wait|sleep|spin|debug|info|warn|warning|error|broadcast|respond"
    r"|reply|render|play|exec|execute|request)(?:_|[A-Z]|$)"
)  # does something with what it is given, and keeps nothing of it
REGISTERS: Final = re.compile(
    r"(?:set|add|register|connect|bind|on|subscribe|install|attach|schedule)(?:_|[A-Z]|$)"
)  # keeps the callables that it is given, to call them later
FAILS: Final = re.compile(
    r"(?:loads?|parse|decode|literal_eval|fromisoformat|strptime|unpack|from_?[Ss]tring|look_?up|transform|do_transform"
    r"|convert|index|Decimal|Fraction|ip_address|UUID|inv|solve)(?:_|[A-Z]|$)|lookup"
)  # raises when it cannot do with what it is given


def changes(method: str, *, dropped: bool) -> bool:
    """Tell whether a method changes its object by what it is given.

    `dropped`: the result is not used, so the call is there for what it does.
    """
    return CHANGES.match(method) is not None or (dropped and TELLS.match(method) is None)


def keeps_callables(name: str) -> bool:
    """Tell whether a class or method keeps the callables that it is given, for later."""
    return name[:1].isupper() or REGISTERS.match(name) is not None


def fails(name: str) -> str | None:
    """Return what a call of a library raises when it cannot do with a value: "" for anything, None for nothing.

    Conversions, parsers and look-ups fail by the value that they are given; of other calls that is not meant.
    """
    if name in ("float", "int", "complex"):
        return "ValueError"
    return "" if FAILS.match(name) else None
