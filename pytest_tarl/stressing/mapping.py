"""Compute the map of a stress test: the predicted margin over the two most important directions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytest_tarl.spaces import Span
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.findings import Curve, MarginMap
from pytest_tarl.stressing.guarantee import LOWEST
from pytest_tarl.stressing.prediction import Prediction

CELLS = 25  # number of cells per direction


def importance(curves: Sequence[Curve]) -> dict[str, float]:
    """Return the largest loss of margin along each range, the most important range first."""
    found: dict[str, float] = {}
    for curve in curves:
        (name,) = curve.ray.names
        if isinstance(curve.ray.space.extents[name], Span):
            found[name] = max(found.get(name, 0.0), lost(curve))
    return dict(sorted(found.items(), key=lambda one: -one[1]))


def lost(curve: Curve) -> float:
    """Return the largest loss of margin along a ray; at 1, the guarantee is only just met."""
    return max((1.0 - max(one.margin, LOWEST) for one in curve.evidence.values()), default=0.0)


def margin_map(curves: Sequence[Curve], model: Prediction, coordinates: Coordinates) -> MarginMap | None:
    """Return the predicted margins of CELLS × CELLS cells, or None if there are fewer than two ranges."""
    spans = coordinates.spans
    names = [*importance(curves)][:2]
    if len(names) < 2:
        return None
    places = [list(spans).index(name) for name in names]
    shares = (np.arange(CELLS) + 0.5) / CELLS
    across, up = (
        coordinates.low[place] + (coordinates.high[place] - coordinates.low[place]) * shares
        for place in places
    )
    vectors = np.zeros((CELLS * CELLS, len(coordinates.spans)))
    vectors[:, places[0]] = np.tile(across, CELLS)
    vectors[:, places[1]] = np.repeat(up, CELLS)
    means, deviations = model.moments(vectors)
    rows = [tuple(round(float(one), 3) for one in row) for row in means.reshape(CELLS, CELLS)]
    spreads = [tuple(round(float(one), 3) for one in row) for row in deviations.reshape(CELLS, CELLS)]
    return MarginMap((names[0], names[1]), (spans[names[0]], spans[names[1]]), tuple(rows), tuple(spreads))
