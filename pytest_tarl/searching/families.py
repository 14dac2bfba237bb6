"""Group constants that describe the same quantity for several axes, sides or joints.

For example, a drone has one stiffness for each axis. If the wind blows in all directions, it does not help to change
the stiffness of one axis only. Constants form a family if their values are similar and if one of two things is true:
they are entries of one table (`STIFFNESS["x"]`, `GAINS[1]`), or their names differ only in a word such as `left` or
`x`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from pytest_tarl.searching.plainness import Oddness, kind
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand

SIMILAR = 4.0  # maximum ratio of two values in a family
FEWEST, MOST = 2, 8  # minimum and maximum number of constants in a family
PLACES = frozenset(
    (
        *("x", "y", "z", "roll", "pitch", "yaw"),
        *("left", "right", "l", "r", "front", "rear", "back", "fl", "fr", "rl", "rr", "bl", "br"),
        *("upper", "lower", "top", "bottom", "first", "second", "third"),
        *map(str, range(9)),
    )
)
_ENTRY = re.compile(r"""\[\s*(?:-?\d+|"[^"\]]*"|'[^'\]]*')\s*\]$""")


def families(apart: Sequence[Unit]) -> tuple[Unit, ...]:
    """Return one unit for each family of named constants. Families are ordered by their first constant."""
    groups: dict[tuple[str, str], list[Operand]] = {}
    for unit in apart:
        if unit.chart is None and kind(unit) is Oddness.NAMED:
            for operand in unit.operands:
                groups.setdefault((operand.span.path, shared_name(operand.code)), []).append(operand)
    return tuple(Unit(tuple(members)) for (_, name), members in groups.items() if name and _alike(members))


def shared_name(code: str) -> str:
    """Replace the word that differs within a family by `*`; return "" if there is no such word.

    >>> shared_name('STIFFNESS["x"]'), shared_name("self.kp_left"), shared_name("LEFT_KP"), shared_name("self.kp")
    ('STIFFNESS[*]', 'self.kp_*', '*_kp', '')
    """
    if _ENTRY.search(code):
        return _ENTRY.sub("[*]", code)
    owner, dot, name = code.rpartition(".")
    words = name.lower().split("_")
    placed = ["*" if word in PLACES else word for word in words]
    if placed == words or all(word == "*" for word in placed):
        return ""
    return f"{owner}{dot}{'_'.join(placed)}"


def _alike(members: Sequence[Operand]) -> bool:
    """Return whether there are several constants with similar values of the same sign."""
    values = [one.value for one in members]
    if any(value is None or isinstance(value, bool) or value == 0 for value in values):
        return False
    known = [float(value) for value in values if value is not None]
    sizes = [abs(value) for value in known]
    same_sign = all((value > 0) == (known[0] > 0) for value in known)
    several = FEWEST <= len({one.definition for one in members}) <= MOST
    return several and same_sign and max(sizes) <= SIMILAR * min(sizes)
