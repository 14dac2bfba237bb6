"""Guess the effects of library methods on their objects from the names of the methods."""

from __future__ import annotations

import re
from typing import Final

CHANGES: Final = re.compile(
    r"(?:set|add)(?:_|[A-Z])|(?:correct|fit|partial_fit|observe|learn|train)$|[Aa]ccept_?[Ww]aveform"
    r"|(?:update|step|process|feed|push|advance|integrate|transition)(?:_|[A-Z]|$)|on_?[Nn]ext$"
)  # names of methods that change their object even if the result is used
TELLS: Final = re.compile(
    r"(?:send|publish|emit|log|print|write|say|speak|show|notify|call|draw|plot|display|imshow|save|dump|export|report"
    r"|get|is|has|check|assert|close|stop|shutdown|wait|sleep|spin|debug|info|warn|warning|error|broadcast|respond"
    r"|reply|render|play|exec|execute|request|destroy|unregister|unsubscribe|addn?w?str|addch|insn?w?str|insch)"
    r"(?:_|[A-Z]|$)"
)  # names of methods that only use their arguments, without storing them
REGISTERS: Final = re.compile(
    r"(?:set|add|register|connect|bind|on|subscribe|install|attach|schedule)(?:_|[A-Z]|$)"
)  # names of methods that store callables in order to call them later
OBSERVES: Final = re.compile(
    r"(?:subscribe|on|once|connect|listen|observe|add_?(?:[Ll]istener|[Oo]bserver))(?:_|[A-Z]|$)"
)  # names of methods that register callables; the callables receive the data that the object receives
DERIVES: Final = re.compile(
    r"(?:pipe|map|flat_map|select|where|share|merge|throttle|debounce|buffer)(?:_|[A-Z]|$)"
)  # names of methods that return a stream of the data that their object receives later
WHOLE: Final = re.compile(
    r"(?:model_|to_?|as_?)?(?:json|dict|yaml|xml|bytes|string|msg|message|proto|copy|tuple|dump)(?:_json|_python|s)?$"
    r"|Serialize\w*$|serialize$|encode$|pack$"
)  # names of methods that return all data of their object
FAILS: Final = re.compile(
    r"(?:loads?|parse|decode|literal_eval|fromisoformat|strptime|unpack|from_?[Ss]tring|look_?up|transform|do_transform"
    r"|convert|index|Decimal|Fraction|ip_address|UUID|inv|solve)(?:_|[A-Z]|$)|lookup"
)  # functions that raise for some arguments
# functions that read from a stream among their arguments
READS: Final = re.compile(r"_?(load|read|parse|open|deserialize|decode|from)", re.IGNORECASE)
# functions that write into a stream among their arguments, even if the result is used
WRITES: Final = re.compile(r"_?(?:write|dump|save|serialize|export|encode_?into|to_)", re.IGNORECASE)


def changes(method: str, *, dropped: bool) -> bool:
    """Return whether a method changes its object by its arguments.

    `dropped` means that the program does not use the result, so the call must have an effect.
    """
    return CHANGES.match(method) is not None or (dropped and not only_tells(method))


def only_tells(name: str) -> bool:
    """Return whether a function or method uses its arguments without storing the arguments or writing into them."""
    return TELLS.match(name) is not None


def reads(name: str) -> bool:
    """Return whether a function or method reads from a stream that it gets, and writes nothing into it."""
    return READS.match(name) is not None


def writes(name: str) -> bool:
    """Return whether a function or method writes into a stream that it gets, whatever the call returns."""
    return WRITES.match(name) is not None


def keeps_callables(name: str) -> bool:
    """Return whether a class or method stores the callables passed to it."""
    return name[:1].isupper() or REGISTERS.match(name) is not None


def observes(name: str) -> bool:
    """Return whether a method registers callables that the object calls with the data that it gets."""
    return OBSERVES.match(name) is not None


def derives(name: str) -> bool:
    """Return whether a method returns a stream of the data that its object receives later."""
    return DERIVES.match(name) is not None


def returns_all(name: str) -> bool:
    """Return whether a method, defined by a library's base class, returns all data of its object, as `json` does."""
    return WHOLE.match(name) is not None


def fails(name: str) -> str | None:
    """Return the exception that a library call raises for an unsuitable value: "" for any exception, None for none.

    Only conversions, parsers and look-ups count, because whether they fail depends on their argument.
    """
    if name in ("float", "int", "complex"):
        return "ValueError"
    return "" if FAILS.match(name) else None
