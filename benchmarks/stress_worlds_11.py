"""Six more machines with drifts in physical units, three to five directions each.

They were written before any search ran on them, by an author who had not read the search. The form is that of
stress_worlds_10.py. `parafoil` fails in a corner of two directions; `loom` in a narrow valley around a resonance;
`brewery` beyond a plane to which five directions contribute; `tram` beyond a curved boundary; `sniffer` by chance, with
a slowly growing share of failures; `drillstring` has two failing regions, and one of its directions is a choice.

    python benchmarks/stress_worlds_11.py [MACHINE ...]      # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import exp, hypot, pi, sin, sqrt

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Choice, Span


def parafoil(
    rng: np.random.Generator, wind: float, wet: float, load: float, drop: float
) -> tuple[bool, float]:
    """Land a parafoil with a parcel within 25 m of a cross, after a release upwind.

    Drifts: `wind` (m/s); `wet`, share of water in the canopy; `load`, the parcel (kg); `drop`, height of the release
    (m). A wet canopy loses glide, which matters only against the wind. The reward falls with the distance.
    """
    gusts = rng.normal(0.0, 0.6, 12)
    aim = rng.normal(0.0, 4.0, 2)
    air = 7.5 * sqrt(load / 60.0)
    glide = 3.2 * (1.0 - 0.35 * wet)
    sink = air / glide
    east, left = float(-60.0 + aim[0]), drop
    for gust in gusts.tolist():
        span = left / 4.0 if left > 40.0 else left
        seconds = span / sink
        against = max(0.0, wind + gust)
        # the parafoil steers for the cross, and can fly with or against the wind
        wish = -east / max(seconds, 1e-6)
        east += seconds * clipped(wish, max(0.0, air - against if wish < 0.0 else air + against))
        east += seconds * 0.22 * against * wet
        left -= span
    off = hypot(east, float(aim[1]))
    return off < 25.0, 10.0 - 0.15 * min(off, 60.0)


def loom(
    rng: np.random.Generator, picks: float, tension: float, humidity: float, reed: float
) -> tuple[bool, float]:
    """Weave 300 picks on a loom whose warp resonates with its shed.

    Drifts: `picks`, speed (picks per minute); `tension` of the warp (cN per end); `humidity` of the hall (percent);
    `reed`, its wear (0 to 1). The cloth passes with at most two broken ends. The reward is the output, minus a share
    for each break.
    """
    ends = rng.gamma(20.0, 1.0 / 20.0, 40)
    luck = rng.random(40)
    own = 520.0 * sqrt(tension / 30.0) * (1.0 + 0.0012 * (humidity - 65.0))
    swing = 1.0 / sqrt((1.0 - (picks / own) ** 2) ** 2 + (0.1 * picks / own) ** 2)
    peak = tension * (1.0 + 0.1 * swing + 0.1 * reed)
    strength = 78.0 * (1.0 - 0.006 * abs(humidity - 68.0)) * (1.0 - 0.08 * reed)
    snaps = 1.0 / (1.0 + np.exp(-(peak - strength * ends) / 3.0))
    breaks = int((luck < 0.35 * snaps).sum())
    return breaks <= 2, picks / 45.0 - 1.2 * min(breaks, 8)


def brewery(
    rng: np.random.Generator, cellar: float, yeast: float, gravity: float, jacket: float, delay: float
) -> tuple[bool, float]:
    """Ferment a tank of lager for ten days with a cooling jacket.

    Drifts: `cellar`, temperature of the room (°C); `yeast`, share of living cells; `gravity` of the wort (°P);
    `jacket`, share of the cooling that is left; `delay` of the thermostat (h). The batch passes if the tank stays below
    15 °C and at least 72 % of the sugar is gone. The reward rises with the share of sugar that is gone, and falls with
    temperatures above 11.5 °C.
    """
    vigour, weather = float(rng.normal(1.0, 0.05)), rng.normal(0.0, 0.8, 10)
    sugar, cells, hot, highest = gravity, 1.0 * yeast, 10.0, 10.0
    seen = [10.0] * (1 + round(delay))
    for hour in range(240):
        warmth = exp(0.09 * (hot - 11.0))
        eaten = min(sugar, 0.024 * vigour * cells * warmth * sugar / (2.0 + sugar) * 3.0)
        sugar -= eaten
        cells = min(3.2, cells * (1.0 + 0.015 * warmth * sugar / gravity))
        cooling = 0.35 * jacket * clipped(max(0.0, seen[0] - 11.0), 1.0)
        room = cellar + float(weather[hour // 24])
        hot += 1.7 * eaten + 0.006 * (room - hot) - cooling
        seen = [*seen[1:], hot]
        highest = max(highest, hot)
    gone = 1.0 - sugar / gravity
    return highest < 15.0 and gone > 0.72, 8.0 * gone - 0.4 * max(0.0, highest - 11.5)


def tram(
    rng: np.random.Generator, leaves: float, slope: float, crowd: float, sanding: float
) -> tuple[bool, float]:
    """Stop a tram at six platforms, with a braking point chosen for dry rails.

    Drifts: `leaves`, how slippery the rails are (0 to 1); `slope` of the line (percent; positive is downhill); `crowd`,
    load (t); `sanding`, delay until sand lies on the rails (s). A stop passes within 4 m of the sign; the run passes
    with at most one bad stop. The reward falls with the mean error.
    """
    speeds = rng.normal(11.0, 0.25, 6)
    patches = np.clip(rng.normal(1.0, 0.25, 6), 0.0, 1.8)
    grip = 0.16 / (1.0 + 1.3 * leaves * patches)
    sanded = np.minimum(0.16, grip + 0.05)
    pull = GRAVITY * slope / 100.0
    force = 1.3 / (1.0 + 0.007 * (crowd - 8.0))
    early = np.maximum(0.15, np.minimum(force, GRAVITY * grip) - pull)
    late = np.maximum(0.15, np.minimum(force, GRAVITY * sanded) - pull)
    then = np.maximum(0.0, speeds - early * sanding)
    way = (speeds**2 - then**2) / (2.0 * early) + then**2 / (2.0 * late)
    errors = np.abs(way - speeds**2 / 2.6) * 0.45
    return int((errors > 4.0).sum()) <= 1, 10.0 - 0.5 * min(float(errors.mean()), 14.0)


def sniffer(
    rng: np.random.Generator, breeze: float, leak: float, traffic: float, age: float, pace: float
) -> tuple[bool, float]:
    """Find ten gas leaks along a street with a methane sensor on a car.

    Drifts: `breeze` across the street (m/s); `leak`, median size (l/min); `traffic`, vehicles ahead per minute; `age`
    of the sensor (years); `pace` of the car (m/s). The drive passes if at least eight leaks are found. The reward is
    the number of leaks, minus false alarms.
    """
    sizes = leak * rng.lognormal(0.0, 0.55, 10)
    aside = rng.uniform(2.0, 6.0, 10)
    mixed = rng.lognormal(0.0, 0.35, 10)
    luck, exhausts = rng.random(10), rng.random(20)
    plume = sizes * mixed / (0.6 + 0.5 * breeze) * np.exp(-aside / (3.0 + 1.2 * breeze))
    reached = 9.0 * plume * (1.0 - exp(-3.2 / (pace * (1.0 + 0.22 * age))))
    floor = 0.35 + 0.06 * age + 0.02 * traffic
    found = int((luck < 1.0 / (1.0 + np.exp(-(reached / floor - 1.0) / 0.3))).sum())
    wrong = int((exhausts < 0.004 * traffic).sum())
    return found >= 8, 1.0 * found - 0.4 * wrong


ROCKS = {"sandstone": (1.0, 0.08), "limestone": (1.25, 0.10), "chert": (1.7, 0.22)}  # hardness, scatter


def drillstring(
    rng: np.random.Generator, rock: str, weight: float, turns: float, mud: float, depth: float
) -> tuple[bool, float]:
    """Drill ten metres with a string that sticks and slips when it turns slowly, and whirls when it turns fast.

    Drifts: `rock` (sandstone, limestone or chert); `weight` on the bit (kN); `turns` (1/min); `mud`, flow (l/s);
    `depth` of the hole (m). A metre fails if the bit sticks, whirls, or is buried in cuttings. The run passes with at
    most one such metre. The reward is the drilling speed.
    """
    hardness, scatter = ROCKS[rock]
    hard = hardness * rng.lognormal(0.0, scatter, 10)
    loose = rng.normal(0.0, 1.0, 10)
    stick = 46.0 * sqrt(depth / 600.0) * (weight / 60.0) * hard**0.5 + 4.0 * loose
    whirl = 205.0 * sqrt(weight / 60.0) / hard**0.35 + 6.0 * loose
    speed = 9.0 * (weight / 60.0) * (turns / 120.0) / hard
    cleaned = 26.0 * mud / 20.0 * (1.0 - 0.00015 * depth)
    bad = int(((turns < stick) | (turns > whirl) | (speed > cleaned)).sum())
    return bad <= 1, float(speed.mean()) - 0.8 * min(bad, 6) + 0.2 * sin(pi * min(mud, 40.0) / 40.0)


ELEVENTH_MACHINES: Mapping[str, Machine] = {
    "parafoil": Machine(
        parafoil,
        {
            "wind": Span(0.0, 9.0, 2.0),
            "wet": Span(0.0, 1.0, 0.1),
            "load": Span(30.0, 90.0, 60.0),
            "drop": Span(150.0, 500.0, 300.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "loom": Machine(
        loom,
        {
            "picks": Span(150.0, 700.0, 300.0),
            "tension": Span(18.0, 40.0, 30.0),
            "humidity": Span(40.0, 85.0, 65.0),
            "reed": Span(0.0, 1.0, 0.1),
        },
        min_success=0.95,
        tolerance=4.0,
    ),
    "brewery": Machine(
        brewery,
        {
            "cellar": Span(2.0, 26.0, 10.0),
            "yeast": Span(0.3, 1.6, 1.0),
            "gravity": Span(9.0, 18.0, 12.0),
            "jacket": Span(0.35, 1.0, 0.95),
            "delay": Span(0.0, 12.0, 1.0),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "tram": Machine(
        tram,
        {
            "leaves": Span(0.0, 1.0, 0.1),
            "slope": Span(-2.0, 2.5, 0.0),
            "crowd": Span(0.0, 24.0, 8.0),
            "sanding": Span(0.2, 4.0, 0.8),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "sniffer": Machine(
        sniffer,
        {
            "breeze": Span(0.0, 8.0, 1.5),
            "leak": Span(1.5, 6.0, 4.0),
            "traffic": Span(0.0, 30.0, 4.0),
            "age": Span(0.0, 8.0, 1.0),
            "pace": Span(2.0, 11.0, 5.0),
        },
        min_success=0.9,
        tolerance=2.0,
    ),
    "drillstring": Machine(
        drillstring,
        {
            "rock": Choice(("sandstone", "limestone", "chert")),
            "weight": Span(35.0, 100.0, 60.0),
            "turns": Span(80.0, 180.0, 120.0),
            "mud": Span(9.0, 35.0, 20.0),
            "depth": Span(100.0, 2000.0, 600.0),
        },
        min_success=0.9,
        tolerance=5.0,
    ),
}


if __name__ == "__main__":
    command(ELEVENTH_MACHINES)
