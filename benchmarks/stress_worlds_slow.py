"""Six machines whose share of failed missions grows slowly with the drifts, for developing the search.

Chance decides much of each mission, so a drift that fails 1 mission in 10 is far from one that fails 1 in 2. The
conventions are those of stress_worlds_5.py.

    python benchmarks/stress_worlds_slow.py [MACHINE ...]    # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import exp, sqrt

import numpy as np
from stress_machines import Machine, clipped, command

from pytest_tarl.spaces import Span


def courier(
    rng: np.random.Generator, range_: float, rain: float, crowd: float, relay: float
) -> tuple[bool, float]:
    """Send twelve orders by radio, with three tries each; the mission passes if at least eleven arrive.

    Drifts: `range_` (km); `rain` (mm/h); `crowd`, number of other senders; `relay`, height of the relay (m). The reward
    is the number of orders that arrive.
    """
    fading = rng.normal(0.0, 4.0, 36)  # dB
    quiet = rng.random(36)
    signal = 22.0 - 9.0 * range_ - 0.06 * rain * range_ + 3.0 * np.log2(relay / 6.0) + fading
    heard = (1.0 / (1.0 + np.exp(-0.5 * signal))) * np.exp(-0.02 * crowd) > quiet
    arrived = int(heard.reshape(12, 3).any(axis=1).sum())
    return arrived >= 11, float(arrived)


def night_shift(
    rng: np.random.Generator, payload: float, frost: float, age: float, hills: float
) -> tuple[bool, float]:
    """Work for a night on one charge; how much charge a night takes varies by a third.

    Drifts: `payload` (kg); `frost` (°C); `age` (years); `hills`, climb per hour (m). The shift passes if the charge
    lasts. The reward is the work done, which hardly depends on the drifts.
    """
    busy = exp(float(rng.normal(0.0, 0.33)))
    charge = 100.0 * (1.0 - 0.05 * age) * (1.0 - 0.006 * max(0.0, 15.0 - frost))
    taken = 36.0 * busy * (1.0 + 0.006 * payload + 0.0012 * hills + 0.00001 * payload * hills)
    return taken < charge, 10.0 * min(busy, 1.2) - 0.002 * taken


def docking(
    rng: np.random.Generator, multipath: float, current: float, lag: float, draught: float
) -> tuple[bool, float]:
    """Back a barge into a berth by satellite positions.

    Drifts: `multipath`, standard deviation of the positions' slow error (m); `current` across (m/s); `lag` of the
    rudder (s); `draught` (m), which makes the barge slow. The manoeuvre passes if the barge is never more than 1.6 m
    beside the line in the last 40 s. The reward falls with the mean deviation.
    """
    step, steps = 0.5, 200
    shocks, waves = rng.normal(0.0, 1.0, steps).tolist(), rng.normal(0.0, 0.02, steps).tolist()
    error = multipath * float(rng.normal(0.0, 1.0))
    side, speed, rudder, worst, total = 0.0, 0.0, 0.0, 0.0, 0.0
    keep = exp(-step / 25.0)
    for now in range(steps):
        error = keep * error + multipath * sqrt(1.0 - keep * keep) * shocks[now]
        wanted = clipped(-0.05 * (side + error) - 0.5 * speed, 0.2)
        rudder += step / (step + lag) * (wanted - rudder)
        speed += step * (rudder / draught + waves[now] - 0.15 * (speed - 0.3 * current))
        side += step * speed
        total += abs(side) / steps
        if now >= steps - 80:
            worst = max(worst, abs(side))
    return worst < 1.6, 10.0 - 2.0 * min(total, 4.0)


def seal(
    rng: np.random.Generator, pressure: float, heat: float, cycles: float, grit: float
) -> tuple[bool, float]:
    """Run a pump for a day; its seal bursts by chance, sooner under more strain. The reward shows nothing of this.

    Drifts: `pressure` (bar); `heat` (°C); `cycles` per hour; `grit` (g/l).
    """
    lasting = float(rng.exponential(1.0))
    strain = (
        0.006 * (pressure / 6.0) ** 2.5 * exp(0.035 * (heat - 40.0)) * (1.0 + 0.06 * cycles) + 0.05 * grit
    )
    return lasting > strain, 1.0


def bin_picking(
    rng: np.random.Generator, oil: float, camera: float, speed: float, mix: float
) -> tuple[bool, float]:
    """Pick twenty parts from a bin; the mission passes if at most two fall.

    Drifts: `oil`, thickness of the film (µm); `camera`, offset (mm); `speed` (m/s); `mix`, share of unknown parts. The
    reward is the number of parts picked in time.
    """
    luck, aside = rng.random(20), rng.normal(0.0, 1.0, 20)
    unknown = rng.random(20) < mix
    off = np.abs(aside * (1.0 + 1.5 * unknown) + camera)
    hold = 4.2 - 0.045 * oil - 0.35 * np.maximum(off - 1.0, 0.0) - 0.5 * speed**2 - 0.8 * unknown
    kept = int((1.0 / (1.0 + np.exp(-hold)) > luck).sum())
    return kept >= 18, kept * (0.7 + 0.3 * speed)


def night_patrol(
    rng: np.random.Generator, fog: float, speed: float, people: float, glare: float
) -> tuple[bool, float]:
    """Patrol a yard in which people step out of gates; the robot must never come within 0.4 m of them.

    Drifts: `fog`, extinction (1/m); `speed` (m/s); `people` per hour; `glare`, which limits sight on one side. The
    reward is the patrolled length, minus a little for each stop.
    """
    draws, sides, quick = rng.random((40, 2)), rng.random(40), rng.gamma(4.0, 0.25, 40)
    met = min(40, int((rng.random(40) < people / 40.0).sum()))
    close = False
    for one in range(met):
        sight = 14.0 * exp(-fog * 6.0) * (1.0 - glare * (sides[one] < 0.5)) * (0.4 + draws[one, 0])
        need = speed * 0.5 * quick[one] + speed**2 / 2.4 + 0.4
        close = close or bool(sight < need * (0.6 + draws[one, 1]))
    return not close, 100.0 * speed - 1.0 * met


SLOW_MACHINES: Mapping[str, Machine] = {
    "courier": Machine(
        courier,
        {
            "range_": Span(0.4, 2.6, 0.9),
            "rain": Span(0.0, 60.0, 0.0),
            "crowd": Span(0.0, 40.0, 4.0),
            "relay": Span(2.0, 12.0, 6.0),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "night_shift": Machine(
        night_shift,
        {
            "payload": Span(0.0, 80.0, 15.0),
            "frost": Span(-25.0, 25.0, 15.0),
            "age": Span(0.0, 8.0, 1.0),
            "hills": Span(0.0, 300.0, 20.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "docking": Machine(
        docking,
        {
            "multipath": Span(0.0, 2.0, 0.3),
            "current": Span(-0.5, 0.5, 0.0),
            "lag": Span(0.5, 8.0, 2.0),
            "draught": Span(0.6, 2.5, 1.0),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "seal": Machine(
        seal,
        {
            "pressure": Span(2.0, 16.0, 6.0),
            "heat": Span(10.0, 90.0, 40.0),
            "cycles": Span(0.0, 60.0, 5.0),
            "grit": Span(0.0, 6.0, 0.0),
        },
        min_success=0.95,
        tolerance=0.5,
    ),
    "bin_picking": Machine(
        bin_picking,
        {
            "oil": Span(0.0, 60.0, 5.0),
            "camera": Span(-4.0, 4.0, 0.0),
            "speed": Span(0.5, 2.2, 1.0),
            "mix": Span(0.0, 0.8, 0.05),
        },
        min_success=0.9,
        tolerance=3.0,
    ),
    "night_patrol": Machine(
        night_patrol,
        {
            "fog": Span(0.0, 0.15, 0.01),
            "speed": Span(0.4, 2.0, 0.8),
            "people": Span(0.0, 30.0, 6.0),
            "glare": Span(0.0, 0.9, 0.1),
        },
        min_success=0.95,
        tolerance=40.0,
    ),
}


if __name__ == "__main__":
    command(SLOW_MACHINES)
