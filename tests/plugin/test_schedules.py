"""The size of a drift over time."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.schedules import Profile, Schedule, profile


@pytest.mark.parametrize(
    ("shape", "shares"),
    [
        ("step", {1.99: 0.0, 2.0: 1.0, 2.5: 1.0, 99.0: 1.0}),
        ("ramp", {1.99: 0.0, 2.0: 0.0, 3.0: 0.25, 4.0: 0.5, 6.0: 1.0, 6.01: 1.0, 99.0: 1.0}),
        ("burst", {1.99: 0.0, 2.0: 1.0, 5.99: 1.0, 6.0: 0.0, 99.0: 0.0}),
    ],
)
def test_drift_lasts_for_its_duration(shape: Any, shares: dict[float, float]) -> None:
    found = Profile(shape, at=2.0, lasts=4.0)
    assert {time: found.share(time) for time in shares} == shares


def test_a_value_moves_from_nominal_to_its_size() -> None:
    found = Schedule(nominal=3.0, size=1.0, profile=Profile("ramp", 10.0, 4.0))
    assert [found(time) for time in (0.0, 10.0, 11.0, 14.0, 20.0)] == [3.0, 3.0, 2.5, 1.0, 1.0]


@pytest.mark.parametrize(
    ("shape", "at", "lasts", "words"),
    [
        ("step", -0.1, 0.0, "Drift.step: at must be a moment"),
        ("step", math.inf, 0.0, "at must be a moment"),
        ("ramp", "soon", 1.0, "Drift.ramp: at must be a moment in seconds, 0 or later, got 'soon'"),
        ("ramp", 1.0, 0.0, "Drift.ramp: over must be a duration in seconds above 0, got 0.0"),
        ("burst", 1.0, 0.0, "Drift.burst: lasts must be a duration"),
        ("burst", 1.0, -1.0, "lasts must be a duration"),
        ("burst", 1.0, None, "lasts must be a duration"),
    ],
)
def test_an_invalid_moment_or_duration_is_refused(shape: Any, at: Any, lasts: Any, words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        profile(shape, at, lasts)


def test_drift_may_begin_with_the_episode() -> None:
    assert profile("step", 0) == Profile("step", 0.0, 0.0)
    assert profile("ramp", 0, 0.5) == Profile("ramp", 0.0, 0.5)
