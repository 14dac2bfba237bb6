"""The test for a decrease of reward or of success keeps its risk for both together."""

from __future__ import annotations

from itertools import combinations
from math import comb

import numpy as np
import pytest

from pytest_tarl.learning.permutation import permuted_decreases, permuted_loss
from pytest_tarl.seeds import generator


def outcomes(seed: int, episodes: int, *, failing: float, linked: bool) -> np.ndarray:
    """Return totals and successes, shape (episodes, 2); if `linked`, a failed episode earns less."""
    rng = generator(seed, "outcomes")
    passed = rng.random(episodes) >= failing
    totals = rng.normal(5.0, 1.0, episodes) + (2.0 * passed if linked else 0.0)
    return np.stack([totals, passed.astype(float)], axis=1)


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize("failing", [0.1, 0.3, 0.6])
def test_at_most_alpha_of_equal_groups_get_a_small_p_value(failing: float, linked: bool) -> None:
    """If the worlds are equal, every group of episodes is as likely to be the deployed one."""
    for seed in range(3):
        every = outcomes(seed, 9, failing=failing, linked=linked)
        p_values = []
        for chosen in combinations(range(9), 4):
            rest = np.delete(every, chosen, axis=0)
            p_values.append(permuted_decreases(rest, every[list(chosen)], generator(0, "any")).min())
        for alpha in np.unique(p_values):
            assert (np.array(p_values) <= alpha + 1e-12).mean() <= alpha + 1e-12


def test_success_test_does_not_change_the_p_value_of_the_loss() -> None:
    for seed in range(5):
        one, other = (outcomes(seed + at, 30, failing=0.0, linked=False) for at in (0, 100))
        alone = permuted_loss(one[:, 0], other[:, 0], generator(seed, "groups"))
        p_loss, p_failures = permuted_decreases(one, other, generator(seed, "groups"))
        assert (p_loss, p_failures) == (alone, 1.0)


@pytest.mark.parametrize(("recorded", "deployed", "failed"), [(12, 6, 4), (10, 5, 5), (20, 3, 2)])
def test_failures_with_constant_reward_use_fishers_test(recorded: int, deployed: int, failed: int) -> None:
    one = np.ones((recorded, 2))
    other = np.ones((deployed, 2))
    other[:failed, 1] = 0.0
    p_loss, p_failures = permuted_decreases(one, other, generator(0, "groups"))
    groups = comb(recorded + deployed, deployed)
    if groups <= 1000:
        assert p_failures == pytest.approx(comb(recorded + deployed - failed, deployed - failed) / groups)
    assert p_failures < 0.05
    assert p_loss == 1.0


def test_more_failures_are_found_despite_more_reward() -> None:
    rng = generator(2, "early")
    one = np.stack([rng.normal(-10.0, 1.0, 40), np.ones(40)], axis=1)
    other = np.stack([rng.normal(-6.0, 1.0, 20), (rng.random(20) < 0.6).astype(float)], axis=1)
    p_loss, p_failures = permuted_decreases(one, other, generator(0, "groups"))
    assert p_failures <= 0.005
    assert p_loss > 0.9


def test_an_increase_of_successes_is_not_significant() -> None:
    one = outcomes(0, 30, failing=0.5, linked=False)
    other = np.stack([one[:20, 0], np.ones(20)], axis=1)
    assert permuted_decreases(one, other, generator(0, "groups"))[1] > 0.9
