"""Acceptance numbers: the largest number of failures with which each look of a test may accept a program.

A look evaluates the test after a fixed number of missions. With a single look, the acceptance numbers follow from the
bound of Clopper and Pearson: if none of 59 missions fails, the failure rate is below 5 % with 95 % confidence. If there
are several looks, they share the risk of accepting a bad program. The risk of each look is computed exactly: the
distribution of the number of failures is updated from look to look, and the numbers of failures that led to acceptance
are removed.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import comb, sqrt

import numpy as np

NEVER = -1  # acceptance number of a look that cannot accept any candidate, not even one without failures


@lru_cache(maxsize=64)
def acceptance_numbers(looks: tuple[int, ...], tolerated: float, risk: float) -> tuple[int, ...]:
    """Return the acceptance number of each look, or `NEVER` for a look that cannot accept any program.

    If a program fails with a probability of `tolerated` or more, all looks together accept it with a probability of at
    most `risk`. After n of N missions, risk × √(n/N) may be spent, so early looks get more than a proportional share.
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
