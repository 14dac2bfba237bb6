"""Random search as a plug-in of `--tarl-search`, so that its candidates face the same acceptance test as ours."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from pytest_tarl.searching.ask_tell import Constant

MOVED = 0.5  # share of the constants that each proposal changes
REACH = math.log(10.0)  # maximum absolute logarithm of a factor


class Random:
    """Random search: half of the constants keep their values; the factors of the others are between 0.1 and 10."""

    def __init__(self, constants: Sequence[Constant], seed: int) -> None:
        self.constants = constants
        self.draws = random.Random(seed)

    def ask(self) -> list[float]:
        """Return the next factors; a negative factor flips a boolean."""
        return [self._factor(isinstance(constant.value, bool)) for constant in self.constants]

    def tell(self, factors: Sequence[float], gain: float) -> None:
        """Learn nothing."""

    def _factor(self, boolean: bool) -> float:
        if self.draws.random() >= MOVED:
            return 1.0
        return -1.0 if boolean else math.exp(self.draws.uniform(-REACH, REACH))
