"""Share a fixed number of episodes among several comparisons: further episodes go to an undecided one.

The looks of every comparison are set before the first episode, with all of its α. The sum of the shares bounds its
error wherever it ends, so which comparison continues may depend on all the data, also of the other comparisons.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pytest_tarl.learning.sequential import Look, planned, spending

MOST = 1.5  # maximum number of episodes of a comparison, in even shares


@dataclass(frozen=True)
class Stage:
    """Part of a comparison: the looks set for all of it, and the number of episodes after which the part ends."""

    looks: tuple[Look, ...]
    episodes: int


@dataclass(frozen=True)
class Standing:
    """A comparison after a look: its number of episodes, its p-value for a loss, and whether it is decided."""

    episodes: int
    p_loss: float = 1.0
    decided: bool = False


def schedule(total: int, comparisons: int, looks: int) -> tuple[Look, ...]:
    """Return the looks of every comparison, whose first looks together need at most the total.

    These are the looks of a comparison that gets an even share. One more look follows after MOST times as many
    episodes, provided that every other comparison can still have its first look.
    """
    even = total // comparisons
    ends = [look.episodes for look in planned(even, looks)]
    last = int(MOST * even)
    return spending([*ends, last] if ends[0] * (comparisons - 1) + last <= total else ends)


def next_look(standing: Standing, looks: Sequence[Look]) -> Look | None:
    """Return the next look of a comparison; None if it is decided, or has had its last look."""
    if standing.decided:
        return None
    return next((look for look in looks if look.episodes > standing.episodes), None)


def chosen(standings: Sequence[Standing], looks: Sequence[Look], left: int) -> int | None:
    """Return the comparison that continues with `left` episodes to spend; None if none can reach its next look.

    It is the undecided one with the least p-value for a loss, which is nearest to a decision; the first one of equals.
    """
    able = [
        number
        for number, one in enumerate(standings)
        if (look := next_look(one, looks)) is not None and look.episodes - one.episodes <= left
    ]
    return min(able, key=lambda number: standings[number].p_loss, default=None)
