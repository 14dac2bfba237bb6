"""Six more machines with drifts in physical units, written before the search that they judge was changed.

The form is that of stress_worlds_7.py, with short simulations. In `ferry`, one direction matters; in `kiln`, two
interact; in `spinner`, the failing region is a narrow band; in `climber`, failures become frequent only slowly; in
`labeller`, the reward shows nothing until the mission fails; in `valet`, one of five directions is a choice.

    python benchmarks/stress_worlds_8.py [MACHINE ...]       # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import exp, pi, sqrt

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Choice, Span


def ferry(
    rng: np.random.Generator, current: float, load: float, glare: float, trim: float
) -> tuple[bool, float]:
    """Cross a river of 80 m twelve times with a ferry on a cable.

    Drifts: `current` (m/s); `load` (t); `glare`, share of the landings at which the camera sees its mark late; `trim`
    (degrees). The day passes if at most one crossing takes more than 110 s. The reward is the number of crossings in
    time, minus the time.
    """
    gusts, rolls = rng.normal(1.0, 0.12, 12), rng.random((12, 3))
    pushed = np.minimum(np.abs(current * gusts) / 2.6, 0.98)
    speed = 1.15 * np.sqrt(1.0 - pushed**2) * (1.0 - 0.004 * load) * (1.0 - 0.0015 * abs(trim))
    times = 80.0 / np.maximum(speed, 0.15) + 2.0 * (rolls < 0.4 * glare).sum(axis=1)
    late = int((times > 110.0).sum())
    return late <= 1, 12.0 - late - 0.02 * (min(float(times.mean()), 250.0) - 75.0)


def kiln(
    rng: np.random.Generator, moisture: float, draught: float, grate: float, soot: float
) -> tuple[bool, float]:
    """Hold a tile kiln at 900 °C for four hours with a PI loop on the fuel, burning wood chips.

    Drifts: `moisture` of the chips (share); `draught` of the chimney (Pa); `grate`, its free share; `soot`, thickness
    of the soot on the probe (mm). Wet chips need much air. The firing passes if the kiln stays within 60 K of its
    temperature for 85 % of the time. The reward falls with the error and the fuel used.
    """
    shocks, reads = rng.normal(0.0, 1.0, 80).tolist(), rng.normal(0.0, 4.0, 80).tolist()
    wall = float(rng.normal(1.0, 0.03))
    hot, seen, total, good, wrong, burnt, gust = 900.0, 900.0, 0.42, 0, 0.0, 0.0, 0.0
    for now in range(80):
        gust += -0.3 * gust + 0.06 * shocks[now]
        air = max(0.2, draught * (1.0 + gust) / 30.0) * (0.6 + 0.4 * grate)
        seen += min(1.0, 1.0 / (1.0 + 0.8 * soot)) * (hot + reads[now] - seen)
        error = (900.0 - seen) / 100.0
        total = min(1.0, max(0.0, total + 0.05 * error))
        fuel = min(1.0, max(0.0, total + 0.35 * error))
        burning = min(fuel, 0.95 * air / (0.35 + 2.2 * moisture))
        hot += 130.0 * burning * (1.0 - 0.45 * moisture) - 0.058 * wall * (hot - 20.0)
        good += abs(hot - 900.0) < 60.0
        wrong += abs(hot - 900.0) / 8000.0
        burnt += fuel / 80.0
    return good >= 68, 10.0 - 3.0 * min(wrong, 3.0) - 2.0 * burnt


def spinner(
    rng: np.random.Generator, speed: float, stiffness: float, load: float, imbalance: float
) -> tuple[bool, float]:
    """Spin a drum of 18 kg on springs at a constant speed.

    Drifts: `speed` (revolutions per second); `stiffness` of the springs (kN/m); `load` (kg); `imbalance` (kg·m). The
    run passes if the drum moves by less than 9 mm. The reward falls with the movement.
    """
    mass, drum = 18.0 + load * float(rng.normal(1.0, 0.02)), 2 * pi * speed * float(rng.normal(1.0, 0.006))
    own = sqrt(1000.0 * stiffness * float(rng.normal(1.0, 0.01)) / mass)
    damping, uneven = 0.035, imbalance * float(rng.lognormal(0.0, 0.08))
    below = sqrt((own**2 - drum**2) ** 2 + (2 * damping * own * drum) ** 2)
    moved = 1000.0 * uneven / mass * drum**2 / below + abs(float(rng.normal(0.0, 0.2)))
    return moved < 9.0, 10.0 - 0.3 * min(moved, 20.0)


def climber(
    rng: np.random.Generator, wet: float, rise: float, worn: float, load: float
) -> tuple[bool, float]:
    """Climb 60 stairs with a robot on tracks, which may lose its hold on each stair.

    Drifts: `wet` (0 to 1); `rise`, height of a stair (cm); `worn`, wear of the tracks (0 to 1); `load` (kg). A robot
    that loses its hold recovers in four of five cases; otherwise it falls. The reward is the time saved, which depends
    little on the slips.
    """
    slips, catches, tempo = rng.random(60), rng.random(60), float(rng.normal(0.0, 0.3))
    hold = (
        7.8 - 1.5 * wet - 1.1 * worn - 1.6 * wet * worn - 0.14 * (rise - 17.0) - 0.05 * max(0.0, load - 5.0)
    )
    share = 1.0 / (1.0 + exp(hold))
    slipped = slips < share
    fallen = bool((slipped & (catches < 0.2 + 0.015 * load)).any())
    return not fallen, 10.0 + tempo - 0.1 * float(slipped.sum()) - 0.02 * abs(rise - 17.0)


def labeller(
    rng: np.random.Generator, speed: float, tilt: float, cold: float, slip: float
) -> tuple[bool, float]:
    """Stick labels on thirty jars; a camera behind the machine counts those that are more than 3 mm off.

    Drifts: `speed` of the belt (m/s); `tilt` of the light barrier (degrees); `cold`, how much colder than usual the
    glue is (K); `slip` of the belt (percent). The batch passes with at most two bad labels. The reward is 10 for a good
    batch and 8 for a bad one.
    """
    jitter, dabs = rng.normal(0.0, 0.45, 30), rng.exponential(1.0, 30)
    middle = 9.0 * (speed - 0.5) - 0.55 * tilt + 0.06 * speed * slip * slip
    creep = 0.004 * cold * cold * dabs * (0.4 + 0.6 * speed)
    bad = int((np.abs(middle + jitter - creep) > 3.0).sum())
    return bad <= 2, 10.0 if bad <= 2 else 8.0


def valet(
    rng: np.random.Generator, surface: str, slope: float, tread: float, mass: float, fog: float
) -> tuple[bool, float]:
    """Park a car eight times, braking from 3 m/s before a wall that a camera sees at 4.5 m.

    Drifts: `surface` (asphalt, cobbles or leaves); `slope` (percent; positive is downhill); `tread` (mm); `mass` of the
    passengers (kg); `fog` (0 to 1). The job passes if every stop is at least 0.3 m before the wall. The reward falls
    with the distance left and with hard braking.
    """
    usual, rough = {"asphalt": (0.75, 0.03), "cobbles": (0.55, 0.12), "leaves": (0.25, 0.12)}[surface]
    luck, looks = rng.normal(0.0, 1.0, 8), rng.exponential(0.06, 8)
    worn = 1.0 - 0.06 * clipped(max(0.0, 4.0 - tread), 4.0)
    rub = np.maximum(usual * worn * (1.0 + rough * luck), 0.05)
    braked = np.minimum(GRAVITY * rub, 4.2 * 1500.0 / (1500.0 + mass)) - 0.01 * GRAVITY * slope
    needed = 3.0 * (0.25 + looks * (0.5 + fog)) + 4.5 / np.maximum(braked, 0.2)
    left = 4.5 - 0.5 * fog - needed
    return bool(left.min() > 0.3), 10.0 - 0.4 * float(np.abs(np.clip(left, -3.0, 3.0) - 1.5).mean())


EIGHTH_MACHINES: Mapping[str, Machine] = {
    "ferry": Machine(
        ferry,
        {
            "current": Span(0.0, 2.4, 0.8),
            "load": Span(0.0, 30.0, 8.0),
            "glare": Span(0.0, 1.0, 0.1),
            "trim": Span(-8.0, 8.0, 0.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
    "kiln": Machine(
        kiln,
        {
            "moisture": Span(0.05, 0.55, 0.15),
            "draught": Span(8.0, 45.0, 30.0),
            "grate": Span(0.3, 1.0, 0.9),
            "soot": Span(0.0, 6.0, 0.3),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "spinner": Machine(
        spinner,
        {
            "speed": Span(2.0, 16.0, 11.0),
            "stiffness": Span(4.0, 60.0, 20.0),
            "load": Span(0.0, 9.0, 4.0),
            "imbalance": Span(0.0, 0.12, 0.02),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "climber": Machine(
        climber,
        {
            "wet": Span(0.0, 1.0, 0.1),
            "rise": Span(12.0, 26.0, 17.0),
            "worn": Span(0.0, 1.0, 0.1),
            "load": Span(0.0, 30.0, 5.0),
        },
        min_success=0.93,
        tolerance=1.5,
    ),
    "labeller": Machine(
        labeller,
        {
            "speed": Span(0.2, 1.0, 0.5),
            "tilt": Span(-6.0, 6.0, 0.0),
            "cold": Span(0.0, 30.0, 4.0),
            "slip": Span(0.0, 8.0, 1.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
    "valet": Machine(
        valet,
        {
            "surface": Choice(("asphalt", "cobbles", "leaves")),
            "slope": Span(-8.0, 12.0, 0.0),
            "tread": Span(1.0, 8.0, 6.0),
            "mass": Span(0.0, 600.0, 150.0),
            "fog": Span(0.0, 1.0, 0.0),
        },
        min_success=0.95,
        tolerance=0.6,
    ),
}


if __name__ == "__main__":
    command(EIGHTH_MACHINES)
