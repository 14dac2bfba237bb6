"""Find directions that break the guarantee together although each alone does not: pairs, then a random search.

The random search tries only drifts that are nearer than the best known one, half of them around it: a (1+1) evolution
strategy with restarts. Each failure is shrunk towards nominal, one direction at a time, on common seeds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from pytest_tarl import seeds
from pytest_tarl.spaces import Choice, Point, Space, Span
from pytest_tarl.stressing.boundary import COARSE, FINE, bisect
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.findings import Curve, Failure, failure
from pytest_tarl.stressing.rays import Ray, distance, joined

INSIDE = 0.9  # share of each boundary at which directions are combined; each direction alone passes there
NEARER = 0.95  # the random search looks up to this share of the best distance
TRIES = 24  # consecutive drifts without a nearer failure after which the random search ends
SHRINKS = 4  # halvings of one direction while shrinking
PART = 0.75  # probability that a direction takes part in a random drift
SPREAD = 0.3  # standard deviation of a step around the best drift, in units of its distance


@dataclass
class Together:
    """The failing combinations found so far; each must be confirmed at a share of `risk`.

    A combination that shrinks to a single direction belongs to its curve instead.
    """

    risk: float
    curves: Sequence[Curve]
    found: list[Failure] = field(default_factory=list)
    tried: int = 0
    candidates: int = 0

    def add(self, point: Point, evaluator: Evaluator) -> bool:
        """Add a failing point if fresh seeds confirm it, the k-th candidate at risk / k(k + 1)."""
        self.candidates += 1
        k = self.candidates
        name = f"combination {k}"
        if not evaluator.confirm(point, name, self.risk / (k * (k + 1))):
            return False
        found = failure(evaluator.space, point)
        if len(found.names) > 1:
            self.found.append(found)
        else:
            nearer(self.curves, found, evaluator)
        return True


def nearer(curves: Sequence[Curve], found: Failure, evaluator: Evaluator) -> None:
    """Add a confirmed failure along a single direction to its curve, if it is the nearest there."""
    (name,) = found.names
    for curve in curves:
        length = curve.ray.length
        t = found.distance / length
        same_way = (curve.ray.farthest[name] > evaluator.space.nominal[name]) == (
            found.point[name] > evaluator.space.nominal[name]
        )
        if curve.ray.names == (name,) and same_way and t < (curve.confirmed or 2.0):
            curve.evidence[t] = evaluator.examine(found.point, FINE)
            curve.confirmed = t


def pairs(evaluator: Evaluator, together: Together) -> None:
    """Test each pair of directions just inside its boundaries, and bisect towards nominal where a pair fails."""
    inside = list(_inside(together.curves))
    for one, other in combinations(inside, 2):
        if one[0].names == other[0].names:
            continue
        together.tried += 1
        curve = Curve(joined((one, other)))
        curve.evidence[1.0] = evaluator.examine(curve.ray.point(1.0), COARSE)
        if curve.failing:
            bisect(curve, evaluator)
            decided = [t for t in curve.failing if curve.evidence[t].result == "fails"]
            if decided:
                together.add(curve.ray.point(decided[0]), evaluator)


def search(evaluator: Evaluator, together: Together) -> None:
    """Look for failing drifts nearer than all known ones, until TRIES in a row have none."""
    space, curves = evaluator.space, together.curves
    if len(space.extents) < 2:
        return
    known = [failure(space, one.ray.point(one.confirmed)) for one in curves if one.confirmed is not None]
    best = min([*known, *together.found], key=lambda one: one.distance, default=None)
    draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} search")
    ends = [curve.ray for curve in curves]
    missed = 0
    while missed < TRIES:
        missed += 1
        point = _proposed(space, ends, best, draws)
        if point is None:
            continue
        together.tried += 1
        if not evaluator.examine(point, COARSE).failing:
            continue
        point = _shrunk(point, evaluator)
        if evaluator.examine(point, FINE).result == "fails" and together.add(point, evaluator):
            best, missed = failure(space, point), 0


def _inside(curves: Sequence[Curve]) -> Iterator[tuple[Ray, float]]:
    """Yield each direction's ray and how far it may change alone; options that fail alone are left out."""
    for curve in curves:
        if not curve.failing:
            yield curve.ray, 1.0
        elif curve.ray.continuous and curve.bracket and curve.bracket[0] > 0.0:
            yield curve.ray, INSIDE * curve.bracket[0]


def _proposed(
    space: Space, ends: Sequence[Ray], best: Failure | None, draws: np.random.Generator
) -> Point | None:
    """Return a random point nearer than the best one; None if the draw has fewer than two directions."""
    if best is None:
        return _nearer(space, _anywhere(space, ends, draws), np.inf)
    around = draws.random() < 0.5
    target = _around(space, best, draws) if around else _anywhere(space, ends, draws)
    return _nearer(space, target, NEARER * best.distance)


def _anywhere(space: Space, ends: Sequence[Ray], draws: np.random.Generator) -> Point:
    """Return a point in a random orthant; each direction takes part with probability PART."""
    target = dict(space.nominal)
    for name in space.extents:
        own = [ray for ray in ends if ray.names == (name,)]
        goal = own[int(draws.integers(len(own)))].farthest[name]
        weight, part = draws.random(2).tolist()
        target[name] = _weighted(space, name, goal, weight) if part < PART else target[name]
    return target


def _around(space: Space, best: Failure, draws: np.random.Generator) -> Point:
    """Return a point around the best one; half of its nominal directions stay nominal, and options stay as they are."""
    target = dict(best.point)
    for name, extent in space.extents.items():
        step, part = float(draws.normal(0.0, SPREAD * best.distance)), draws.random()
        if isinstance(extent, Span) and (name in best.names or part < 0.5):
            moved = target[name] + step * (extent.high - extent.low)
            target[name] = min(max(moved, extent.low), extent.high)
    return target


def _nearer(space: Space, target: Point, limit: float) -> Point | None:
    """Return the point on the way from nominal to a target, within a distance; None if options are too far."""
    found = failure(space, target)
    if len(found.names) < 2:
        return None
    if found.distance <= limit:
        return target
    options = sum(isinstance(space.extents[name], Choice) for name in found.names)
    room, moving = limit**2 - options, found.distance**2 - options
    if room <= 0.0 or moving <= 0.0:
        return None
    return {name: _weighted(space, name, target[name], float(np.sqrt(room / moving))) for name in target}


def _weighted(space: Space, name: str, number: float, weight: float) -> float:
    """Return the number at a share of the distance from nominal; an option is either reached or nominal."""
    usual = space.nominal[name]
    if isinstance(space.extents[name], Choice):
        return number if weight > 0.0 else usual
    return usual + (number - usual) * weight


def _shrunk(point: Point, evaluator: Evaluator) -> Point:
    """Return a failing point that halving any single direction does not bring nearer; nominal is tried first."""
    space, now = evaluator.space, dict(point)
    for name in sorted(now, key=lambda one: -distance(space, {**space.nominal, one: now[one]})):
        usual, step = space.nominal[name], 1.0
        for attempt in range(SHRINKS):
            if now[name] == usual:
                break
            share = 0.0 if attempt == 0 else 1.0 - step
            tried = {**now, name: _weighted(space, name, now[name], share)}
            step /= 2
            if evaluator.examine(tried, COARSE).result == "fails":
                now = tried
            elif isinstance(space.extents[name], Choice):
                break
    return now
