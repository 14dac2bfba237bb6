"""Search for the failing drift nearest to nominal, in all directions at once.

A model predicts the nearest failing drift from the drifts tried so far. The search tries the prediction, and the model
learns from the outcome. While no drift fails, Hypothesis explores the space. Afterwards CMA-ES, an evolution strategy,
looks for nearer failing drifts. All episodes use the common seeds of the search; the module `combinations` confirms the
result on fresh seeds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from math import sqrt

import numpy as np

from pytest_tarl import seeds
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.coordinates import Coordinates, Vector
from pytest_tarl.stressing.evaluating import NEAREST, SIZES, SPENT, BudgetSpentError, Evaluator
from pytest_tarl.stressing.evolving import evolve
from pytest_tarl.stressing.findings import Curve, MarginMap
from pytest_tarl.stressing.fitting import fitted
from pytest_tarl.stressing.generating import generate
from pytest_tarl.stressing.guarantee import most_passed
from pytest_tarl.stressing.loss_noise import cut_off, pairing_wastes
from pytest_tarl.stressing.mapping import margin_map
from pytest_tarl.stressing.prediction import Prediction, Shown
from pytest_tarl.stressing.rays import distance
from pytest_tarl.stressing.shrinking import shrunk
from pytest_tarl.stressing.spreading import around, spread

# maximum distance at which a failing drift counts as nearer, as a share of the best distance so far
NEARER = 0.98
LARGEST = 2.0  # maximum distance of the drifts that are searched
PREDICTED = 3  # number of predicted drifts that are tried in succession
GAIN = 0.01  # minimum expected reduction of the distance, as a share of the best distance, for a drift to be tried
# numbers of standard deviations that are added to the predicted losses; successive predictions use them in turn
BOLD = (0.0, 1.0, 0.0, 0.5)
# a drift also counts as failing if its predicted excess loss is at most this share below the detectable loss
SURE = 0.5
# a margin that lies at least this number of standard deviations below 0 clearly shows a failure
CLEAR = 4.0
GENERATED = 24  # maximum number of drifts from Hypothesis
ROUNDS = 24  # number of rounds of the first search
EXPLORED = 4  # number of drifts that each round explores without the model
GUIDED = 4  # number of drifts that the model chooses in each round
AMONG = 4  # number of candidates among which the model chooses one drift
HOPE = 1.0  # number of standard deviations by which predictions are raised, to favour uncertain drifts
DESCENDED = 2  # number of drifts near the best one that are tried in each round
AGAIN = 4  # number of rounds of each later search
SAME = 0.02  # relative difference below which two drifts count as the same
TRIES = 24  # CMA-ES stops after this number of consecutive drifts without a nearer failure
SPREAD = 0.35  # initial standard deviation of CMA-ES, in units of the best distance
# Each step has two numbers: the error of the model to allow for, in standard deviations, and the required excess over
# the guarantee, in units of what fresh episodes can show. EXPECTED holds the steps for drifts that are reported without
# confirmation.
EXPECTED = ((0.2, 0.9), (0.4, 1.0), (0.6, 1.2), (0.8, 1.5), (1.0, 2.0), (1.5, 2.5))
# if the loss exceeds the tolerated loss by this number of standard errors, fresh episodes show it in 4 of 5 cases
STANDARD = 3.8
# excess of a failure rate, in standard errors, that fresh episodes show in 4 of 5 cases; maximum failure rate
POWER, IMPOSSIBLE = 0.6, 0.99
# limits of the excess loss that fresh episodes can show, in units of the tolerated loss
SHALLOW, DEEP = 0.03, 1.2
# components of a drift below this share of its distance may be noise, so they are set to nominal before confirmation
TRIFLE = 0.15

Steps = Sequence[tuple[float, float]]  # (number of standard deviations, excess), as in EXPECTED


@dataclass
class Nearest:
    """The search in several directions; `tried` are the drifts tried so far."""

    evaluator: Evaluator
    curves: Sequence[Curve]
    tried: list[Point] = field(default_factory=list)
    tested: list[Point] = field(default_factory=list)  # drifts at which fresh episodes ran
    # error probability of a test on fresh seeds; it determines how clear a failure must be
    risk: float = 0.01
    base: Point | None = None  # drift whose options the whole search keeps; None for the nominal options
    ceiling: float = LARGEST  # maximum distance of the drifts that are explored
    _spread: Iterator[Vector] | None = None
    _fitted: tuple[int, Prediction] | None = None  # (number of episodes that the model was fitted to, model)

    def approach(self, rounds: int = ROUNDS) -> None:
        """Try predicted drifts; if none fails so far, let Hypothesis explore first.

        Raise BudgetSpentError; the drifts tried so far are kept.
        """
        self._predict()
        if self.best is None:
            self._generate()
            self._predict()
        self.explore(rounds)

    def refine(self) -> None:
        """Predict again, and try drifts around the best one. Raise BudgetSpentError."""
        for _ in range(ROUNDS):
            self._predict()
            self._descend()

    def improve(self) -> None:
        """Predict and explore again, then evolve and shrink the best drift.

        Raise BudgetSpentError; the drifts tried so far are kept.
        """
        self._predict()
        self.explore(AGAIN)
        self._evolve()
        if self.best is not None:
            self.tried.append(shrunk(self.best, self.evaluator))

    @property
    def best(self) -> Point | None:
        """Return the nearest known failing drift, from `tried` and the rays, or None.

        If a drift's own episodes clearly show that it fails, they decide; otherwise, the model of all episodes decides.
        The nominal model does not cover a drift with an option that is not nominal, so only the drift's own episodes
        decide. If the search has a base, only drifts with the options of the base count.
        """
        coordinates = self.coordinates
        own = [point for point in self._known() if coordinates.covers(point) and self.distance(point) > 0.0]
        other = [
            point
            for point in self._known()
            if self.base is None and not coordinates.covers(point) and self._fails(point)
        ]
        if own and coordinates.spans:
            model = self.model()
            excess = model.excess(np.array([coordinates.vector(point) for point in own]))
            least = -SURE * model.shown.depth
            other += [
                point
                for point, one in zip(own, excess, strict=True)
                if one > least or self._clearly_fails(point)
            ]
        return min(other, key=self.distance, default=None)

    def predicted(self, errors: float, depth: float, draws: np.random.Generator) -> Point | None:
        """Return the nearest drift that fails according to the model, or None; parameters as in `Plan`."""
        model = self.model().deeper(depth)
        vector = model.shortest(errors, LARGEST, draws)
        if vector is None:
            return None
        return self.coordinates.point(_without_trifles(vector, model, errors))

    def expected(self, steps: Steps) -> list[Point]:
        """Return for each step the nearest drift that fails according to the model.

        A step is a pair as in EXPECTED. Drifts that hardly differ from an earlier one are skipped. The result is empty
        if no tried drift fails.
        """
        best, coordinates = self.best, self.coordinates
        if best is None or not coordinates.covers(best):
            return []
        draws = seeds.generator(self.evaluator.seed, f"stress {self.evaluator.drift} chain {len(self.tried)}")
        near: list[Point] = []
        for errors, depth in steps:
            point = self.predicted(errors, depth, draws)
            if point is not None and (
                not near or self.distance(point) > (1.0 + SAME) * self.distance(near[-1])
            ):
                near.append(point)
        return near

    @property
    def unpaired(self) -> bool:
        """Return whether tests of losses should compare with the recorded mean instead of nominal episodes.

        Only the episodes of the search decide, so that the answer does not depend on fresh seeds.
        """
        evaluator = self.evaluator
        points = {tuple(point.values()): point for point in (*self.tried, *self._swept)}.values()
        found = [evaluator.totals(point) for point in points]
        usual, unit = evaluator.usual_mean, evaluator.guarantee.tolerance
        if unit <= 0.0:
            return False
        paired = [cut_off([(before - after) / unit for after, before in pairs]) for pairs in found]
        alone = [cut_off([(usual - after) / unit for after, _ in pairs]) for pairs in found]
        return pairing_wastes(evaluator.guarantee, paired, alone, NEAREST[-1])

    def map(self) -> MarginMap | None:
        """Return the map of margins that the model predicts, or None with fewer than two ranges."""
        return margin_map(self.curves, self.model(), self.coordinates)

    def _fails(self, point: Point) -> bool:
        """Return whether a point's own episodes show a failure; run a few more episodes if they suggest one.

        If the budget does not cover the missing episodes of a point, the point does not count as failing.
        """
        evaluator = self.evaluator
        try:
            return evaluator.glance(point).failing and evaluator.examine(point, SIZES[0]).result == "fails"
        except BudgetSpentError:
            return False

    def _clearly_fails(self, point: Point) -> bool:
        """Return whether a point's own episodes clearly show a failure, without the help of the model."""
        margin, spread = self.evaluator.measured(point)
        return margin + CLEAR * spread < 0.0

    def vectors(self) -> list[Vector]:
        """Return the vectors of all known drifts that the model covers."""
        return [self.coordinates.vector(point) for point in self._known() if self.coordinates.covers(point)]

    def _known(self) -> list[Point]:
        tested = [point for point in self.tested if self.evaluator.knows(point)]
        return [*self._swept, *self.tried, *tested]

    @property
    def _swept(self) -> list[Point]:
        """Return the drifts along single directions at which episodes of the search ran."""
        return [curve.ray.point(t) for curve in self.curves for t in curve.evidence]

    @cached_property
    def coordinates(self) -> Coordinates:
        """Return the coordinates of the drifts with the options of the base, which the model covers."""
        return Coordinates(self.evaluator.space, self.base or self.evaluator.space.nominal)

    def model(self) -> Prediction:
        """Return the model of the drifts with the options of the base, fitted to all drifts known so far."""
        if self._fitted is None or self._fitted[0] != self.evaluator.spent:
            evaluator = self.evaluator
            before = None if self._fitted is None else self._fitted[1]
            model = fitted(evaluator, self.coordinates, self._known(), self._shown, before)
            self._fitted = evaluator.spent, model
        return self._fitted[1]

    @cached_property
    def _share(self) -> float:
        """Return the failure rate that the largest test shows in about 4 of 5 cases."""
        episodes = NEAREST[-1]
        most = most_passed(self.evaluator.guarantee, episodes, self.risk * SPENT[-1])
        if most < 0:
            return IMPOSSIBLE
        share = (episodes - most) / episodes
        return min(share + POWER * sqrt(share * (1.0 - share) / episodes), IMPOSSIBLE)

    def _shown(self, noise: float) -> Shown:
        """Return the loss and failure rate that fresh episodes can show.

        `noise` is the standard deviation of a loss at the boundary.
        """
        depth = min(max(STANDARD * noise / sqrt(NEAREST[-1]), SHALLOW), DEEP)
        return Shown(depth, self._share)

    def _limit(self) -> float:
        best = self.best
        return float("inf") if best is None else NEARER * self.distance(best)

    def distance(self, point: Point) -> float:
        """Return the distance of a drift from nominal."""
        return distance(self.evaluator.space, point)

    def _probe(self, point: Point) -> float:
        """Run the first episodes of a drift, and more if they fail; return its margin."""
        found = self.evaluator.glance(point, len(self.tried))
        self.tried.append(point)
        if found.failing and found.result == "open":
            found = self.evaluator.examine(point, SIZES[0])
            if found.failing:
                found = self.evaluator.examine(point, SIZES[1])
        return found.margin

    def _predict(self) -> None:
        """Try the nearest drifts that the model predicts to fail, with varying optimism, and learn from each."""
        evaluator, coordinates = self.evaluator, self.coordinates
        draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} prediction {len(self.tried)}")
        if len(coordinates.spans) < 2:
            return
        for number in range(PREDICTED):
            bold = BOLD[number % len(BOLD)]
            vector = self.model().shortest(-bold, LARGEST, draws)
            if vector is None:
                best = self.best
                limit = LARGEST if best is None else self.distance(best)
                vector, gain = self.model().promising(limit, draws)
                if gain < GAIN * limit:
                    continue
            self._probe(coordinates.point(vector))

    def explore(self, rounds: int) -> None:
        """Explore and predict in turn. Raise BudgetSpentError; the drifts tried so far are kept."""
        for _ in range(rounds):
            self._explore()
            self._predict()

    def _explore(self) -> None:
        """Try drifts nearer than the best one in all directions, to find other failing regions.

        The model chooses some of them, because tolerated losses indicate where a failing region may be. Then try a few
        drifts around the best one.
        """
        evaluator, coordinates = self.evaluator, self.coordinates
        if len(coordinates.spans) < 2:
            return
        if self._spread is None:
            draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} exploration")
            self._spread = spread(coordinates, draws)
        limit = sqrt(max(min(self._limit(), self.ceiling) ** 2 - coordinates.options, 0.0))
        vectors = [limit * vector for vector in islice(self._spread, EXPLORED)]
        among = np.array([limit * vector for vector in islice(self._spread, GUIDED * AMONG)])
        hopes = self.model().excess(np.clip(among, coordinates.low, coordinates.high), -HOPE)
        vectors += [among[place] for place in np.argsort(-hopes, kind="stable")[:GUIDED]]
        for vector in vectors:
            self._probe(coordinates.point(vector))
        self._descend()

    def _descend(self) -> None:
        """Try a few drifts around the best one."""
        evaluator, coordinates, best = self.evaluator, self.coordinates, self.best
        if best is not None and coordinates.covers(best):
            draws = seeds.generator(evaluator.seed, f"stress {evaluator.drift} descent {len(self.tried)}")
            for vector in islice(around(coordinates, coordinates.vector(best), draws), DESCENDED):
                self._probe(coordinates.point(vector))

    def _generate(self) -> None:
        """Let Hypothesis search for a first failing drift."""

        def margin(point: Point) -> float | None:
            found = self._probe(point)
            return None if found < 0.0 and self.best is not None else found

        evaluator = self.evaluator
        generate(evaluator.space, seeds.episode_seed(evaluator.seed, "hypothesis", 0), GENERATED, margin)

    def _evolve(self) -> None:
        """Search for nearer failing drifts with CMA-ES; restart it at each failing drift that it finds."""
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
            evolve(start, SPREAD * (self.distance(best) if best is not None else 1.0), draws, margin)


def _without_trifles(vector: Vector, model: Prediction, errors: float) -> Vector:
    """Set a vector's smallest components to 0, if the model then still expects a failure."""
    kept: Vector = np.where(np.abs(vector) < TRIFLE * float(np.linalg.norm(vector)), 0.0, vector)
    return kept if model.excess(kept[None, :], errors)[0] >= 0.0 else vector
