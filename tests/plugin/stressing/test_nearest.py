"""The search in several directions: the model, Hypothesis and CMA-ES."""

from __future__ import annotations

from itertools import islice
from math import sqrt
from statistics import fmean

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl import Drift, extras
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.evolving import evolve
from pytest_tarl.stressing.findings import Curve
from pytest_tarl.stressing.generating import generate
from pytest_tarl.stressing.nearest import Nearest
from pytest_tarl.stressing.prediction import Prediction, Sample, Shown
from pytest_tarl.stressing.rays import distance, rays
from pytest_tarl.stressing.spreading import CLOSEST, spread
from tests.plugin.stressing.worlds import evaluator_of, space_of, stressed

SPACE = space_of(
    a=Drift.range(-1.0, 1.0, nominal=0.0),
    b=Drift.range(0.0, 2.0, nominal=2.0),
    camera=Drift.choice("up", "down"),
)


@given(st.floats(-0.5, 0.5), st.floats(-1.0, 0.0), st.sampled_from([0.0, 1.0]))
@settings(max_examples=20)
def test_coordinates_are_distances_in_units_of_the_ranges(a: float, b: float, camera: float) -> None:
    point = {"a": 2.0 * a, "b": 2.0 + 2.0 * b, "camera": camera}
    coordinates = Coordinates(SPACE, point)
    assert coordinates.vector(point) == pytest.approx([a, b])
    back = coordinates.point(coordinates.vector(point))
    assert back == pytest.approx(point, abs=1e-9)
    near = coordinates.within(np.array([a, b]), 1.05)
    assert near is not None
    assert distance(SPACE, coordinates.point(near)) <= 1.05 + 1e-9
    assert coordinates.within(np.array([a, b]), 0.9) is None or camera == 0.0


def measured(evaluator: Evaluator, point: Point) -> tuple[float, float, int, list[tuple[str, int]]]:
    """Return the mean loss, its standard deviation, the number of failed episodes and their seeds."""
    losses, failed = evaluator.losses(point)
    return fmean(losses), 0.05, failed, evaluator.sources(point)


def test_prediction_finds_the_nearest_additive_failure() -> None:
    weights = {"a": 1.0, "b": 2.0}
    space = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), b=Drift.range(0.0, 1.0, nominal=0.0))
    evaluator = evaluator_of(
        lambda point, _: (True, 10.0 - 0.5 * sum(weights[name] * point[name] for name in weights)), space
    )
    curves = [Curve(ray) for ray in rays(space, {})]
    for curve in curves:
        curve.evidence.update({t: evaluator.examine(curve.ray.point(t), 4) for t in curve.ray.places})
    coordinates = Coordinates(space, space.nominal)
    points = [curve.ray.point(t) for curve in curves for t in curve.evidence]
    samples = [Sample(coordinates.vector(point), *measured(evaluator, point)) for point in points]
    model = Prediction(
        coordinates, evaluator.guarantee, samples, Shown(0.05, 0.2), typical=0.01, paired=0.005
    )
    assert model.margins(np.array([[0.2, 0.4]]))[0] == pytest.approx(0.0, abs=0.1)
    vector, gain = model.promising(0.5, np.random.default_rng(0))
    assert gain > 0.0
    assert 0.35 < np.linalg.norm(vector) < 0.5  # the true distance is 1 / √5 = 0.447
    assert vector[1] > vector[0]
    shortest = model.shortest(0.0, 2.0, np.random.default_rng(0))
    assert shortest is not None
    assert np.linalg.norm(shortest) == pytest.approx(1.05 / sqrt(5.0), rel=0.06)
    assert model.excess(shortest[None, :])[0] >= 0.0
    deeper = model.deeper(4.0).shortest(0.0, 2.0, np.random.default_rng(0))
    assert deeper is not None
    assert np.linalg.norm(deeper) > 1.05 * np.linalg.norm(shortest)


def test_prediction_finds_the_nearest_failure_without_rewards() -> None:
    space = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), b=Drift.range(0.0, 1.0, nominal=0.0))
    evaluator = evaluator_of(lambda point, _: (point["a"] + point["b"] < 0.8, 1.0), space)
    coordinates = Coordinates(space, space.nominal)
    grid = [{"a": a / 5, "b": b / 5} for a in range(6) for b in range(6)]
    for point in grid:
        evaluator.examine(point, 4)
    samples = [Sample(coordinates.vector(point), *measured(evaluator, point)) for point in grid]
    model = Prediction(
        coordinates, evaluator.guarantee, samples, Shown(0.05, 0.2), typical=1e-6, paired=5e-07
    )
    vector = model.shortest(0.0, 2.0, np.random.default_rng(0))
    assert vector is not None
    assert 0.6 <= vector.sum() <= 0.8  # the grid's points at 0.6 hold, those at 0.8 fail
    assert (model.margins(np.array([[0.1, 0.1], [0.9, 0.9]])) < 0.0).tolist() == [False, True]


def test_generated_drifts_are_repeatable_and_in_the_space() -> None:
    def drawn(seed: int) -> list[Point]:
        found: list[Point] = []

        def margin(point: Point) -> float | None:
            found.append(point)
            return -abs(point["a"])

        generate(SPACE, seed, 12, margin)
        return found

    one = drawn(3)
    assert one == drawn(3)
    assert one != drawn(4)
    assert len({tuple(point.values()) for point in one}) > 5
    for point in one:
        assert -1.0 <= point["a"] <= 1.0
        assert 0.0 <= point["b"] <= 2.0
        assert point["camera"] in (0.0, 1.0)


def test_an_exception_under_a_generated_drift_is_raised_once() -> None:
    calls: list[Point] = []

    def margin(point: Point) -> float | None:
        calls.append(point)
        raise LookupError("spent")

    with pytest.raises(LookupError, match="spent"):
        generate(SPACE, 0, 12, margin)
    assert len(calls) == 1


def test_evolution_uses_no_global_random_numbers() -> None:
    """Nodes may draw from the global generator in the process of the search, but not in workers."""
    reached: list[list[float]] = []
    for state in (1, 2):
        np.random.seed(state)
        before = np.random.get_state()[1].tolist()  # type: ignore[index, union-attr]
        seen: list[float] = []

        def margin(vector: np.ndarray, seen: list[float] = seen) -> float | None:
            seen.append(float(np.sum(vector**2)))
            return seen[-1] if len(seen) < 60 else None

        evolve(np.array([0.5, 0.5]), 0.2, np.random.default_rng(0), margin)
        assert np.random.get_state()[1].tolist() == before  # type: ignore[index, union-attr]
        reached.append(seen)
    assert reached[0] == reached[1]
    assert min(reached[0]) < 0.05


def test_search_finds_a_multiplicative_boundary() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return True, 10.0 - 0.5 * 4.0 * point["a"] * point["b"] + float(draws.normal(0.0, 0.1))

    space = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), b=Drift.range(0.0, 1.0, nominal=0.0))
    nearest = stressed(world, space, budget=500).failures[0]
    assert nearest.distance < 1.1 * sqrt(0.5)  # 4 a b = 1 at a = b = 0.5


def test_the_error_about_a_missing_extra_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    assert extras.missing_stress("--tarl-stress") is None
    monkeypatch.setattr(extras, "STRESS", ("cma", "no_such_package"))
    assert "--tarl-stress needs no_such_package" in str(extras.missing_stress("--tarl-stress"))


def test_spread_drifts_fill_all_directions_within_the_unit_ball() -> None:
    coordinates = Coordinates(SPACE, SPACE.nominal)  # a has both signs, b only the negative one
    vectors = np.array(list(islice(spread(coordinates, np.random.default_rng(0)), 200)))
    lengths = np.linalg.norm(vectors, axis=1)
    assert lengths.min() >= CLOSEST
    assert lengths.max() <= 1.0
    assert (vectors[:, 1] <= 0.0).all()
    both = vectors[(vectors != 0.0).all(axis=1)]
    angles = np.sort(np.arctan2(both[:, 0], -both[:, 1]))  # from -π/2 to π/2
    assert np.diff(angles, prepend=-np.pi / 2, append=np.pi / 2).max() < 0.3


def test_narrow_failing_region_near_nominal_is_found() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        x = np.array(list(point.values()))
        wide = 1.2 * float(np.linalg.norm(x - [0.9, 0.9, 0.0]) < 0.5)
        narrow = 1.8 * float(np.exp(-((np.linalg.norm(x - [0.3, -0.25, 0.25]) / 0.25) ** 2)))
        return True, 10.0 - 0.5 * max(wide, narrow) + float(draws.normal(0.0, 0.05))

    space = space_of(
        a=Drift.range(0.0, 1.0, nominal=0.0),
        b=Drift.range(-0.5, 0.5, nominal=0.0),
        c=Drift.range(0.0, 1.0, nominal=0.0),
    )
    nearest = stressed(world, space, budget=600).failures[0]
    assert nearest.distance < 0.4  # the regions begin at distances of 0.27 and about 0.77


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_expected_failures_lie_a_little_beyond_the_true_boundary(seed: int) -> None:
    """The boundary of this world is the line 0.6 a + 0.8 b = 0.5, at a distance of 0.5."""
    space = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), b=Drift.range(0.0, 1.0, nominal=0.0))

    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        lost = 0.5 * (0.6 * point["a"] + 0.8 * point["b"]) / 0.5
        return True, 10.0 - lost + float(draws.normal(0.0, 0.05))

    found = stressed(world, space, seed=seed, budget=600)
    assert found.expected
    assert 0.5 <= found.expected[0].distance <= 0.6
    assert [one.distance for one in found.expected] == sorted(one.distance for one in found.expected)


def test_a_failure_is_approached_equally_closely_under_each_option() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        lost = abs(point["a"]) + 2.0 * abs(point["b"]) if point["camera"] else 0.0
        return True, 10.0 - lost + float(draws.normal(0.0, 0.05))

    space = space_of(
        a=Drift.range(0.0, 1.0, nominal=0.0),
        b=Drift.range(0.0, 1.0, nominal=0.0),
        camera=Drift.choice("up", "down"),
    )
    found = [one.distance for one in stressed(world, space, budget=600).combinations]
    # at the boundary, b is 0.25 or a little less with some a: 0.5 is lost at (0.1, 0.2), 0.224 from nominal
    assert sqrt(1.0 + 0.05) < min(found) < sqrt(1.0 + 0.3**2)


@pytest.mark.parametrize(("common", "own", "unpaired"), [(0.3, 0.0, False), (0.0, 0.3, True)])
def test_independent_rewards_save_nominal_episodes(common: float, own: float, unpaired: bool) -> None:
    space = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), b=Drift.range(0.0, 1.0, nominal=0.0))

    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        shared, alone = draws.normal(size=2)
        lost = 0.5 * (point["a"] + point["b"])
        # the noise of `common` is that of the nominal episode with the same seed, the other grows with the loss
        return True, 10.0 - lost + common * float(shared) + own * lost * float(alone)

    evaluator = evaluator_of(world, space)
    nearest = Nearest(evaluator, [])
    for number in range(12):
        nearest.tried.append({"a": 0.3 + 0.05 * number, "b": 0.4})
        evaluator.common(space.nominal, 4)
        evaluator.common(nearest.tried[-1], 4)
    assert nearest.unpaired is unpaired
