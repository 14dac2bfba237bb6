"""Chains of drifts that are tested on fresh seeds, from far beyond the boundary towards it."""

from __future__ import annotations

from itertools import pairwise
from math import hypot, inf

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import chains
from pytest_tarl.stressing.combinations import RECORDED, SHARES, Together, _share
from pytest_tarl.stressing.evaluating import NEAREST, SEARCH, SPENT, TURNS, BudgetSpentError, Evaluator
from pytest_tarl.stressing.findings import Curve
from pytest_tarl.stressing.nearest import Nearest
from pytest_tarl.stressing.rays import rays
from tests.plugin.stressing.worlds import evaluator_of, space_of

SQUARE = space_of(**{name: Drift.range(0.0, 1.0, nominal=0.0) for name in "ab"})


def sloping(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose the tolerated reward at 0.8 a + 0.6 b = 0.5."""
    return True, 10.0 - 0.8 * point["a"] - 0.6 * point["b"] + float(draws.normal(0.0, 0.05))


def independent(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose 0.8 a + 0.6 b, with noise that differs between drifts with the same seed."""
    noise = np.random.default_rng([int(draws.integers(2**31)), int(1e6 * (point["a"] + 2.0 * point["b"]))])
    return True, 10.0 - 0.8 * point["a"] - 0.6 * point["b"] + float(noise.normal(0.0, 0.2))


def searched(seed: int) -> tuple[Evaluator, Nearest]:
    evaluator = evaluator_of(sloping, SQUARE, seed=seed)
    curves = [Curve(ray) for ray in rays(SQUARE, {})]
    for curve in curves:
        curve.evidence.update({t: evaluator.glance(curve.ray.point(t)) for t in curve.ray.places})
    nearest = Nearest(evaluator, curves)
    nearest.approach(10)
    return evaluator, nearest


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_chain_leads_from_far_drifts_to_the_boundary(seed: int) -> None:
    evaluator, nearest = searched(seed)
    found = chains.chain(nearest, chains.FIRST, inf)
    assert len(found) == 1 + len(chains.FIRST.steps)
    assert len(evaluator.losses(found[-1])[0]) >= TURNS
    for point in found:
        assert 0.8 * point["a"] + 0.6 * point["b"] > 0.5
    distances = [nearest.distance(point) for point in found]
    assert distances == sorted(distances, reverse=True)
    for (far, near), (_, apart) in zip(pairwise(distances), chains.FIRST.steps[::-1], strict=True):
        assert far > apart * near
    assert chains.chain(nearest, chains.NEXT, 0.5) == []  # the boundary is at a distance of 0.5
    limit = 1.02 * distances[-1]
    assert all(nearest.distance(point) < limit for point in chains.chain(nearest, chains.FIRST, limit))


def test_failing_drifts_are_tested_where_the_model_erred() -> None:
    evaluator = evaluator_of(lambda point, _: (point["a"] + point["b"] < 0.9, 1.0), SQUARE)
    points = [{"a": 0.1 * number, "b": 0.1 * number} for number in range(1, 10)]
    nearest = Nearest(evaluator, [], [*points[::-1], {"a": 1.0, "b": 0.0}, {"a": 0.2, "b": 0.3}])
    for point in nearest.tried:
        evaluator.examine(point, 4)
    spent = evaluator.spent
    assert chains.clear(nearest) == [points[6], points[5], points[4]]
    assert evaluator.spent == spent
    nearest.tried = [points[8], points[0]]
    assert chains.clear(nearest) == [points[8]]
    nearest.tried = [points[0]]
    assert chains.clear(nearest) == []


def test_chain_ends_at_the_first_unconfirmed_drift() -> None:
    evaluator = evaluator_of(sloping, SQUARE)
    together = Together(0.02, [])
    far, middle, holding, nearer = ({"a": a, "b": 0.5} for a in (0.6, 0.4, 0.2, 0.1))
    assert together.confirm([far, middle, holding, nearer], evaluator)
    assert [one.point for one in together.found] == [far, middle]
    assert together.tested == [far, middle, holding]
    spent = evaluator.spent
    assert not together.confirm([far, middle], evaluator)  # known already
    assert evaluator.spent == spent
    assert not together.confirm([holding], evaluator)


def test_each_chain_has_its_own_seeds() -> None:
    evaluator = evaluator_of(independent, SQUARE)
    together = Together(0.02, [])
    one, other = {"a": 0.8, "b": 0.5}, {"a": 0.5, "b": 0.8}
    assert not evaluator.knows(one)
    with pytest.raises(KeyError):
        evaluator.losses(one)
    evaluator.examine(other, 4)
    before = evaluator.sources(other)
    assert {pool for pool, _ in before} == {SEARCH}
    together.confirm([one], evaluator)
    together.confirm([other], evaluator)
    losses, failed = evaluator.losses(one)
    assert len(losses) >= NEAREST[0]
    assert failed == 0
    assert np.mean(losses) == pytest.approx(0.94 / evaluator.guarantee.tolerance, abs=0.3)
    pools = {pool for pool, _ in [*evaluator.sources(one), *evaluator.sources(other)]}
    assert len(pools) == 3
    assert evaluator.sources(other)[: len(before)] == before
    assert len(evaluator.sources(other)) == len(evaluator.losses(other)[0])
    plans = [
        [plan.seed for plan, _ in evaluator.recalled(pool, at)]
        for pool, at in (("chain 0", one), ("chain 1", other))
    ]
    assert not set(plans[0]) & set(plans[1])


def test_chain_beyond_the_budget_yields_no_episodes() -> None:
    evaluator = evaluator_of(sloping, SQUARE, budget=NEAREST[0] + 3)  # enough for the drift, not for nominal
    point = {"a": 0.8, "b": 0.5}
    together = Together(0.02, [])
    with pytest.raises(BudgetSpentError):
        together.confirm([point], evaluator)
    assert together.tested == [point]
    assert not evaluator.knows(point)


def test_chain_risks_add_up_to_the_whole_risk() -> None:
    assert RECORDED + sum(_share(number) for number in range(60)) == pytest.approx(1.0)
    assert _share(len(SHARES)) > _share(len(SHARES) + 1) > 0.0
    assert sum(SPENT) == pytest.approx(1.0)
    assert len(SPENT) == len(NEAREST)


def test_chains_rarely_confirm_a_holding_drift() -> None:
    """Each chain goes from failing drifts to drifts that lose just what is tolerated; at a high risk, errors occur."""
    wrong = 0
    points = [{"a": a, "b": b} for a, b in ((0.9, 0.4), (0.625, 0.0), (0.5, 1.0 / 6.0), (0.35, 0.55 / 1.5))]
    assert [0.8 * point["a"] + 0.6 * point["b"] for point in points[1:]] == pytest.approx([0.5, 0.5, 0.5])
    for seed in range(100):
        together = Together(0.5, [])
        together.chains = 1  # its share is 0.3, so a test has the risk 0.15
        together.confirm(points, evaluator_of(independent, SQUARE, seed=seed))
        wrong += any(hypot(*one.point.values()) < 0.9 for one in together.found)
    assert wrong <= 0.15 * 100 + 11  # mean plus three standard errors
