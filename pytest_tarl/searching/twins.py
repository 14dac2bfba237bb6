"""Group constants that a program repeats (twins). A maintainer would change all of them.

For example, a node sets `angular_velocity = 0.1` for two turns of a path. A mission succeeds only if both turns work.
Literals are twins if they are assigned to the same name with the same value in one file. Uses of one name in one
function are twins, too, if the name's value may come from several constants (such as a parameter of a helper function).
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from functools import cache

from pytest_tarl.searching.plainness import Oddness, kind
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand

FEWEST, MOST = 2, 8  # minimum and maximum number of twins

Key = tuple[str, str, str, float]  # what twins have in common: "literal" or "name", file, name, value


def twins(apart: Sequence[Unit]) -> tuple[Unit, ...]:
    """Return one unit for each group of twins. Groups are ordered by their first constant."""
    groups: dict[Key, dict[Operand, None]] = {}
    for unit in apart:
        key = _key(unit) if unit.chart is None else None
        if key is not None:
            groups.setdefault(key, {}).update(dict.fromkeys(unit.operands))
    known = {frozenset(unit.operands) for unit in apart}
    return tuple(
        Unit(tuple(members))
        for members in groups.values()
        if FEWEST <= len({one.site for one in members}) <= MOST and frozenset(members) not in known
    )


def twin_of(unit: Unit, groups: Sequence[Unit]) -> Unit | None:
    """Return the group of twins to which a unit belongs, or None."""
    mine = {*unit.operands}
    return next((group for group in groups if mine < {*group.operands}), None)


def _key(unit: Unit) -> Key | None:
    operand = unit.operands[0]
    if isinstance(operand.value, bool) or len({one.site for one in unit.operands}) > 1:
        return None
    if operand.literal and operand.value is not None:
        name = assigned_alone(operand.site.text)
        return ("literal", operand.span.path, name, float(operand.value)) if name else None
    if kind(unit) is Oddness.VARIABLE and operand.code.isidentifier():
        place = f"{operand.site.module}.{operand.site.qualname}"
        return "name", operand.span.path, f"{place}:{operand.code}", 0.0
    return None


@cache
def assigned_alone(text: str) -> str:
    """Return the name or attribute to which a statement assigns a literal number, or "" for other statements.

    >>> assigned_alone("turn = 0.1"), assigned_alone("self.rate: float = -2"), assigned_alone("turn = 2 * x")
    ('turn', 'self.rate', '')
    """
    try:
        statement = ast.parse(text).body[0]
    except (SyntaxError, IndexError):
        return ""
    if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
        target, value = statement.targets[0], statement.value
    elif isinstance(statement, ast.AnnAssign) and statement.value is not None:
        target, value = statement.target, statement.value
    else:
        return ""
    bare = value.operand if isinstance(value, ast.UnaryOp) else value
    return ast.unparse(target) if isinstance(bare, ast.Constant) else ""
