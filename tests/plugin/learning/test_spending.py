"""Comparisons that share a number of episodes: their checks, the choice of the next comparison, and false alarms."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.learning.bounds import rate
from pytest_tarl.learning.sequential import FEWEST, Look
from pytest_tarl.learning.spending import MOST, Standing, chosen, next_look, schedule

LOOKS = (Look(10, 0.1), Look(20, 0.3), Look(40, 0.6))


@given(st.integers(1, 12), st.integers(FEWEST, 300), st.integers(2, 5))
def test_every_comparison_has_at_least_its_first_check(comparisons: int, share: int, looks: int) -> None:
    total = comparisons * share
    plan = schedule(total, comparisons, looks)
    assert sum(look.share for look in plan) == pytest.approx(1.0)
    assert all(look.share > 0.0 for look in plan)
    ends = [look.episodes for look in plan]
    assert ends == sorted(set(ends))
    assert ends[0] * comparisons <= total
    assert share <= ends[-1] <= MOST * share


def test_most_nearly_decided_comparison_continues() -> None:
    standings = [Standing(10, 0.3), Standing(20, 0.04, decided=True), Standing(20, 0.06), Standing(40, 0.01)]
    assert chosen(standings, LOOKS, 20) == 2  # the second is decided, the last has no checks left
    assert chosen(standings, LOOKS, 19) == 0
    assert chosen(standings, LOOKS, 9) is None
    assert chosen([Standing(10, 0.3), Standing(10, 0.3)], LOOKS, 10) == 0
    assert next_look(standings[0], LOOKS) == LOOKS[1]
    assert next_look(standings[1], LOOKS) is None
    assert next_look(standings[3], LOOKS) is None


def test_shared_episodes_keep_the_error_probability() -> None:
    """Four comparisons without a drift: each is found drifted in at most α of the runs."""
    alpha, runs, total = 0.05, 1500, 160
    looks = schedule(total, 4, 3)
    draws = np.random.default_rng(0)
    wrong = np.zeros(4, int)
    for _ in range(runs):
        losses = draws.standard_normal((4, looks[-1].episodes))

        def after(number: int, look: Look, losses: np.ndarray = losses) -> Standing:
            z = float(losses[number, : look.episodes].sum()) / look.episodes**0.5
            p_value = 1.0 - NormalDist().cdf(z)
            return Standing(look.episodes, p_value, p_value < alpha * look.share)

        standings = [after(number, looks[0]) for number in range(4)]
        while (
            number := chosen(standings, looks, total - sum(one.episodes for one in standings))
        ) is not None:
            look = next_look(standings[number], looks)
            assert look is not None
            standings[number] = after(number, look)
        wrong += [one.decided for one in standings]
    assert wrong.min() > 0
    assert all(rate(int(count), runs, 0.999).low <= alpha for count in wrong)
