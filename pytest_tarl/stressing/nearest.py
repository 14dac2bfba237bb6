"""Search for the failing drift nearest to nominal, in all directions together.

A model of the drifts tried so far predicts where it is; the prediction is tried, and the model learns from it. Without
any failing drift, Hypothesis explores. CMA-ES then looks for failing drifts nearer than the best one. All of this runs
on common seeds; `combinations` confirms the result on fresh ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from math import sqrt

import numpy as np

from pytest_tarl import seeds
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.coordinates import Coordinates, Vector
from pytest_tarl.stressing.evaluating import NEAREST, SIZES, Evaluator
from pytest_tarl.stressing.evolving import evolve
from pytest_tarl.stressing.findings import Curve, MarginMap
from pytest_tarl.stressing.generating import generate
from pytest_tarl.stressing.mapping import margin_map
from pytest_tarl.stressing.prediction import Prediction, Sample
from pytest_tarl.stressing.rays import distance
from pytest_tarl.stressing.shrinking import shrunk
from pytest_tarl.stressing.spreading import spread

NEARER = 0.98  # a drift is looked for up to this share of the best distance
LARGEST = 2.0  # distance beyond which no failing drift is looked for
PREDICTED = 80  # drifts tried by predictions, at most
GAIN = 0.01  # expected gain, in units of the best distance, below which predictions end
SURE = 0.1  # a tried drift fails for the search if its predicted margin is this far below 0
CLEAR = 4.0  # or if its margin is this many standard deviations below 0
GENERATED = 24  # drifts of Hypothesis
ROUNDS, EXPLORED = 3, 8  # rounds of drifts nearer than the best one, and drifts of a round
TRIES = 24  # consecutive drifts of CMA-ES without a nearer failure after which it ends
SPREAD = 0.35  # first standard deviation of CMA-ES, in units of the best distance
DEPTHS = (
    3.0,
    5.0,
    9.0,
)  # predicted margins below 0 of the drifts to confirm, in standard deviations on fresh seeds
SHALLOW, DEEP = 0.03, 1.2  # limits of these margins
TRIFLE = 0.15  # a component below this share of the distance is left out of a drift to confirm: noise may explain it
FARTHEST = 1.6  # in units of the best distance, for confirmation


@dataclass
class Nearest:
    """The search; `tried` are the drifts that it tried, with several directions."""

    evaluator: Evaluator
    curves: Sequence[Curve]
    tried: list[Point] = field(default_factory=list)
    _spread: Iterator[Vector] | None = None
    _fitted: tuple[int, Prediction] | None = None  # the episodes that it has seen, and the model

    def approach(self) -> None:
        """Follow the predictions, after Hypothesis if nothing fails yet. Raise BudgetSpentError; findings stay."""
        self._predict()
        if self.best is None:
            self._generate()
            self._predict()
        for _ in range(ROUNDS):
            self._explore()
            self._predict()

    def improve(self) -> None:
        """Predict again, evolve and shrink. Raise BudgetSpentError; findings stay."""
        self._predict()
        self._evolve()
        if self.best is not None:
            self.tried.append(shrunk(self.best, self.evaluator))

    @property
    def best(self) -> Point | None:
        """Return the nearest drift, tried or on a ray, that fails by the model of all of them; None without one."""
        coordinates = self._nominal()
        own = [point for point in self._known() if coordinates.covers(point) and self._distance(point) > 0.0]
        other = [
            point
            for point in self._known()
            if not coordinates.covers(point) and self.evaluator.examine(point, SIZES[0]).result == "fails"
        ]
        if own and coordinates.spans:
            margins = self._model().margins(np.array([coordinates.vector(point) for point in own]))
            other += [
                point
                for point, margin in zip(own, margins, strict=True)
                if margin < -SURE or self._clearly_fails(point)
            ]
        return min(other, key=self._distance, default=None)

    def chain(self) -> list[Point]:
        """Return drifts on the ray of the best one, outwards, as candidates for confirmation.

        At the boundary even many episodes rarely show a failure, so the candidates lie beyond it, as far as the noise
        makes necessary (DEPTHS).
        """
        best = self.best
        if best is None:
            return []
        coordinates = Coordinates(self.evaluator.space, best)
        if not self._nominal().covers(best):
            return [best]
        vector, model = _without_trifles(coordinates.vector(best)), self._model()
        shares = np.linspace(0.9, FARTHEST, 141)
        margins = model.margins(shares[:, None] * vector)
        noise = self.evaluator.noise(best) / sqrt(NEAREST[-1])
        depths = [-min(max(times * noise, SHALLOW), DEEP) for times in DEPTHS]
        places = [
            int(np.argmax(margins <= depth)) if (margins <= depth).any() else len(shares) - 1
            for depth in depths
        ]
        clearly = [coordinates.point(vector)] if self.evaluator.measured(best)[0] <= -DEEP else []
        near = [*clearly, *(coordinates.point(vector * shares[place]) for place in dict.fromkeys(places))]
        return [*near, *self._farther(max(map(self._distance, near)))]

    def map(self) -> MarginMap | None:
        """Return the map of margins by the model of all drifts that were tried."""
        return margin_map(self.curves, self._model(), self._nominal())

    def _farther(self, limit: float) -> list[Point]:
        """Return up to three drifts in several directions that were seen to fail beyond a distance, the nearest first.

        They are candidates if none of the nearer ones is confirmed, because the model or few episodes misled there.
        """
        usual, coordinates = self.evaluator.space.nominal, self._nominal()
        found = [
            point
            for point in self.tried
            if self._distance(point) > limit
            and coordinates.covers(point)
            and sum(point[name] != usual[name] for name in usual) > 1
            and self.evaluator.examine(point, SIZES[0]).result == "fails"
        ]
        found.sort(key=lambda point: (self._distance(point), *point.values()))
        places = dict.fromkeys((0, len(found) // 4, len(found) // 2))
        return [found[place] for place in places if place < len(found)]

    def _clearly_fails(self, point: Point) -> bool:
        """Return whether the episodes at a point show a failure, whatever the model makes of its neighbours."""
        margin, spread = self.evaluator.measured(point)
        return margin + CLEAR * spread < 0.0

    def _known(self) -> list[Point]:
        single = [curve.ray.point(t) for curve in self.curves for t in curve.evidence]
        return [*single, *self.tried]

    def _nominal(self) -> Coordinates:
        return Coordinates(self.evaluator.space, self.evaluator.space.nominal)

    def _model(self) -> Prediction:
        """Return the model of the drifts with nominal options."""
        if self._fitted is None or self._fitted[0] != self.evaluator.spent:
            coordinates = self._nominal()
            unique = {tuple(point.values()): point for point in self._known() if coordinates.covers(point)}
            samples = [
                Sample(coordinates.vector(point), *self.evaluator.measured(point))
                for point in unique.values()
            ]
            self._fitted = self.evaluator.spent, Prediction(coordinates, self.curves, samples)
        return self._fitted[1]

    def _limit(self) -> float:
        best = self.best
        return float("inf") if best is None else NEARER * self._distance(best)

    def _distance(self, point: Point) -> float:
        return distance(self.evaluator.space, point)

    def _probe(self, point: Point) -> float:
        """Run the first episodes of a drift, and more of one that fails; return its margin."""
        found = self.evaluator.examine(point, SIZES[0])
        self.tried.append(point)
        if found.failing:
            found = self.evaluator.examine(point, SIZES[1])
        return found.margin

    def _predict(self) -> None:
        """Try the most promising drifts with nominal options until none promises much."""
        evaluator, coordinates = self.evaluator, self._nominal()
        draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} prediction {len(self.tried)}")
        if len(coordinates.spans) < 2:
            return
        for _ in range(PREDICTED):
            best = self.best
            limit = LARGEST if best is None else self._distance(best)
            vector, gain = self._model().promising(limit, draws)
            if gain < GAIN * limit:
                break
            self._probe(coordinates.point(vector))

    def _explore(self) -> None:
        """Try drifts nearer than the best one in all directions, since another failing region may be nearer."""
        evaluator, coordinates = self.evaluator, self._nominal()
        if len(coordinates.spans) < 2:
            return
        if self._spread is None:
            draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} exploration")
            self._spread = spread(coordinates, draws)
        for vector in islice(self._spread, EXPLORED):
            limit = min(self._limit(), LARGEST)
            self._probe(coordinates.point(vector * limit))

    def _generate(self) -> None:
        """Let Hypothesis look for a first failing drift."""

        def margin(point: Point) -> float | None:
            found = self._probe(point)
            return None if found < 0.0 and self.best is not None else found

        evaluator = self.evaluator
        generate(evaluator.space, seeds.episode_seed(evaluator.seed, "hypothesis", 0), GENERATED, margin)

    def _evolve(self) -> None:
        """Look for nearer failing drifts with CMA-ES, which starts again around each that it finds."""
        draws = seeds.generator(self.evaluator.seed, f"stress {self.evaluator.drift} evolution")
        missed = 0
        while missed < TRIES:
            best, limit = self.best, self._limit()
            coordinates = Coordinates(self.evaluator.space, best or self.evaluator.space.nominal)
            if len(coordinates.spans) < 2:
                return

            def margin(
                vector: Vector, coordinates: Coordinates = coordinates, limit: float = limit
            ) -> float | None:
                nonlocal missed
                nearer = coordinates.within(vector, limit)
                missed = TRIES if nearer is None else missed + 1
                if nearer is None or missed > TRIES:
                    return None
                found = self._probe(coordinates.point(nearer))
                if found < 0.0 and self._limit() < limit:
                    missed = 0
                    return None
                return found

            start = (
                coordinates.vector(best) if best is not None else 0.5 * (coordinates.high + coordinates.low)
            )
            evolve(start, SPREAD * (self._distance(best) if best is not None else 1.0), draws, margin)


def _without_trifles(vector: Vector) -> Vector:
    """Return a vector of the same length without its smallest components."""
    length = float(np.linalg.norm(vector))
    kept: Vector = np.where(np.abs(vector) < TRIFLE * length, 0.0, vector)
    return kept * length / float(np.linalg.norm(kept))
