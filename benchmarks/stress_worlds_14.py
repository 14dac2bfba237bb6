"""Ten more machines with drifts in physical units, four directions each.

They were written before any search ran on them, by an author who had not read the search. `detumbler` fails along one
direction; `snow_groomer` only if three are bad at once; `sail_drone` in two opposite corners; `gondola` in a slanted
band, beyond which it passes again; `sputter_coater` by a jump between two states; `pill_counter` only in some missions
of a wide region; `fire_monitor` beyond a curve of two directions; `curling_robot` on both sides of a valley, by its
reward alone; `extruder` with one of three options; `grain_elevator` in an island. The form is that of
stress_worlds_13.py.

    python benchmarks/stress_worlds_14.py [MACHINE ...]      # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, exp, hypot, pi, radians, sin

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Choice, Span


def detumbler(
    rng: np.random.Generator, inclination: float, spin: float, dipole: float, inertia: float
) -> tuple[bool, float]:
    """Stop a small satellite's spin within three orbits, with coils that push against the Earth's field.

    Drifts: `inclination` of the orbit (degrees); `spin` after the launcher (°/s); `dipole`, disturbance by the
    satellite's own magnetism (°/s per step); `inertia` relative to the design. The coils cannot brake a spin about the
    field, which hardly turns along an equatorial orbit. The mission passes below 0.6 °/s. The reward falls with the
    mean spin.
    """
    first = rng.normal(0.0, 1.0, 3)
    x, y, z = (spin * first / float(np.linalg.norm(first))).tolist()
    pushes = rng.normal(0.0, dipole, (450, 3)).tolist()
    turned = float(rng.uniform(0.0, 2.0 * pi))  # the Earth's magnetic axis is 11° from its rotation axis
    mx, my, mz = sin(0.19) * cos(turned), sin(0.19) * sin(turned), cos(0.19)
    level, up = cos(radians(inclination)), sin(radians(inclination))
    total = 0.0
    for step, (px, py, pz) in enumerate(pushes):
        phase = 2.0 * pi * step / 150.0
        rx, ry, rz = cos(phase), level * sin(phase), up * sin(phase)
        along = 3.0 * (mx * rx + my * ry + mz * rz)
        bx, by, bz = along * rx - mx, along * ry - my, along * rz - mz
        square = bx * bx + by * by + bz * bz
        about = (x * bx + y * by + z * bz) / square
        brake = 0.013 * square / inertia
        x += px - brake * (x - about * bx)
        y += py - brake * (y - about * by)
        z += pz - brake * (z - about * bz)
        total += (x * x + y * y + z * z) ** 0.5
    return x * x + y * y + z * z < 0.36, 10.0 - 0.8 * total / 450.0


def snow_groomer(
    rng: np.random.Generator, slope: float, air: float, worn: float, blade: float
) -> tuple[bool, float]:
    """Groom 40 stretches of a ski run without sliding for more than 4 m.

    Drifts: `slope` (degrees); `air`, temperature (°C); `worn`, lost height of the tracks' bars (mm); `blade`, depth of
    the cut (cm), which changes the work but not the hold. The reward is the area.
    """
    snow = rng.normal(0.0, 0.022, 40) + float(rng.normal(0.0, 0.012))
    firm = 1.0 / (1.0 + exp(0.55 * (air - 1.5)))
    hold = (0.44 + 0.18 * firm + 0.24 * (1.0 - 0.03 * worn) + snow) * cos(radians(slope))
    lacking = np.maximum(sin(radians(slope)) - hold, 0.0)
    slid = np.cumsum(GRAVITY * lacking * 4.0)
    area = 10.0 - 0.06 * abs(blade - 12.0) - 0.03 * (slope - 16.0) + float(rng.normal(0.0, 0.15))
    if slid[-1] > 4.0:
        return False, area * float(np.searchsorted(slid, 4.0)) / 40.0
    return True, area


def sail_drone(
    rng: np.random.Generator, current: float, rudder: float, wind: float, waves: float
) -> tuple[bool, float]:
    """Sail 700 m to a gate of 70 m.

    Drifts: `current` across the course (m/s); `rudder`, its offset (degrees); `wind` (m/s); `waves`, their height (m).
    The pilot steers by the compass and a little by the distance from the course: a current and an offset add up if they
    are towards the same side, and cancel out otherwise. The reward falls with the distance from the course.
    """
    speed = 1.1 + 0.16 * wind
    kicks = rng.normal(0.0, 0.6 + 1.6 * waves, 300)
    current += float(rng.normal(0.0, 0.025))
    heading, turning, across, total, steps = 0.0, 0.0, 0.0, 0.0, 0
    for kick in kicks.tolist():
        steps += 1
        helm = clipped(-0.9 * heading - 0.44 * across, 25.0) + rudder
        turning += 0.5 * (0.5 * helm - turning) + 0.3 * kick
        heading += turning
        across += 2.0 * (speed * sin(radians(heading)) + current)
        total += abs(across)
        if steps * 2.0 * speed > 700.0:
            break
    return abs(across) < 35.0, 10.0 - 0.04 * min(total / steps, 100.0)


def gondola(
    rng: np.random.Generator, speed: float, load: float, wind: float, grease: float
) -> tuple[bool, float]:
    """Bring a cabin over 14 supports, each of which pushes it; it passes if it never swings by more than 14°.

    Drifts: `speed` of the rope (m/s); `load` (kg), which lowers the cabin's centre; `wind` along the rope (m/s);
    `grease`, damping of the hanger relative to the usual one. The cabin resonates if it passes one support per swing.
    The reward is the time saved.
    """
    length = 4.6 + 0.0032 * load
    damping = 0.055 * grease
    gusts = rng.normal(0.0, 0.0004 * wind, 1300)
    knocks = 0.055 * (speed / 5.0) * rng.lognormal(0.0, 0.12, 16)
    angle, swing, done, largest, step, support = 0.0, 0.0, 0.0, 0.0, 0.1, 0
    for gust in gusts.tolist():
        done += step * speed
        if done > 30.0 * (support + 1):
            swing += float(knocks[support])
            support += 1
            if support == 14:
                break
        swing += gust - step * (GRAVITY / length * sin(angle) + damping * swing)
        angle += step * swing
        largest = max(largest, abs(angle))
    return largest < radians(14.0), 7.0 + 0.6 * speed + float(rng.normal(0.0, 0.1))


def sputter_coater(
    rng: np.random.Generator, oxygen: float, pump: float, power: float, argon: float
) -> tuple[bool, float]:
    """Coat 20 panes with an oxide; the target itself must not become covered by oxide.

    Drifts: `oxygen`, flow (sccm); `pump`, speed relative to the design; `power`, relative to the design; `argon`,
    pressure (µbar), which matters little. Metal from the target binds the oxygen. As the target becomes covered, it
    binds less, and within seconds it is covered completely; then the run ends. The reward is the thickness.
    """
    flows = oxygen * (1.0 + 0.05 * rng.normal(0.0, 1.0, 500)) * (1.0 + 0.01 * float(rng.normal(0.0, 1.0)))
    covered, gas, thick = 0.05, 0.3, 0.0
    for step, flow in enumerate(flows.tolist()):
        metal = power * (1.0 - covered)
        bound = 11.5 * metal * gas / (gas + 0.2)
        gas += 0.05 * (flow - bound - pump * gas)
        gas = max(gas, 0.0)
        covered += 0.02 * (1.1 * gas * (1.0 - covered) - 2.2 * power * covered)
        thick += metal
        if covered > 0.55:
            return False, 10.0 * step / 500.0
    return True, 5.0 + 6.0 * min(thick / 500.0, 1.2) - 0.02 * abs(argon - 4.0) + float(rng.normal(0.0, 0.1))


def pill_counter(
    rng: np.random.Generator, humidity: float, rate: float, size: float, lamp: float
) -> tuple[bool, float]:
    """Count 40 bottles of 50 pills with a light barrier; two pills that fall together count as one.

    Drifts: `humidity` of the air (percent); `rate` (pills per second); `size` of the pills (mm); `lamp`, brightness
    relative to a new one. On about one day in four, the chute is charged, and pills stick together in dry air. The day
    passes if no bottle is wrong by more than two. The reward is the number of bottles per minute.
    """
    charged = float(rng.uniform()) < 0.24
    dry = 1.0 / (1.0 + exp(0.7 * (humidity - 30.0)))
    crowd = 1.0 / (1.0 + exp(-0.9 * (rate - 23.0)))
    pairs = 0.0006 * (rate / 18.0) * (size / 8.0) + (0.12 * dry * crowd if charged else 0.0)
    wrong = rng.binomial(50, min(pairs, 0.5), 40)
    bottles = 60.0 * min(rate, 30.0) / 50.0
    return int(wrong.max()) <= 2, 8.0 + 0.08 * bottles + 0.05 * (lamp - 1.0) + float(rng.normal(0.0, 0.2))


def fire_monitor(
    rng: np.random.Generator, pressure: float, headwind: float, gusts: float, worn: float
) -> tuple[bool, float]:
    """Throw water through a window 12 m up and 30 m away with a cannon that corrects its elevation after each jet.

    Drifts: `pressure` (bar); `headwind` (m/s; negative: from behind); `gusts`, their standard deviation (m/s); `worn`,
    spread of the jet by a worn nozzle (m). The elevation is limited to 48°. The fire passes if 18 of the last 30 jets
    hit the window, which is 3 m high. The reward falls with the jets' mean distance from its middle.
    """
    winds = (headwind + rng.normal(0.0, gusts, 36)).tolist()
    spreads = rng.normal(0.0, 0.25 + worn, 36).tolist()
    start = 0.93 * (200.0 * pressure) ** 0.5
    elevation, hits, total = 34.0, 0, 0.0
    for jet in range(36):
        x, y, u, v = 0.0, 1.5, start * cos(radians(elevation)), start * sin(radians(elevation))
        while x < 30.0 and y > 0.0:
            drag = 0.020 * hypot(u + winds[jet], v)
            u -= 0.1 * drag * (u + winds[jet])
            v -= 0.1 * (GRAVITY + drag * v)
            x += 0.1 * u
            y += 0.1 * v
        high = y + (30.0 - x) * v / max(u, 1.0) if x >= 30.0 else x - 30.0
        off = high + spreads[jet] - 12.0
        elevation = min(elevation - clipped(0.7 * off, 4.0), 48.0)
        if jet >= 6:
            hits += abs(off) < 1.5
            total += min(abs(off), 10.0)
    return hits >= 18, 10.0 - 1.0 * total / 30.0


def curling_robot(
    rng: np.random.Generator, pebble: float, lean: float, spin: float, hall: float
) -> tuple[bool, float]:
    """Lay 10 curling stones near the centre; after each stone, the robot corrects its push a little.

    Drifts: `pebble`, friction of the ice (thousandths); `lean`, its slope to the side (mm/m); `spin`, turns of a stone
    on its way; `hall`, temperature (°C), which wears the pebble slowly. The game passes with one stone within 4 m. The
    reward falls with the mean distance, so it is the reward that breaks the guarantee.
    """
    luck = rng.normal(0.0, 1.0, (10, 2)).tolist()
    push, aim, total, near = 2.06, -0.82, 0.0, 0
    for stone, (far, side) in enumerate(luck):
        friction = 0.001 * (pebble - 0.03 * stone * (hall + 4.0) / 10.0)
        run = (push + 0.012 * far) ** 2 / (2.0 * GRAVITY * friction)
        curl = 1.15 * spin / (spin + 1.0) + 0.31 * lean * run / 28.0
        long, wide = run - 28.0, aim + curl + 0.12 * side
        off = hypot(long, wide)
        push = 2.06 + clipped(0.7 * (push - 2.06) - 0.018 * long, 0.06)
        aim = -0.82 + clipped(0.8 * (aim + 0.82) - 0.3 * wide, 0.25)
        total += min(off, 5.0)
        near += off < 4.0
    return near >= 1, 10.0 - 1.5 * total / 10.0


def extruder(
    rng: np.random.Generator, nozzle: str, heat: float, feed: float, moisture: float
) -> tuple[bool, float]:
    """Print 60 layers; if the filament does not melt in time, it is ground off and the print ends.

    Drifts: `nozzle`, its material; `heat` of the block (°C); `feed` (mm/s); `moisture` of the filament (percent), which
    only roughens the surface. The reward is the quality of the surface.
    """
    conducts, wears = {"brass": (1.0, 0.05), "ruby": (0.93, 0.0), "steel": (0.72, 0.02)}[nozzle]
    melts = 1.05 * conducts * (heat - 150.0) * (1.0 + rng.normal(0.0, 0.05, 60))
    force = 0.5 * feed / np.maximum(melts / 60.0, 0.1) * (1.0 + 0.02 * float(rng.normal(0.0, 1.0)))
    quality = 10.0 - 1.5 * moisture - wears - 0.006 * abs(feed - 60.0) + float(rng.normal(0.0, 0.15))
    slips = np.flatnonzero(force > 96.0)
    if slips.size >= 3:
        return False, quality * float(slips[2]) / 60.0
    return True, quality


def grain_elevator(
    rng: np.random.Generator, dust: float, moisture: float, spark: float, hours: float
) -> tuple[bool, float]:
    """Lift grain for a shift without a spark that ignites the dust.

    Drifts: `dust` (g/m³); `moisture` of the grain (percent); `spark`, usual energy of a spark (mJ); `hours` since the
    belt was oiled, which costs some power. Thin dust does not burn, and dense dust lacks air. The reward is the lifted
    grain.
    """
    sparks = spark * rng.lognormal(0.0, 0.35, 25)
    cloud = dust * float(rng.lognormal(0.0, 0.08))
    needed = 31.0 * exp(1.6 * np.log(cloud / 330.0) ** 2 + 0.30 * (moisture - 9.0))
    lifted = 10.0 - 0.0006 * dust - 0.01 * hours - 0.05 * abs(moisture - 13.0) + float(rng.normal(0.0, 0.15))
    ignited = np.flatnonzero(sparks > needed)
    if ignited.size:
        return False, lifted * float(ignited[0]) / 25.0
    return True, lifted


FOURTEENTH_MACHINES: Mapping[str, Machine] = {
    "detumbler": Machine(
        detumbler,
        {
            "inclination": Span(2.0, 98.0, 82.0),
            "spin": Span(2.0, 9.0, 5.0),
            "dipole": Span(0.0, 0.02, 0.005),
            "inertia": Span(0.85, 1.2, 1.0),
        },
        min_success=0.95,
        tolerance=3.0,
    ),
    "snow_groomer": Machine(
        snow_groomer,
        {
            "slope": Span(8.0, 30.0, 16.0),
            "air": Span(-18.0, 6.0, -6.0),
            "worn": Span(0.0, 25.0, 3.0),
            "blade": Span(4.0, 25.0, 12.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "sail_drone": Machine(
        sail_drone,
        {
            "current": Span(-0.45, 0.45, 0.0),
            "rudder": Span(-9.0, 9.0, 0.5),
            "wind": Span(4.0, 13.0, 8.0),
            "waves": Span(0.0, 2.5, 0.5),
        },
        min_success=0.95,
        tolerance=2.5,
    ),
    "gondola": Machine(
        gondola,
        {
            "speed": Span(3.4, 7.6, 5.0),
            "load": Span(0.0, 900.0, 150.0),
            "wind": Span(0.0, 16.0, 4.0),
            "grease": Span(0.5, 2.0, 1.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "sputter_coater": Machine(
        sputter_coater,
        {
            "oxygen": Span(3.5, 7.0, 5.0),
            "pump": Span(0.5, 1.2, 1.0),
            "power": Span(0.8, 1.25, 1.0),
            "argon": Span(2.0, 8.0, 4.0),
        },
        min_success=0.95,
        tolerance=3.0,
    ),
    "pill_counter": Machine(
        pill_counter,
        {
            "humidity": Span(12.0, 70.0, 45.0),
            "rate": Span(8.0, 36.0, 16.0),
            "size": Span(5.0, 12.0, 8.0),
            "lamp": Span(0.5, 1.0, 1.0),
        },
        min_success=0.95,
        tolerance=3.0,
    ),
    "fire_monitor": Machine(
        fire_monitor,
        {
            "pressure": Span(5.4, 10.0, 8.0),
            "headwind": Span(-8.0, 5.0, 1.0),
            "gusts": Span(0.0, 1.0, 0.3),
            "worn": Span(0.0, 0.5, 0.1),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "curling_robot": Machine(
        curling_robot,
        {
            "pebble": Span(6.9, 8.9, 7.8),
            "lean": Span(-5.0, 5.0, 0.0),
            "spin": Span(0.8, 6.0, 2.5),
            "hall": Span(2.0, 14.0, 5.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "extruder": Machine(
        extruder,
        {
            "nozzle": Choice(("brass", "ruby", "steel")),
            "heat": Span(194.0, 235.0, 212.0),
            "feed": Span(25.0, 103.0, 60.0),
            "moisture": Span(0.0, 1.0, 0.1),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "grain_elevator": Machine(
        grain_elevator,
        {
            "dust": Span(20.0, 1100.0, 60.0),
            "moisture": Span(8.0, 18.0, 13.0),
            "spark": Span(0.5, 20.0, 3.0),
            "hours": Span(0.0, 60.0, 10.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
}


if __name__ == "__main__":
    command(FOURTEENTH_MACHINES)
