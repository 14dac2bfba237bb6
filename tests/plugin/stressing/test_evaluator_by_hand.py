"""The episodes that an evaluator runs, one by one, in worlds with known rewards."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.errors import RecordingError
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import evaluating
from pytest_tarl.stressing.boundary import bisect, confirm, sweep
from pytest_tarl.stressing.evaluating import (
    FRESH,
    GLANCE,
    RAYS,
    SEARCH,
    TURNS,
    BudgetSpentError,
    Count,
    Evaluator,
)
from pytest_tarl.stressing.findings import Curve
from pytest_tarl.stressing.guarantee import Guarantee, outcome
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.shrinking import shrunk
from tests.plugin.stressing.worlds import Simulated, World, space_of

SPACE = space_of(
    a=Drift.range(0.0, 1.0, nominal=0.0),
    b=Drift.range(-1.0, 1.0, nominal=0.0),
    camera=Drift.choice("up", "down"),
)
GIVEN = Guarantee(0.9, 0.5, (10.0,) * 20, 1.0)
UP, DOWN, UPPER, LOWER = (
    {**SPACE.nominal, **one} for one in ({"a": 0.5}, {"camera": 1.0}, {"b": 1.0}, {"b": -1.0})
)


def evaluator(world: World, budget: int = 1000, **given: Any) -> tuple[Evaluator, Simulated]:
    rollout = Simulated(world)
    made = Evaluator(
        rollout, SPACE, "world", GIVEN, 5, budget, given.pop("progress", lambda *_: None), **given
    )
    return made, rollout


def constant(total: float, passed: bool = True) -> World:
    return lambda point, _: (passed, total if point != SPACE.nominal else 10.0)


def seeds(pool: str, count: int) -> list[int]:
    return list(episode_seeds(5, f"stress world {pool}", count))


# which seeds run


def test_quick_look_runs_two_episodes_and_nominal_ones() -> None:
    made, ran = evaluator(constant(9.8))
    found = made.glance(UP)
    assert (found.episodes, found.passed, made.spent) == (2, 2, 4)
    assert [plan.seed for plan in ran.plans] == seeds(SEARCH, 2) * 2
    assert [plan.point for plan in ran.plans] == [SPACE.nominal] * 2 + [UP] * 2
    assert found.loss == pytest.approx(0.2)
    assert found.margin == pytest.approx(0.6)


def test_later_look_needs_the_nominal_episodes_of_its_seeds() -> None:
    made, ran = evaluator(constant(9.8))
    made.glance(UP, 2)
    assert [plan.seed for plan in ran.plans] == seeds(SEARCH, 6) + seeds(SEARCH, 6)[4:]


def test_the_turns_begin_again_after_sixteen_seeds() -> None:
    made, _ = evaluator(constant(9.8))
    made.glance(UP, TURNS // GLANCE)
    assert made.rows(UP, 3) == [0, 1, 2]
    made.glance(UPPER, TURNS // GLANCE - 1)
    assert made.rows(UPPER, 4) == [14, 15, 0, 1]
    assert made.rows(UPPER, 18) == [14, 15, *range(14), 16, 17]


def test_nominal_episodes_always_start_at_the_first_seed() -> None:
    made, ran = evaluator(constant(9.8))
    made.glance(SPACE.nominal, 3)
    assert [plan.seed for plan in ran.plans] == seeds(SEARCH, 2)


def test_a_decided_drift_gets_no_further_episodes() -> None:
    for total, episodes in ((-50.0, 4), (9.99, 8), (9.5, 16)):
        made, _ = evaluator(
            lambda point, draws, total=total: (True, total if point != SPACE.nominal else 10.0)
        )
        assert made.examine(UP, 16).episodes == episodes


def test_undecided_drift_gets_limited_episodes() -> None:
    for most, episodes in ((4, 4), (7, 4), (8, 8), (31, 16), (32, 32), (99, 32)):
        made, _ = evaluator(constant(9.5))
        assert made.examine(UP, most).episodes == episodes


def test_the_evidence_on_a_drift_covers_all_its_episodes() -> None:
    made, _ = evaluator(constant(9.5))
    made.examine(UP, 8)
    spent = made.spent
    assert made.known(UP).episodes == 8
    assert made.spent == spent


def test_fresh_seeds_differ_from_the_seeds_of_the_search() -> None:
    made, ran = evaluator(constant(9.5))
    made.fresh(UP, 3)
    assert [plan.seed for plan in ran.plans] == seeds(RAYS, 3)
    assert not set(seeds(RAYS, 64)) & set(seeds(SEARCH, 64))
    made.fresh(UP, 2)
    assert made.spent == 3


# confirmations


def test_a_clear_failure_is_confirmed_after_the_first_check() -> None:
    made, ran = evaluator(constant(10.0, passed=False))
    assert made.confirm(UP, "chain 0", 0.01)
    assert made.spent == 2 * FRESH[0]
    assert {plan.seed for plan in ran.plans} == set(seeds("chain 0", FRESH[0]))


def test_test_without_loss_ends_at_the_first_check() -> None:
    made, _ = evaluator(constant(10.0))
    assert not made.confirm(UP, "chain 0", 0.01)
    assert made.spent == 2 * FRESH[0]


def test_each_interim_check_has_its_share_of_the_risk(monkeypatch: pytest.MonkeyPatch) -> None:
    risks: list[float] = []

    def refuted(given: Any, outcomes: Any, nominal: Any, risk: float, part: str) -> bool:
        risks.append(risk)
        return False

    monkeypatch.setattr(evaluating, "refuted", refuted)
    monkeypatch.setattr(evaluating, "hopeless", lambda *_, strict: strict)
    made, _ = evaluator(constant(9.5))
    assert not made.confirm(UP, "chain 0", 0.08)
    assert risks == [0.04, 0.04]
    risks.clear()
    assert not made.confirm(UP, "chain 0", 0.1, (4, 8, 16), (0.1, 0.2, 0.7))
    assert risks == pytest.approx([0.01, 0.02, 0.07])


def test_a_test_is_judged_hopeless_by_its_last_check(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, int, float, str]] = []

    def hopeless(
        given: Any, outcomes: Any, nominal: Any, most: int, risk: float, part: str, *, strict: bool
    ) -> bool:
        asked.append((len(outcomes), most, risk, part))
        return len(outcomes) == 8

    monkeypatch.setattr(evaluating, "hopeless", hopeless)
    made, _ = evaluator(constant(10.0))
    assert not made.confirm(UP, "chain 0", 0.1, (4, 8, 16), (0.1, 0.2, 0.7), "rate")
    assert asked == [(4, 16, pytest.approx(0.07), "rate"), (8, 16, pytest.approx(0.07), "rate")]


# budgets


def test_budget_covers_its_last_episode() -> None:
    made, _ = evaluator(constant(9.5), budget=4)
    made.glance(UP)
    assert made.left == 0
    with pytest.raises(BudgetSpentError):
        made.glance(UPPER)
    assert made.spent == 4


def test_phase_limit_is_a_share_of_the_budget() -> None:
    made, _ = evaluator(constant(9.5), budget=20)
    with made.limited(0.5):
        assert made.budget == 10
        made.common(UP, 10)
        assert not made.short
        made.common(UP, 11)
    assert made.short
    assert made.budget == 20
    with made.limited(2.0):
        assert made.budget == 20


def test_a_phase_limit_also_shortens_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    made, _ = evaluator(constant(9.5), seconds=8.0, begun=0.0)
    with made.limited(0.25):
        assert made.seconds == 2.0
    assert made.seconds == 8.0
    untimed, _ = evaluator(constant(9.5))
    with untimed.limited(0.25):
        assert untimed.seconds is None


def test_time_limit_is_converted_by_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(evaluating, "monotonic", lambda: now[0])
    made, _ = evaluator(constant(9.5), seconds=10.0)
    made.common(UP, 6)
    now[0] = 104.0
    assert made.left == 9  # 6 episodes in 4 s, and 6 s left
    now[0] = 111.0
    assert made.left == 0
    with pytest.raises(BudgetSpentError):
        made.common(UP, 7)
    assert made.spent == 6


def test_episodes_run_until_the_time_limit_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(evaluating, "monotonic", lambda: now[0])
    made, _ = evaluator(constant(9.5), seconds=10.0)
    now[0] = 10.0
    assert len(made.common(UP, 2)) == 2


def test_each_episode_is_counted_and_reported_to_the_progress() -> None:
    told: list[tuple[int, int, str]] = []
    made, _ = evaluator(constant(9.5), budget=7, progress=lambda *one: told.append(one))
    made.common(UP, 3)
    assert told == [(1, 7, "world stress"), (2, 7, "world stress"), (3, 7, "world stress")]


def test_the_budget_must_cover_only_the_missing_fresh_episodes() -> None:
    made, _ = evaluator(constant(9.5), budget=20)
    assert made.affords(UP, 12, 8)
    assert not made.short
    assert not made.affords(UP, 12, 9)
    assert made.short
    made.fresh(UP, 8)
    assert made.affords(UP, 12, 8)
    assert made.affords(UP, 4, 12)  # episodes that ran do not pay for others
    assert not made.affords(UP, 4, 13)


# what the model learns from


def test_losses_are_in_units_of_the_tolerance() -> None:
    made, _ = evaluator(lambda point, _: (point["a"] == 0.0, 10.0 - point["a"]))
    made.glance(UP, 1)
    assert made.losses(UP) == ([pytest.approx(1.0)] * 2, 2)
    assert made.sources(UP) == [(SEARCH, 2), (SEARCH, 3)]
    assert made.measured(UP)[0] < 0.0


def test_an_unknown_drift_has_no_losses() -> None:
    made, _ = evaluator(constant(9.5))
    assert not made.knows(UP)
    with pytest.raises(KeyError):
        made.losses(UP)
    with pytest.raises(KeyError):
        made.measured(UP)


def test_loss_without_a_tolerance_counts_twice() -> None:
    made, _ = evaluator(constant(9.5))
    made.guarantee = Guarantee(0.9, 0.0, (10.0,) * 20, 1.0)
    made.glance(UP)
    assert made.losses(UP)[0] == [2.0, 2.0]
    made.glance({**SPACE.nominal, "b": 0.5})
    equal, _ = evaluator(constant(10.0))
    equal.guarantee = made.guarantee
    equal.glance(UP)
    assert equal.losses(UP)[0] == [0.0, 0.0]


def test_model_learns_from_released_fresh_episodes() -> None:
    made, _ = evaluator(constant(9.5))
    made.glance(UP)
    made.confirm(UP, "chain 3", 0.01)
    assert len(made.losses(UP)[0]) == 2
    assert made.fresh_pools == [RAYS]
    made.release("chain 3")
    assert len(made.losses(UP)[0]) == 2 + 16
    assert made.sources(UP)[:4] == [(SEARCH, 0), (SEARCH, 1), ("chain 3", 0), ("chain 3", 1)]
    assert made.fresh_pools == [RAYS, "chain 3"]
    assert made.knows(UP)


def test_unpaired_test_runs_no_nominal_episodes() -> None:
    made, ran = evaluator(constant(9.25))
    assert made.confirm(UP, "chain 0", 0.01, (16, 32), part="loss", least=10.0)
    assert [plan.point for plan in ran.plans] == [UP] * 16
    assert not made.confirm(DOWN, "chain 0", 0.01, (16, 32), part="loss", least=9.7)
    made.release("chain 0")
    assert made.losses(UP) == ([pytest.approx(1.5)] * 16, 0)
    assert all(failed for _, failed in made.recalled("chain 0", UP))


def test_search_rewards_are_paired_with_nominal_ones() -> None:
    made, _ = evaluator(constant(9.25))
    made.glance(UP)
    assert made.totals(UP) == [(9.25, 10.0)] * GLANCE
    assert made.usual_mean == 10.0


def test_the_margin_is_measured_again_after_further_episodes() -> None:
    totals = iter([10.0] * 4 + [9.9, 9.9, 9.0, 9.0])
    made, _ = evaluator(lambda point, _: (True, next(totals)))
    made.common(SPACE.nominal, 4)
    made.common(UP, 2)
    first = made.measured(UP)
    assert made.measured(UP) == first
    made.common(UP, 4)
    assert made.measured(UP)[0] < first[0]


def test_chain_seeds_run_in_order() -> None:
    made, ran = evaluator(lambda point, draws: (True, float(draws.normal())))
    made.ordered("chain 0", UP, [5, 2])
    found = made.ordered("chain 0", UP, [2, 7])
    every = seeds("chain 0", 8)
    assert [plan.seed for plan in ran.plans] == [every[5], every[2], every[7]]
    assert list(found) == [5, 2, 7]
    assert made.recalled("chain 0", UP)[1][0].seed == every[2]


def test_pool_counts_are_known_after_its_release() -> None:
    made, _ = evaluator(constant(9.5))
    made.count("chain 0", Count(UP, 1.0, 8))
    made.count("chain 1", Count(DOWN, 2.0, 8))
    assert made.counts == []
    made.count("chain 0", Count(UP, 1.5, 16))  # a continued test replaces its first count
    made.release("chain 1")
    made.release("chain 0")
    assert made.counts == [Count(DOWN, 2.0, 8), Count(UP, 1.5, 16)]


@pytest.mark.parametrize(
    ("total", "passed", "failed"),
    [(9.5, True, False), (9.49, True, True), (10.0, False, True), (10.0, True, False)],
)
def test_recalled_episode_failed_by_its_loss(total: float, passed: bool, failed: bool) -> None:
    made, _ = evaluator(constant(total, passed))
    made.glance(UP)
    assert [one for _, one in made.recalled(SEARCH, UP)] == [failed] * 2
    plan = made.recalled(SEARCH, UP)[0][0]
    assert (plan.seed, plan.point, plan.drift) == (seeds(SEARCH, 1)[0], UP, "world")


def test_episode_without_a_nominal_one_fails_by_not_passing() -> None:
    made, _ = evaluator(constant(-99.0))
    made.fresh(UP, 2)
    assert [one for _, one in made.recalled(RAYS, UP)] == [False, False]


def test_raising_test_is_reported_and_hanging_test_fails() -> None:
    def run(**given: Any) -> Any:
        plan = SimpleNamespace(point={"a": 0.5, "b": -1.0}, seed=7)
        trace = SimpleNamespace(reward=np.array([1.5, 2.0]))
        return SimpleNamespace(
            **{"broken": "", "stuck": "", "passed": True, "plan": plan, "trace": trace} | given
        )

    assert (outcome(run()).passed, outcome(run()).total) == (True, 3.5)
    assert not outcome(run(passed=False)).passed
    assert not outcome(run(stuck="pilot", broken="E")).passed
    with pytest.raises(
        RecordingError, match=r"^An episode at a=0\.5, b=-1 \(seed 7\) failed outside the mission:\nE$"
    ):
        outcome(run(broken="E"))


# boundaries


def failing_from(edge: float) -> World:
    def run(point: Point, _: np.random.Generator) -> tuple[bool, float]:
        return point["a"] < edge, 10.0

    return run


def test_a_sweep_examines_the_ray_from_its_far_end() -> None:
    made, _ran = evaluator(failing_from(0.6))
    one = Curve(rays(SPACE, {})[0])
    sweep(one, made)
    assert list(one.evidence) == [1.0, 0.75, 0.5, 0.25]
    assert one.swept
    assert [one.evidence[t].result for t in sorted(one.evidence)] == ["holds", "holds", "fails", "fails"]
    assert one.failing == [0.75, 1.0]
    assert one.bracket == (0.5, 0.75)


def test_a_bisection_stops_at_a_fiftieth_of_the_range() -> None:
    made, _ = evaluator(failing_from(0.6))
    one = Curve(rays(SPACE, {})[0])
    sweep(one, made)
    bisect(one, made)
    assert sorted(one.evidence)[1:-2] == [0.5, 0.5625, 0.59375, 0.609375, 0.625]
    assert one.bracket == (0.59375, 0.609375)


def test_a_confirmed_place_ends_the_tests_along_a_ray() -> None:
    made, _ = evaluator(failing_from(0.6))
    one = Curve(rays(SPACE, {})[0])
    sweep(one, made)
    confirm(one, made, 0.01)
    assert one.confirmed == 0.75
    assert one.rejected == ()


def test_ray_test_risk_falls_with_their_number(monkeypatch: pytest.MonkeyPatch) -> None:
    made, _ = evaluator(failing_from(0.1))
    one = Curve(rays(SPACE, {})[0])
    sweep(one, made)
    asked: list[tuple[str, float]] = []

    def never(point: Point, pool: str, risk: float) -> bool:
        asked.append((pool, risk))
        return False

    monkeypatch.setattr(made, "confirm", never)
    confirm(one, made, 0.06)
    assert [risk for _, risk in asked[:2]] == pytest.approx([0.03, 0.01])
    assert {pool for pool, _ in asked} == {RAYS}
    assert len(one.rejected) == len(asked)
    assert list(one.rejected) == sorted(one.rejected)
    assert one.confirmed is None


def test_a_place_beyond_a_confirmed_place_is_not_tested() -> None:
    made, _ = evaluator(failing_from(0.6))
    one = Curve(rays(SPACE, {})[0])
    sweep(one, made)
    one.confirmed = 0.1
    spent = made.spent
    confirm(one, made, 0.01)
    assert (one.confirmed, made.spent) == (0.1, spent)


# shrinking


def test_a_direction_that_does_not_matter_becomes_nominal() -> None:
    made, _ = evaluator(lambda point, _: (point["a"] < 0.5, 10.0))
    found = shrunk({"a": 0.8, "b": 0.7, "camera": 1.0}, made)
    assert found["b"] == 0.0
    assert found["camera"] == 0.0
    assert 0.5 <= found["a"] <= 0.7


def test_effective_option_is_kept_after_one_try() -> None:
    made, _ = evaluator(lambda point, _: (point["camera"] == 0.0, 10.0))
    found = shrunk({"a": 0.0, "b": 0.5, "camera": 1.0}, made)
    assert found == {"a": 0.0, "b": 0.0, "camera": 1.0}


def test_direction_is_halved_three_times() -> None:
    tried: list[float] = []

    def world(point: Point, _: np.random.Generator) -> tuple[bool, float]:
        if point["a"] not in tried:
            tried.append(point["a"])
        return point["a"] < 0.05, 10.0

    made, _ = evaluator(world)
    found = shrunk({"a": 0.8, "b": 0.0, "camera": 0.0}, made)
    assert [one for one in tried if one != 0.0] == pytest.approx([0.4, 0.3, 0.2625])
    assert found["a"] == pytest.approx(0.2625)
