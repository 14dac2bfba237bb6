"""Estimate how much memory recording will need, and warn before memory runs out.

While episodes run, their statistics are kept as columns with 8 bytes per number. To merge, pack and write them takes
`PEAK` times as much memory. Both grow in proportion to the number of episodes, so the first few episodes allow an
estimate for all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np

from pytest_tarl.errors import RecordingError
from pytest_tarl.free_memory import available
from pytest_tarl.learning.tables import Sample

PEAK = 5  # peak bytes of memory per byte of columns (benchmarks/limits.py, case recording)
# number of episodes before the first estimate; the estimate is repeated whenever this number doubles
FIRST = 3
STRIDE = 32_000_000  # bytes of columns between two checks of the free memory
GB = 1e9


def nbytes(sample: Sample) -> int:
    """Return the size of all columns of a sample in bytes."""
    return sum(array.nbytes for array in _arrays(sample))


def _arrays(value: Any) -> Iterator[np.ndarray[Any, Any]]:
    if isinstance(value, np.ndarray):
        yield value
    elif is_dataclass(value):
        for one in fields(value):
            yield from _arrays(getattr(value, one.name))
    elif isinstance(value, tuple) and value and is_dataclass(value[0]):
        for each in value:
            yield from _arrays(each)


@dataclass
class Footprint:
    """The memory of the episodes so far and of all expected ones; `tell` receives the warning."""

    expected: int
    tell: Callable[[str], None] = lambda _: None
    warning: str = ""
    episodes: int = 0
    held: int = 0
    _estimate_at: int = FIRST
    _look_at: int = field(default_factory=lambda: STRIDE)

    def add(self, sample: Sample) -> None:
        """Count an episode. Raise RecordingError if too little memory is left to write the episodes so far."""
        self.episodes += 1
        self.held += nbytes(sample)
        if self.episodes == self._estimate_at:
            self._estimate_at *= 2
            self._estimate()
        if self.held >= self._look_at:
            self._look_at = self.held + STRIDE
            self._look()

    def _estimate(self) -> None:
        free = available()
        needed = self._needed(self.held * self.expected // self.episodes)
        if free is not None and needed > free and not self.warning:
            self.warning = (
                f"{self.expected:,} episodes will need about {needed / GB:.1f} GB of memory, and {free / GB:.1f} GB "
                f"are free. {self._advice(free)}"
            )
            self.tell(self.warning)

    def _look(self) -> None:
        free = available()
        needed = self._needed(self.held)
        if free is not None and needed > free:
            raise RecordingError(
                f"Stopped after {self.episodes:,} of {self.expected:,} episodes: writing them needs about "
                f"{needed / GB:.1f} GB of memory, and {free / GB:.1f} GB are free. {self._advice(free)}"
            )

    def _needed(self, columns: int) -> int:
        """Return how many more bytes it takes to write columns of this size."""
        return PEAK * columns - self.held

    def _advice(self, free: int) -> str:
        fitting = (free + self.held) * self.episodes // max(1, PEAK * self.held)
        return (
            f"Run at most {fitting:,} with --tarl-episodes, declare fewer bins or sensors, or make the episodes "
            "shorter."
        )
