"""Find the boundary of a rejected interval by bisection."""

from __future__ import annotations

from collections.abc import Callable

HALVINGS = 60  # enough to reach the precision of a float


def root(refuted: Callable[[float], bool], low: float, high: float, halvings: int = HALVINGS) -> float:
    """Return the largest refuted value, given that all smaller ones are refuted; `low` if none is."""
    for _ in range(halvings):
        middle = (low + high) / 2
        low, high = (middle, high) if refuted(middle) else (low, middle)
    return low
