"""Drifts over time: their size changes suddenly, gradually or temporarily during the episode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from pytest_tarl.errors import SettingsError
from pytest_tarl.finite_numbers import finite_number

Shape = Literal["step", "ramp", "burst"]


@dataclass(frozen=True, slots=True)
class Profile:
    """The course of a drift that starts at time `at` (s); `lasts` is the duration (s) of a ramp or burst."""

    shape: Shape
    at: float
    lasts: float = 0.0

    def share(self, time: float) -> float:
        """Return the share of the drift's full size at a time in s; 0 is nominal."""
        if time < self.at:
            return 0.0
        if self.shape == "ramp":
            return min((time - self.at) / self.lasts, 1.0)
        return 0.0 if self.shape == "burst" and time >= self.at + self.lasts else 1.0


@dataclass(frozen=True, slots=True)
class Schedule:
    """The value of a drift over time; the test calls it with the time in s, such as `tarl.now`."""

    nominal: float
    size: float
    profile: Profile

    def __call__(self, time: float) -> float:
        """Return the value at a time in s since the episode began."""
        return self.nominal + (self.size - self.nominal) * self.profile.share(time)


def profile(shape: Shape, at: Any, lasts: Any = 0.0) -> Profile:
    """Return a checked profile. Raise SettingsError for an invalid time or duration."""
    begin, duration = finite_number(at), finite_number(lasts)
    if begin is None or begin < 0.0:
        raise SettingsError(f"Drift.{shape}: at must be a moment in seconds, 0 or later, got {at!r}.")
    if duration is None or (shape != "step" and duration <= 0.0):
        name = "over" if shape == "ramp" else "lasts"
        raise SettingsError(f"Drift.{shape}: {name} must be a duration in seconds above 0, got {lasts!r}.")
    return Profile(shape, begin, duration)
