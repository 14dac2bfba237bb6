"""Eight small simulated worlds for gate.py: sensor bins, rewards, and where a drift is active.

The drift ranges from 0 (as designed) to 1. For each step, a mission gives its sensors' bins, the reward, and whether
the drift is active at this place or time (or would be, if it is 0).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import cos, pi

import numpy as np

Generator = np.random.Generator


@dataclass
class Log:
    """One mission, step by step."""

    bins: list[tuple[int, ...]] = field(default_factory=list)
    reward: list[float] = field(default_factory=list)
    exposed: list[bool] = field(default_factory=list)

    def step(self, bins: tuple[int, ...], reward: float, exposed: bool) -> None:
        """Add one step."""
        self.bins.append(bins)
        self.reward.append(reward)
        self.exposed.append(exposed)


Simulation = Callable[[Generator, float], Log]


def binned(value: float, low: float, high: float, bins: int) -> int:
    """Return the bin of a value: -1 below the range, `bins` above it."""
    return max(-1, min(bins, int((value - low) / (high - low) * bins // 1)))


def track(rng: Generator, drift: float) -> Log:
    """Deliver over a straight track; in 60 % of the missions, soft ground takes up to 90 % of the speed."""
    log, x, v = Log(), rng.uniform(0.9, 1.1), 0.0
    soft = rng.random() < 0.6
    noise = rng.normal(0.0, 0.01, 75)
    for step in range(75):
        seen = x + noise[step]
        command = min(4.4, 0.4 * (11.0 - seen) + 0.3)
        here = soft and 5.0 <= x <= 7.0
        v += 0.6 * (command * (1 - 0.9 * drift * here) - v)
        before, x = x, x + 0.1 * v
        arrived = x >= 10.8
        late = step == 74 and not arrived
        earned = (x - before) / 2 - 0.02 + 5.0 * arrived - 10.0 * late
        log.step((binned(seen, 0, 12, 24),), earned, here)
        if arrived:
            break
    return log


def greenhouse(rng: Generator, drift: float) -> Log:
    """Hold 22 °C for a day with a vent, which the drift weakens in the afternoon by up to 80 %."""
    log, inside = Log(), rng.normal(20.0, 1.0)
    day = rng.normal(18.0, 1.5)
    noise = rng.normal(0.0, 0.25, 96)
    for quarter in range(96):
        hour = quarter / 4
        outside = day - 6.0 * cos((hour - 3.0) * pi / 12)
        vent = max(0.0, min(1.0, 0.4 * (inside - 21.0)))
        afternoon = 12.0 <= hour < 18.0
        sun = 3.0 * max(0.0, -cos(hour * pi / 12))
        inside += sun * 0.35 - vent * (1 - 0.8 * drift * afternoon) * 0.25 * max(inside - outside, 1.0)
        inside += 0.03 * (outside - inside) + noise[quarter]
        log.step((binned(inside, 10, 34, 12), int(hour // 4)), -abs(inside - 22.0) / 10, afternoon)
    return log


def lane(rng: Generator, drift: float) -> Log:
    """Stay within 1.5 m of a lane's centre for 100 m; the drift is wind between 60 m and 80 m."""
    log, y, heading = Log(), rng.normal(0.0, 0.1), 0.0
    noise, gusts = rng.normal(0.0, 0.05, 100), rng.normal(1.0, 0.4, 100)
    for s in range(100):
        seen = y + noise[s]
        windy = 60 <= s < 80
        heading += -0.25 * seen - 0.7 * heading + 0.02 * rng.standard_normal()
        y += heading + 0.35 * drift * gusts[s] * windy
        off = abs(y) > 1.5
        log.step((s // 10, binned(seen, -1.5, 1.5, 7)), 0.1 * (1 - abs(y)) - 10.0 * off, windy)
        if off:
            break
    return log


def gripper(rng: Generator, drift: float) -> Log:
    """Lift twelve boxes by suction; the drift weakens the grip on rough cardboard, one of four kinds of boxes."""
    log = Log()
    for _ in range(12):
        kind, tries = int(rng.integers(4)), 0
        while tries < 3:
            force = rng.normal(10.0, 1.0) - (6.0 * drift if kind == 2 else 0.0)
            held = force > 7.5
            log.step((kind, tries), 1.0 if held else -0.3, kind == 2)
            tries += 1
            if held:
                break
    return log


def climb(rng: Generator, drift: float) -> Log:
    """Climb to 10 m and stay there; the drift is a payload of up to 35 % of the weight."""
    log, z, v, integral = Log(), 0.0, 0.0, 0.0
    noise = rng.normal(0.0, 0.3, 120)
    for step in range(120):
        error = 10.0 - z + 0.05 * rng.standard_normal()
        integral += 0.1 * error if abs(error) < 2.0 else 0.0
        thrust = max(0.0, min(14.0, 9.81 + 1.2 * error - 2.6 * v + 0.2 * integral))
        v += 0.1 * (thrust / (1 + 0.35 * drift) - 9.81 + noise[step])
        z = max(0.0, z + 0.1 * v)
        log.step((binned(z, 0, 12, 8), binned(v, -2, 4, 6)), -abs(10.0 - z) / 10, True)
    return log


def convoy(rng: Generator, drift: float) -> Log:
    """Follow a lead car; the drift is a wet road, which weakens braking by up to 60 %."""
    log, gap, closing, lead = Log(), rng.normal(20.0, 2.0), 0.0, 0.0
    for _ in range(120):
        lead = 0.9 * lead + rng.normal(0.0, 0.5)
        command = max(-4.0, min(2.0, 0.12 * (gap - 20.0) - 0.5 * closing))
        braking = command < -0.5
        own = command * (1 - 0.6 * drift) if braking else command
        closing += 0.2 * (own - lead)
        gap -= 0.2 * closing
        crash = gap <= 4.0
        cell = (binned(gap, 0, 40, 10), binned(closing, -4, 4, 6))
        log.step(cell, -abs(gap - 20.0) / 100 - 10.0 * crash, braking)
        if crash:
            break
    return log


def gatherer(rng: Generator, drift: float) -> Log:
    """Walk across a 6 × 6 grid to the far corner; the drift makes the ground in one corner slippery."""
    log, x, y = Log(), 0, 0
    for _ in range(60):
        cell, slippery = (x, y), x >= 3 and y >= 2
        slips = rng.random() < (0.05 + 0.7 * drift * slippery)
        dx, dy = ((1, 0), (0, 1), (-1, 0), (0, -1))[int(rng.integers(4))] if slips else _towards(x, y, rng)
        x, y = max(0, min(5, x + dx)), max(0, min(5, y + dy))
        home = x == y == 5
        log.step(cell, 10.0 * home - 0.1, slippery)
        if home:
            break
    return log


def _towards(x: int, y: int, rng: Generator) -> tuple[int, int]:
    if x == 5 or (y < 5 and rng.random() < 0.5):
        return 0, 1
    return 1, 0


def pipe(rng: Generator, drift: float) -> Log:
    """Crawl through a pipe and clean it; with the drift, a wheel slips from step 50 on."""
    log, x = Log(), 0.0
    for step in range(100):
        late = step >= 50
        before = x
        x += max(0.0, rng.normal(0.1, 0.03)) * (1 - 0.8 * drift * late)
        log.step((binned(x, 0, 10, 20),), (x - before) - 0.05, late)
        if x >= 9.0:
            break
    return log


WORLDS: dict[str, Simulation] = {
    "track": track,
    "greenhouse": greenhouse,
    "lane": lane,
    "gripper": gripper,
    "climb": climb,
    "convoy": convoy,
    "gatherer": gatherer,
    "pipe": pipe,
}
