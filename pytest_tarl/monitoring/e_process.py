"""Bet against a lower bound on a mean: a sequential test of E[x] ≥ m for observations in [0, 1].

Each observation multiplies the stake by 1 + λ(m - x). For 0 ≤ λ ≤ 1/(1 - m), this factor is never negative. Its mean is
at most 1 as long as the mean of x, given all earlier observations, is at least m (Waudby-Smith & Ramdas 2023). If each
x is 0 or 1, the stake is the likelihood ratio of the success rates m(1 - λ(1 - m)) and m.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats

# λ(1 - m) for each of the BETS bets (see restarts.py): the share of its stake that a bet loses when a mission succeeds.
# Small shares detect mild losses of performance, large shares total failure.
SHARES = (0.01, 0.015, 0.023, 0.035, 0.053, 0.08, 0.12, 0.18, 0.27, 0.41, 0.62, 0.9)


def factors(bound: float, observed: NDArray[np.float64]) -> Floats:
    """Return the factor of each bet, shape (missions, bets), for observations in [0, 1], shape (missions,)."""
    lost: Floats = (bound - observed) / (1.0 - bound)
    return 1.0 + np.array(SHARES) * lost[:, None]


def testable(bound: float) -> bool:
    """Return whether a bound can be tested.

    A bound of 0 cannot be violated, and no number of episodes can show that a bound of 1 is met.
    """
    return 0.0 < bound < 1.0
