"""Keep the start times of every n-th mission, to look up when a given mission took place."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

MOST = 1024  # maximum number of stored times


@dataclass
class Moments:
    """The start times of every `stride`-th mission, in seconds since 1970; the stride doubles when MOST are stored."""

    stride: int = 1
    times: list[float] = field(default_factory=list)

    def add(self, first: int, times: Sequence[float]) -> None:
        """Store start times of consecutive missions; `first` is the number of the first one."""
        number = first + -first % self.stride
        while number < first + len(times):
            self.times.append(times[number - first])
            if len(self.times) == MOST:
                self.times = self.times[::2]
                self.stride *= 2
            number += self.stride - number % self.stride

    def at(self, number: int) -> float | None:
        """Return the start time of the latest stored mission up to this number, or None."""
        place = bisect_right(range(0, len(self.times) * self.stride, self.stride), number) - 1
        return self.times[place] if place >= 0 else None
