"""Conformal ranks are exactly uniform and independent for exchangeable scores, even with ties."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial.legendre import leggauss

from pytest_tarl.monitoring import conformal
from pytest_tarl.monitoring.conformal import BINS, edges, factors, joined, ranks
from pytest_tarl.monitoring.restarts import BETS


def one_by_one(pool: np.ndarray, bins: np.ndarray, draws: np.ndarray) -> np.ndarray:
    """Return the ranks by their definition, adding each score to a list."""
    found = np.full(bins.shape, 0.5)
    for score in range(bins.shape[1]):
        seen = [value for value in range(BINS) for _ in range(pool[score, value])]
        for mission, value in enumerate(bins[:, score].tolist()):
            if value < 0:
                continue
            equal = seen.count(value) + 1
            found[mission, score] = (sum(one < value for one in seen) + draws[mission] * equal) / (
                len(seen) + 1
            )
            seen.append(value)
    return found


@given(st.integers(0, 2**32 - 1), st.integers(1, 20), st.integers(1, 4), st.integers(0, 30))
def test_joint_ranks_equal_sequential_ranks(seed: int, count: int, scores: int, offline: int) -> None:
    rng = np.random.default_rng(seed)
    pool = np.zeros((scores, BINS), np.int64)
    for score in range(scores):
        pool[score] = np.bincount(rng.integers(0, 6, offline), minlength=BINS)
    bins, draws = rng.integers(-1, 6, (count, scores)), 1.0 - rng.random(count)
    low, high = ranks(pool, bins, draws)
    np.testing.assert_allclose(low, one_by_one(pool, bins, draws), rtol=1e-12)
    np.testing.assert_allclose(low + high, 1.0, rtol=1e-9)
    assert (low > 0).all()
    assert (high > 0).all()
    cut = count // 2
    again = ranks(joined(pool, bins[:cut]), bins[cut:], draws[cut:])
    np.testing.assert_array_equal(np.concatenate((ranks(pool, bins[:cut], draws[:cut])[0], again[0])), low)


@pytest.mark.parametrize("scores", [(0, 1, 2, 3, 4, 5), (0, 0, 1, 1, 1, 2), (3, 3, 3, 3, 3, 3)])
def test_ranks_of_exchangeable_missions_are_uniform_and_independent(
    scores: tuple[int, ...],
) -> None:
    """For each order of three scores, their ranks are uniform in a box; the boxes of all orders fill the unit cube."""
    offline, parts = 3, 60  # 60 is a multiple of 4, 5 and 6, so bins of sixtieths cover all their intervals
    density = np.zeros((parts,) * 3)
    orders = list(permutations(scores))
    for order in orders:
        pool = np.bincount(order[:offline], minlength=BINS)[None, :]
        bins = np.array(order[offline:])[:, None]
        ends = [ranks(pool, bins, np.full(3, draw))[0][:, 0] for draw in (2.0**-53, 1.0)]
        places = [slice(round(a * parts), round(b * parts)) for a, b in zip(*ends, strict=True)]
        sides = [place.stop - place.start for place in places]
        density[tuple(places)] += 1.0 / np.prod(sides)
    np.testing.assert_allclose(density * parts**3 / len(orders), 1.0, rtol=1e-9)


def test_every_bet_integrates_to_one_and_is_nonnegative() -> None:
    """Substitute p = s^8 on both halves of the unit interval, which removes the poles."""
    nodes, weights = leggauss(80)
    top = 0.5 ** (1 / 8)
    s, w = (nodes + 1) / 2 * top, weights / 2 * top
    near, measure = s**8, w * 8 * s**7
    total = np.zeros(BETS)
    for low, high in ((near, 1.0 - near), (1.0 - near, near)):
        values = np.empty((len(low), BETS, 1))
        factors(low[:, None], high[:, None], values)
        values = values[:, :, 0]
        assert (values >= 0).all()
        total += measure @ values
    np.testing.assert_allclose(total, 1.0, rtol=1e-6)


@given(st.lists(st.floats(-1e6, 1e6, allow_nan=False), min_size=0, max_size=200), st.floats(1e-3, 1e6))
def test_bins_are_ordered_and_rounding_changes_no_bin(values: list[float], unit: float) -> None:
    found = edges(np.array(values), unit)
    assert found.shape == (BINS - 1,)
    assert (np.diff(found[np.isfinite(found)]) > 0).all()
    for value in values:
        # Values that differ by less than CLOSE count as equal; the bin edges are at the value ± CLOSE / 2.
        on_grid = round(value / (conformal.CLOSE * unit)) * (conformal.CLOSE * unit)
        shaken = np.searchsorted(found, [on_grid - 1e-5 * unit, on_grid + 1e-5 * unit])
        assert shaken[0] == shaken[1]


def test_outliers_have_their_own_bins() -> None:
    found = edges(np.random.default_rng(0).normal(size=100), 1.0)
    assert np.searchsorted(found, -100.0) == 0
    bins = np.searchsorted(found, [-100.0, -3.0, 0.0, 3.0, 100.0])
    assert (np.diff(bins) > 0).all()
