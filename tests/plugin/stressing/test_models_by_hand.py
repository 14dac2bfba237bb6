"""The models that choose drifts to test, on few values worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.stressing import prediction
from pytest_tarl.stressing.candidates import CENTRES, SCALES, Model
from pytest_tarl.stressing.combinations import Together, pairs
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.findings import (
    Curve,
)
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


def test_the_chance_that_few_of_some_episodes_fail_is_binomial() -> None:
    model = Model({0.5: seen(1.0)}, 0.5)
    weights = np.zeros((len(CENTRES), len(SCALES)))
    weights[100, -1] = 1.0  # an episode fails beyond 0.5, in half of the cases there
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
def test_values_that_are_tested_to_hold(one: Curve, values: tuple[float, float], paired: int) -> None:
    evaluator: Any = SimpleNamespace(guarantee=GIVEN)
    assert _values(one, evaluator) == (values, paired)


def test_values_before_a_boundary_lie_inside_it() -> None:
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


def test_pairs_are_tested_unless_they_are_farther_than_what_is_known() -> None:
    ran: list[Any] = []

    def examine(point: Any, most: int) -> Evidence:
        ran.append(dict(point))
        return seen(-1.0)

    evaluator: Any = SimpleNamespace(space=SPACE, examine=examine)
    inside = [curve(MUD, {1.0: 1.0}), curve(FLAT, {1.0: 1.0}), curve(STEEP, {1.0: 1.0})]
    together = Together(0.1, inside, [combined(mud=0.0, slope=1.0)])
    proposed: list[Any] = []
    pairs(evaluator, together, proposed)
    assert (ran, proposed, together.tried) == ([], [], 0)  # the only pairs are as far as the one known
    free = Together(0.1, inside)
    pairs(evaluator, free, proposed)
    assert free.tried == 2  # not both ends of one range
    assert {one["slope"] for one in ran if one["mud"] == 0.0} == {-1.0, 1.0}
    assert len(proposed) == 2
    assert all(one["mud"] > 3.8 for one in proposed)  # bisected towards nominal


def test_the_prior_of_a_prediction() -> None:
    one, other = np.array([[0.3, 0.0]]), np.array([[0.1, -0.2], [0.3, 0.0]])
    local = 0.15 * np.exp(-(0.2**2 + 0.2**2) / (2 * 0.25**2))
    expected = [[4.0 * 2 * 0.03**2 + local, 4.0 * 2 * 0.09**2 + 0.15]]
    assert prediction._covariance(one, other) == pytest.approx(np.array(expected))
    assert prediction._variance(other) == pytest.approx(
        [prediction._covariance(row[None], row[None])[0, 0] for row in np.array([[0.1, 0.2], [0.3, 0.0]])]
    )


def test_losses_along_directions_add_up_where_nothing_else_is_known() -> None:
    coordinates = Coordinates(SPACE, SPACE.nominal)
    curves = [curve(MUD, {0.5: 0.75, 1.0: 0.5}), curve(STEEP, {0.5: 0.5}), curve(FLAT, {1.0: -9.0})]
    places, lost = prediction._knots(coordinates, curves, "slope")
    assert (places.tolist(), lost.tolist()) == ([-0.5, 0.0, 0.25], [2.5, 0.0, 0.5])
    model = prediction.Prediction(coordinates, curves, [])
    some = np.array([[0.0, 0.0], [-0.25, 0.125], [-1.0, 0.5], [0.0, -0.5]])
    means, deviations = model.moments(some)
    assert means == pytest.approx([1.0, 1.0 - 0.125 - 0.25, 0.0, -1.5])
    assert deviations == pytest.approx(np.sqrt(prediction._variance(some)))
    tried = [prediction.Sample(np.array([-0.25, 0.125]), -1.0, 0.01)]
    informed = prediction.Prediction(coordinates, curves, tried)
    assert informed.margins(some[1:2]) == pytest.approx([-1.0], abs=0.01)
    assert informed.moments(some[1:2])[1] == pytest.approx([0.01], abs=0.001)


def test_vectors_beyond_the_limit_are_shortened_and_the_nearest_failing_one_wins() -> None:
    coordinates = Coordinates(SPACE, SPACE.nominal)
    sure = [prediction.Sample(np.array([-t, 0.0]), -1.0, 0.01) for t in (0.2, 0.4, 0.8)]
    model = prediction.Prediction(coordinates, [curve(MUD, {0.2: -1.0, 1.0: -1.0})], sure)
    draws: Any = SimpleNamespace(random=lambda count: np.full(count, 0.0625))
    best, gain = model._largest(np.array([[-0.8, 0.0], [-0.4, 0.0]]), 0.5, draws)
    # the first is shortened to 0.5 · 0.0625^0.25 = 0.25, the other stays at 0.4
    assert best.tolist() == pytest.approx([-0.25, 0.0])
    assert 0.2 < gain <= 0.25
    none, nothing = model._largest(np.array([[-0.4, 0.0]]), 0.4, draws)
    assert (none.tolist(), nothing) == ([-0.4, 0.0], 0.0)
