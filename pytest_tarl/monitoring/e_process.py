"""Betting against a lower bound of a mean: a test of E[x] ≥ m for observations in [0, 1] that come one by one.

The stake is multiplied by 1 + λ(m - x), which is never negative for 0 ≤ λ ≤ 1/(1 - m), and whose mean is at most 1 as
long as the mean of x, given all that went before, is at least m (Waudby-Smith & Ramdas 2023). For x of 0 and 1 this is
the likelihood ratio against a success rate of m(1 - λ(1 - m)) in place of m.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats

# λ(1 - m), what a success costs, of each of restarts.BETS bets: from mild losses to nothing but failures
SHARES = (0.01, 0.015, 0.023, 0.035, 0.053, 0.08, 0.12, 0.18, 0.27, 0.41, 0.62, 0.9)


def factors(bound: float, observed: NDArray[np.float64]) -> Floats:
    """Return what each bet's stake is multiplied by, shape (missions, bets); observations are in [0, 1]."""
    lost: Floats = (bound - observed) / (1.0 - bound)
    return 1.0 + np.array(SHARES) * lost[:, None]


def testable(bound: float) -> bool:
    """Return whether there is anything below the bound: one of 0 cannot be broken, one of 1 is no bound of a sample."""
    return 0.0 < bound < 1.0
