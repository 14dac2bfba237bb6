"""Compute binomial probabilities by exact sums."""

from __future__ import annotations

from math import exp, log, log1p

import numpy as np

from pytest_tarl.learning.tables import Floats


class BinomialTail:
    """The function p ↦ P(Bin(n, p) ≤ k), computed as an exact sum."""

    def __init__(self, k: int, n: int) -> None:
        self._reached = np.arange(k + 1)
        self._rest = n - self._reached
        self._ways = log_choose(n)[: k + 1]

    def __call__(self, p: float) -> float:
        """Return the probability for this p."""
        if p <= 0.0 or not self._reached.size:
            return 1.0 if self._reached.size else 0.0
        if p >= 1.0:
            return 1.0 if self._rest[-1] <= 0 else 0.0
        terms = self._ways + self._reached * log(p) + self._rest * log1p(-p)
        largest = float(terms.max())
        return min(1.0, exp(largest) * float(np.exp(terms - largest).sum()))


def probabilities(n: int, p: float) -> Floats:
    """Return the probabilities of 0 to n successes, shape (n + 1,)."""
    reached = np.arange(n + 1)
    found: Floats = np.exp(log_choose(n) + reached * log(p) + (n - reached) * log1p(-p))
    return found


def log_choose(n: int) -> Floats:
    """Return log C(n, k) for k from 0 to n, shape (n + 1,)."""
    k = np.arange(1, n + 1)
    return np.append(0.0, np.cumsum(np.log((n - k + 1) / k)))
