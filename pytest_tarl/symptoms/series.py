"""The values of a statement in a mission, and pairs of missions with the same seed, one in each world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.instrumentation.trace import Floats

Ints = NDArray[np.int32]
TAILS = 0.02  # share of values that `scale` ignores at each end


@dataclass(frozen=True)
class Series:
    """The values of a statement with the step of each, shape (values,), and the mission's rewards, shape (steps,)."""

    values: Floats
    step: Ints
    reward: Floats

    def until(self, steps: int) -> Series:
        """Return the series of the mission's first steps."""
        early = self.step < steps
        return Series(self.values[early], self.step[early], self.reward[:steps])


@dataclass(frozen=True)
class Pair:
    """A statement's series in two missions with the same seed."""

    designed: Series
    drifted: Series

    def together(self) -> Pair:
        """Return both series, cut off at the end of the shorter mission."""
        steps = min(len(self.designed.reward), len(self.drifted.reward))
        return Pair(self.designed.until(steps), self.drifted.until(steps))


def scale(pairs: Sequence[Pair]) -> float:
    """Return the range of the designed world's values, without the `TAILS`; 0 if there are none."""
    values = np.concatenate([pair.designed.values for pair in pairs] or [np.zeros(0)])
    if not values.size:
        return 0.0
    low, high = np.quantile(values, (TAILS, 1.0 - TAILS))
    return float(high - low)
