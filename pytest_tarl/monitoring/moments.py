"""Keep the start time of every n-th mission."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

MOST = 1024  # maximum number of stored times


@dataclass
class Moments:
    """The start times of every `stride`-th mission, in seconds since 1970."""

    stride: int = 1
    times: list[float] = field(default_factory=list)

    def add(self, first: int, times: Sequence[float]) -> None:
        """Store the start times of consecutive missions, beginning with mission number `first`."""
        number = first + -first % self.stride
        while number < first + len(times):
            self.times.append(times[number - first])
            if len(self.times) == MOST:
                self.times = self.times[::2]
                self.stride *= 2
            number += self.stride - number % self.stride

    def at(self, number: int) -> float | None:
        """Return the latest stored start time up to this mission, or None."""
        place = bisect_right(range(0, len(self.times) * self.stride, self.stride), number) - 1
        return self.times[place] if place >= 0 else None
