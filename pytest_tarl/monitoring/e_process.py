"""Bet against a lower bound on a mean: a sequential test of E[x] ≥ m for observations in [0, 1].

The stake is multiplied by 1 + λ(m - x), which is never negative for 0 ≤ λ ≤ 1/(1 - m), and whose mean is at most 1 as
long as the mean of x, given all earlier observations, is at least m (Waudby-Smith & Ramdas 2023). For x of 0 and 1,
it is the likelihood ratio of a success rate of m(1 - λ(1 - m)) against m.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats

# λ(1 - m), the share of the stake lost by a success, for each of restarts.BETS bets: mild losses to total failure
SHARES = (0.01, 0.015, 0.023, 0.035, 0.053, 0.08, 0.12, 0.18, 0.27, 0.41, 0.62, 0.9)


def factors(bound: float, observed: NDArray[np.float64]) -> Floats:
    """Return the factor on each bet's stake, shape (missions, bets); observations are in [0, 1], shape (missions,)."""
    lost: Floats = (bound - observed) / (1.0 - bound)
    return 1.0 + np.array(SHARES) * lost[:, None]


def testable(bound: float) -> bool:
    """Return whether a bound can be tested: 0 cannot be violated, and a sample cannot support 1."""
    return 0.0 < bound < 1.0
