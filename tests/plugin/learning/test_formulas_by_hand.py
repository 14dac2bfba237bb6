"""Formulas of the bounds, shuffles and packed utilities, worked out step by step in plain Python."""

from __future__ import annotations

from math import log, log1p, sqrt

import numpy as np
import pytest

from pytest_tarl.learning.bounds import STAKE, bet_low
from pytest_tarl.learning.packing import UNIT, _before, _unpacked_in_turn, _visited
from pytest_tarl.learning.permutation import _smallest
from pytest_tarl.learning.shifts import _drawn
from pytest_tarl.learning.tables import Edges, Visits
from pytest_tarl.seeds import generator


def wealth(values: list[float], m: float, risk: float, anytime: bool) -> float:
    """Return the log of the largest wealth of the bets against the mean m."""
    total, squares, variance, money, most = 0.5, 0.25, 0.25, 0.0, float("-inf")
    for n, value in enumerate(values, 1):
        horizon = n * log(n + 1) if anytime else len(values)
        stake = sqrt(2 * log(1 / risk) / (variance * horizon))
        money += log1p(min(stake, STAKE / m) * (value - m))
        most = max(most, money)
        total += value
        squares += (value - total / (n + 1)) ** 2
        variance = squares / (n + 1)
    return most


@pytest.mark.parametrize("anytime", [False, True])
@pytest.mark.parametrize("risk", [0.05, 0.2, 0.5])
@pytest.mark.parametrize(
    "values",
    [[1.0] * 5, [0.9] * 12, [1.0, 0.0, 1.0, 1.0, 0.5] * 4, [0.2, 0.4, 0.3] * 10, [0.75, 0.8, 0.7, 0.9] * 25],
)
def test_bound_is_the_largest_refuted_mean(values: list[float], risk: float, anytime: bool) -> None:
    low = bet_low(np.array(values), risk, anytime=anytime)
    assert 0.0 < low < sum(values) / len(values)
    assert wealth(values, low * 0.999, risk, anytime) > log(1 / risk)
    assert wealth(values, low * 1.001, risk, anytime) < log(1 / risk)


def test_smallest_numbers_of_each_row_are_picked_despite_ties() -> None:
    draws = np.array([[0.3, 0.1, 0.4, 0.2], [0.5, 0.5, 0.1, 0.5], [0.2, 0.2, 0.2, 0.2], [0.9, 0.1, 0.1, 0.9]])
    picked = _smallest(draws, 2)
    assert set(picked.ravel().tolist()) == {0.0, 1.0}
    assert picked.sum(axis=1).tolist() == [2.0] * 4
    assert picked[0].tolist() == [0.0, 1.0, 0.0, 1.0]
    assert picked[1, 2] == 1.0
    assert picked[3].tolist() == [0.0, 1.0, 1.0, 0.0]


def test_a_shuffle_consists_of_the_rows_with_the_smallest_numbers() -> None:
    """Each set of rows is then equally likely."""
    draws = generator(0, "shifts/900/400").random((300, 900))  # numpy sorts short rows as a whole
    wanted = np.sort(np.argsort(draws, axis=1)[:, :400], axis=1)
    assert np.sort(_drawn(900, 400, 300), axis=1).tolist() == wanted.tolist()


def test_previous_row_has_the_same_cell_and_episode() -> None:
    episode = np.array([0, 0, 0, 0, 0, 0, 1, 1, 1])
    state = np.array([0, 1, 2, 3, 4, 5, 5, 6, 0])  # the start, then cells of two states each
    visits = Visits(episode, state, np.ones(9, np.int64), *(np.zeros(9) for _ in range(4)))
    assert _before(visits, 2).tolist() == [-1, -1, 1, -1, 3, -1, -1, 6, -1]
    assert _before(visits, 0).tolist() == [-1] * 9
    assert _before(visits, 6).tolist() == [-1, -1, 1, 2, 3, 4, -1, 6, -1]


def test_visits_are_the_sums_of_their_outgoing_edges() -> None:
    edges = Edges(
        episode=np.array([0, 0, 1, 0, 1]),
        state=np.array([2, 0, 2, 2, 0]),
        next_state=np.array([1, 2, 1, 3, 2]),
        count=np.array([4, 1, 2, 3, 1]),
    )
    found = [column.tolist() for column in _visited(edges)]
    assert found == [[0, 0, 1, 1], [0, 2, 0, 2], [1, 7, 1, 2]]


def test_prediction_is_the_previous_nonzero_row() -> None:
    signs = np.array([1, -1, 1, 0, 1, 1], np.int8)
    away = np.array([3, 2, -1, 0, 4, 5]) * UNIT
    before = np.array([-1, 0, 1, 2, 3, -1])
    values, code = _unpacked_in_turn((signs, away), before)
    assert (code // UNIT).tolist() == [3, 5, 4, 0, 4, 5]
    assert values.tolist() == [8.0, -32.0, 16.0, 0.0, 16.0, 32.0]
    assert _unpacked_in_turn((signs[:0], away[:0]), before[:0])[0].tolist() == []
