"""The models that choose the drifts to test, on a few values checked by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.stressing import prediction, surrogates
from pytest_tarl.stressing.combinations import Together, pairs
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.findings import (
    Curve,
)
from pytest_tarl.stressing.fresh_values import CENTRES, SCALES, Model
from pytest_tarl.stressing.guarantee import (
    Evidence,
)
from pytest_tarl.stressing.holding import _values
from tests.plugin.stressing.test_words_by_hand import (
    DOWN,
    FLAT,
    GIVEN,
    MUD,
    SPACE,
    STEEP,
    combined,
    curve,
    seen,
)


def test_probability_of_few_failures_is_binomial() -> None:
    model = Model({0.5: seen(1.0)}, 0.5)
    weights = np.zeros((len(CENTRES), len(SCALES)))
    weights[100, -1] = 1.0  # an episode fails beyond 0.5, and in half of the cases at 0.5
    model.__dict__["_weights"] = weights
    assert CENTRES[100] == pytest.approx(0.5)
    assert model._passing(0.5, 3, 3) == pytest.approx(1 / 8)
    assert model._passing(0.5, 3, 2) == pytest.approx(4 / 8)
    assert model._passing(0.5 + SCALES[-1] * np.log(3.0), 2, 1) == pytest.approx(1 - (3 / 4) ** 2)


@pytest.mark.parametrize(
    ("one", "values", "paired"),
    [
        (curve(DOWN, {1.0: 1.0}), (1.0, 0.0), 16),
        (curve(MUD, {1.0: 1.0}), (1.0, 0.5), 32),
        (curve(MUD, {0.25: -1.0}), (0.0, 0.0), 16),
    ],
)
def test_sizes_for_holding_tests_are_known(one: Curve, values: tuple[float, float], paired: int) -> None:
    evaluator: Any = SimpleNamespace(guarantee=GIVEN)
    assert _values(one, evaluator) == (values, paired)


def test_holding_tests_lie_inside_the_boundary() -> None:
    evaluator: Any = SimpleNamespace(guarantee=GIVEN)
    evidence = {t: Evidence("holds", 1.0, 60, 60, 0.0, 0.01) for t in (0.25, 0.5)}
    one = Curve(MUD, {**evidence, 0.75: Evidence("fails", -1.0, 60, 0, 0.0, 0.01)})
    (first, second), paired = _values(one, evaluator)
    assert 0.3 < first <= 0.5
    assert (second, paired) == (first / 2, 16)
    wide = {
        t: replace(found, spread=0.65) for t, found in evidence.items()
    }  # 3 · 0.65 · √(1 / 60 + 1 / 16) > 0.5
    (farther, _), more = _values(Curve(MUD, wide), evaluator)
    assert (farther > 0.0, more) == (True, 32)


def test_pairs_beyond_a_known_failure_are_not_tested() -> None:
    ran: list[Any] = []

    def examine(point: Any, most: int) -> Evidence:
        ran.append(dict(point))
        return seen(-1.0)

    evaluator: Any = SimpleNamespace(space=SPACE, examine=examine)
    inside = [curve(MUD, {1.0: 1.0}), curve(FLAT, {1.0: 1.0}), curve(STEEP, {1.0: 1.0})]
    together = Together(0.1, inside, [combined(mud=0.0, slope=1.0)])
    proposed: list[Any] = []
    pairs(evaluator, together, proposed)
    assert (ran, proposed, together.tried) == ([], [], 0)  # all pairs are as far as the known one
    free = Together(0.1, inside)
    pairs(evaluator, free, proposed)
    assert free.tried == 2  # pairs never combine both ends of one range
    assert {one["slope"] for one in ran if one["mud"] == 0.0} == {-1.0, 1.0}
    assert len(proposed) == 2
    assert all(one["mud"] > 3.8 for one in proposed)  # bisected towards nominal


def test_the_prior_covariance_of_two_drifts_equals_the_formula() -> None:
    one, other = np.array([[0.3, 0.0]]), np.array([[0.1, -0.2], [0.3, 0.0]])

    def smooth(a: float, b: float, squares: float) -> float:
        """Return a term of the prior covariance of two drifts, from squared distances to nominal and to each other."""
        return float(np.exp(-squares / (2 * 0.3**2)) - np.exp(-(a + b) / (2 * 0.3**2)))

    far = (
        2 * 1.0 * 0.03 + 2 * 4.0 * 0.03**2 + 0.3 * smooth(0.09, 0.01, 0.04) + 0.15 * smooth(0.09, 0.05, 0.08)
    )
    same = 2 * 1.0 * 0.09 + 2 * 4.0 * 0.09**2 + (0.3 + 0.15) * smooth(0.09, 0.09, 0.0)
    assert surrogates.covariance(one, other) == pytest.approx(np.array([[far, same]]))


def model(samples: list[tuple[float, float]], failed: int = 0) -> prediction.Prediction:
    """Return the model of drifts along mud, each by its coordinate and its mean loss of 32 episodes."""
    coordinates = Coordinates(SPACE, SPACE.nominal)
    sources = [("search", number) for number in range(32)]
    tried = [prediction.Sample(np.array([-t, 0.0]), loss, 0.01, failed, sources) for t, loss in samples]
    return prediction.Prediction(coordinates, GIVEN, tried, prediction.Shown(0.1, 0.5), 0.01, 0.005)


def test_model_predicts_measured_losses() -> None:
    found = model([(0.2, 0.4), (0.4, 0.8), (0.8, 1.6)])
    margins = found.margins(np.array([[0.0, 0.0], [-0.2, 0.0], [-0.4, 0.0], [-0.8, 0.0], [-0.6, 0.0]]))
    assert margins == pytest.approx([1.0, 0.6, 0.2, -0.6, -0.2], abs=0.03)
    # a loss of 1.1 can be shown, by definition in `model`
    assert found.excess(np.array([[-0.55, 0.0]])) == pytest.approx([0.0], abs=0.03)
    assert found.deeper(2.0).excess(np.array([[-0.6, 0.0]])) == pytest.approx([0.0], abs=0.03)


def test_shortest_failing_vector_has_a_detectable_loss() -> None:
    found = model([(0.2, 0.4), (0.4, 0.8), (0.8, 1.6)])
    vector = found.shortest(0.0, 2.0, np.random.default_rng(0))
    assert vector is not None
    assert found.excess(vector[None])[0] >= 0.0
    assert found.excess(0.97 * vector[None])[0] < 0.0
    assert np.linalg.norm(vector) < 0.57
    assert found.shortest(0.0, 0.3, np.random.default_rng(0)) is None
    cautious = found.shortest(1.0, 2.0, np.random.default_rng(0))
    assert cautious is not None
    assert np.linalg.norm(cautious) > np.linalg.norm(vector)


def test_failing_drift_violates_the_guarantee_at_any_reward() -> None:
    vectors = np.array([[-0.4, 0.0]])
    assert model([(0.4, 0.0)]).failing(vectors)[0] < 0.01
    assert model([(0.4, 0.0)], failed=30).failing(vectors)[0] > 0.9


def test_vectors_beyond_the_limit_are_shortened() -> None:
    draws: Any = SimpleNamespace(random=lambda count: np.full(count, 0.0625))
    # the first is shortened to 0.5 · 0.0625^0.25 = 0.25, the other stays at 0.4
    found = prediction._within(np.array([[-0.8, 0.0], [-0.4, 0.0]]), 0.5, draws)
    assert found == pytest.approx(np.array([[-0.25, 0.0], [-0.4, 0.0]]))
