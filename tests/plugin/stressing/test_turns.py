"""Drifts of the search use different seeds in turn, and the model chooses some of the drifts."""

from __future__ import annotations

from itertools import islice
from math import sqrt

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.evaluating import GLANCE, SEARCH, TURNS
from pytest_tarl.stressing.guarantee import Guarantee
from pytest_tarl.stressing.nearest import DESCENDED, EXPLORED, GUIDED, Nearest
from pytest_tarl.stressing.prediction import Prediction, Sample, Shown, shared_error
from pytest_tarl.stressing.spreading import SHORTER, around
from tests.plugin.stressing.worlds import evaluator_of, space_of

GIVEN = Guarantee(0.95, 0.5, (1.0,) * 100, 1.0)
SQUARE = space_of(**{name: Drift.range(0.0, 1.0, nominal=0.0) for name in "ab"})


def sloping(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose the tolerated reward at 0.8 a + 0.6 b = 0.5."""
    return True, 10.0 - 0.8 * point["a"] - 0.6 * point["b"] + float(draws.normal(0.0, 0.05))


def test_drifts_start_at_different_seeds() -> None:
    evaluator = evaluator_of(lambda _, draws: (True, float(draws.normal(0.0, 5.0))), SQUARE)
    seeds = list(episode_seeds(evaluator.seed, "stress world search", 2 * TURNS))
    for turn in (0, 3, TURNS // GLANCE - 1, TURNS // GLANCE):
        point = {"a": 0.01 * (turn + 1), "b": 0.5}
        evaluator.glance(point, turn)
        first = turn * GLANCE % TURNS
        ran = [plan.seed for plan, _ in evaluator.recalled(SEARCH, point)]
        assert ran == seeds[first : first + GLANCE]
        assert evaluator.losses(point)[0] == [0.0] * GLANCE  # the reward depends on the seed alone
        evaluator.common(point, TURNS + 1)
        ran = [plan.seed for plan, _ in evaluator.recalled(SEARCH, point)]
        assert sorted(ran) == sorted(seeds[: TURNS + 1])
        assert not any(failed for _, failed in evaluator.recalled(SEARCH, point))


def test_evaluating_a_drift_again_uses_its_first_seeds() -> None:
    evaluator = evaluator_of(sloping, SQUARE)
    point = {"a": 0.5, "b": 0.5}
    evaluator.glance(point, 3)
    spent = evaluator.spent
    evaluator.glance(point, 5)
    assert evaluator.spent == spent
    assert evaluator.rows(point, GLANCE) == [3 * GLANCE, 3 * GLANCE + 1]
    assert evaluator.rows(SQUARE.nominal, GLANCE) == [0, 1]


def test_drifts_with_different_seeds_make_the_model_more_certain() -> None:
    coordinates = Coordinates(SQUARE, SQUARE.nominal)
    vectors = [np.array([0.5, 0.5]), np.array([0.51, 0.5])]
    given = evaluator_of(sloping, SQUARE).guarantee

    def deviation(rows: list[list[int]]) -> float:
        samples = [
            Sample(vector, 1.0, 0.2, 0, [(SEARCH, number) for number in row])
            for vector, row in zip(vectors, rows, strict=True)
        ]
        model = Prediction(coordinates, given, samples, Shown(0.05, 0.2), typical=0.08, paired=0.04)
        return float(model.moments(np.array([[0.5, 0.5]]))[1][0])

    assert deviation([[0, 1], [2, 3]]) < 0.95 * deviation([[0, 1], [0, 1]])


def test_nearby_vectors_are_shorter_and_similar() -> None:
    coordinates = Coordinates(SQUARE, SQUARE.nominal)
    best = np.array([0.3, 0.9])
    found = np.array(list(islice(around(coordinates, best, np.random.default_rng(0)), 100)))
    lengths = np.linalg.norm(found, axis=1)
    assert (found >= 0.0).all()
    assert (found <= 1.0).all()
    assert lengths.max() <= SHORTER[1] * np.linalg.norm(best)
    assert np.median(lengths) >= SHORTER[0] * np.linalg.norm(best)
    assert np.median(found @ best / lengths / np.linalg.norm(best)) > 0.9


def test_half_of_the_drifts_explore_expected_losses() -> None:
    """Only `a` changes the reward, and at the end of its range the loss is just tolerated."""
    evaluator = evaluator_of(lambda point, _: (True, 10.0 - 0.4 * point["a"]), SQUARE)
    nearest = Nearest(evaluator, [])
    for a in (0.3, 0.6, 0.9):
        for b in (0.3, 0.6, 0.9):
            nearest._probe({"a": a, "b": b})
    known = len(nearest.tried)
    nearest._explore()
    explored = nearest.tried[known:]
    assert len(explored) == EXPLORED + GUIDED  # nothing fails, so there is no best drift to go around
    spread, guided = explored[:EXPLORED], explored[EXPLORED:]
    assert min(point["a"] for point in guided) > np.mean([point["a"] for point in spread])


def test_drifts_around_the_best_drift_are_tried() -> None:
    evaluator = evaluator_of(sloping, SQUARE)
    nearest = Nearest(evaluator, [], [{"a": 0.9, "b": 0.6}])
    evaluator.examine(nearest.tried[0], 16)
    assert nearest.best == nearest.tried[0]
    nearest._explore()
    assert len(nearest.tried) == 1 + EXPLORED + GUIDED + DESCENDED
    for point in nearest.tried[-DESCENDED:]:
        assert 0.5 < np.hypot(point["a"], point["b"]) / np.hypot(0.9, 0.6) <= SHORTER[1] + 1e-9


def shared(seeds: int, own: float, common: float, typical: float, loss: float = 1.0) -> float:
    """Return the shared error of 60 drifts that use pairs of `seeds` in turn.

    `own` and `common` are the standard deviations of the factors of an episode and of a seed.
    """
    draws = np.random.default_rng(3)
    factors = 1.0 + common * draws.standard_normal(seeds)
    samples = []
    for number in range(60):
        row = [2 * number % seeds, (2 * number + 1) % seeds]
        losses = [loss * (factors[place] + own * draws.standard_normal()) for place in row]
        sources = [(SEARCH, place) for place in row]
        samples.append(Sample(np.array([0.5, 0.0]), float(np.mean(losses)), 0.1, 0, sources, losses))
    return shared_error(samples, np.full(60, loss), typical)


def test_common_seed_error_shrinks_with_the_number_of_seeds() -> None:
    assert shared(16, 0.0, 0.4, 0.0) == pytest.approx(0.4 / sqrt(16), rel=0.4)
    assert shared(60, 0.0, 0.4, 0.0) == pytest.approx(0.4 / sqrt(60), rel=0.4)
    assert shared(16, 0.3, 0.4, 0.3**2) == pytest.approx(0.4 / sqrt(16), rel=0.4)


def test_noise_of_each_episode_causes_no_shared_error() -> None:
    assert shared(16, 0.4, 0.0, 0.4**2) < 0.03
    assert shared(16, 0.4, 0.0, 0.0) > 0.03  # the noise of a seed's mean, if `typical` does not explain it


@pytest.mark.parametrize("loss", [0.2, 2.5, 0.0, -1.0])
def test_clipped_losses_give_no_seed_factors(loss: float) -> None:
    assert shared(16, 0.0, 0.4, 0.0, loss) == 0.0


def test_shared_error_grows_with_the_loss() -> None:
    coordinates = Coordinates(SQUARE, SQUARE.nominal)
    known = [(0.4, 0.5), (0.8, 1.0)]
    factors = [0.7, 1.3, 0.6, 1.4]
    plain, aware = (
        Prediction(
            coordinates,
            GIVEN,
            [
                Sample(
                    np.array([t, 0.0]),
                    loss,
                    0.01,
                    0,
                    [(SEARCH, place) for place in range(4)],
                    [loss * one for one in factors][: 4 * known_losses],
                )
                for t, loss in known
            ],
            Shown(0.1, 0.5),
            0.0001,
            0.0,
        )
        for known_losses in (0, 1)
    )
    asked = np.array([[0.0, 0.0], [0.4, 0.0], [0.8, 0.0]])
    (mean, deviation), (same, larger) = (one.moments(asked) for one in (plain, aware))
    assert same == pytest.approx(mean)
    rise = np.sqrt(larger**2 - deviation**2)
    assert rise == pytest.approx(np.sqrt(0.125) / 2 * np.array([0.0, 0.5, 1.0]), abs=0.02)
