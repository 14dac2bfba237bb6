"""Count the simulations until a formula of ARCH-COMP's falsification category is violated.

    python benchmarks/arch_comp/falsify.py [FORMULA ...] [--seeds 10] [--limit 300] [--methods explored random stress]

Inputs are piecewise constant (instance 2 of the category). AT has 6 values of the throttle and 6 of the brake
over 30 s; CC has 20 of each over 100 s. WT has a value of the wind every 5 s over 630 s, with linear
interpolation. Each value is a direction of the space. A drift counts as one simulation; repeated episodes of
it are not counted, since nothing is random. The method `explored` first tries inputs that are constant over time.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, product
from pathlib import Path
from statistics import fmean, median

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from arch_formulas import AUTOMATIC_TRANSMISSION, CHASING_CARS, WIND_TURBINE, Outputs, Robustness
from arch_models import (
    AT_STEP,
    CC_STEP,
    WT_STEP,
    Signal,
    automatic_transmission,
    chasing_cars,
    wind_turbine,
)

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.seeds import episode_seed, generator
from pytest_tarl.spaces import Point, Space, Span
from pytest_tarl.stressing.combinations import Together
from pytest_tarl.stressing.coordinates import Coordinates, Vector
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.evolving import evolve
from pytest_tarl.stressing.findings import Curve
from pytest_tarl.stressing.generating import generate
from pytest_tarl.stressing.guarantee import Guarantee
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.spreading import spread
from pytest_tarl.stressing.stress_run import explore

SPREAD = 0.35  # initial standard deviation of CMA-ES, in units of the ranges
_NONE = np.zeros(0, np.int32)


class FalsifiedError(Exception):
    """Raised to end the search: the formula is violated, or the limit of simulations is reached."""


@dataclass(frozen=True)
class Model:
    """A model and its inputs; each input has a number of values, a range, and a nominal value."""

    run: Callable[[Signal], Outputs]
    seconds: float
    step: float
    inputs: tuple[tuple[int, float, float, float], ...]
    formulas: Mapping[str, Robustness]
    linear: bool = False

    @property
    def space(self) -> Space:
        """Return a direction for each value of each input."""
        spans = {
            f"u{number}_{place}": Span(low, high, usual)
            for number, (count, low, high, usual) in enumerate(self.inputs)
            for place in range(count)
        }
        return Space(spans, {})

    def constant(self, draws: np.random.Generator) -> list[Point]:
        """Return the points whose inputs are constant: each at an end or at its usual value, in random order."""
        levels = product(*(sorted({low, high, usual}) for _, low, high, usual in self.inputs))
        points: list[Point] = []
        for chosen in levels:
            values = [
                level for level, (count, *_) in zip(chosen, self.inputs, strict=True) for _ in range(count)
            ]
            points.append(dict(zip(self.space.extents, values, strict=True)))
        return [points[int(at)] for at in draws.permutation(len(points))]

    def signals(self, values: Sequence[float]) -> Signal:
        """Return the inputs over time, shape (steps, inputs)."""
        steps = round(self.seconds / self.step) + 1
        columns, first = [], 0
        for count, *_ in self.inputs:
            own = np.array(values[first : first + count])
            first += count
            if self.linear:
                columns.append(np.interp(np.linspace(0, count - 1, steps), np.arange(count), own))
            else:
                columns.append(own[np.minimum(np.arange(steps) * count // steps, count - 1)])
        return np.column_stack(columns)


MODELS = (
    Model(
        automatic_transmission,
        30.0,
        AT_STEP,
        ((6, 0.0, 100.0, 50.0), (6, 0.0, 325.0, 0.0)),
        AUTOMATIC_TRANSMISSION,
    ),
    Model(chasing_cars, 100.0, CC_STEP, ((20, 0.0, 1.0, 0.5), (20, 0.0, 1.0, 0.5)), CHASING_CARS),
    Model(wind_turbine, 630.0, WT_STEP, ((127, 8.0, 16.0, 12.0),), WIND_TURBINE, linear=True),
)


@dataclass
class Simulations:
    """A rollout that simulates each drift once, and stops at a violation or after `limit` simulations."""

    model: Model
    robustness: Robustness
    limit: int
    known: dict[tuple[float, ...], float] = field(default_factory=dict)
    workers: int = 1

    def value(self, point: Point) -> float:
        """Return the robustness at a point. Raise FalsifiedError."""
        values = tuple(point.values())
        if values not in self.known:
            if len(self.known) >= self.limit:
                raise FalsifiedError
            self.known[values] = self.robustness(self.model.run(self.model.signals(values)))
            if self.known[values] < 0.0:
                raise FalsifiedError
        return self.known[values]

    @property
    def falsified(self) -> int | None:
        """Return the number of simulations of a search; None if it found no violation."""
        return len(self.known) if min(self.known.values()) < 0.0 else None

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode, whose reward is the robustness."""
        assert plan.point is not None
        total = self.value(plan.point)
        trace = Trace((), _NONE, np.zeros(0), _NONE, _NONE, _NONE, np.array([total]), {})
        return EpisodeRun(plan, trace, total >= 0.0)

    def begin(self, plan: EpisodePlan) -> Pending:
        """Return an episode that runs when its result is requested."""
        return Deferred(self, plan)


def stressed(model: Model, robustness: Robustness, seed: int, limit: int) -> int | None:
    """Return the number of simulations that a stress run needs; None if the limit does not suffice."""
    runs, space = Simulations(model, robustness, limit), model.space
    try:
        usual = runs.value(space.nominal)
        given = Guarantee(0.95, max(usual, 1e-9), (usual,) * 100, 1.0)
        evaluator = Evaluator(runs, space, "inputs", given, seed, 10**6, lambda *_: None)
        explore(evaluator, Together(0.01, [Curve(ray) for ray in rays(space, {})]), 0.01)
    except FalsifiedError:
        pass
    return runs.falsified


def explored(model: Model, robustness: Robustness, seed: int, limit: int) -> int | None:
    """Return the number of simulations that a search of many directions needs; None if the limit does not suffice.

    Constant inputs come first. A Halton sequence and Hypothesis then use a sixth of the limit each, CMA-ES the rest.
    """
    runs, space = Simulations(model, robustness, limit), model.space
    coordinates = Coordinates(space, space.nominal)

    def margin(vector: Vector) -> float:
        return runs.value(coordinates.point(vector))

    try:
        for point in model.constant(generator(seed, "constant inputs")):
            runs.value(point)
        largest = float(np.linalg.norm(np.maximum(-coordinates.low, coordinates.high)))
        for vector in islice(spread(coordinates, generator(seed, "spread")), limit // 6):
            margin(largest * vector)
        generate(space, episode_seed(seed, "hypothesis", 0), limit // 6, runs.value)
        best = min(runs.known, key=lambda values: runs.known[values])
        start = coordinates.vector(dict(zip(space.extents, best, strict=True)))
        while True:
            evolve(start, SPREAD, generator(seed, f"evolution {len(runs.known)}"), margin)
    except FalsifiedError:
        return runs.falsified


def by_chance(model: Model, robustness: Robustness, seed: int, limit: int) -> int | None:
    """Return the number of simulations that uniformly random inputs need; None if the limit does not suffice."""
    runs, draws = Simulations(model, robustness, limit), generator(seed, "random")
    spans = model.space.directions
    try:
        while True:
            runs.value({name: float(draws.uniform(one.low, one.high)) for name, one in spans.items()})  # type: ignore[union-attr]
    except FalsifiedError:
        return runs.falsified


def cell(found: Sequence[int | None]) -> str:
    """Return how many searches found a violation, and their mean and median number of simulations."""
    known = [one for one in found if one is not None]
    if not known:
        return f"0 of {len(found)}"
    return f"{len(known)} of {len(found)}, {fmean(known):.1f}, {median(known):g}"


def main() -> None:
    """Print a line for each formula."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("formulas", nargs="*")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--limit", type=int, default=300)
    parser.add_argument("--methods", nargs="+", default=["explored", "random"])
    arguments = parser.parse_args()
    methods = {"explored": explored, "random": by_chance, "stress": stressed}
    names = [name for name in methods if name in arguments.methods]
    print(f"| formula | robustness at nominal | {' | '.join(names)} |\n|---|---|{'---|' * len(names)}")
    for model in MODELS:
        for name, robustness in model.formulas.items():
            if arguments.formulas and name not in arguments.formulas:
                continue
            usual = robustness(model.run(model.signals([*model.space.nominal.values()])))
            cells = [
                cell(
                    [
                        methods[one](model, robustness, seed, arguments.limit)
                        for seed in range(arguments.seeds)
                    ]
                )
                for one in names
            ]
            print(f"| {name} | {usual:.3g} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
