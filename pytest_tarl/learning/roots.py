"""Where a claim stops being refuted."""

from __future__ import annotations

from collections.abc import Callable

HALVINGS = 60  # of an interval that holds a root: its width is then that of a float


def root(refuted: Callable[[float], bool], low: float, high: float, halvings: int = HALVINGS) -> float:
    """Return the largest value that is refuted, where all below it are; `low` where none is."""
    for _ in range(halvings):
        middle = (low + high) / 2
        low, high = (middle, high) if refuted(middle) else (low, middle)
    return low
