"""Choose values on a ray at which fresh episodes can show that the guarantee holds or fails.

The choice uses an approximate model of the search's episodes. A poor choice makes the reported interval wider, but not
wrong.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import comb, sqrt

import numpy as np

from pytest_tarl.learning.tables import Floats
from pytest_tarl.stressing.guarantee import Evidence

HOPE = 0.8  # a value is chosen only if its test is expected to succeed with at least this probability
# standard errors by which a loss must be below the tolerated loss, so that a bound with 4 % risk confirms this in 4 of
# 5 cases
HOLDING = 3.0
# standard errors by which a loss must exceed the tolerated loss, so that a bound with 0.4 % risk confirms this in 4 of
# 5 cases
FAILING = 4.0
# candidate positions on a ray for the next test
PLACES = tuple(step / 100 for step in range(1, 101))
CENTRES = np.linspace(0.0, 1.25, 251)  # candidate values of t at which half of the episodes fail
SCALES = np.geomspace(0.002, 0.3, 16)  # candidate scales of the logistic distribution, in units of t


@dataclass(frozen=True)
class Model:
    """A model of the episodes along a ray.

    Each episode has its own threshold: it fails if t exceeds the threshold. Thresholds follow a logistic distribution,
    with a uniform prior over CENTRES and SCALES. The mean loss of reward is interpolated linearly between the measured
    values of t. Its standard deviation at t is the one measured at the next larger t.
    """

    evidence: Mapping[float, Evidence]
    tolerance: float

    def holding(self, episodes: int, paired: int) -> float:
        """Return the farthest t whose test is expected to show that the guarantee holds, or 0.

        The test shows this if all `episodes` pass, and the bound on the loss from `paired` episodes is at most the
        tolerated loss.
        """

        def beyond(t: float) -> bool:
            return (
                self._passing(t, episodes, episodes) < HOPE or self._loss(t, HOLDING, paired) > self.tolerance
            )

        at = bisect_left(PLACES, True, key=beyond)
        return PLACES[at - 1] if at else 0.0

    def failing(self, episodes: int, passed: int) -> float | None:
        """Return the nearest t whose test is expected to show a failure, or None.

        The test shows a failure if at most `passed` of `episodes` pass, or if the loss is clearly larger than
        tolerated.
        """
        few = bisect_left(PLACES, HOPE, key=lambda t: 1.0 - self._passing(t, episodes, passed + 1))
        lost = (t for t in PLACES[:few] if self._loss(t, -FAILING, episodes) > self.tolerance)
        return next(lost, PLACES[few] if few < len(PLACES) else None)

    def _passing(self, t: float, episodes: int, least: int) -> float:
        """Return the expected probability that at least `least` episodes pass at t."""
        exponent = (t - CENTRES[:, None]) / SCALES
        passes, fails = -np.logaddexp(0.0, exponent), -np.logaddexp(0.0, -exponent)
        chance = sum(
            comb(episodes, failed) * np.exp((episodes - failed) * passes + failed * fails)
            for failed in range(episodes - least + 1)
        )
        return float((self._weights * chance).sum())

    def _loss(self, t: float, errors: float, episodes: int) -> float:
        """Return the expected loss at t plus `errors` times its standard error.

        The standard error includes the uncertainty of the search's episodes and of `episodes` fresh ones.
        """
        ts = sorted(self.evidence)
        every = [self.evidence[one] for one in ts]
        loss = np.maximum.accumulate([0.0, *(one.loss for one in every)])
        there = every[min(int(np.searchsorted(ts, t)), len(ts) - 1)]
        return float(
            np.interp(t, [0.0, *ts], loss)
            + errors * there.spread * sqrt(1.0 / there.episodes + 1.0 / episodes)
        )

    @cached_property
    def _weights(self) -> Floats:
        """Return the posterior probability of each combination of centre and scale, shape (centres, scales)."""
        ts = np.array(sorted(self.evidence))
        passed = np.array([self.evidence[t].passed for t in ts])
        failed = np.array([self.evidence[t].episodes for t in ts]) - passed
        exponent = (ts[:, None, None] - CENTRES[:, None]) / SCALES
        found = -np.tensordot(passed, np.logaddexp(0.0, exponent), 1)
        found -= np.tensordot(failed, np.logaddexp(0.0, -exponent), 1)
        weights = np.exp(found - found.max())
        shares: Floats = weights / weights.sum()
        return shares
