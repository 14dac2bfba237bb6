"""Acceptance: repairs that hold are accepted, others are refused even after a few lucky episodes."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.learning.betting import bet
from pytest_tarl.learning.bounds import rate
from pytest_tarl.searching.accept import (
    LOOKS,
    SCREEN,
    SEEDS,
    Acceptance,
    Outcome,
    Reference,
    World,
    accept,
    risk_of,
)
from pytest_tarl.searching.acceptance_numbers import NEVER, acceptance_numbers

DESIGNED, LOWEST, MARGIN = 10.0, -10.0, 0.5
RISK = risk_of(0.05, 0)


def world(mean: float, spread: float = 0.3, failing: float = 0.0, seed: int = 0) -> World:
    def run(episode: int) -> Outcome:
        draws = np.random.default_rng([seed, episode])
        failed = bool(draws.random() < failing)
        return Outcome(LOWEST if failed else float(draws.normal(mean, spread)), not failed)

    return World(run)


def seeds(at: int) -> range:
    return range(at * SEEDS, (at + 1) * SEEDS)


AS_DESIGNED = world(DESIGNED, seed=7)
REFERENCE = Reference([AS_DESIGNED.run(i).total for i in range(10**6, 10**6 + 200)], 1.0, MARGIN, LOWEST)


def judged(
    drifted: World, nominal: World | None = None, at: int = 0, designed: World = AS_DESIGNED
) -> Acceptance:
    return accept(drifted, nominal, designed, seeds(at), REFERENCE, RISK)


def test_each_world_knows_its_next_seeds_before_it_runs_the_first_of_them() -> None:
    """Workers can then start these episodes early."""
    known: dict[str, list[int]] = {"repaired": [], "designed": []}
    ran: dict[str, list[int]] = {"repaired": [], "designed": []}

    def watched(name: str, mean: float, seed: int) -> World:
        inner = world(mean, seed=seed).run

        def run(episode: int) -> Outcome:
            assert episode in known[name]
            ran[name].append(episode)
            return inner(episode)

        return World(run, known[name].extend)

    assert judged(watched("repaired", DESIGNED, 0), None, 0, watched("designed", DESIGNED, 7)).accepted
    assert ran == known
    assert len(ran["repaired"]) >= LOOKS[0]


def test_a_repair_that_restores_the_designed_reward_is_accepted() -> None:
    found = judged(world(DESIGNED), world(DESIGNED, seed=1))
    assert found.accepted
    assert found.tested
    assert len(found.drifted) in LOOKS
    assert len(found.nominal) in LOOKS
    longest = max(len(found.drifted), len(found.nominal))
    assert found.episodes == len(found.drifted) + len(found.nominal) + longest + 3 * SCREEN


def test_repair_that_gains_too_little_is_refused_early() -> None:
    found = judged(world(8.0), world(DESIGNED))
    assert (found.accepted, found.reason, found.nominal, found.tested) == (False, "gain too small", (), False)


def test_a_repair_that_breaks_the_designed_world_is_refused() -> None:
    found = judged(world(DESIGNED), world(7.0))
    assert (found.accepted, found.reason) == (False, "nominal gets worse")


@pytest.mark.parametrize("loss", [0.45, 2.0])
def test_result_states_the_world_that_rejected(loss: float) -> None:
    """A loss of nearly the margin is not shown to be tolerable, and one of four margins is shown not to be."""
    costly = judged(world(DESIGNED), world(DESIGNED - loss, seed=1))
    weak = judged(world(DESIGNED - loss), world(DESIGNED, seed=1))
    assert [costly.accepted, weak.accepted] == [False, False]
    assert (costly.costly, weak.costly) == (True, False)
    assert not judged(world(DESIGNED), world(DESIGNED, seed=1)).costly


def test_designed_world_is_skipped_if_the_condition_never_holds() -> None:
    found = judged(world(DESIGNED))
    assert found.accepted
    assert found.nominal == ()


def test_failed_missions_count_even_if_the_reward_is_right() -> None:
    def run(episode: int) -> Outcome:
        return Outcome(DESIGNED, bool(np.random.default_rng(episode).random() > 0.3))

    assert judged(World(run)).reason == "fails too often"


@pytest.mark.parametrize(("drifted", "reason"), [(True, "fails too often"), (False, "nominal gets worse")])
def test_early_failure_refuses_a_candidate_without_risk(drifted: bool, reason: str) -> None:
    """If the stake of the bet were computed from the failed mission, no test could be won."""

    def run(episode: int) -> Outcome:
        failed = episode == seeds(0)[3]
        return Outcome(LOWEST if failed else DESIGNED, not failed)

    found = judged(*((World(run),) if drifted else (AS_DESIGNED, World(run))))
    assert (found.reason, found.tested) == (reason, False)
    assert [one.passed for one in (found.drifted if drifted else found.nominal)].count(False) == 1


def test_report_includes_screening_missions() -> None:
    found = judged(world(DESIGNED - 0.9 * MARGIN, 0.01))
    assert not found.accepted
    assert found.seeds == tuple(seeds(0)[: len(found.drifted)])
    assert len(found.drifted) > SCREEN
    assert len(found.designed) == len(found.drifted)
    accepted = judged(world(DESIGNED))
    assert accepted.seeds == tuple(seeds(0)[SCREEN : SCREEN + len(accepted.drifted)])


def test_the_unrepaired_program_runs_once_per_seed() -> None:
    runs: list[int] = []

    def run(episode: int) -> Outcome:
        runs.append(episode)
        return AS_DESIGNED.run(episode)

    judged(world(DESIGNED), world(DESIGNED, seed=1), designed=World(run))
    assert len(runs) == len(set(runs))


def share_accepted(make: Callable[[int], World], runs: int) -> float:
    return sum(judged(make(at), at=at).accepted for at in range(runs)) / runs


@pytest.mark.parametrize("failing", [0.05, 0.08, 0.12])
def test_frequent_failures_are_accepted_with_at_most_the_risk(failing: float) -> None:
    runs = 80
    accepted = share_accepted(lambda at: world(DESIGNED, failing=failing, seed=at + 10), runs)
    assert accepted <= RISK + 3 * np.sqrt(RISK / runs)


@pytest.mark.parametrize("spread", [0.02, 0.3, 2.0])
def test_repair_below_the_margin_is_accepted_with_at_most_the_risk(spread: float) -> None:
    runs = 80
    below = DESIGNED - MARGIN - 0.01
    accepted = share_accepted(lambda at: world(below, spread, seed=at + 10), runs)
    assert accepted <= RISK + 3 * np.sqrt(RISK / runs)


def test_totals_are_compared_seed_by_seed() -> None:
    def varying(loss: float) -> World:
        def run(episode: int) -> Outcome:
            return Outcome(float(np.random.default_rng([5, episode]).normal(DESIGNED, 3.0)) - loss, True)

        return World(run)

    totals = [varying(0.0).run(at).total for at in range(10**6, 10**6 + 200)]
    reference = Reference(totals, 1.0, MARGIN, min(totals))
    for at in range(20):
        assert accept(varying(0.1), None, varying(0.0), seeds(at), reference, RISK).accepted
        assert not accept(varying(0.6), None, varying(0.0), seeds(at), reference, RISK).accepted


def test_undecided_test_shows_no_refusal_reason() -> None:
    found = judged(world(DESIGNED - 0.9 * MARGIN, 0.01))
    assert found.reason == "not shown"


def test_the_risks_of_all_tests_add_up_to_alpha() -> None:
    risks = [risk_of(0.05, before) for before in range(60)]
    assert sum(risks) == pytest.approx(0.05)
    assert all(later < earlier for earlier, later in itertools.pairwise(risks))


def test_clean_missions_bound_the_failure_rate() -> None:
    assert rate(59, 59, 0.95).low > 0.95 > rate(58, 58, 0.95).low
    assert acceptance_numbers((59,), 0.05, 0.05) == (0,)
    assert acceptance_numbers((58,), 0.05, 0.05) == (NEVER,)


@settings(max_examples=8)
@given(st.sampled_from([0.02, 0.05, 0.1, 0.25, 0.6]), st.sampled_from([0.05, 0.0333, 0.0111, 0.0037]))
def test_checks_together_keep_the_stated_risk(rate: float, risk: float) -> None:
    numbers = acceptance_numbers(LOOKS, rate, risk)
    assert list(numbers) == sorted(numbers)
    failed = np.random.default_rng(1).random((15_000, LOOKS[-1])) < rate
    counts = np.cumsum(failed, axis=1)[:, np.array(LOOKS) - 1]
    accepted = float(np.mean(np.any(counts <= np.array(numbers), axis=1)))
    assert accepted <= risk + 4 * np.sqrt(risk / 15_000)


@settings(max_examples=60)
@given(
    st.lists(st.floats(-20, 5), min_size=2, max_size=8),
    st.floats(0.1, 2.0),
    st.lists(st.floats(0.02, 1.0), min_size=1, max_size=4),
    st.integers(0, 2**16),
)
def test_bet_against_a_true_claim_is_rarely_won(
    known: list[float], margin: float, steps: list[float], seed: int
) -> None:
    """Distributions with few values whose mean loses exactly the margin: skewed, bimodal, nearly constant."""
    least, draws = -20.0, np.random.default_rng(seed)
    worst = draws.uniform(least, -margin - 0.05)
    best = draws.uniform(-margin + 0.05, 2.0)
    rate = (best + margin) / (best - worst)  # share of the worst value with which the mean is -margin
    stake = bet(margin, least, known)
    runs = np.where(draws.random((400, 200)) < rate, worst, best)
    money = np.average(
        [np.cumprod(1.0 + one * (runs + margin), axis=1) for one in stake.stakes],
        axis=0,
        weights=stake.shares,
    )
    assert money.min() >= 0.0
    won = float(np.mean(money.max(axis=1) >= 1 / RISK))
    assert won <= RISK + 4 * np.sqrt(RISK / 400) + 0.01
    assert stake.wealth(runs[0].tolist()) == pytest.approx(float(np.log(money[0, -1])), abs=1e-6)


STRATA = st.lists(st.floats(0.0, 1.0), min_size=4, max_size=4).filter(lambda rates: sum(rates) > 0.01)


@settings(max_examples=60, deadline=None)
@given(STRATA, st.sampled_from([0.05, 0.1, 0.25]), st.sampled_from([0.0333, 0.0111]))
def test_varying_failure_rates_do_not_raise_the_risk(shares: list[float], rate: float, risk: float) -> None:
    """Seeds come from four strata in turn; the probability is exact (for one look see Hoeffding 1956)."""
    rates = [min(4 * rate * share / sum(shares), 1.0) for share in shares]
    numbers = acceptance_numbers(LOOKS, sum(rates) / 4, risk)
    waiting, seen, accepted = np.ones(1), 0, 0.0
    for look, number in zip(LOOKS, numbers, strict=True):
        for episode in range(seen, look):
            failing = rates[episode % 4]
            waiting = np.convolve(waiting, [1 - failing, failing])
        seen = look
        if number > NEVER:
            accepted += float(waiting[: number + 1].sum())
            waiting[: number + 1] = 0.0
    assert accepted <= risk + 1e-12


@settings(max_examples=40, deadline=None)
@given(STRATA, st.lists(st.floats(-20, 5), min_size=2, max_size=8), st.integers(0, 2**16))
def test_bet_is_rarely_won_at_the_margin(weights: list[float], known: list[float], seed: int) -> None:
    """The strata lose different amounts whose mean is exactly the margin; looks come after whole blocks."""
    losses = np.array(weights) / sum(weights) * 4 * MARGIN
    draws = np.random.default_rng(seed)
    runs = -np.tile(losses, 50) + draws.choice([-1.0, 1.0], (300, 200)) * 0.3
    stake = bet(MARGIN, -20.0, known)
    money = np.average(
        [np.cumprod(1.0 + one * (runs + MARGIN), axis=1) for one in stake.stakes],
        axis=0,
        weights=stake.shares,
    )
    won = float(np.mean(money[:, np.array(LOOKS) - 1].max(axis=1) >= 1 / RISK))
    assert won <= RISK + 4 * np.sqrt(RISK / 300) + 0.01


def test_declared_range_bounds_the_loss_of_a_mission() -> None:
    recorded = Reference([9.9, 10.1], 1.0, MARGIN, 8.0)
    declared = Reference([9.9, 10.1], 1.0, MARGIN, 6.0, 11.0)
    failing_dearly = Reference([9.9, 10.1], 1.0, MARGIN, -500.0, 11.0)
    assert recorded.least == pytest.approx(8.0 - 10.1)
    assert declared.least == pytest.approx(6.0 - 11.0)
    assert failing_dearly.least == pytest.approx(-DESIGNED)
    assert accept(world(DESIGNED), None, AS_DESIGNED, seeds(0), failing_dearly, RISK).accepted
