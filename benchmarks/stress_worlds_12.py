"""Ten more machines with drifts in physical units, four directions each, and three in which nothing breaks.

They were written before any search ran on them, by an author who had not read the search. The form is that of
stress_worlds_11.py. `maglev`, `caster` and `stirred_tank` become unstable; `chromatograph` and `laser_link` fail on
both sides of a valley; `tape_library` fails by chance, as its queue grows; `beacons`, `irrigator`, `eddy_sorter` and
`footbridge` fail beyond curved boundaries.

    python benchmarks/stress_worlds_12.py [MACHINE ...]      # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import exp, pi, sqrt

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Choice, Span


def maglev(
    rng: np.random.Generator, delay: float, load: float, warm: float, joint: float
) -> tuple[bool, float]:
    """Carry a tray on a magnet for two seconds, over the joints of a rail.

    Drifts: `delay` of the gap sensor (ms); `load` on the tray (kg); `warm`, temperature of the coil (°C); `joint`,
    height of the rail's joints (mm). The tray passes if its gap stays between 0.3 and 7.7 mm. The reward falls with the
    deviation of the gap.
    """
    bumps = rng.normal(0.0, 1.0, 8)
    step, gap, speed, moved = 0.002, 4.0, 0.0, 0.0
    seen = [4.0] * (2 + round(delay / (1000.0 * step)))
    most = 3.2 * (4.0 + 3.0) / (4.0 + load) * 1.7 / (1.0 + 0.0039 * (warm - 25.0))
    low = high = 4.0
    for tick in range(1000):
        if tick % 125 == 60:
            gap += joint * float(bumps[tick // 125])
        rate = (seen[0] - seen[1]) / -step
        seen = [*seen[1:], gap]
        pull = clipped(420.0 * (seen[0] - 4.0) + 34.0 * rate, 110.0 * most)
        speed += step * (130.0 * (gap - 4.0) - pull)
        gap += step * speed
        low, high = min(low, gap), max(high, gap)
        moved += abs(gap - 4.0)
        if not 0.0 < gap < 8.0:
            return False, tick / 200.0
    return low > 0.3 and high < 7.7, 10.0 - 0.006 * min(moved, 1000.0)


def eddy_sorter(
    rng: np.random.Generator, belt: float, wet: float, size: float, splitter: float
) -> tuple[bool, float]:
    """Throw 60 pieces of aluminium over a splitter, and let 60 pieces of plastic fall before it.

    Drifts: `belt`, speed (m/s); `wet`, share of pieces that stick to the belt; `size` of the pieces (mm); `splitter`,
    distance (mm). The batch passes if 85 % of each material land on their side. The reward is the purity.
    """
    sizes = size * rng.lognormal(0.0, 0.22, 60)
    luck = rng.normal(0.0, 1.0, (2, 60))
    stuck = 0.1 * (rng.random((2, 60)) < wet)
    kick = 1.35 * (1.0 - np.exp(-((sizes / 22.0) ** 2)))
    fall = sqrt(2.0 * 0.55 / GRAVITY)
    metal = 1000.0 * ((belt + kick) * (fall - stuck[0])) + 45.0 * luck[0]
    plastic = 1000.0 * (belt * (fall - stuck[1])) + 35.0 * luck[1]
    right, wrong = float((metal > splitter).mean()), float((plastic > splitter).mean())
    return right >= 0.85 and wrong <= 0.15, 10.0 * (right - wrong)


def chromatograph(
    rng: np.random.Generator, flow: float, oven: float, age: float, acid: float
) -> tuple[bool, float]:
    """Separate six pairs of substances on a column.

    Drifts: `flow` (ml/min); `oven` (°C); `age` of the column (hundreds of runs); `acid`, pH of the solvent. A pair
    counts if its resolution is above 1.5. The run passes with five pairs in 30 minutes. The reward falls with the
    duration.
    """
    near = 1.14 + 0.01 * rng.normal(0.0, 1.0, 6)
    held = 3.0 * rng.lognormal(0.0, 0.08, 6) * exp(-0.018 * (oven - 35.0))
    plates = (
        9500.0
        * (1.0 - 0.06 * age)
        / (0.45 * (0.55 / flow + flow / 0.9) + 0.1)
        * (1.0 + 0.004 * (oven - 35.0))
    )
    apart = near * (1.0 - 0.03 * (acid - 3.2) ** 2)
    resolved = 0.25 * np.sqrt(plates) * np.maximum(0.0, apart - 1.0) / near * held / (1.0 + held)
    minutes = 3.4 / flow * (1.0 + float(held.max()))
    return int((resolved > 1.5).sum()) >= 5 and minutes < 30.0, 9.0 - 0.25 * min(minutes, 30.0)


def beacons(
    rng: np.random.Generator, water: float, salt: float, swell: float, echo: float
) -> tuple[bool, float]:
    """Locate a diver 20 times from three acoustic beacons, with the speed of sound of a mild sea.

    Drifts: `water`, temperature (°C); `salt` (g/kg); `swell`, movement of the beacons (m); `echo`, share of pings heard
    via the ground. A fix passes within 1.5 m; the dive passes with 17 good fixes. The reward falls with the median
    error.
    """
    at = rng.uniform(-25.0, 25.0, (20, 2))
    noise = rng.normal(0.0, 1.0, (20, 3))
    heard = rng.random((20, 3)) < echo
    detour = rng.uniform(0.5, 4.0, (20, 3))
    posts = np.array([[-60.0, -35.0], [60.0, -35.0], [0.0, 70.0]])
    sound = 1449.2 + 4.6 * water - 0.055 * water**2 + 1.34 * (salt - 35.0)
    scale = 1500.0 / sound
    ways = np.linalg.norm(at[:, None, :] - posts[None], axis=2)
    ranges = scale * (ways + heard * detour) + (0.12 + 0.6 * swell) * noise
    # the squared ranges minus that of the third beacon are linear in the position
    matrix = 2.0 * (posts[2] - posts[:2])
    right = ranges[:, :2] ** 2 - ranges[:, 2:] ** 2 - (posts[:2] ** 2).sum(1) + (posts[2] ** 2).sum()
    found = np.linalg.solve(matrix, right.T).T
    errors = np.linalg.norm(found - at, axis=1)
    return int((errors < 1.5).sum()) >= 17, 10.0 - 2.5 * min(float(np.median(errors)), 3.5)


def footbridge(
    rng: np.random.Generator, crowd: float, stiffness: float, damper: float, frost: float
) -> tuple[bool, float]:
    """Carry walkers over a footbridge whose tuned damper was adjusted on a mild day.

    Drifts: `crowd`, number of walkers; `stiffness` of the deck relative to its design; `damper`, share of its damping
    that is left; `frost` (°C), which moves its frequency. Walkers fall into step when the deck moves. The day passes if
    the deck's acceleration stays below 0.9 m/s². The reward falls with the motion.
    """
    pace = rng.normal(1.86, 0.02)
    scatter = rng.lognormal(0.0, 0.06)
    heavy = 46000.0 + 72.0 * crowd
    own = 2.05 * sqrt(stiffness * 46000.0 / heavy)
    tuned = 2.0 * (1.0 + 0.004 * (frost - 10.0))
    detuned = (tuned / own - 1.0) / 0.09
    damping = 0.006 + 0.03 * damper / (1.0 + detuned**2)
    ratio = pace / own
    gain = ratio**2 / sqrt((1.0 - ratio**2) ** 2 + (2.0 * damping * ratio) ** 2)
    moved = 0.0
    for _ in range(12):
        together = sqrt(crowd) + 0.16 * crowd * min(1.0, moved / 1.2)
        moved = scatter * 210.0 * together / heavy * gain * 0.5 + 0.5 * moved
    return moved < 0.9, 10.0 - 8.0 * min(moved, 1.25)


def irrigator(
    rng: np.random.Generator, pump: float, clogged: float, slope: float, leak: float
) -> tuple[bool, float]:
    """Water eight rows through a pipe with a pump at its lower end.

    Drifts: `pump`, share of its pressure; `clogged`, share of the filter; `slope` of the field (m per row); `leak`, an
    opening after the third row, relative to a dripper. A row passes with 70 to 135 % of its water; the field passes
    with seven rows. The reward falls with the spread.
    """
    drippers = rng.lognormal(0.0, 0.04, 8)
    heads = 26.0 * pump * (1.0 - 0.85 * clogged**2)
    flows = drippers.copy()
    for _ in range(20):
        carried = np.cumsum(flows[::-1])[::-1]
        carried[:3] += leak * 0.9
        lost = np.cumsum(0.05 * carried**1.75)
        left = np.maximum(0.01, heads - lost - slope * np.arange(1, 9))
        flows = 0.5 * flows + 0.5 * drippers * np.sqrt(left / 18.0)
    good = int(((flows > 0.7) & (flows < 1.35)).sum())
    return good >= 7, 10.0 - 12.0 * float(np.std(flows)) - 6.0 * abs(float(flows.mean()) - 1.0)


DRIVES = {"fast": (62.0, 0.06), "refurbished": (75.0, 0.16), "old": (96.0, 0.3)}  # seconds per job, scatter


def tape_library(
    rng: np.random.Generator, drive: str, rush: float, dropped: float, far: float
) -> tuple[bool, float]:
    """Serve 60 requests of a tape library with one robot.

    Drifts: `drive` (fast, refurbished or old); `rush`, requests per hour; `dropped`, share of grips that must be
    repeated; `far`, share of tapes at the far end. The shift passes if 52 requests wait less than 400 s. The reward
    falls with the mean wait.
    """
    pauses, luck, places = rng.exponential(1.0, 60), rng.random((3, 60)), rng.random(60)
    usual, scatter = DRIVES[drive]
    jobs = usual * np.exp(scatter * rng.normal(0.0, 1.0, 60)) + 22.0 * (places < far)
    jobs = jobs + 35.0 * (luck < dropped).sum(0)
    arrivals = np.cumsum(pauses * 3600.0 / rush)
    free, waits = 0.0, []
    for arrival, job in zip(arrivals.tolist(), jobs.tolist(), strict=True):
        start = max(free, arrival)
        free = start + job
        waits.append(start - arrival)
    return sum(wait < 400.0 for wait in waits) >= 52, 10.0 - 0.02 * min(sum(waits) / 60.0, 500.0)


def laser_link(
    rng: np.random.Generator, fog: float, shaking: float, beam: float, reach: float
) -> tuple[bool, float]:
    """Send 50 frames over a laser link between two masts.

    Drifts: `fog` (dB per km); `shaking` of the masts (mrad); `beam`, width (mrad); `reach`, distance (km). A narrow
    beam misses, and a wide one is too faint. The link passes with 45 frames. The reward is the mean margin.
    """
    off = shaking * np.abs(rng.normal(0.0, 1.0, (50, 2))).max(1)
    air = rng.normal(0.0, 0.8 + 0.4 * reach, 50)
    spread = 20.0 * np.log10(beam * reach / 2.0)
    margin = 11.0 - spread - fog * reach - 8.7 * (off / beam) ** 2 + air
    return int((margin > 0.0).sum()) >= 45, float(np.clip(margin, -6.0, 12.0).mean())


def stirred_tank(
    rng: np.random.Generator, feed: float, coolant: float, fouling: float, activity: float
) -> tuple[bool, float]:
    """Run an exothermic reaction in a cooled tank for 200 minutes; too hot, it runs away; too cold, it dies out.

    Drifts: `feed` (mol/l); `coolant` (°C); `fouling`, lost share of the cooling surface; `activity` of the catalyst
    relative to a fresh one. The run passes if it stays below 118 °C and has converted 55 % at the end. The reward is
    the mean conversion.
    """
    ripple = rng.normal(0.0, 0.04, 20)
    own = float(rng.normal(1.0, 0.03))
    left, hot, total, peak = 0.4 * feed, 82.0, 0.0, 82.0
    for minute in range(200):
        rich = feed * (1.0 + float(ripple[minute // 10]))
        rate = 0.075 * own * activity * exp(9500.0 * (1.0 / 355.0 - 1.0 / (hot + 273.0))) * left
        rate = min(rate, 0.9 * left)
        left += 0.05 * (rich - left) - rate
        wish = min(0.12, max(0.0, 0.02 + 0.012 * (hot - 82.0)))
        hot += 0.05 * (40.0 - hot) + 70.0 * rate - wish * (1.0 - fouling) * (hot - coolant)
        peak = max(peak, hot)
        total += 1.0 - left / rich
        if hot > 160.0:
            return False, total / 40.0 - 4.0
    return peak < 118.0 and 1.0 - left / feed > 0.55, total / 20.0


def caster(
    rng: np.random.Generator, speed: float, trail: float, load: float, wear: float
) -> tuple[bool, float]:
    """Push a cart whose casters shimmy when they roll fast on a short trail.

    Drifts: `speed` (m/s); `trail` of the casters (mm); `load` on each (kg); `wear`, share of the swivel's friction that
    is gone. The run passes if no caster swings by more than 0.5 rad. The reward falls with the mean swing.
    """
    kick = float(rng.normal(0.0, 1.0)) * 0.03
    bumps = rng.normal(0.0, 1.0, 40)
    step, angle, rate, side, swung, most = 0.005, kick, 0.0, 0.0, 0.0, 0.0
    arm, grip = trail / 1000.0, 9.0 * GRAVITY * load
    inertia = 0.006 + 0.9 * arm**2
    for tick in range(400):
        slip = side / 0.035
        # the tyre's side force follows its slip after it has rolled some way
        side += step * (speed * (angle - slip) + arm * rate)
        force = clipped(0.12 * grip * slip, 0.6 * grip)
        rub = (1.0 - 0.9 * wear) * 0.06 * rate
        rate += step * (-arm * force - rub + 0.02 * speed * float(bumps[tick // 10])) / inertia
        angle += step * rate
        swung += abs(angle)
        most = max(most, abs(angle))
        if most > 1.2:
            return False, tick / 100.0
    return most < 0.5, 10.0 - 0.06 * min(swung, 150.0)


def quiet_kettle(
    rng: np.random.Generator, room: float, volts: float, scale: float, lid: float
) -> tuple[bool, float]:
    """Heat water to 90 °C within nine minutes, with a heater that has enough power in reserve.

    Drifts: `room` (°C); `volts` of the mains; `scale` on the heater (mm); `lid`, how far it is open. Within the ranges,
    nothing breaks.
    """
    litres = float(rng.normal(1.2, 0.03))
    power = 2100.0 * (volts / 230.0) ** 2 * (1.0 - 0.03 * scale)
    loss = 60.0 + 90.0 * lid + 2.0 * (20.0 - room)
    seconds = 4186.0 * litres * (90.0 - room) / (power - loss)
    return seconds < 540.0, 10.0 - 0.004 * seconds


def quiet_counter(
    rng: np.random.Generator, light: float, pace: float, dust: float, tilt: float
) -> tuple[bool, float]:
    """Count 200 bottles with two light barriers, either of which is enough.

    Drifts: `light` of the hall (lx); `pace` (bottles per second); `dust` on the lenses (0 to 1); `tilt` (degrees).
    Within the ranges, nothing breaks.
    """
    missed = 0.004 + 0.0000012 * light + 0.01 * dust + 0.001 * pace + 0.0004 * abs(tilt)
    lost = int((rng.random((2, 200)) < missed).all(0).sum())
    return lost <= 4, 10.0 - 0.4 * lost


def quiet_pendulum(
    rng: np.random.Generator, wire: float, air: float, push: float, drag: float
) -> tuple[bool, float]:
    """Keep a clock's pendulum going; the escapement compensates for its losses.

    Drifts: `wire`, its length (cm); `air`, temperature (°C); `push` of the escapement and `drag` of the air, both
    relative to the design. Within the ranges, nothing breaks.
    """
    swing = 0.05 * sqrt(push / drag) * float(rng.lognormal(0.0, 0.02))
    period = (
        2.0 * pi * sqrt(wire / 100.0 * (1.0 + 0.000012 * (air - 20.0)) / GRAVITY) * (1.0 + swing**2 / 16.0)
    )
    late = abs(period / 2.0 - 1.0)
    return 0.02 < swing < 0.12, 10.0 - 5.0 * min(late, 0.2)


TWELFTH_MACHINES: Mapping[str, Machine] = {
    "maglev": Machine(
        maglev,
        {
            "delay": Span(0.0, 60.0, 4.0),
            "load": Span(0.0, 9.0, 3.0),
            "warm": Span(15.0, 120.0, 40.0),
            "joint": Span(0.0, 1.6, 0.2),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "eddy_sorter": Machine(
        eddy_sorter,
        {
            "belt": Span(1.1, 2.0, 1.5),
            "wet": Span(0.0, 0.4, 0.02),
            "size": Span(14.0, 60.0, 35.0),
            "splitter": Span(520.0, 880.0, 690.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "chromatograph": Machine(
        chromatograph,
        {
            "flow": Span(0.3, 2.2, 0.8),
            "oven": Span(20.0, 75.0, 35.0),
            "age": Span(0.0, 10.0, 1.0),
            "acid": Span(2.2, 4.6, 3.2),
        },
        min_success=0.95,
        tolerance=2.5,
    ),
    "beacons": Machine(
        beacons,
        {
            "water": Span(6.0, 26.0, 14.0),
            "salt": Span(15.0, 40.0, 35.0),
            "swell": Span(0.0, 0.7, 0.1),
            "echo": Span(0.0, 0.2, 0.01),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "footbridge": Machine(
        footbridge,
        {
            "crowd": Span(10.0, 250.0, 60.0),
            "stiffness": Span(0.7, 1.2, 1.0),
            "damper": Span(0.1, 1.0, 0.9),
            "frost": Span(-20.0, 35.0, 10.0),
        },
        min_success=0.95,
        tolerance=3.0,
    ),
    "irrigator": Machine(
        irrigator,
        {
            "pump": Span(0.6, 1.2, 1.0),
            "clogged": Span(0.0, 0.9, 0.1),
            "slope": Span(-1.5, 2.0, 0.0),
            "leak": Span(0.0, 6.0, 0.1),
        },
        min_success=0.95,
        tolerance=2.5,
    ),
    "tape_library": Machine(
        tape_library,
        {
            "drive": Choice(("fast", "refurbished", "old")),
            "rush": Span(10.0, 45.0, 22.0),
            "dropped": Span(0.0, 0.4, 0.02),
            "far": Span(0.0, 1.0, 0.2),
        },
        min_success=0.9,
        tolerance=2.0,
    ),
    "laser_link": Machine(
        laser_link,
        {
            "fog": Span(0.0, 15.0, 1.0),
            "shaking": Span(0.0, 2.5, 0.3),
            "beam": Span(0.3, 6.0, 1.5),
            "reach": Span(0.3, 4.0, 1.2),
        },
        min_success=0.95,
        tolerance=5.0,
    ),
    "stirred_tank": Machine(
        stirred_tank,
        {
            "feed": Span(0.6, 3.0, 1.6),
            "coolant": Span(5.0, 55.0, 25.0),
            "fouling": Span(0.0, 0.8, 0.1),
            "activity": Span(0.3, 1.8, 1.0),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "caster": Machine(
        caster,
        {
            "speed": Span(0.3, 4.0, 1.2),
            "trail": Span(5.0, 70.0, 40.0),
            "load": Span(5.0, 80.0, 30.0),
            "wear": Span(0.0, 1.0, 0.1),
        },
        min_success=0.95,
        tolerance=3.0,
    ),
}
TWELFTH_QUIET: Mapping[str, Machine] = {  # machines that pass everywhere in their ranges
    "quiet_kettle": Machine(
        quiet_kettle,
        {
            "room": Span(5.0, 35.0, 20.0),
            "volts": Span(207.0, 253.0, 230.0),
            "scale": Span(0.0, 3.0, 0.2),
            "lid": Span(0.0, 1.0, 0.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "quiet_counter": Machine(
        quiet_counter,
        {
            "light": Span(100.0, 5000.0, 500.0),
            "pace": Span(1.0, 12.0, 4.0),
            "dust": Span(0.0, 1.0, 0.1),
            "tilt": Span(-10.0, 10.0, 0.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
    "quiet_pendulum": Machine(
        quiet_pendulum,
        {
            "wire": Span(95.0, 104.0, 99.4),
            "air": Span(-10.0, 40.0, 20.0),
            "push": Span(0.6, 1.5, 1.0),
            "drag": Span(0.8, 1.4, 1.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
}


if __name__ == "__main__":
    command({**TWELFTH_MACHINES, **TWELFTH_QUIET})
