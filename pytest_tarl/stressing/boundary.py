"""Find the boundary along a ray: a coarse sweep, bisection, and confirmation on fresh seeds."""

from __future__ import annotations

from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.findings import Curve

COARSE, FINE = 16, 32  # maximum number of episodes at a point of the sweep, and near the boundary
RESOLUTION = 0.01  # share of the declared range at which a bisection ends


def sweep(curve: Curve, evaluator: Evaluator) -> None:
    """Run the points of the coarse sweep along a ray, the farthest first."""
    for t in curve.ray.places:
        if t not in curve.evidence:
            curve.evidence[t] = evaluator.examine(curve.ray.point(t), COARSE)
    curve.swept = True


def bisect(curve: Curve, evaluator: Evaluator) -> None:
    """Halve the interval between the nearest failing point and the holding one before it, down to RESOLUTION."""
    _settle(curve, evaluator)
    while curve.ray.continuous and (found := curve.bracket):
        near, far = found
        if (far - near) * curve.ray.length <= RESOLUTION:
            break
        _measure(curve, (near + far) / 2, evaluator)
        _settle(curve, evaluator)


def confirm(curve: Curve, evaluator: Evaluator, risk: float) -> None:
    """Test failing points on fresh seeds, the k-th at risk / k(k + 1), until one is confirmed.

    All rays share these seeds, since no point was chosen with them.
    """
    for k, t in enumerate(_candidates(curve), 1):
        if evaluator.confirm(curve.ray.point(t), "rays", risk / (k * (k + 1))):
            curve.confirmed = t
            return
        curve.rejected = (*curve.rejected, t)


def _candidates(curve: Curve) -> list[float]:
    """Return three nearest points: the failing one, one with half of the lowest margin, and one with the lowest margin.

    Exactly at the boundary, even very many episodes rarely show a failure.
    """
    decided = sorted(t for t, one in curve.evidence.items() if one.result == "fails")
    margins = [curve.evidence[t].margin for t in decided]
    lowest = min(margins, default=0.0)
    chosen = [
        next(t for t, margin in zip(decided, margins, strict=True) if margin <= share * lowest)
        for share in ((0.0, 0.5, 1.0) if decided else ())
    ]
    return list(dict.fromkeys(chosen))


def _settle(curve: Curve, evaluator: Evaluator) -> None:
    """Run all episodes at the nearest failing point if it is undecided, since it may be due to noise."""
    while curve.failing:
        nearest = curve.evidence[curve.failing[0]]
        if nearest.result != "open" or nearest.episodes >= FINE:
            break
        _measure(curve, curve.failing[0], evaluator)


def _measure(curve: Curve, t: float, evaluator: Evaluator) -> None:
    curve.evidence[t] = evaluator.examine(curve.ray.point(t), FINE)
