"""The bounds that a recording states: minimum success rate and minimum mean reward."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.bounds import rate
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.guarantees import CONFIDENCE
from pytest_tarl.learning.tables import Floats
from pytest_tarl.model import Bound as Rate


@dataclass(frozen=True)
class Bound:
    """A lower bound on the mean of a quantity within [low, high].

    `what` is "success" or "total". `confidence` is the share of repeated recordings whose bound holds.
    """

    what: str
    least: float
    confidence: float
    low: float = 0.0
    high: float = 1.0

    def share(self, value: NDArray[np.float64] | float) -> Floats:
        """Scale values from [low, high] to [0, 1], clipped; keep the shape."""
        return np.clip((np.asarray(value) - self.low) / (self.high - self.low), 0.0, 1.0)


def bounds(fixture: Fixture) -> tuple[Bound, ...]:
    """Return the bounds of a recording: on success and, if the marker declared a range, on the mean total.

    If all episodes are equal, there are no bounds, because equal episodes do not show how much episodes vary.
    Recordings of older versions state no bounds; for these, the bound on success is computed from the episodes.
    """
    told = fixture.stated
    if told is None:
        passed = fixture.sample.passed
        return (_success(rate(int(passed.sum()), len(passed), CONFIDENCE)),)
    if not told.varied:
        return ()
    if told.declared is None:
        return (_success(told.success),)
    low, high = told.declared
    return _success(told.success), Bound("total", told.mean.low, told.mean.confidence, low, high)


def _success(found: Rate) -> Bound:
    return Bound("success", found.low, found.confidence)
