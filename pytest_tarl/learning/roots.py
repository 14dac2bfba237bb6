"""Find the largest value that refutes a hypothesis, by bisection."""

from __future__ import annotations

from collections.abc import Callable

HALVINGS = 60  # bisection steps; enough for the precision of a float


def root(refuted: Callable[[float], bool], low: float, high: float, halvings: int = HALVINGS) -> float:
    """Return the largest refuted value between `low` and `high`, or `low` if none is.

    All values below a refuted one must also be refuted.
    """
    for _ in range(halvings):
        middle = (low + high) / 2
        low, high = (middle, high) if refuted(middle) else (low, middle)
    return low
