"""Parse and check formulas, with a one-sentence message for each mistake."""

from __future__ import annotations

import difflib
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.util import find_spec
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.extras import install_command
from pytest_tarl.formulas.said import NOTHING_SAID, Said

NEWEST = (3, 12)  # newest Python version that can import rtamt's parser
EXAMPLE = 'such as "always (gap > 0.3)"'


@dataclass(frozen=True)
class Formula:
    """A parsed formula with its signals."""

    text: str
    signals: tuple[str, ...]
    tree: Any = field(compare=False, repr=False)


def formula(where: str, text: Any, names: Sequence[str], said: Said = NOTHING_SAID) -> Formula:
    """Parse a formula over these signals. Raise SettingsError, whose message begins with `where`.

    `said` has the names that the test's source observes; if a name is unknown, the message suggests one of them.
    """
    if not isinstance(text, str) or not text.strip():
        raise SettingsError(f"{where}: a formula is a string {EXAMPLE}, got {text!r}.")
    require_rtamt(where)
    from pytest_tarl.formulas.grammar import ReadingError

    try:
        return _formula(" ".join(text.split()), tuple(names))
    except ReadingError as problem:
        raise SettingsError(f"{where}: the formula {text!r} cannot be used: {problem}.") from None
    except _UnknownError as problem:
        unknown = _unknown(problem.name, names, said)
        raise SettingsError(f"{where}: the formula {text!r} names {unknown}") from None


def require_rtamt(where: str) -> None:
    """Raise SettingsError if rtamt is missing or does not support this Python version."""
    if sys.version_info[:2] > NEWEST:
        raise SettingsError(
            f"{where}: formulas need rtamt, which runs on Python 3.10 to 3.12; this is Python "
            f"{sys.version_info[0]}.{sys.version_info[1]}: run these tests on one of these versions, or "
            "use tarl.reward and assert in place of formulas."
        )
    if find_spec("rtamt") is None:
        raise SettingsError(
            f"{where}: formulas need rtamt, which is not installed: run {install_command('stl')}."
        )


class _UnknownError(Exception):
    """A formula names an unknown signal."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


@lru_cache(maxsize=256)
def _formula(text: str, names: tuple[str, ...]) -> Formula:
    from pytest_tarl.formulas import grammar
    from pytest_tarl.formulas.reach import unjudged

    plain = re.sub(r"!=(?!=)", "!==", text)  # accept Python's != for rtamt's !==
    used, others = grammar.words(plain)
    reserved = next((name for name in names if name in others), None)
    if reserved is not None:
        raise grammar.ReadingError(
            f"{reserved} is a keyword of the formula language, so it cannot be a signal name"
        )
    unknown = next((name for name in used if name not in names), None)
    if unknown is not None:
        raise _UnknownError(unknown)
    tree = grammar.tree(plain, names)
    problem = unjudged(tree)
    if problem:
        raise grammar.ReadingError(problem)
    return Formula(text, grammar.signals(tree), tree)


def _unknown(name: str, names: Sequence[str], said: Said) -> str:
    from pytest_tarl.formulas.grammar import WORDS

    if "/" in name and name.partition("/")[0] in names:
        return f"{name!r}, which is not a signal; write a division with spaces, {name.replace('/', ' / ')}."
    known = [*dict.fromkeys((*names, *said.observed))]
    close = difflib.get_close_matches(name, [*known, *WORDS], 1)
    told = ", ".join(known) or "there is none"
    if close:
        return f"{name!r}, which is not a signal; did you mean {close[0]!r}? The signals are: {told}."
    first = name.partition(".")[0]
    if said.computed:
        return (
            f"{name!r}, which is not a signal ({told}): the test computes the names that it passes to "
            "tarl.observe, so TARL cannot read them from its source; declare this one in the marker, "
            f"signals=[{first!r}]."
        )
    return (
        f"{name!r}, which is not a signal ({told}): it is not a sensor, and no tarl.observe in the test's modules "
        f"sets it. Set it with tarl.observe({first}=…), or read it from a message, signals=[Signal({first!r}, "
        f"topic=…, field=…)]; if another module observes it, declare it, signals=[{first!r}]."
    )
