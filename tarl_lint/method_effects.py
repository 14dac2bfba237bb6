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


def changes(method: str, *, dropped: bool) -> bool:
    """Tell whether a method changes its object by what it is given.

    `dropped`: the result is not used, so the call is there for what it does.
    """
    return CHANGES.match(method) is not None or (dropped and TELLS.match(method) is None)


def keeps_callables(name: str) -> bool:
    """Tell whether a class or method keeps the callables that it is given, for later."""
    return name[:1].isupper() or REGISTERS.match(name) is not None
