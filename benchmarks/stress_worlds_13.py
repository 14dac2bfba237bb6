"""Ten more machines with drifts in physical units, and two in which nothing breaks.

Each machine has a shape of failure that the earlier sets do not have, or have only once: `spray_booth` fails by a
product of four factors, `twin_compressors` on a narrow ridge across two directions, `tide_lock` with the period of the
tide, `glue_press` on another side for each option, `heliostat` by delay times gain, `cold_store` if two of four
thresholds are exceeded, `ground_ray` at distances between others that hold, `seed_belt` by rare events that do not show
in the reward, `peak_shaver` by losses with heavy tails, and `six_axes` by six offsets that matter a little each. The
form is that of stress_worlds_12.py. The file was complete before any search ran on it.

    python benchmarks/stress_worlds_13.py [MACHINE ...]      # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, exp, hypot, pi, sin, sqrt

import numpy as np
from stress_machines import Machine, clipped, command

from pytest_tarl.spaces import Choice, Span


def spray_booth(
    rng: np.random.Generator, flow: float, solids: float, line: float, spread: float
) -> tuple[bool, float]:
    """Paint 40 panels with a film of 60 µm.

    Drifts: `flow` of the gun (ml/min); `solids`, share of the paint that stays; `line`, speed (m/min); `spread`, width
    of the fan (cm). The batch passes if at most three panels have less than 42 or more than 85 µm. The reward falls
    with the deviation of the film.
    """
    film = 60.0 * (flow / 300.0) * (solids / 0.45) * (4.0 / line) * (30.0 / spread)
    panels = film * rng.lognormal(0.0, 0.06, 40) * float(rng.lognormal(0.0, 0.03))
    bad = int(((panels < 42.0) | (panels > 85.0)).sum())
    return bad <= 3, 10.0 - 0.12 * float(np.abs(panels - 60.0).mean())


def twin_compressors(
    rng: np.random.Generator, lead: float, lag: float, mount: float, pressure: float
) -> tuple[bool, float]:
    """Run two compressors on one frame, which shakes if their speeds are nearly as three to two.

    Drifts: `lead` and `lag`, speeds (rpm); `mount`, damping of the frame relative to new rubber; `pressure` of the
    network (bar). The hour passes if the frame never shakes by more than 4 mm/s. The reward is the delivered air.
    """
    drift = rng.normal(0.0, 6.0, 30)
    beat = np.abs(2.0 * (lead + drift) - 3.0 * lag) / 60.0
    shaking = 1.1 + 0.12 * pressure + 5.2 / np.sqrt(mount) / (1.0 + (beat / 0.9) ** 2)
    air = (lead + lag) / 2500.0 * 10.0 * (1.0 - 0.02 * (pressure - 8.0))
    return float(shaking.max()) < 4.0, air + float(rng.normal(0.0, 0.1))


def tide_lock(
    rng: np.random.Generator, hour: float, draught: float, silt: float, wind: float
) -> tuple[bool, float]:
    """Bring a barge over the sill of a lock; the tide has a period of 12.4 hours.

    Drifts: `hour` since high water; `draught` of the barge (m); `silt` on the sill (m); `wind` from the sea (m/s;
    negative: from the land), which raises the water. The mission passes with 0.4 m under the keel. The reward falls
    with the time that the barge needs.
    """
    surge = 0.02 * wind + float(rng.normal(0.0, 0.06))
    level = 4.6 + surge + 1.1 * cos(2.0 * pi * hour / 12.4) + 0.25 * cos(4.0 * pi * hour / 12.4)
    waves = 0.015 * abs(wind) * float(np.abs(rng.normal(0.0, 1.0, 6)).max())
    under = level - silt - draught - waves
    minutes = 20.0 + 6.0 / max(under, 0.15)
    return under > 0.4, 10.0 - 0.05 * minutes


def glue_press(
    rng: np.random.Generator, glue: str, warm: float, moist: float, seconds: float
) -> tuple[bool, float]:
    """Press 50 boards with one of four glues, each of which has its own process window.

    Drifts: `glue`; `warm`, temperature of the hall (°C); `moist`, water in the wood (percent); `seconds` in the press.
    The batch passes if at most five boards open. The reward falls with the number of boards that open.
    """
    best, window, thirst, need = {
        "white": (22.0, 11.0, 0.5, 55.0),
        "urea": (28.0, 9.0, -0.7, 62.0),
        "melt": (18.0, 16.0, -0.2, 40.0),
        "foam": (24.0, 8.0, 1.1, 70.0),
    }[glue]
    off = (warm - best - thirst * (moist - 10.0)) / window
    short = max(0.0, need * (1.0 + 0.012 * max(best - warm, 0.0)) - seconds) / need
    strength = 3.4 - 1.6 * off**2 - 3.0 * short + rng.normal(0.0, 0.55, 50) + float(rng.normal(0.0, 0.15))
    opened = int((strength < 1.0).sum())
    return opened <= 5, 10.0 - 0.15 * opened


def heliostat(
    rng: np.random.Generator, delay: float, gain: float, slack: float, gust: float
) -> tuple[bool, float]:
    """Hold the sun's image on a tower for three minutes, with a control loop on a camera.

    Drifts: `delay` of the camera (s); `gain` of the motors relative to their design; `slack` of the gear (mrad);
    `gust`, push of the wind (mrad per step). The image passes if it is within 4 mrad in 95 % of the last two minutes.
    The reward falls with its mean deviation.
    """
    pushes = rng.normal(0.0, gust, 360)
    late = 1 + round(delay / 0.5)
    angle, held, total, near = 2.0, 0.0, 0.0, 0
    seen = [angle] * late
    for step in range(360):
        wish = held + 0.28 * gain * seen[0]
        if abs(wish - held) > 0.1 * slack:
            angle -= (wish - held) * (1.0 - 0.05 * slack)
        held = wish
        angle = clipped(angle + float(pushes[step]), 60.0)
        seen = [*seen[1:], angle]
        if step >= 120:
            total += abs(angle)
            near += abs(angle) < 4.0
    return near >= 228, 10.0 - 0.8 * min(total / 240.0, 12.0)


def cold_store(
    rng: np.random.Generator, outside: float, doors: float, frost: float, voltage: float
) -> tuple[bool, float]:
    """Keep a cold store below −18 °C for a day; it holds unless two of its four reserves are exhausted.

    Drifts: `outside` (°C); `doors`, openings per hour; `frost` on the evaporator (mm); `voltage` of the mains (V). The
    reward falls with the energy used, which hardly shows how much reserve is left.
    """
    day = rng.normal(0.0, 1.0, 4)
    over = (
        outside + 1.5 * float(day[0]) > 33.0,
        doors + 2.0 * float(day[1]) > 24.0,
        frost + 0.4 * float(day[2]) > 6.0,
        voltage + 2.5 * float(day[3]) < 212.0,
    )
    energy = 40.0 + 0.3 * outside + 0.1 * doors + 0.4 * frost
    return sum(over) < 2, 10.0 - 0.03 * energy - 0.4 * sum(over)


def ground_ray(
    rng: np.random.Generator, metres: float, mast: float, wet: float, noise: float
) -> tuple[bool, float]:
    """Send 100 packets from a drone at 30 m to a mast; at times, the ray from the ground cancels the direct one.

    Drifts: `metres`, distance; `mast`, height of the aerial (m); `wet`, how well the ground reflects; `noise` above the
    usual level (dB). The flight passes with 90 packets. The reward is the mean of the signal in dB, cut off.
    """
    direct, bounced = hypot(metres, 30.0 - mast), hypot(metres, 30.0 + mast)
    phases = 2.0 * pi * (bounced - direct) / 0.75 + rng.normal(0.0, 0.25, 100)
    strength = np.sqrt(1.0 + wet**2 - 2.0 * wet * np.cos(phases))
    signal = 26.0 + 20.0 * np.log10(100.0 / direct * strength) - noise + rng.normal(0.0, 1.5, 100)
    return int((signal > 12.0).sum()) >= 90, float(np.clip(signal, 0.0, 30.0).mean()) / 3.0


def seed_belt(
    rng: np.random.Generator, dust: float, static: float, slope: float, age: float
) -> tuple[bool, float]:
    """Sow 2,000 seeds; a rare lump that blocks the tube spoils the bed.

    Drifts: `dust` (mg/m³); `static`, charge of the belt (kV); `slope` of the field (degrees); `age` of the belt
    (years). The bed passes without a lump. The reward measures the spacing, which lumps do not change.
    """
    chance = 0.004 * exp(0.9 * dust + 0.5 * static + 0.0045 * slope**2 + 0.16 * age + 0.35 * dust * static)
    lumps = int(rng.poisson(min(chance, 5.0)))
    spacing = float(rng.normal(0.0, 0.15)) - 0.01 * abs(slope)
    return lumps == 0, 10.0 + spacing


def peak_shaver(
    rng: np.random.Generator, heat: float, worn: float, wind: float, forecast: float
) -> tuple[bool, float]:
    """Keep a factory below its contracted power for a month with a battery; a peak costs money by its height.

    Drifts: `heat`, mean temperature (°C); `worn`, lost share of the capacity; `wind`, mean yield of the turbine
    (percent of the usual one); `forecast`, its error (percent). The month passes without a peak above 900 kW. The
    reward falls with the price of the peaks, which has a heavy tail.
    """
    need = 400.0 + 9.0 * max(heat - 18.0, 0.0) + 1.4 * (100.0 - wind)
    peaks = need * (1.0 + (0.05 + 0.012 * forecast) * rng.pareto(3.5, 30))
    over = np.maximum(peaks - 660.0 * (1.0 - 0.5 * worn), 0.0)
    return float(over.max()) < 900.0, 10.0 - 0.004 * min(float(over.sum()), 4000.0)


def six_axes(
    rng: np.random.Generator,
    base: float,
    shoulder: float,
    elbow: float,
    wrist: float,
    tool: float,
    tilt: float,
) -> tuple[bool, float]:
    """Put 16 pegs into a plate with an arm whose axes and tool are slightly off.

    Drifts: `base`, `shoulder`, `elbow` and `wrist`, errors of the joints (mrad); `tool`, error of its length (mm);
    `tilt` of the plate (mrad). The plate passes with at most one peg beside its hole. The reward falls with the mean
    distance from the holes.
    """
    holes = rng.uniform(-0.15, 0.15, (16, 2))
    spots = rng.normal(0.0, 0.22, (16, 2))
    across = 0.75 * base + 0.12 * wrist + holes[:, 0] * (base + wrist) + 0.2 * tilt
    along = 0.55 * shoulder + 0.42 * elbow - 0.16 * wrist + 0.7 * tool + holes[:, 1] * tilt
    off = np.hypot(across + spots[:, 0], along + spots[:, 1])
    return int((off > 1.35).sum()) <= 1, 10.0 - 1.2 * float(off.mean())


def quiet_mixer(
    rng: np.random.Generator, water: float, sand: float, speed: float, minutes: float
) -> tuple[bool, float]:
    """Mix concrete whose ingredients compensate for each other; nothing breaks within the ranges.

    Drifts: `water` and `sand` (percent of the recipe); `speed` of the drum (rpm); `minutes`.
    """
    slump = 12.0 * (water / 100.0) * (100.0 / sand) + float(rng.normal(0.0, 0.6))
    turns = speed * minutes
    return 7.0 < slump < 18.0 and turns > 30.0, 10.0 - 0.08 * abs(slump - 12.0)


def quiet_swing(
    rng: np.random.Generator, phase: float, length: float, push: float, load: float
) -> tuple[bool, float]:
    """Stop a theme park's swing at its platform; the reward changes with the phase, but it always stops.

    Drifts: `phase` (rad); `length` (m); `push` relative to the usual one; `load` (kg).
    """
    left = 0.2 * push * (1.0 + 0.3 * sin(3.0 * phase)) * sqrt(length / 6.0) + float(rng.normal(0.0, 0.02))
    return left < 1.0, 10.0 - 1.2 * left - 0.0002 * load


THIRTEENTH_MACHINES: Mapping[str, Machine] = {
    "spray_booth": Machine(
        spray_booth,
        {
            "flow": Span(240.0, 380.0, 300.0),
            "solids": Span(0.35, 0.55, 0.45),
            "line": Span(3.2, 5.2, 4.0),
            "spread": Span(24.0, 38.0, 30.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "twin_compressors": Machine(
        twin_compressors,
        {
            "lead": Span(1200.0, 2400.0, 1500.0),
            "lag": Span(800.0, 1500.0, 1250.0),
            "mount": Span(0.4, 1.2, 1.0),
            "pressure": Span(6.0, 11.0, 8.0),
        },
        min_success=0.95,
        tolerance=3.5,
    ),
    "tide_lock": Machine(
        tide_lock,
        {
            "hour": Span(-3.0, 16.0, 0.5),
            "draught": Span(1.5, 4.4, 2.6),
            "silt": Span(0.0, 1.2, 0.1),
            "wind": Span(-18.0, 18.0, 2.0),
        },
        min_success=0.95,
        tolerance=0.8,
    ),
    "glue_press": Machine(
        glue_press,
        {
            "glue": Choice(("white", "urea", "melt", "foam")),
            "warm": Span(8.0, 40.0, 23.0),
            "moist": Span(5.0, 18.0, 10.0),
            "seconds": Span(25.0, 110.0, 80.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
    "heliostat": Machine(
        heliostat,
        {
            "delay": Span(0.0, 4.0, 1.0),
            "gain": Span(0.4, 2.2, 1.0),
            "slack": Span(0.0, 6.0, 0.5),
            "gust": Span(0.1, 1.1, 0.4),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "cold_store": Machine(
        cold_store,
        {
            "outside": Span(10.0, 42.0, 22.0),
            "doors": Span(2.0, 36.0, 10.0),
            "frost": Span(0.0, 10.0, 1.0),
            "voltage": Span(200.0, 240.0, 230.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
    "ground_ray": Machine(
        ground_ray,
        {
            "metres": Span(40.0, 260.0, 90.0),
            "mast": Span(2.0, 6.0, 3.0),
            "wet": Span(0.0, 0.9, 0.3),
            "noise": Span(0.0, 8.0, 1.0),
        },
        min_success=0.95,
        tolerance=3.0,
    ),
    "seed_belt": Machine(
        seed_belt,
        {
            "dust": Span(0.0, 2.5, 0.2),
            "static": Span(0.0, 3.0, 0.3),
            "slope": Span(-15.0, 15.0, 0.0),
            "age": Span(0.0, 12.0, 1.0),
        },
        min_success=0.9,
        tolerance=1.0,
    ),
    "peak_shaver": Machine(
        peak_shaver,
        {
            "heat": Span(5.0, 38.0, 18.0),
            "worn": Span(0.0, 0.5, 0.05),
            "wind": Span(20.0, 140.0, 100.0),
            "forecast": Span(1.0, 15.0, 3.0),
        },
        min_success=0.9,
        tolerance=1.5,
    ),
    "six_axes": Machine(
        six_axes,
        {
            "base": Span(-1.2, 1.2, 0.0),
            "shoulder": Span(-1.3, 1.3, 0.0),
            "elbow": Span(-1.6, 1.6, 0.0),
            "wrist": Span(-2.5, 2.5, 0.0),
            "tool": Span(-0.9, 0.9, 0.0),
            "tilt": Span(-2.0, 2.0, 0.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
}
THIRTEENTH_QUIET: Mapping[str, Machine] = {  # machines that pass everywhere in their ranges
    "quiet_mixer": Machine(
        quiet_mixer,
        {
            "water": Span(88.0, 112.0, 100.0),
            "sand": Span(90.0, 112.0, 100.0),
            "speed": Span(10.0, 24.0, 16.0),
            "minutes": Span(4.0, 9.0, 6.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
    "quiet_swing": Machine(
        quiet_swing,
        {
            "phase": Span(0.0, 6.2, 1.0),
            "length": Span(4.0, 8.0, 6.0),
            "push": Span(0.6, 1.6, 1.0),
            "load": Span(200.0, 900.0, 500.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
}


if __name__ == "__main__":
    command({**THIRTEENTH_MACHINES, **THIRTEENTH_QUIET})
