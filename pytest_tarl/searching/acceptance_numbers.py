"""Acceptance numbers: for each look, the largest number of failures that still shows a tolerable failure rate.

A look evaluates the test after a fixed number of missions. A single look gives the bound of Clopper and Pearson: 0
failures in 59 missions show, with 95 % confidence, a failure rate below 5 %. Several looks share the risk of accepting
wrongly. The risk of each look is exact: the distribution of the failure count is propagated from look to look, without
the counts that were already accepted.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import comb, sqrt

import numpy as np

NEVER = -1  # with this number of missions, no candidate can be accepted, not even without a failure


@lru_cache(maxsize=64)
def acceptance_numbers(looks: tuple[int, ...], tolerated: float, risk: float) -> tuple[int, ...]:
    """Return the acceptance number of each look, or `NEVER` for a look that cannot accept.

    A program that fails with probability `tolerated` or more is accepted with probability at most `risk` over all
    looks. After n of N missions, risk × √(n/N) may be spent, so early looks get more than a proportional share.
    """
    waiting = np.ones(1)  # entry k: P(k failures so far and not accepted yet) at the tolerated rate
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
    """Return the probabilities of 0 … `trials` failures, shape (trials + 1,)."""
    counts: Sequence[int] = range(trials + 1)
    return np.array([comb(trials, k) * rate**k * (1.0 - rate) ** (trials - k) for k in counts])
