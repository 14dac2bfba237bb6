"""Thresholds that separate the values of drifted missions as they separated the designed ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.instrumentation.trace import Floats
from pytest_tarl.repairing.separating import MARGIN, between_groups, reaching, separating

DESIGNED = np.array([0.02, 0.05, 0.08, 0.03, 6.0])  # errors of a position, and a tag of the next track
SLIPPED = np.array([0.02, 1.1, 1.15, 1.1, 4.9])


def test_threshold_moves_between_slip_and_outliers() -> None:
    by = separating(0.5, [(DESIGNED, SLIPPED)])
    assert by is not None
    assert 0.5 * by == pytest.approx(np.sqrt(1.15 * 4.9))


def test_a_threshold_that_nothing_exceeded_moves_beyond_all_values() -> None:
    by = separating(1.0, [(np.full(5, 0.5), np.linspace(1.5, 2.0, 5))])
    assert by == pytest.approx(2.0 * MARGIN)
    by = separating(1.0, [(np.full(5, 2.0), np.linspace(0.4, 0.8, 5))])
    assert by == pytest.approx(0.4 / MARGIN)


def test_a_negative_threshold_moves_on_its_own_side() -> None:
    assert separating(-0.5, [(-DESIGNED, -SLIPPED)]) == separating(0.5, [(DESIGNED, SLIPPED)])
    assert separating(-0.5, [(DESIGNED, SLIPPED)]) is None


@pytest.mark.parametrize(
    "pairs",
    [
        [],
        [(DESIGNED, DESIGNED)],
        [(DESIGNED, np.array([]))],
        [(DESIGNED, SLIPPED), (SLIPPED, DESIGNED)],
        [(DESIGNED, SLIPPED), (DESIGNED, DESIGNED)],
        [(DESIGNED[:3], SLIPPED[:3])],
    ],
    ids=["no mission", "as designed", "no value", "opposite", "one mission only", "few values"],
)
def test_missions_that_do_not_separate_values_move_no_threshold(
    pairs: list[tuple[np.ndarray, np.ndarray]],
) -> None:
    assert separating(0.5, pairs) is None


@given(
    st.lists(st.floats(0.01, 100.0), min_size=4, max_size=30, unique=True),
    st.lists(st.floats(0.01, 100.0), min_size=4, max_size=30, unique=True),
    st.floats(0.02, 50.0),
)
def test_new_threshold_keeps_the_designed_share(
    designed: list[float], drifted: list[float], threshold: float
) -> None:
    before, after = np.array(designed), np.array(drifted)
    by = separating(threshold, [(before, after)])
    if by is not None:
        share, left = np.mean(before > threshold), np.mean(after > threshold * by)
        assert abs(left - share) <= 0.5 / after.size + 1e-9


OPEN = np.array([20.9, 21.0, 21.1, 21.0, 20.8, 21.2])  # voltage of open contacts
DOCKED = np.array([27.9, 28.0, 28.2, 28.1])
WORN = DOCKED - 5.0
DOCKS, TRIES = np.concatenate([OPEN, DOCKED]), np.concatenate([OPEN, WORN, OPEN, WORN, OPEN])


def test_threshold_stays_between_the_same_groups() -> None:
    by = between_groups(26.5, [(DOCKS, TRIES)])
    assert by is not None
    assert 26.5 * by == pytest.approx((21.2 + 22.9) / 2.0)
    assert between_groups(-26.5, [(-DOCKS, -TRIES)]) == by


@pytest.mark.parametrize(
    ("threshold", "pairs"),
    [
        (26.5, []),
        (26.5, [(DOCKS, DOCKS)]),  # still between the groups
        (26.5, [(DOCKS, OPEN)]),  # only one group
        (26.5, [(DOCKS, np.linspace(20.0, 28.0, 30))]),  # no gap
        (26.5, [(np.linspace(20.0, 28.0, 30), TRIES)]),
        (28.05, [(DOCKS, TRIES)]),  # not between the designed groups
        (26.5, [(DOCKS, np.append(OPEN, 24.0))]),  # a single value is no group
        (-26.5, [(DOCKS, TRIES)]),
        (26.5, [(DOCKS[:7], TRIES[:7])]),
    ],
)
def test_without_two_groups_in_both_worlds_no_threshold_moves(
    threshold: float, pairs: list[tuple[np.ndarray, np.ndarray]]
) -> None:
    assert between_groups(threshold, pairs) is None


FALLING = np.array([1.2, 0.6, 0.2, 0.05, 0.008])  # an angle that a base turns to its goal, rad
STUCK, LESS_STUCK = np.array([1.2, 0.5, 0.06, 0.06]), np.array([0.9, 0.04, 0.04])


def test_tolerance_reached_only_as_designed_is_widened() -> None:
    by = reaching(0.01, [(FALLING, LESS_STUCK), (FALLING, STUCK)])
    assert by == pytest.approx(0.06 * MARGIN / 0.01)
    assert reaching(-0.01, [(-FALLING, -STUCK)]) == pytest.approx(0.06 * MARGIN / 0.01)


def test_threshold_exceeded_only_as_designed_is_lowered() -> None:
    faded, more_faded = np.array([0.0, 20.0, 60.0]), np.array([0.0, 50.0])
    by = reaching(100.0, [(np.array([0.0, 40.0, 130.0]), faded), (np.array([0.0, 120.0]), more_faded)])
    assert by == pytest.approx(50.0 / MARGIN / 100.0)


@pytest.mark.parametrize(
    "pairs",
    [
        [],
        [(FALLING, np.array([]))],
        [(FALLING, FALLING)],  # drifted missions cross it, too
        [(FALLING, STUCK), (FALLING, FALLING)],  # one of them does
        [(STUCK, STUCK)],  # designed missions do not cross it
        [(FALLING, STUCK), (FALLING, np.array([0.001, 0.002]))],  # on different sides of it
    ],
    ids=["no pair", "no value", "crossed", "crossed once", "never crossed", "different sides"],
)
def test_threshold_crossed_in_both_worlds_is_not_moved(
    pairs: list[tuple[Floats, Floats]],
) -> None:
    assert reaching(0.01, pairs) is None


def test_values_of_the_opposite_sign_give_no_threshold() -> None:
    assert reaching(0.5, [(np.array([-1.0, 1.0]), np.array([-2.0, -1.0]))]) is None
