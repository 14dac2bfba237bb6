"""The search finds the known boundaries and failing combinations of small worlds."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from math import sqrt
from statistics import NormalDist

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl import Drift
from pytest_tarl.learning.bounds import Range
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import evaluating, json_result, page, words
from pytest_tarl.stressing.combinations import Together
from pytest_tarl.stressing.evaluating import BudgetSpentError
from pytest_tarl.stressing.findings import Curve, failure
from pytest_tarl.stressing.guarantee import Guarantee, Outcome, examined, refuted
from pytest_tarl.stressing.rays import distance, rays
from pytest_tarl.stressing.stress_run import explore
from tests.plugin.stressing.worlds import Simulated, evaluator_of, space_of, stressed
from tests.slow import slow

MUD = Drift.range(0.0, 1.0, nominal=1.0)
SLOPE = Drift.range(-0.5, 0.5, nominal=0.0)
CAMERA = Drift.choice("up", "down", "left")


def noisy(total: float, draws: np.random.Generator, spread: float = 0.2) -> tuple[bool, float]:
    return True, total + float(draws.normal(0.0, spread))


@settings(max_examples=12)
@given(st.floats(0.1, 0.9), st.integers(0, 1000))
def test_the_boundary_of_a_lost_reward_is_found(edge: float, seed: int) -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return noisy(
            10.0 - 0.5 * (1.0 - point["mud"]) / (1.0 - edge), draws
        )  # the loss at `edge` is 0.5, the tolerance

    found = stressed(world, space_of(mud=MUD), seed=seed)
    boundary = found.curves[0].boundary
    assert boundary is not None
    value = found.curves[0].ray.value
    assert value(boundary.at) == pytest.approx(edge, abs=0.1)
    assert value(boundary.far) < edge + 0.02
    assert boundary.near <= boundary.at <= boundary.far


@settings(max_examples=12)
@given(st.floats(0.1, 0.9), st.integers(0, 1000))
def test_the_boundary_of_failed_missions_is_found(edge: float, seed: int) -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool(point["mud"] > edge + draws.normal(0.0, 0.01)), 1.0

    found = stressed(world, space_of(mud=MUD), seed=seed)
    boundary = found.curves[0].boundary
    assert boundary is not None
    # the guarantee allows 5 % of failed missions
    allowed = edge + NormalDist(0.0, 0.01).inv_cdf(0.95)
    assert found.curves[0].ray.value(boundary.at) == pytest.approx(allowed, abs=0.03)


def test_both_ends_of_a_range_have_separate_boundaries() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return -0.4 < point["slope"] < 0.1, float(draws.normal(1.0, 0.01))

    down, up = stressed(world, space_of(slope=SLOPE)).curves
    assert down.boundary is not None
    assert up.boundary is not None
    assert down.ray.value(down.boundary.at) == pytest.approx(-0.4, abs=0.02)
    assert up.ray.value(up.boundary.at) == pytest.approx(0.1, abs=0.02)


def test_options_are_examined_separately() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return point["camera"] != 1.0, 1.0

    found = stressed(world, space_of(camera=CAMERA))
    told = dict(words.directions(found))
    assert told["camera"] == [
        "Fails with camera='down'.",
        "No failure found with camera='left'; the guarantee holds (90 %).",
    ]


def test_harmless_directions_are_reported_as_harmless() -> None:
    found = stressed(lambda _, draws: noisy(10.0, draws), space_of(mud=MUD, slope=SLOPE), budget=300)
    assert found.failures == ()
    told = "\n".join(words.lines(found))
    assert "Not affected by mud: no failure found from 0 to 1 (4 values)." in told
    assert "No combination was found that fails although each of its changes alone passes" in told


@pytest.mark.parametrize("spread", [0.1, 1.5])
def test_noise_alone_rarely_gives_a_boundary(spread: float) -> None:
    def world(_: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool(draws.random() < 0.96), float(draws.normal(10.0, spread))

    found = [stressed(world, space_of(mud=MUD, slope=SLOPE), seed=seed, budget=250) for seed in range(3)]
    assert not any(one.failures for one in found)


def test_failures_in_an_interval_are_not_monotone() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return not 0.4 < point["mud"] < 0.6, float(draws.normal(1.0, 0.01))

    (curve,) = stressed(world, space_of(mud=MUD)).curves
    assert curve.boundary is not None
    assert not curve.boundary.monotone
    assert curve.ray.value(curve.boundary.at) == pytest.approx(0.6, abs=0.02)


def test_two_directions_that_fail_only_together_are_found() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool((1.0 - point["mud"]) + abs(point["slope"]) < 1.2), float(draws.normal(1.0, 0.01))

    space = space_of(mud=MUD, slope=SLOPE)
    found = stressed(world, space, budget=700)
    assert all(curve.confirmed is None for curve in found.curves)
    nearest = found.failures[0]
    assert nearest.names == ("mud", "slope")
    # the true distance is 1.2 / √2, or larger because slope ends at 0.5: (0.7, 0.5)
    assert sqrt(0.7**2 + 0.5**2) * 0.98 <= nearest.distance < sqrt(0.7**2 + 0.5**2) * 1.12
    assert "although no failure was found with each change alone" in "\n".join(words.together(found))


def test_text_claims_single_changes_hold_only_without_counterexample() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool((1.0 - point["mud"]) + abs(point["slope"]) < 0.6), float(draws.normal(1.0, 0.01))

    found = replace(stressed(world, space_of(mud=MUD, slope=SLOPE), combined=False), expected=())
    both = {"mud": 0.3, "slope": 0.2}  # mud = 0.4 fails already
    told = list(words.together(replace(found, combinations=(failure(found.space, both),))))
    assert told == ["Fails with mud=0.3 and slope=0.2 (distance 0.73)."]
    apart = {"mud": 0.6, "slope": 0.3}
    told = list(words.together(replace(found, combinations=(failure(found.space, apart),))))
    assert told == [
        "Fails with mud=0.6 and slope=0.3 (distance 0.5), although no failure was found with each change alone."
    ]


@slow
def test_a_corner_of_four_directions_is_found_and_shrunk() -> None:
    names = ("a", "b", "c", "d")

    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return point["a"] + point["b"] + point["c"] < 1.5, float(draws.normal(1.0, 0.01))

    space = space_of(**{name: Drift.range(0.0, 1.0, nominal=0.0) for name in names})
    nearest = stressed(world, space, budget=6000).failures[0]
    assert nearest.distance < 1.1  # the best distance is √0.75, that of the nearest pair √1.25
    assert nearest.point["d"] < 0.2


@slow
def test_a_spent_budget_keeps_the_findings_so_far() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool(point["mud"] > 0.5), 1.0

    whole = stressed(world, space_of(mud=MUD, slope=SLOPE))
    assert whole.ended == ""
    for budget in range(32, whole.episodes, 40):
        found = stressed(world, space_of(mud=MUD, slope=SLOPE), budget=budget)
        assert (found.ended, found.episodes <= budget) == ("budget", True)
        jsonschema.validate(json_result.document(found), json_result.schema())
        assert page.render(found)
        assert "did not suffice" in list(words.lines(found))[-1]


@given(
    st.floats(0.2, 0.8),
    st.floats(0.1, 0.4),
    st.integers(0, 99),
    st.sampled_from([64, 200, 300]),
)
@settings(max_examples=5)
def test_same_seed_gives_the_same_bytes(edge: float, tilt: float, seed: int, budget: int) -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool(point["mud"] > edge), 10.0 - abs(point["slope"]) / tilt + float(draws.normal(0.0, 0.3))

    space = space_of(mud=MUD, slope=SLOPE, camera=CAMERA)
    one, other = (stressed(world, space, seed=seed, budget=budget) for _ in range(2))
    assert json_result.text(one) == json_result.text(other)
    assert page.render(one) == page.render(other)
    plans = []
    for workers in (1, 4):
        evaluator = evaluator_of(world, space, seed=seed)
        simulated = Simulated(world, workers=workers)
        evaluator.rollout = simulated
        evaluator.examine(rays(space, {})[0].point(0.3), 32)
        plans.append([(plan.seed, plan.point) for plan in simulated.plans])
    assert plans[0] == plans[1]


def test_margin_is_one_as_designed_and_zero_at_the_guarantee() -> None:
    given_ = evaluator_of(lambda _, draws: noisy(10.0, draws), space_of(mud=MUD)).guarantee
    assert given_.margin(1.0, 0.0) == 1.0
    assert given_.margin(1.0, given_.tolerance) == pytest.approx(0.0)
    assert given_.margin(given_.rate, 0.0) == pytest.approx(0.0)
    assert given_.margin(0.5, 0.0) < -1.0


def test_one_failure_does_not_refute_the_guarantee() -> None:
    given_ = evaluator_of(lambda _, draws: noisy(10.0, draws), space_of(mud=MUD)).guarantee
    fine, failed = Outcome(True, 10.0), Outcome(False, 10.0)
    assert examined(given_, [fine] * 7 + [failed], [fine] * 8).result == "open"
    assert examined(given_, [fine] * 8, [fine] * 8).result == "holds"
    assert examined(given_, [failed] * 4, [fine] * 4).result == "fails"
    assert not refuted(given_, [fine] * 15 + [failed], [fine] * 16, 0.01)
    assert refuted(given_, [fine] * 4 + [failed] * 12, [fine] * 16, 0.01)
    assert refuted(given_, [Outcome(True, 9.0)] * 16, [fine] * 16, 0.01)
    wild = [Outcome(True, 10.0)] * 12 + [Outcome(True, 6.0)] * 4  # a mean of 9, due to few episodes
    assert not refuted(given_, wild, [fine] * 16, 0.01)


@pytest.mark.parametrize("zero", [0.0, 8.0, -10.0, 1000.0])
def test_power_depends_on_the_width_of_a_declared_range(zero: float) -> None:
    def found(width: float, loss: float) -> bool:
        declared = Range(zero, zero + width)
        given_ = Guarantee(0.8, 0.5, (zero,) * 50, 1.0, declared)
        best = zero + width
        return refuted(given_, [Outcome(True, best - loss)] * 32, [Outcome(True, best)] * 32, 0.01)

    assert found(2.0, 1.5)
    assert not found(2.0, 0.5)
    assert not found(10.0, 1.5)


def test_distances_are_in_units_of_the_declared_ranges() -> None:
    space = space_of(mud=Drift.range(0.0, 4.0, nominal=4.0), slope=SLOPE, camera=CAMERA)
    assert distance(space, space.nominal) == 0.0
    assert distance(space, {"mud": 2.0, "slope": 0.0, "camera": 0.0}) == 0.5
    assert distance(space, {"mud": 4.0, "slope": -0.5, "camera": 2.0}) == sqrt(1.25)


def test_timed_out_search_says_how_to_repeat_it(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0

    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        nonlocal now
        now += 0.1
        return noisy(10.0 - 0.7 * abs(point["slope"]) - 0.5 * (1.0 - point["mud"]), draws)

    monkeypatch.setattr(evaluating, "monotonic", lambda: now)
    space = space_of(mud=MUD, slope=SLOPE)
    evaluator = evaluator_of(world, space, budget=10**6)
    evaluator.seconds, evaluator.begun = 20.0, now
    curves = [Curve(ray) for ray in rays(space, {})]
    ended = explore(evaluator, Together(0.01, curves), 0.01)
    assert ended == "budget"
    assert 150 < evaluator.spent <= 201  # 0.1 s each; the last episodes may have been dropped
    assert evaluator.seconds == 20.0
    assert any(curve.evidence for curve in curves)
    found = replace(stressed(world, space, budget=60), ended="budget", seconds=20.0, episodes=evaluator.spent)
    told = [*words.lines(found)]
    assert (
        told[-2] == "  The budget of 20 s did not suffice for the whole search: raise --tarl-stress-budget."
    )
    assert told[-1].endswith(f"for the same number of episodes, use --tarl-stress-budget {evaluator.spent}.")
    document = json_result.document(found)
    jsonschema.validate(document, json_result.schema())
    assert (document["budget"], document["seconds"]) == (None, 20.0)
    assert "budget 20 s" in page.render(found)


@pytest.mark.parametrize("budget", [43, 50, 51, 58])
def test_margin_exists_without_nominal_episodes(budget: int) -> None:
    space = space_of(mud=MUD, slope=SLOPE)
    evaluator = evaluator_of(lambda _, draws: noisy(10.0, draws, 0.5), space, budget=budget)
    point = {"mud": 0.5, "slope": 0.1}
    evaluator.common(space.nominal, 8)
    evaluator.common({"mud": 0.4, "slope": 0.0}, 19)
    for count in (4, 8, 16, 32):
        with suppress(BudgetSpentError):
            evaluator._evidence(point, count)
    assert np.isfinite(evaluator.measured(point)).all()


@pytest.mark.parametrize(
    "budget", [16, 40, 90]
)  # 90 ends between the nominal and the first drifted episode of "down"
def test_early_spent_budget_does_not_end_the_search(budget: int) -> None:
    space = space_of(mud=MUD, slope=SLOPE, camera=Drift.choice("up", "down"))
    found = stressed(lambda *_: (True, 10.0), space, budget=budget)
    assert found.ended == "budget"
    assert found.episodes <= budget
    assert found.combinations == ()
