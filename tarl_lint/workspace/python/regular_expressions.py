"""Regular expressions of interpreted files, unless matching them might take long.

Python's `re` has no time limit, so the number of ways in which a pattern can match is estimated first.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any, Final

from tarl_lint.workspace.python.elements import settled
from tarl_lint.workspace.python.operators import limited
from tarl_lint.workspace.python.values import OpaqueError, Stream

try:  # the parser of `re`: `re._parser` since Python 3.11, `sre_parse` before
    from re import _parser as _patterns  # type: ignore[attr-defined] # the modules have no stubs
except ImportError:
    import sre_parse as _patterns

MOST: Final = 20_000_000  # maximum number of ways to match that a search may try
LONGEST: Final = 2_000  # maximum length of a pattern (characters)
# number of positional arguments between pattern and flags
_POSITIONS: Final = {"sub": 3, "subn": 3, "split": 2}
_REPEATS: Final = frozenset({"MAX_REPEAT", "MIN_REPEAT", "POSSESSIVE_REPEAT"})


def compiled(pattern: Any, flags: Any = 0) -> re.Pattern[str]:
    """Return a compiled pattern. Raises OpaqueError if it is not constant."""
    if isinstance(pattern, re.Pattern):
        return pattern
    if not isinstance(pattern, str) or len(pattern) > LONGEST:
        raise OpaqueError("not a constant")
    try:
        return re.compile(pattern, flags)
    except (re.error, RecursionError, OverflowError) as error:
        raise OpaqueError(str(error)) from None


def of_pattern(pattern: re.Pattern[str], name: str, args: list[Any], keywords: dict[str, Any]) -> Any:
    """Return the result of a method of a pattern: a match, a list of strings, or a string.

    Raises OpaqueError if the arguments are not constant, or if the search might take long.
    """
    text = keywords.get("string", args[1] if name in ("sub", "subn") and len(args) > 1 else args[0])
    replaced = args[0] if name in ("sub", "subn") else ""
    if not isinstance(text, str) or not settled(list(keywords.values())):
        raise OpaqueError("not a constant")
    if _ways(pattern, len(text)) > MOST:
        raise OpaqueError("it might take long")
    if isinstance(replaced, str):
        limited((len(text) + 1) * (len(replaced) + replaced.count("\\") * len(text)) / 100)
    elif not callable(replaced):
        raise OpaqueError("not a constant")
    try:
        found = getattr(pattern, name)(*args, **keywords)
    except re.error as error:
        raise OpaqueError(str(error)) from None
    if isinstance(found, str):
        limited(len(found))
    return Stream(iter(list(found))) if name == "finditer" else found


def _ways(pattern: re.Pattern[str], length: int) -> float:
    """Estimate the number of ways to match a string of a given length; nested repeats give exponentially many."""
    try:
        parsed = _patterns.parse(pattern.pattern, pattern.flags)
    except RecursionError:
        raise OpaqueError("too deep") from None
    repeats, choices, nested = 1, 1, False
    for repeat, alternatives, inside in _choices(parsed, False):
        repeats += repeat
        choices *= alternatives
        nested = nested or inside
        if choices > MOST:
            return math.inf
    exponential = 2.0 ** min(length, 1_000) if nested else 1.0
    return exponential * choices * math.comb(length + repeats, min(repeats, length + repeats))


def _choices(parsed: Any, repeated: bool, depth: int = 0) -> Iterator[tuple[int, int, bool]]:
    """For each choice in a pattern, yield whether it repeats, its alternatives, and whether it is inside a repeat."""
    if depth > 50:
        raise OpaqueError("too deep")
    for kind, value in parsed:
        name = str(kind)
        inner: list[tuple[Any, bool]] = []
        if name in _REPEATS:
            low, high, part = value
            once = high == 1
            if low != high:
                yield (0, 2, repeated) if once else (1, 1, repeated)
            inner = [(part, repeated or not once)]
        elif name == "BRANCH":
            yield 0, len(value[1]), repeated
            inner = [(part, repeated) for part in value[1]]
        elif name in ("SUBPATTERN", "ASSERT", "ASSERT_NOT"):
            inner = [(value[-1], repeated)]
        elif name == "ATOMIC_GROUP":
            inner = [(value, repeated)]
        elif name == "GROUPREF_EXISTS":
            inner = [(part or (), repeated) for part in value[1:]]
        for part, inside in inner:
            yield from _choices(part, inside, depth + 1)


def _function(name: str) -> Any:
    most = _POSITIONS.get(name, 1)

    def run(pattern: Any, *args: Any, flags: Any = 0, **keywords: Any) -> Any:
        if len(args) > most:
            args, flags = args[:most], args[most]
        return of_pattern(compiled(pattern, flags), name, list(args), keywords)

    return run


def _escaped(text: Any) -> str:
    if not isinstance(text, str):
        raise OpaqueError("not a constant")
    return re.escape(text)


OF_EXPRESSIONS: Final = {
    "re.compile": compiled, "re.escape": _escaped,
    **{f"re.{name}": _function(name)
       for name in ("match", "search", "fullmatch", "findall", "finditer", "sub", "subn", "split")},
    **{f"re.{name}": getattr(re, name)
       for name in ("IGNORECASE", "I", "MULTILINE", "M", "DOTALL", "S", "VERBOSE", "X", "ASCII", "A")},
}  # fmt: skip
