"""Compare the margins before and after a code change.

A direction became more fragile if the guarantee now fails at a value that was shown to hold before. This verdict is
wrong with a probability of at most 1 - confidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pytest_tarl.stressing.margins import Margin, Margins

Change = Literal["more fragile", "more robust", "no significant change", "not comparable", "new", "gone"]


@dataclass(frozen=True)
class Row:
    """One direction before and after a code change; None where the direction does not exist."""

    title: str
    before: Margin | None
    after: Margin | None

    @property
    def change(self) -> Change:
        """Return the kind of change."""
        before, after = self.before, self.after
        if before is None or after is None:
            return "new" if before is None else "gone"
        if (before.nominal, before.end) != (after.nominal, after.end):
            return "not comparable"
        if _within(after.fails_at, before.holds_to, before):
            return "more fragile"
        return "more robust" if _within(before.fails_at, after.holds_to, before) else "no significant change"

    @property
    def name(self) -> str:
        """Return the name of the direction; for a range, with the end to which it changes."""
        (side,) = {one.name: one for one in (self.before, self.after) if one is not None}.values()
        return side.name if "=" in side.name else f"{side.name} to {side.end:.3g}"

    @property
    def cells(self) -> tuple[str, str]:
        """Return in words where the boundary was and is."""
        return (words(self.before) if self.before else "-", words(self.after) if self.after else "-")


def compared(before: Sequence[Margins], after: Sequence[Margins]) -> list[Row]:
    """Return a row for each direction of all tests, in the order of the files; removed directions come last."""
    old = {(one.title, side.name, side.end > side.nominal): side for one in before for side in one.sides}
    new = {(one.title, side.name, side.end > side.nominal): side for one in after for side in one.sides}
    keys = [*new, *(key for key in old if key not in new)]
    return [Row(key[0], old.get(key), new.get(key)) for key in keys]


def words(side: Margin) -> str:
    """Return in words where the boundary of a direction is."""
    if "=" in side.name:
        return (
            "fails"
            if side.fails_at is not None
            else "holds"
            if side.holds_to is not None
            else "no failure shown"
        )
    if side.fails_at is None:
        return "no failure shown" if side.holds_to is None else f"beyond {side.holds_to:.3g}"
    if side.holds_to is None:
        return f"not beyond {side.fails_at:.3g}"
    low, high = sorted((side.holds_to, side.fails_at))
    return f"{low:.3g} to {high:.3g}"


def _within(fails: float | None, holds: float | None, side: Margin) -> bool:
    return fails is not None and holds is not None and side.share(fails) <= side.share(holds)
