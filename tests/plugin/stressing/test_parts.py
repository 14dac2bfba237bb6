"""The part of the guarantee that a chain tests, and the drifts that chains of failures add."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import chains
from pytest_tarl.stressing.combinations import APART, Together, _apart
from pytest_tarl.stressing.coordinates import Coordinates, Vector
from pytest_tarl.stressing.findings import failure
from pytest_tarl.stressing.guarantee import Guarantee, Outcome, hopeless, most_passed, refuted
from pytest_tarl.stressing.surrogates import RateField, covariance
from tests.plugin.stressing.worlds import evaluator_of, space_of

SQUARE = space_of(**{name: Drift.range(0.0, 1.0, nominal=0.0) for name in "ab"})
GIVEN = Guarantee(0.95, 0.5, (1.0,) * 100, 1.0)


@dataclass
class Told:
    """A search whose model predicts probabilities from the first coordinate of a drift."""

    by_loss: dict[float, float]
    by_rate: dict[float, float]
    luck: float = 0.0

    coordinates = Coordinates(SQUARE, SQUARE.nominal)

    def model(self) -> Told:
        return self

    def shown_by(self, vectors: Vector) -> tuple[Vector, Vector]:
        return np.array([self.by_loss[one] for one in vectors[:, 0]]), np.array(
            [self.by_rate[one] for one in vectors[:, 0]]
        )

    def distance(self, point: Point) -> float:
        return hypot(*point.values())


def at(a: float, b: float = 0.0) -> Point:
    return {"a": a, "b": b}


@pytest.mark.parametrize(
    ("by_loss", "by_rate", "part"),
    [
        ((0.0, 0.0), (0.9, 0.6), "rate"),
        ((1.0, 0.3), (0.9, 0.4), "rate"),
        ((1.0, 0.6), (0.9, 0.4), "both"),
        ((0.0, 0.0), (0.4, 0.6), "both"),  # the first test would hardly show the failure
        ((1.0, 0.6), (0.04, 0.01), "loss"),
    ],
)
def test_model_decides_what_a_chain_tests(
    by_loss: tuple[float, float], by_rate: tuple[float, float], part: str
) -> None:
    nearest: Any = Told(
        dict(zip((1.0, 0.5), by_loss, strict=True)), dict(zip((1.0, 0.5), by_rate, strict=True))
    )
    assert chains.part_of(nearest, [at(1.0), at(0.5)]) == part
    assert chains.part_of(nearest, []) == "both"


def test_failure_chain_continues_in_short_steps() -> None:
    alike: Any = Told({}, {}, luck=1.0)
    found = [point["a"] for point in chains.finer(alike, [at(0.8), at(0.5)], "rate")]
    assert found[:5] == [0.8, *(pytest.approx(0.5 * share) for share in chains.OUTWARD), 0.5]
    assert found[5:] == [pytest.approx(0.5 * share) for share in chains.INWARD]
    assert found == sorted(found, reverse=True)
    assert [point["a"] for point in chains.finer(alike, [at(0.53), at(0.5)], "rate")][:3] == [
        0.53,
        pytest.approx(0.52),
        0.5,
    ]
    independent: Any = Told({}, {})
    assert [point["a"] for point in chains.finer(independent, [at(0.8), at(0.5)], "rate")][:3] == [
        0.8,
        0.5,
        pytest.approx(0.5 * chains.INWARD[0]),
    ]


def test_failures_beyond_a_similar_nearer_one_are_omitted() -> None:
    evaluator = evaluator_of(lambda point, _: (point["a"] < 0.9, 1.0), SQUARE)
    every = [failure(SQUARE, point) for point in (at(0.6), at(0.51), at(0.505), at(0.5), at(0.4, 0.31))]
    assert 0.505 < 0.51 < APART * 0.5 < 0.6
    assert _apart(every, evaluator) == [every[0], every[3], every[4]]
    assert _apart([], evaluator) == []


def test_test_of_one_reward_part_has_the_whole_risk() -> None:
    fine, failed, poor = Outcome(True, 1.0), Outcome(False, 1.0), Outcome(True, -9.0)
    nominal = [fine] * 16
    failing, losing = [failed] * 8 + [fine] * 8, [poor] * 16
    assert refuted(GIVEN, failing, nominal, 0.01, "rate")
    assert not refuted(GIVEN, failing, nominal, 0.01, "loss")
    assert refuted(GIVEN, losing, nominal, 0.01, "loss")
    assert not refuted(GIVEN, losing, nominal, 0.01, "rate")
    assert hopeless(GIVEN, losing, nominal, 64, 0.01, "rate")
    assert not hopeless(GIVEN, losing, nominal, 64, 0.01, "loss")
    assert not hopeless(GIVEN, failing, nominal, 64, 0.01, "rate")
    assert hopeless(GIVEN, failing, nominal, 64, 0.01, "loss")
    assert most_passed(GIVEN, 64, 0.01, "rate") == most_passed(GIVEN, 64, 0.02)


def test_common_failures_are_explained_by_their_seeds() -> None:
    """Of eight drifts with two pairs of seeds in turn, those on the second pair fail, wherever they are."""
    vectors = np.array([[0.1 * number, 0.0] for number in range(1, 9)])
    failed, episodes = np.array([0.0, 2.0] * 4), np.full(8, 2.0)
    used = np.kron(np.ones((4, 1)), np.eye(2))
    prior = covariance(vectors, vectors)
    plain = RateField(prior, 9.0, failed, episodes, -5.0)
    lucky = RateField(prior, 9.0, failed, episodes, -5.0, plain.logits, 4.0 * used @ used.T)
    assert lucky.evidence > plain.evidence
    even = np.array([0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0])
    steep = RateField(prior, 9.0, even, episodes, -5.0)
    assert (
        RateField(prior, 9.0, even, episodes, -5.0, steep.logits, 4.0 * used @ used.T).evidence
        < steep.evidence
    )


def test_omitted_failure_does_not_hide_farther_ones() -> None:
    evaluator = evaluator_of(lambda point, _: (point["a"] < 0.45, 1.0), SQUARE)
    together = Together(0.5, [])
    assert together.confirm([at(0.53, 0.1), at(0.51, 0.1)], evaluator)
    assert together.confirm([at(0.495, 0.1)], evaluator)
    assert [one.point["a"] for one in together.every] == [0.53, 0.51, 0.495]
    assert [one.point["a"] for one in together.found] == [0.53, 0.495]
