"""Acceptance: what holds is taken, what does not is not, however lucky a few episodes are."""

from __future__ import annotations

import itertools
from statistics import NormalDist

import numpy as np
import pytest

from pytest_tarl.searching.accept import (
    LOOKS,
    SHARES,
    Outcome,
    Reference,
    World,
    accept,
    episodes_to_see,
)


def world(mean: float, spread: float = 0.3, passing: float = 1.0, seed: int = 0) -> World:
    def run(episode: int) -> Outcome:
        draws = np.random.default_rng([seed, episode])
        return Outcome(float(draws.normal(mean, spread)), bool(draws.random() < passing))

    return World(run)


REFERENCE = Reference([world(10.0).run(i).total for i in range(1000, 1200)], 1.0, 0.5)
SEEDS = range(LOOKS[-1])


def test_a_repair_as_good_as_designed_is_accepted_early() -> None:
    found = accept(world(10.0), world(10.0, seed=1), SEEDS, REFERENCE, 0.025)
    assert found.accepted
    assert len(found.drifted) <= LOOKS[2]
    assert len(found.nominal) <= LOOKS[2]


def test_a_repair_that_gains_too_little_is_refused_without_asking_the_nominal_world() -> None:
    found = accept(world(8.0), world(10.0), SEEDS, REFERENCE, 0.025)
    assert (found.accepted, found.reason, found.nominal) == (False, "gain too small", ())


def test_a_repair_that_breaks_the_nominal_world_is_refused() -> None:
    found = accept(world(10.0), world(7.0), SEEDS, REFERENCE, 0.025)
    assert (found.accepted, found.reason) == (False, "nominal gets worse")


def test_no_nominal_episode_is_run_where_the_guard_never_fires() -> None:
    found = accept(world(10.0), None, SEEDS, REFERENCE, 0.025)
    assert found.accepted
    assert found.nominal == ()


def test_missions_that_fail_count_even_when_the_reward_is_right() -> None:
    found = accept(world(10.0, passing=0.7), None, SEEDS, REFERENCE, 0.025)
    assert not found.accepted


def test_a_repair_just_below_the_margin_is_rarely_accepted() -> None:
    borderline = REFERENCE.mean - REFERENCE.margin
    accepted = [accept(world(borderline, seed=s), None, SEEDS, REFERENCE, 0.05).accepted for s in range(200)]
    assert sum(accepted) <= 15


def test_looks_are_increasing() -> None:
    assert all(a < b for a, b in itertools.pairwise(LOOKS))


@pytest.mark.parametrize("risk", [0.05, 0.025, 0.0125, 0.00625, 0.003125, 0.0015625])
def test_all_looks_together_err_no_more_often_than_the_risk(risk: float) -> None:
    paths = 400_000
    steps = np.diff(LOOKS, prepend=0)
    sums = np.cumsum(np.random.default_rng(1).normal(size=(paths, len(LOOKS))) * np.sqrt(steps), axis=1)
    limits = [NormalDist().inv_cdf(1 - risk * share) for share in SHARES]
    erring = float(np.mean(np.any(sums / np.sqrt(LOOKS) > limits, axis=1)))
    assert erring <= risk + 3 * np.sqrt(risk / paths)


def in_some_missions(share: float, lost: float, seed: int) -> World:
    """A world as designed but for a share of the missions, which the candidate does not mend."""

    def run(episode: int) -> Outcome:
        draws = np.random.default_rng([seed, episode])
        return Outcome(float(draws.normal(lost if draws.random() < share else 10.0, 0.3)), True)

    return World(run, share)


@pytest.mark.parametrize("share", [0.3, 0.15])
def test_a_drift_that_shows_in_few_missions_is_given_time_to_show(share: float) -> None:
    accepted = [
        accept(in_some_missions(share, -7.0, seed), None, SEEDS, REFERENCE, 0.025).accepted
        for seed in range(200)
    ]
    assert sum(accepted) <= 10


@pytest.mark.parametrize(
    ("exposure", "alpha", "episodes"),
    [(1.0, 0.025, 8), (0.5, 0.025, 6), (0.3, 0.025, 11), (0.01, 0.025, 40), (0, 0.1, 40)],
)
def test_so_many_episodes_show_what_there_is_to_see(exposure: float, alpha: float, episodes: int) -> None:
    assert episodes_to_see(exposure, alpha) == episodes


def test_a_world_without_any_chance_is_accepted_when_it_is_the_designed_one() -> None:
    same = World(lambda episode: Outcome(0.0, True))
    assert accept(same, same, SEEDS, Reference([0.0] * 20, 1.0, 0.0), 0.025).accepted
