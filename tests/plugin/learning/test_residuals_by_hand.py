"""Residuals of single steps, computed by hand from a given model."""

from __future__ import annotations

from dataclasses import replace
from math import nan

import numpy as np
import pytest

from pytest_tarl.learning.residuals import Model, residuals
from pytest_tarl.learning.tables import END, Chain, Floats, Sample
from pytest_tarl.learning.utility import GAMMA_STEP

KNOWN = Model(
    utility=np.array([1.0, 3.0]), move=np.array([0.5, -2.0]), reward=np.array([2.0, 4.0]), size=np.zeros(2)
)
# (episode, cell, next cell, count, sum of the rewards)
ROWS = [(0, 0, 1, 2, 7.0), (0, 1, 0, 1, 4.0), (0, 1, END, 3, 10.0), (1, 0, 0, 1, 2.0)]


def sample(*rows: tuple[int, int, int, int, float]) -> Sample:
    episode, cell, following, count, reward = (np.array(one) for one in zip(*rows, strict=True))
    chain = Chain(episode, cell, following, count, reward, np.zeros((len(rows), 0)))
    none = np.zeros(2)
    return Sample(((0,), (1,)), (5, 6), none == 0, none, none.astype(int), (), chain, ())


def listed(values: Floats) -> list[list[float]]:
    found: list[list[float]] = values.tolist()
    return found


def test_a_move_counts_by_how_much_more_it_gains_than_the_designed_mean() -> None:
    found = residuals(sample(*ROWS), KNOWN)
    first = 2 * (GAMMA_STEP * 3.0 - 1.0 - 0.5)
    second = GAMMA_STEP * 1.0 - 3.0 + 2.0  # the last step of an episode has no move
    third = GAMMA_STEP * 1.0 - 1.0 - 0.5
    assert listed(found.move) == [pytest.approx([first, second]), pytest.approx([third, 0.0])]


def test_a_reward_counts_by_how_much_it_exceeds_the_designed_mean_of_its_visits() -> None:
    found = residuals(sample(*ROWS), KNOWN)
    assert listed(found.reward) == [[3.0, -2.0], [0.0, 0.0]]
    assert listed(found.novel) == [[0.0, 0.0], [0.0, 0.0]]


def test_cells_of_unknown_utility_only_count_as_novel() -> None:
    unknown = replace(KNOWN, utility=np.array([1.0, nan]), move=np.array([0.5, nan]))
    found = residuals(sample(*ROWS), unknown)
    assert listed(found.novel) == [[0.0, 4.0], [0.0, 0.0]]
    assert listed(found.move) == [[0.0, 0.0], pytest.approx([GAMMA_STEP - 1.5, 0.0])]
    assert listed(found.reward) == [[3.0, 0.0], [0.0, 0.0]]


def test_without_any_visit_no_utility_is_known() -> None:
    from pytest_tarl.learning.tiles import _fitted

    none = np.zeros(0, np.int64)
    assert np.isnan(_fitted(none, none, none, np.zeros(3), np.array([[0], [0], [1]]), 0.9)).all()
