"""Acceptance numbers: how many failures at most show that missions fail seldom enough, look after look.

One look at n missions with c failures is the bound of Clopper and Pearson: 0 of 59 shows 5 % at 95 %. Several looks
share the risk; what a look spends is computed exactly, over the paths of the count that no earlier look ended.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import comb, sqrt

import numpy as np

NEVER = -1  # no number of failures suffices at this look


@lru_cache(maxsize=64)
def acceptance_numbers(looks: tuple[int, ...], tolerated: float, risk: float) -> tuple[int, ...]:
    """Return the acceptance number of each look, `NEVER` where there is none.

    A program that fails with probability `tolerated` or more is accepted with probability `risk` at most, over all
    looks. By look n of N, risk × √(n/N) may be spent: early looks get a larger share than they have episodes.
    """
    waiting = np.ones(1)  # P(so many failures, not accepted until now), at the tolerated rate
    spent, seen = 0.0, 0
    numbers: list[int] = []
    for look in looks:
        waiting = np.convolve(waiting, _binomial(look - seen, tolerated))
        seen = look
        passed = np.cumsum(waiting)
        number = int(np.searchsorted(passed, risk * sqrt(look / looks[-1]) - spent, side="right")) - 1
        if number > NEVER:
            spent += float(passed[number])
            waiting[: number + 1] = 0.0
        numbers.append(number)
    return tuple(numbers)


def _binomial(trials: int, rate: float) -> np.ndarray:
    """Return the probabilities of 0 … `trials` failures."""
    counts: Sequence[int] = range(trials + 1)
    return np.array([comb(trials, k) * rate**k * (1.0 - rate) ** (trials - k) for k in counts])
