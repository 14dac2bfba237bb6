"""Learn the bins of a sensor as quantiles, so that all bins have about equally many values."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from pytest_tarl.errors import RecordingError
from pytest_tarl.sensors import Sensor

DIGITS = 4  # edges are rounded to this many digits, relative to the range of the values


def learned_edges(
    sensors: Iterable[Sensor], read: Mapping[str, Sequence[float]]
) -> dict[str, tuple[float, ...]]:
    """Return the edges of each sensor whose bins are learned; `read` has the values of each sensor.

    Raise RecordingError if a sensor has no values, or only equal ones.
    """
    return {s.name: quantiles(s.name, read.get(s.name, ()), s.bins or 1) for s in sensors if s.to_learn}


def quantiles(name: str, values: Sequence[float], bins: int) -> tuple[float, ...]:
    """Return the ascending edges of at most `bins` bins.

    Raise RecordingError if there are no values, or only equal ones.
    """
    known = np.array([value for value in values if math.isfinite(value)])
    spread = float(np.ptp(known)) if known.size else 0.0
    if not spread:
        raise RecordingError(
            f"Sensor {name!r} read {f'{known[0]:g} all the time' if known.size else 'nothing'} in the episodes "
            "from which its bins are learned, so there are no bins. Give it low, high and bins, or remove it."
        )
    places = DIGITS - math.floor(math.log10(spread))
    cuts = np.quantile(known, np.linspace(0.0, 1.0, bins + 1)).round(places) + 0.0
    return tuple(np.unique(cuts).tolist())
