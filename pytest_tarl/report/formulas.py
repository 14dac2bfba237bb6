"""Report formulas: their robustness in each world, and the first violation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pytest_tarl.formulas.judging import NEGLIGIBLE
from pytest_tarl.model import Comparison, FormulaRow, FormulaWorld
from pytest_tarl.report import amounts

WORLDS = {
    "offline": "designed",
    "online": "deployed",
    "repaired": "repaired",
    "nominal_repaired": "designed world repaired",
}


def lines(comparison: Comparison) -> Iterator[str]:
    """Yield one line per formula for the terminal; violated formulas come first."""
    for row in sorted(comparison.formulas, key=lambda one: not violated(one)):
        yield f"{row.formula}: {', '.join(_worlds(row)) or 'never judged'}"


def violated(row: FormulaRow) -> bool:
    """Return whether any deployed episode violates the formula."""
    world = row.worlds.get("online")
    return world is not None and world.violated > 0


def page_rows(comparison: Comparison) -> list[dict[str, Any]]:
    """Return the rows of the formula table on the report page."""
    return [
        {
            "formula": row.formula,
            "worlds": {name: row.worlds.get(name) for name in WORLDS},
            "first": row.worlds["online"].first if "online" in row.worlds else None,
        }
        for row in comparison.formulas
    ]


def margin(value: float) -> str:
    """Format a robustness; infinitesimal values (from strict comparisons) are shown as 0."""
    return amounts.amount(0.0 if abs(value) < NEGLIGIBLE else value)


def _worlds(row: FormulaRow) -> Iterator[str]:
    for name, label in WORLDS.items():
        world = row.worlds.get(name)
        if world is not None:
            yield f"{label} {margin(world.robustness)}{_broken(world)}"


def _broken(world: FormulaWorld) -> str:
    if world.first is None:
        return ""
    return f" (violated in {world.violated} of {world.episodes}, first at {world.first:g} s)"
