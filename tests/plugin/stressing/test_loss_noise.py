"""Noise of losses: drifts far beyond the boundary must not blur the model near it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.findings import failure
from pytest_tarl.stressing.guarantee import Guarantee, recorded_mean
from pytest_tarl.stressing.loss_noise import (
    HIGHEST,
    cut_off,
    nominal_variance,
    pairing_wastes,
    standard_error,
    typical_variance,
    variance_near,
)
from pytest_tarl.stressing.map_figure import answer
from tests.plugin.stressing.worlds import recorded, space_of, stressed

SPACE = space_of(a=Drift.range(-0.8, 0.8, nominal=0.0), b=Drift.range(0.0, 3.0, nominal=0.0))
SIDE = 25  # cells of the map


def steep(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose much more than is tolerated soon beyond the boundary, with noise that grows with the loss."""
    lost = 8.0 * max(4.0 * abs(point["a"]) - 0.1, 0.0) + 8.0 * max(2.0 * point["b"] - 0.1, 0.0)
    return True, 10.0 - lost * (1.0 + 0.5 * float(draws.normal())) + 0.02 * float(draws.normal())


def test_extreme_losses_count_as_the_limits() -> None:
    assert cut_off([-9.0, 0.5, 40.0]) == pytest.approx([-1.5, 0.5, 2.5])


def test_far_drifts_do_not_affect_the_typical_variance() -> None:
    near = [cut_off([0.4, 0.6]), cut_off([0.5, 0.7])]
    far = [cut_off([30.0, 90.0])] * 20
    assert typical_variance([*near, *far]) == pytest.approx(0.02)
    assert typical_variance(far) == 1e-6
    assert typical_variance([cut_off([0.3])]) == 1e-6  # one episode shows no variance


def test_noiseless_drifts_do_not_hide_noise() -> None:
    quiet = [cut_off([0.0, 0.0])] * 30
    noisy = [cut_off([0.2, 0.6]), cut_off([0.5, 0.9])]
    assert typical_variance([*quiet, *noisy]) == pytest.approx(2 * 0.08 / 32)


def test_boundary_variance_uses_similar_losses() -> None:
    quiet = [cut_off([0.0, 0.02, -0.02])] * 30
    varying = [cut_off([0.4, 1.6, 1.0])] * 30
    far = [cut_off([30.0, 90.0])] * 30
    every = [*quiet, *varying, *far]
    assert variance_near(1.0, every, 0.001) == pytest.approx(0.36, rel=0.1)
    assert variance_near(0.0, every, 0.001) < 0.01
    assert variance_near(1.0, [*quiet, *far], 0.5) == pytest.approx(0.5, rel=0.2)  # no drift is similar
    assert variance_near(1.0, [cut_off([1.0])], 0.5) == 0.5  # one episode shows no variance


def test_error_of_a_mean_shrinks_to_the_typical_one() -> None:
    assert standard_error(cut_off([0.5, 0.5]), 0.0) == 0.0
    assert standard_error(cut_off([0.5, 0.5]), 0.25) == pytest.approx(np.sqrt(4 * 0.25 / 5 / 2))
    assert standard_error(cut_off([HIGHEST, 60.0]), 0.0) == 0.0  # both are at the limit


def test_nominal_episode_adds_the_recorded_noise_at_most() -> None:
    given = recorded(steep, SPACE)
    assert nominal_variance(given, 4.0) == pytest.approx((0.02 / 0.5) ** 2, rel=0.3)
    assert nominal_variance(given, 0.001) == 0.0005
    assert nominal_variance(replace(given, totals=()), 4.0) == 2.0
    assert nominal_variance(replace(given, tolerance=0.0), 4.0) == 2.0


def test_map_and_nearest_failure_survive_noise() -> None:
    found = stressed(steep, SPACE, budget=600)
    assert found.margin_map is not None
    holding = [
        (column, row)
        for row, pairs in enumerate(zip(found.margin_map.margins, found.margin_map.spreads, strict=True))
        for column, pair in enumerate(zip(*pairs, strict=True))
        if answer(*pair) == "holds"
    ]
    for column, row in holding:
        centre = {"a": (column + 0.5) / SIDE * 1.6 - 0.8, "b": (row + 0.5) / SIDE * 3.0}
        assert 8.0 * max(4.0 * abs(centre["a"]) - 0.1, 0.0) + 8.0 * max(2.0 * centre["b"] - 0.1, 0.0) <= 0.5
    assert found.failures
    # alone, a may change by 0.041 and b by 0.081: distances of 0.025 and 0.027
    assert 0.025 <= min(failure(SPACE, one.point).distance for one in found.failures) < 0.08


def test_nominal_episodes_are_saved_if_they_add_no_precision() -> None:
    given = Guarantee(0.9, 1.0, (9.9, 10.1) * 50, 1.0)
    noisy = [cut_off([0.4, 1.6, 1.0])] * 30
    quiet = [cut_off([0.9, 1.1, 1.0])] * 30
    assert pairing_wastes(given, noisy, noisy, 64)
    assert not pairing_wastes(given, quiet, noisy, 64)  # the same seeds cause the same losses
    assert not pairing_wastes(
        replace(given, totals=(9.0, 11.0) * 3), noisy, noisy, 64
    )  # few, varied recordings
    assert not pairing_wastes(replace(given, totals=(10.0,)), noisy, noisy, 64)
    assert not pairing_wastes(replace(given, tolerance=0.0), noisy, noisy, 64)
    assert recorded_mean(given, 0.01) < 10.0
    assert recorded_mean(given, 0.001) < recorded_mean(given, 0.01)
