"""In worlds with known boundaries, intervals contain the boundary at the stated confidence."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from math import comb, exp, log
from statistics import fmean

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import json_result, words
from pytest_tarl.stressing.evaluating import BudgetSpentError
from pytest_tarl.stressing.findings import CONFIDENCE, Curve
from pytest_tarl.stressing.guarantee import LEAST, Guarantee, Outcome, enough_pass
from pytest_tarl.stressing.holding import SHARES, holds, least
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.stress_run import along_rays, near_ends
from tests.plugin.stressing.worlds import World, evaluator_of, space_of, stressed
from tests.slow import SLOW

SIZE = Drift.range(0.0, 1.0, nominal=0.0)
SPACE = space_of(size=SIZE)
GUARANTEED = 0.95  # success rate of the worlds' guarantee
CONFIRMED_AT = 0.01
RUNS = 200 if SLOW else 4


def at(point: Point, draws: np.random.Generator) -> np.random.Generator:
    """Return noise that is independent at each point of a seed."""
    draws.random(int(point["size"] * 10_000) % 101)
    return draws


def rare_failures(edge: float, scale: float) -> World:
    """Return a world in which 5 % of the episodes fail at the edge; the noise of each point is independent."""
    centre = edge + scale * log(GUARANTEED / (1.0 - GUARANTEED))

    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        failing = 1.0 / (1.0 + exp(min((centre - point["size"]) / scale, 700.0)))
        return bool(at(point, draws).random() >= failing), 1.0

    return world


def own_limits(edge: float, scale: float) -> World:
    """Return a world in which each seed fails beyond its own drift size, 5 % of the seeds before the edge."""
    return lambda point, draws: (bool(point["size"] < edge + scale * (draws.gumbel() + log(-log(0.05)))), 1.0)


def lost_reward(edge: float, scale: float) -> World:
    """Return a world whose mean loss at the edge is the tolerated one, 0.5."""
    return lambda point, draws: (
        True,
        10.0 - 0.5 * point["size"] / edge + float(at(point, draws).normal(0.0, scale)),
    )


def run(world: World, seed: int) -> Curve:
    """Return the curve of a run with the budget of benchmarks/stress.py."""
    evaluator = evaluator_of(world, SPACE, seed=seed, budget=246)
    (curve,) = (Curve(ray) for ray in rays(SPACE, {}))
    with suppress(BudgetSpentError):
        along_rays([curve], evaluator, CONFIRMED_AT)
        near_ends([curve], evaluator)
    return curve


def searched(curve: Curve) -> tuple[float, float]:
    """Return the interval that the episodes of the search alone would give."""
    fails = min(t for t, one in curve.evidence.items() if one.result == "fails")
    return max(
        (t for t, one in curve.evidence.items() if one.result == "holds" and t < fails), default=0.0
    ), fails


@pytest.mark.parametrize(
    ("make", "scale", "narrow"),
    [
        (rare_failures, 0.01, 0.2),
        (rare_failures, 0.05, 0.7),
        (own_limits, 0.02, 0.2),
        (lost_reward, 0.1, 0.7),
    ],
)
def test_intervals_contain_the_boundary_and_are_narrow(
    make: Callable[[float, float], World], scale: float, narrow: float
) -> None:
    edges = np.random.default_rng(3).uniform(0.2, 0.7, RUNS).tolist()
    curves = [run(make(edge, scale), seed) for seed, edge in enumerate(edges)]
    found = [(edge, one, one.boundary) for edge, one in zip(edges, curves, strict=True) if one.boundary]
    contained = [(one.near or 0.0) <= edge <= one.far for edge, _, one in found]
    before = [
        low <= edge <= high for edge, (low, high) in ((edge, searched(curve)) for edge, curve, _ in found)
    ]
    assert len(found) >= 0.9 * RUNS
    assert sum(contained) >= CONFIDENCE * len(found)
    assert fmean(one.far - (one.near or 0.0) for _, _, one in found) < narrow
    if make is rare_failures:  # the search misses these failures, so this test could fail
        assert sum(before) <= 0.75 * len(found)


@pytest.mark.parametrize("share", [0.6, 0.9, 0.95, 0.98])
@pytest.mark.parametrize("risk", [0.08, 0.01])
def test_tests_of_one_drift_size_share_the_risk(share: float, risk: float) -> None:
    total = 0.0
    for allowed, part in enumerate(SHARES):
        episodes = least(share, allowed, part * risk)
        total += sum(
            comb(episodes, failed) * share ** (episodes - failed) * (1.0 - share) ** failed
            for failed in range(allowed + 1)
        )
        given_ = Guarantee(share, 1.0, (1.0,), 1.0)
        passed = [Outcome(True, 1.0)] * (episodes - allowed) + [Outcome(False, 1.0)] * allowed
        assert enough_pass(given_, passed, part * risk)
        assert episodes == LEAST or not enough_pass(given_, passed[1:], part * risk)
    assert total <= risk


def test_failing_values_are_rarely_declared_to_hold() -> None:
    shown = 0
    for seed in range(20):
        evaluator = evaluator_of(rare_failures(0.5, 0.05), SPACE, seed=seed)
        shown += holds(rays(SPACE, {})[0], 0.51, evaluator, 0.05, 16)
    assert shown <= 4  # exceeded with probability 0.003 if each is shown at 5 %


def test_early_end_prints_only_the_far_end() -> None:
    found = stressed(own_limits(0.4, 0.005), SPACE, budget=130)
    (size,) = (sentences for name, sentences in words.directions(found) if name == "size")
    assert "(boundary not beyond 0.4" in size[0]
    boundary = json_result.document(found)["directions"][0]["boundary"]
    assert (boundary["held_up_to"], boundary["confidence"]) == (None, CONFIDENCE)


def test_suspected_direction_holds_up_to_the_failure() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool(draws.random() > 0.07 * (point["size"] > 0.8)), 1.0  # too rare to be confirmed

    for seed in range(40):
        (curve,) = stressed(world, SPACE, seed=seed).curves
        if curve.failing and curve.confirmed is None:
            break
    assert curve.confirmed is None
    assert curve.held is not None
    assert 0.3 < curve.held <= 0.8


def test_a_direction_without_failures_is_shown_to_hold() -> None:
    space = space_of(size=SIZE, camera=Drift.choice("up", "down"))
    found = dict(
        words.directions(stressed(lambda _, draws: (True, float(draws.normal(1.0, 0.1))), space, budget=4000))
    )
    assert found["size"][1] == "The guarantee holds while size ≤ 1 (90 % each)."
    assert found["camera"] == ["No failure found with camera='down'; the guarantee holds (90 %)."]
