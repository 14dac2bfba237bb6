"""Six more machines with drifts in physical units, written without knowledge of the search and its results.

The form is that of stress_worlds_8.py, with short simulations in four directions each. In `palletiser`, one direction
is a choice; in `skimmer`, the reward is noisy; in `matlander`, failures are rare; in `walkway`, the failing region is
small and away from the axes; in `downhill`, a failure needs two directions together; in `pumps`, one part fails after
another.

    python benchmarks/stress_worlds_9.py [MACHINE ...]       # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, hypot, pi, radians, sin, sqrt

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Choice, Span

# force (N), and the share lost if the carton is wet
CARTONS = {"plain": (90.0, 0.42), "glossy": (96.0, 0.18), "film": (74.0, 0.0)}


def palletiser(
    rng: np.random.Generator, carton: str, humidity: float, pace: float, tilt: float
) -> tuple[bool, float]:
    """Stack 24 cartons of about 4 kg with a suction gripper.

    Drifts: `carton` (plain, glossy or wrapped in film); `humidity` (share); `pace`, acceleration of the arm (m/s²);
    `tilt` of the floor (degrees). The pallet passes if at most one carton falls. The reward is the number of cartons,
    minus the time.
    """
    force, wet = CARTONS[carton]
    masses, seals = rng.normal(4.0, 0.25, 24), rng.normal(1.0, 0.05, 24)
    held = force * seals * (1.0 - wet * max(0.0, humidity - 0.4) ** 1.5)
    down = GRAVITY * cos(radians(tilt)) + 0.6 * pace
    needed = masses * hypot(down, 1.4 * (pace + GRAVITY * sin(radians(tilt))))
    fallen = int((needed > held).sum())
    return fallen <= 1, 24.0 - 2.0 * fallen - 12.0 / sqrt(pace)


def skimmer(
    rng: np.random.Generator, wind: float, weed: float, sun: float, drag: float
) -> tuple[bool, float]:
    """Collect litter on a lake for a day with a solar boat.

    Drifts: `wind` (m/s); `weed`, overgrown share of the lake; `sun`, energy of the day (kWh); `drag` of the fouled hull
    (1 when clean). The amount of litter on the lake varies widely. The day passes if the boat comes home with energy
    left. The reward is the litter in kg.
    """
    litter = 18.0 * float(rng.lognormal(0.0, 0.45))
    clouds, squall = float(rng.normal(1.0, 0.08)), float(rng.gumbel(0.0, 0.5))
    stored = 1.2 + 0.8 * sun * clouds
    blown = wind + 0.6 * max(0.0, squall)
    hourly = 0.24 * drag * (1.0 + 0.006 * blown**2) * (1.0 + 0.7 * weed)
    hours = min(8.0, 0.85 * stored / hourly)
    left = stored - hourly * hours - 0.02 * drag * blown
    share = hours / 8.0 * (1.0 - 0.3 * weed) * (1.0 - 0.004 * blown**1.5)
    return left > 0.0, litter * share


def matlander(
    rng: np.random.Generator, gusts: float, swing: float, dusk: float, battery: float
) -> tuple[bool, float]:
    """Land a courier drone on a mat of 1.2 m in a yard.

    Drifts: `gusts`, their scale (m/s); `swing` of the parcel on its cord (degrees); `dusk` (0 is day, 1 is night);
    `battery`, share of the thrust that is left. A landing fails if a single gust or a lost mark carries the drone off
    the mat. The reward is the accuracy, which hardly depends on the drifts.
    """
    gust = gusts * float(rng.gumbel(0.9, 0.28))
    lost = float(rng.exponential(0.06)) * (0.4 + 1.2 * dusk**2)
    reserve = 1.9 * battery - 0.8
    carried = 0.052 * gust**1.5 / reserve + 0.6 * lost + 0.012 * swing * (0.3 + 0.04 * gust**2)
    aimed = abs(float(rng.normal(0.0, 0.05)))
    return carried + aimed < 0.6, 10.0 - 2.0 * aimed - 0.1 * min(carried, 1.0)


def walkway(
    rng: np.random.Generator, speed: float, plank: float, load: float, wear: float
) -> tuple[bool, float]:
    """Carry samples over a boardwalk with a wheeled robot on springs; each plank is a small bump.

    Drifts: `speed` (m/s); `plank`, width of a plank (m); `load` (kg); `wear` of the dampers (0 to 1). The springs
    resonate if the planks come at the loaded robot's frequency. The trip passes if the samples are shaken by less than
    20.5 mm. The reward falls with the shaking.
    """
    rhythm = 2 * pi * speed * float(rng.normal(1.0, 0.01)) / plank
    own = sqrt(26000.0 / (55.0 + load + float(rng.normal(0.0, 0.5))))
    damping = 0.34 - 0.26 * wear
    ratio = rhythm / own
    bump = 0.0028 * (1.0 + 0.9 * clipped((plank - 0.15) / 0.45, 1.0)) * float(rng.lognormal(0.0, 0.06))
    gain = sqrt(1 + (2 * damping * ratio) ** 2) / hypot(1 - ratio**2, 2 * damping * ratio)
    shaken = 1000.0 * bump * gain
    return shaken < 20.5, 10.0 - 0.1 * min(shaken, 40.0)


def downhill(
    rng: np.random.Generator, slope: float, load: float, air: float, breeze: float
) -> tuple[bool, float]:
    """Bring logs down a forest road of 2 km with a tractor that holds its speed with its brakes.

    Drifts: `slope` (percent); `load` (t); `air`, temperature (°C); `breeze`, headwind (m/s). The trip passes if the
    brakes stay below 420 °C. The reward falls when they are above 300 °C.
    """
    step, hot, worst = 20.0, 25.0 + 0.5 * air, 0.0
    bends = rng.normal(1.0, 0.15, 34).tolist()
    mass = 2.5 + load * float(rng.normal(1.0, 0.03))
    for bend in bends:
        push = 1000.0 * mass * (0.01 * GRAVITY * slope * bend - 0.25) - 3.0 * (3.0 + breeze) ** 2
        heat = max(0.0, push) * 3.0 / 8000.0
        hot += step * (heat - 0.0065 * (1.0 + 0.03 * breeze) * (hot - air))
        worst = max(worst, hot)
    return worst < 420.0, 10.0 - 0.02 * clipped(max(0.0, worst - 300.0), 300.0)


def pumps(
    rng: np.random.Generator, inflow: float, clogged: float, volts: float, silt: float
) -> tuple[bool, float]:
    """Keep a pit dry with three pumps; if a pump trips from too much work, the others must do its work as well.

    Drifts: `inflow` (l/s); `clogged`, blocked share of each screen; `volts`, share of the usual voltage; `silt` (0 to
    1). The night passes if the pit does not overflow. The reward falls with the water in it.
    """
    screens = (1.0 - clogged * np.clip(rng.normal(1.0, 0.12, 3), 0.5, 1.5)).tolist()
    rain = rng.normal(1.0, 0.10, 90).tolist()
    heat, running = [0.0, 0.0, 0.0], [True, True, True]
    level = total = 0.0
    for now in range(90):
        wanted = max(0.0, inflow * rain[now] + 12.0 * (level - 0.4))
        working = max(1, sum(running))
        for i in range(3):
            if not running[i]:
                continue
            share = min(1.0, wanted / working / 27.0)
            power = share * (1.0 + 0.5 * silt) / (volts**2 * max(0.3, screens[i]) ** 0.5)
            heat[i] += 0.12 * (power - heat[i])
            wanted_here = share * 27.0 * volts * max(0.2, screens[i])
            level -= wanted_here / 60.0
            running[i] = heat[i] < 0.97
        level = max(0.0, level + inflow * rain[now] / 60.0)
        total += min(level, 5.0) / 90.0
        if level > 5.0:
            return False, 4.0 - 0.04 * (90 - now)
    return True, 10.0 - total


NINTH_MACHINES: Mapping[str, Machine] = {
    "palletiser": Machine(
        palletiser,
        {
            "carton": Choice(("plain", "glossy", "film")),
            "humidity": Span(0.2, 0.95, 0.45),
            "pace": Span(1.0, 7.0, 3.5),
            "tilt": Span(0.0, 10.0, 1.0),
        },
        min_success=0.95,
        tolerance=6.0,
    ),
    "skimmer": Machine(
        skimmer,
        {
            "wind": Span(0.0, 10.0, 3.0),
            "weed": Span(0.0, 0.6, 0.1),
            "sun": Span(1.0, 5.0, 3.5),
            "drag": Span(1.0, 1.8, 1.1),
        },
        min_success=0.9,
        tolerance=8.0,
    ),
    "matlander": Machine(
        matlander,
        {
            "gusts": Span(0.0, 2.8, 1.0),
            "swing": Span(0.0, 15.0, 3.0),
            "dusk": Span(0.0, 1.0, 0.1),
            "battery": Span(0.7, 1.0, 0.95),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "walkway": Machine(
        walkway,
        {
            "speed": Span(0.3, 1.6, 0.7),
            "plank": Span(0.15, 0.6, 0.4),
            "load": Span(0.0, 80.0, 20.0),
            "wear": Span(0.0, 1.0, 0.15),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "downhill": Machine(
        downhill,
        {
            "slope": Span(2.0, 14.0, 6.0),
            "load": Span(0.0, 6.0, 1.5),
            "air": Span(-10.0, 35.0, 12.0),
            "breeze": Span(0.0, 10.0, 2.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "pumps": Machine(
        pumps,
        {
            "inflow": Span(10.0, 58.0, 32.0),
            "clogged": Span(0.0, 0.35, 0.05),
            "volts": Span(0.85, 1.1, 1.0),
            "silt": Span(0.0, 1.0, 0.1),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
}


if __name__ == "__main__":
    command(NINTH_MACHINES)
