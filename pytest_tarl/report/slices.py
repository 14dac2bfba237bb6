"""Lay out slices beside code lines, with positions in percent of the width."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pytest_tarl.model import SitePlace, Slice

MARGIN = 0.05  # share of the width left free at each end
TICKS = 4  # approximate number of ticks of an axis


@dataclass(frozen=True, slots=True)
class Scale:
    """A linear scale that includes zero, in percent of the width."""

    low: float
    high: float

    def at(self, value: float) -> float:
        """Return the position of a value, from 0 to 100."""
        return round(100 * (value - self.low) / (self.high - self.low), 3)

    @property
    def ticks(self) -> tuple[float, ...]:
        """Return round values to label, including zero."""
        step = _round_step((self.high - self.low) / TICKS)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return tuple(step * i for i in range(first, last + 1))


@dataclass(frozen=True, slots=True)
class Row:
    """A site with its slices, and whether its difference is the largest."""

    site: SitePlace
    offline: float
    online: float
    difference: float
    peak: bool

    @property
    def known(self) -> bool:
        """Return whether there is anything to draw."""
        return math.isfinite(self.difference)


@dataclass(frozen=True, slots=True)
class Chart:
    """The slices of a taint list, with one scale for values and one for differences."""

    rows: tuple[Row, ...]
    values: Scale
    change: Scale

    @property
    def known(self) -> bool:
        """Return whether any slice exists."""
        return any(row.known for row in self.rows)


def chart(slices: Sequence[Slice]) -> Chart:
    """Lay out the slices of one list."""
    largest = peak(slices)
    rows = tuple(Row(one.site, one.offline, one.online, one.difference, one is largest) for one in slices)
    values = [value for row in rows for value in (row.offline, row.online)]
    return Chart(rows, scale(values), scale(row.difference for row in rows))


def scale(values: Iterable[float]) -> Scale:
    """Return a scale with margins for zero and all finite values."""
    known = [0.0, *(value for value in values if math.isfinite(value))]
    low, high = min(known), max(known)
    if low == high:
        return Scale(-1.0, 1.0)
    free = MARGIN * (high - low)
    return Scale(low - free, high + free)


def _round_step(step: float) -> float:
    """Return the next larger number of the form 1, 2 or 5 times 10ⁿ."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))


def peak(slices: Iterable[Slice]) -> Slice | None:
    """Return the slice with the largest difference, or None."""
    known = [one for one in slices if one.difference and not math.isnan(one.difference)]
    return max(known, key=lambda one: abs(one.difference), default=None)
