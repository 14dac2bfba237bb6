"""Find the boundary along a ray: a coarse sweep, bisection, and confirmation on fresh seeds.

A ray changes one direction (a declared parameter of the world) from its nominal value to one end of its range. `t` is
the position on the ray: 0 at the nominal value, 1 at the end.
"""

from __future__ import annotations

from pytest_tarl.stressing.evaluating import FRESH, RAYS, Evaluator
from pytest_tarl.stressing.findings import Curve
from pytest_tarl.stressing.fresh_values import Model
from pytest_tarl.stressing.guarantee import Guarantee, most_passed

COARSE, FINE = 16, 32  # maximum number of episodes per point: in the sweep, and near the boundary
RESOLUTION = 0.02  # bisection stops when the interval is narrower than this share of the declared range
# used instead of RESOLUTION while the failing end is undecided: noise then hides the exact boundary
NOISY = 0.04


def sweep(curve: Curve, evaluator: Evaluator) -> None:
    """Run episodes at the coarse points along a ray, far end first. Raise BudgetSpentError."""
    for t in curve.ray.places:
        curve.evidence[t] = evaluator.examine(curve.ray.point(t), COARSE)
    curve.swept = True


def bisect(curve: Curve, evaluator: Evaluator) -> None:
    """Bisect between the nearest failing point and the point before it, where the guarantee holds.

    Stop when the interval is narrower than RESOLUTION, or than NOISY while the failing end is undecided. Raise
    BudgetSpentError.
    """
    _settle(curve, evaluator)
    while curve.ray.continuous and (found := curve.bracket):
        near, far = found
        decided = curve.evidence[far].result != "open"
        if (far - near) * curve.ray.length <= (RESOLUTION if decided else NOISY):
            break
        _measure(curve, (near + far) / 2, evaluator)
        _settle(curve, evaluator)


def confirm(curve: Curve, evaluator: Evaluator, risk: float) -> None:
    """Test failing points on fresh seeds until one is confirmed; test k has risk `risk / (k(k + 1))`.

    The search does not use these seeds, so all rays can share them. Raise BudgetSpentError.
    """
    for k, t in enumerate(_candidates(curve, evaluator.guarantee, risk), 1):
        if curve.confirmed is not None and t >= curve.confirmed:
            return
        if evaluator.confirm(curve.ray.point(t), RAYS, risk / (k * (k + 1))):
            curve.confirm(t)
            return
        curve.rejected = (*curve.rejected, t)


def _candidates(curve: Curve, given: Guarantee, risk: float) -> list[float]:
    """Return the values of t to confirm: the promising ones in ascending order, then values farther away.

    Two kinds of values are promising: the nearest one that the model expects to be confirmed, and failing values whose
    margin is clearly low. A value exactly at the boundary is not tested: its failures are too rare to show, even in
    many episodes.
    """
    decided = sorted(t for t, one in curve.evidence.items() if one.result == "fails")
    if not decided:
        return []
    margins = [curve.evidence[t].margin for t in decided]
    chosen = [
        next(t for t, margin in zip(decided, margins, strict=True) if margin <= share * min(margins))
        for share in (0.5, 1.0)
    ]
    if curve.ray.continuous:
        most, share = FRESH[-1], risk / 2 / len(FRESH)
        nearest = Model(curve.evidence, given.tolerance).failing(most, most_passed(given, most, share))
        chosen += [] if nearest is None else [max(nearest, curve.failing[0])]
        chosen += [t for t in decided if t in curve.ray.extra]  # the ends of the declared `must_hold` range
    # these are tried last; they help if the few episodes at nearer values failed by chance
    beyond = [t for t in decided if t > max(chosen)]
    return [*sorted(set(chosen)), *dict.fromkeys([*beyond[len(beyond) // 2 :][:1], *beyond[-1:]])]


def _settle(curve: Curve, evaluator: Evaluator) -> None:
    """Run more episodes at the nearest failing point while it is undecided: its failures may be noise."""
    while curve.failing:
        nearest = curve.evidence[curve.failing[0]]
        if nearest.result != "open" or nearest.episodes >= FINE:
            break
        _measure(curve, curve.failing[0], evaluator)


def _measure(curve: Curve, t: float, evaluator: Evaluator) -> None:
    curve.evidence[t] = evaluator.examine(curve.ray.point(t), FINE)
