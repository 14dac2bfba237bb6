"""Find combinations of directions that break the guarantee although each direction alone holds.

The combinations are confirmed on fresh seeds.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import inf, isclose

from pytest_tarl.spaces import Point
from pytest_tarl.stressing.boundary import COARSE, bisect
from pytest_tarl.stressing.evaluating import NEAREST, RAYS, SIZES, Evaluator
from pytest_tarl.stressing.findings import Curve, Failure, MarginMap, confirmed, failure
from pytest_tarl.stressing.nearest import EXPECTED, FIRM, NEAR, Nearest, Steps
from pytest_tarl.stressing.rays import Ray, distance, joined

# share of the distance to each boundary at which pairs are tested; each direction alone holds there
INSIDE = 0.9
FIRST = 0.55  # share of the budget for the first search for the nearest failing drift
CONFIRMED = 0.95  # share of the budget that the tests of a nearer failing drift may use
LAST = 0.85  # share of the budget after which pairs and evolution stop, to keep episodes for confirmation
QUICK = SIZES[0]  # number of episodes at a confirmed failure


@dataclass
class Together:
    """The confirmed combinations; the probability that any of them is a false alarm is at most `risk`."""

    risk: float
    curves: Sequence[Curve]
    found: list[Failure] = field(default_factory=list)
    tried: int = 0
    margin_map: MarginMap | None = None
    tests: int = 0
    # drifts that fail according to the model but are not confirmed
    expected: list[Failure] = field(default_factory=list)

    @property
    def confirmed(self) -> list[Failure]:
        """Return the confirmed failing drifts along single directions and in combination."""
        return [*confirmed(self.curves), *self.found]

    def confirm(self, chain: Iterable[Point], evaluator: Evaluator) -> bool:
        """Test drifts in order on fresh seeds until one is confirmed; the k-th test overall has risk / (k(k + 1)).

        No drift was chosen with the seeds of the rays, so all tests share these seeds. Stop at a drift that contains a
        confirmed failure: one that changes the same values at least as much. Return whether a drift was confirmed.
        Raise BudgetSpentError.
        """
        for point in chain:
            one = failure(evaluator.space, point)
            known = any(_at_most(other.point, point, evaluator) for other in self.confirmed)
            if not one.names or known:
                return False
            self.tests += 1
            if evaluator.confirm(point, RAYS, self.risk / (self.tests * (self.tests + 1)), NEAREST):
                if len(one.names) > 1:
                    self.found.append(one)
                else:
                    self._along(one, evaluator)
                return True
        return False

    def _along(self, found: Failure, evaluator: Evaluator) -> None:
        """Add a confirmed failure along a single direction to its curve."""
        (name,) = found.names
        for curve in self.curves:
            t = found.distance / curve.ray.length
            if curve.ray.names == (name,) and isclose(curve.ray.value(t), found.point[name]):
                curve.evidence[t] = evaluator.examine(found.point, QUICK)
                curve.confirmed = t


def _at_most(one: Point, other: Point, evaluator: Evaluator) -> bool:
    """Return whether `one` lies between nominal and `other` in each direction."""
    return all(
        min(usual, other[name]) <= one[name] <= max(usual, other[name])
        for name, usual in evaluator.space.nominal.items()
    )


class Combined:
    """The search in several directions: `begin` runs before the single directions are examined, `end` afterwards."""

    def __init__(self, evaluator: Evaluator, together: Together) -> None:
        self.evaluator, self.together = evaluator, together
        self.nearest = Nearest(evaluator, together.curves, risk=together.risk)

    def begin(self) -> None:
        """Run a few episodes on each ray, search for the nearest failing drift, and confirm it.

        Raise BudgetSpentError.
        """
        with self.evaluator.limited(FIRST):
            for curve in self.together.curves:
                for t in curve.ray.places:
                    curve.evidence[t] = self.evaluator.glance(curve.ray.point(t))
            self.nearest.approach()
        if self._confirm(FIRM):
            with self.evaluator.limited(CONFIRMED):
                self._confirm_nearer()

    def end(self) -> None:
        """Search for nearer failing drifts, test pairs, and confirm the results. Raise BudgetSpentError."""
        proposed: list[Point] = []
        with self.evaluator.limited(LAST):
            self.nearest.improve()
            pairs(self.evaluator, self.together, proposed)
        self._confirm_nearer()
        for point in sorted(proposed, key=lambda one: distance(self.evaluator.space, one)):
            self.together.confirm([point], self.evaluator)

    def draw(self) -> None:
        """Predict the map and the nearest failures from all episodes, if every ray has some."""
        if all(curve.evidence for curve in self.together.curves):
            found = self.nearest.expected(EXPECTED)
            self.together.expected = [failure(self.evaluator.space, point) for point in found]
            self.together.margin_map = self.nearest.map()

    def _confirm_nearer(self) -> None:
        """Test drifts ever closer to the boundary, until one is not confirmed. Raise BudgetSpentError."""
        for step in NEAR:
            if not self._confirm([step]):
                return

    def _confirm(self, steps: Steps) -> bool:
        limit = min((one.distance for one in self.together.confirmed), default=inf)
        try:
            return self.together.confirm(self.nearest.candidates(steps, limit), self.evaluator)
        finally:
            self.together.tried = len(self.nearest.tried)


def pairs(evaluator: Evaluator, together: Together, proposed: list[Point]) -> None:
    """Test pairs of directions just inside their boundaries; if a pair fails, bisect towards nominal.

    Append the nearest failing drift of each pair to `proposed`. Skip pairs farther from nominal than a confirmed
    combination. Raise BudgetSpentError.
    """
    inside = list(_inside(together.curves))
    nearest = min((one.distance for one in together.found), default=inf)
    for one, other in combinations(inside, 2):
        if one[0].names == other[0].names:
            continue
        curve = Curve(joined((one, other)))
        if curve.ray.length >= nearest:
            continue
        together.tried += 1
        curve.evidence[1.0] = evaluator.examine(curve.ray.point(1.0), COARSE)
        if curve.failing:
            bisect(curve, evaluator)
            decided = [t for t in curve.failing if curve.evidence[t].result == "fails"]
            proposed += [curve.ray.point(t) for t in decided[:1]]


def _inside(curves: Sequence[Curve]) -> Iterator[tuple[Ray, float]]:
    """Yield each ray with the largest t to use in a pair; skip options that fail alone."""
    for curve in curves:
        if not curve.failing:
            yield curve.ray, 1.0
        elif curve.ray.continuous and curve.bracket and curve.bracket[0] > 0.0:
            yield curve.ray, INSIDE * curve.bracket[0]
