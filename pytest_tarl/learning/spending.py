"""Divide a fixed number of episodes among several comparisons; spare episodes go to undecided ones.

The looks of every comparison are planned before the first episode and together spend its whole α. This bounds the
comparison's error, whichever look is its last. All data, including those of other comparisons, may therefore be used to
choose the comparison that continues.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pytest_tarl.learning.sequential import Look, planned, spending

MOST = 1.5  # maximum number of episodes of a comparison, in even shares of the total


@dataclass(frozen=True)
class Stage:
    """A part of a comparison: its planned looks, and the number of episodes at which it ends."""

    looks: tuple[Look, ...]
    episodes: int


@dataclass(frozen=True)
class Standing:
    """The state of a comparison after a look: its number of episodes, and whether it is decided.

    `p_worse` is the smaller of the p-values for a loss and for more failures.
    """

    episodes: int
    p_worse: float = 1.0
    decided: bool = False


def schedule(total: int, comparisons: int, looks: int) -> tuple[Look, ...]:
    """Return the looks of each comparison; all comparisons can have their first looks within `total` episodes.

    Each comparison gets the looks that fit into an even share of the episodes, plus one more look at MOST times that
    share. This last look is planned only if every other comparison can still reach its first one.
    """
    even = total // comparisons
    ends = [look.episodes for look in planned(even, looks)]
    last = int(MOST * even)
    return spending([*ends, last] if ends[0] * (comparisons - 1) + last <= total else ends)


def next_look(standing: Standing, looks: Sequence[Look]) -> Look | None:
    """Return the next look of a comparison, or None if it is decided or has had its last look."""
    if standing.decided:
        return None
    return next((look for look in looks if look.episodes > standing.episodes), None)


def chosen(standings: Sequence[Standing], looks: Sequence[Look], left: int) -> int | None:
    """Return the index of the comparison that continues, or None if none can reach its next look.

    `left` is the number of remaining episodes. The undecided comparison with the smallest p-value continues, because it
    is closest to a decision; if several have the same p-value, the first one continues.
    """
    able = [
        number
        for number, one in enumerate(standings)
        if (look := next_look(one, looks)) is not None and look.episodes - one.episodes <= left
    ]
    return min(able, key=lambda number: standings[number].p_worse, default=None)
