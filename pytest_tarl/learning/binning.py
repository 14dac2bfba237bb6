"""Learn the bins of a sensor from what it read: quantiles, so that every bin holds about as many values."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from pytest_tarl.errors import RecordingError
from pytest_tarl.sensors import Sensor

DIGITS = 4  # of the spread of the values, to which edges are rounded


def learned_edges(
    sensors: Iterable[Sensor], read: Mapping[str, Sequence[float]]
) -> dict[str, tuple[float, ...]]:
    """Return the edges of every sensor that has bins to learn, given the values that each of them read."""
    return {s.name: quantiles(s.name, read.get(s.name, ()), s.bins or 1) for s in sensors if s.to_learn}


def quantiles(name: str, values: Sequence[float], bins: int) -> tuple[float, ...]:
    """Return rising edges of at most `bins` bins. Raises RecordingError where the values are all the same."""
    known = np.array([value for value in values if math.isfinite(value)])
    spread = float(np.ptp(known)) if known.size else 0.0
    if not spread:
        raise RecordingError(
            f"Sensor {name!r} read {f'{known[0]:g} all the time' if known.size else 'nothing'} in the episodes that "
            "its bins are learned from: there is nothing to tell apart. Give it low, high and bins, or leave it out."
        )
    places = DIGITS - math.floor(math.log10(spread))
    cuts = np.quantile(known, np.linspace(0.0, 1.0, bins + 1)).round(places) + 0.0
    return tuple(np.unique(cuts).tolist())
