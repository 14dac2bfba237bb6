"""Six more machines with drifts in physical units, written without knowledge of the search and its results.

The form is that of stress_worlds_6.py: each mission is a small simulation that takes a generator and four drifts; an
episode's noise depends only on its seed; and each machine has the success rate and tolerance that a tester would
choose. A mission's docstring gives the model, the controller and what passes, but not where it fails. The boundaries
were chosen to differ: one is steep along one direction, two have interacting directions, in one failures become
frequent only slowly, one failing region is narrow, and one direction fails only in the middle.

    python benchmarks/stress_worlds_7.py [MACHINE ...]       # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import asinh, cos, exp, log, pi, sin, sqrt

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Span


def unloader(
    rng: np.random.Generator, pores: float, mass: float, lip: float, supply: float
) -> tuple[bool, float]:
    """Unload twelve cartons from a trailer with two suction cups, one carton after another.

    Drifts: `pores`, air that leaks through a usual carton at full vacuum (l/s); `mass`, of a usual carton (kg); `lip`,
    wear of the cups (0 to 1); `supply`, pressure of the compressed air (bar). The arm grips up to three times until the
    vacuum reaches 42 kPa; if it does not, the arm lifts the carton slowly. The mission passes if at most one carton
    falls. The reward is the number of cartons, minus the time.
    """
    leaks, weights = rng.lognormal(0.0, 0.45, 12).tolist(), rng.lognormal(0.0, 0.25, 12).tolist()
    seats, jerks = rng.exponential(1.0, (12, 3)).tolist(), rng.lognormal(0.0, 0.15, 12).tolist()
    aside = rng.rayleigh(0.05, 12).tolist()  # distance from the centre of mass (m)
    full = 82.0 * (1.0 - exp(-supply / 2.0))  # kPa
    capacity = 0.5 + 0.25 * supply  # l/s
    fallen, time = 0, 0.0
    for carton in range(12):
        vacuum = 0.0
        for seat in seats[carton]:
            leak = pores * leaks[carton] + (0.08 + 0.7 * lip) * seat
            vacuum = max(vacuum, full / (1.0 + leak / capacity))
            time += 1.0
            if vacuum > 42.0:
                break
        slow = vacuum <= 42.0
        pulled = mass * weights[carton] * (GRAVITY + jerks[carton] * (1.5 if slow else 4.0))
        hold = 1000.0 * vacuum * 0.0066 * (1.0 - min(0.9, aside[carton] / 0.3))
        fallen += hold < pulled
        time += 9.0 if slow else 5.0
    return fallen <= 1, 12.0 - 1.5 * fallen - 0.03 * (time - 72.0)


def blade(
    rng: np.random.Generator, wind: float, latency: float, payload: float, volts: float
) -> tuple[bool, float]:
    """Hold a drone in front of a wind turbine's blade for 22 s, while gusts push it towards the blade.

    Drifts: `wind` (m/s); `latency` of the position (s); `payload` (kg); `volts` of the battery. A PID loop with limited
    tilt controls the position, and a PI loop with limited thrust the height. The inspection passes if the drone stays
    within 1.6 m of its place and sinks by less than 1 m. The reward falls with both errors.
    """
    step, steps = 0.05, 440
    shocks, reads = rng.normal(0.0, 1.0, steps).tolist(), rng.normal(0.0, 0.02, steps).tolist()
    mass, most = 1.6 + payload, 27.0 * (volts / 15.8) ** 2 * float(rng.normal(1.0, 0.02))
    delay, shift = round(latency / step), latency / step - round(latency / step)
    seen, tilt, gust, total = [(0.0, 0.0)] * 9, 0.0, 0.0, 0.0
    place, speed, height, climb, held = 0.3 * float(rng.normal(0.0, 1.0)), 0.0, 0.0, 0.0, 0.0
    far = low = wrong = 0.0
    for now in range(steps):
        seen.append((place + reads[now], speed))
        last, before = seen[-1 - delay], seen[-2 - delay] if shift >= 0.0 else seen[-delay]
        error, rate = (one + abs(shift) * (two - one) for one, two in zip(last, before, strict=True))
        total = clipped(total + step * error, 6.0)
        tilt += step / 0.12 * (clipped(-(0.30 * error + 0.26 * rate + 0.06 * total), 0.5) - tilt)
        gust += -gust * step / 1.5 + 0.28 * wind * sqrt(2 * step / 1.5) * shocks[now]
        air = wind * 0.8 + gust - speed
        held = clipped(held - 0.8 * step * height, 4.0)
        wanted = mass * GRAVITY / cos(tilt) - mass * (3.0 * height + 3.2 * climb) + mass * held
        thrust = min(most, max(4.0, wanted))
        speed += step * (thrust * sin(tilt) + 0.022 * air * abs(air)) / mass
        climb += step * (thrust * cos(tilt) / mass - GRAVITY)
        place += step * speed
        height += step * climb
        wrong += (abs(place) + abs(height)) / steps
        far, low = max(far, abs(place)), max(low, -height)
        if far > 6.0 or low > 6.0:
            break
    return far < 1.6 and low < 1.0, 10.0 - 2.0 * min(wrong, 2.0) - 1.0 * min(far, 3.0)


def neutraliser(
    rng: np.random.Generator, acid: float, flow: float, lag: float, reagent: float
) -> tuple[bool, float]:
    """Neutralise waste water in a stirred tank with caustic soda before it enters the river.

    Drifts: `acid`, concentration of the water relative to the usual one; `flow` (m³/h); `lag` of the probe (s);
    `reagent`, strength of the soda relative to the usual one. A PI loop on the pH doses with a pump of limited stroke.
    The run passes if the water in the basin behind the tank stays between pH 6 and 9 for 96 % of the time. The reward
    falls with the distance from pH 7.3 and with the soda used.
    """
    step, steps = 5.0, 420
    shocks, reads = rng.normal(0.0, 1.0, steps).tolist(), rng.normal(0.0, 0.03, steps).tolist()
    usual, buffer = 2.0 * acid * float(rng.normal(1.0, 0.03)), 0.3 * float(rng.normal(1.0, 0.05))
    # inflow (m³/s); acid in tank and basin (mol/m³)
    inflow, excess, basin, load = flow / 3600.0, 0.0, 0.0, 0.0
    seen, dosed, total, good, wrong, soda = 7.2, 0.5, 0.5, 0, 0.0, 0.0
    for now in range(steps):
        load += -0.02 * load + 0.035 * shocks[now]
        entering = usual * max(0.2, 1.0 + load)
        acidity = 7.3 - asinh(excess / buffer) / log(10.0) * 2.2
        seen += min(1.0, step / (lag + step)) * (acidity + reads[now] - seen)
        error = 7.3 - seen
        total = min(1.0, max(0.0, total + 0.006 * step * error))
        dosed += 0.5 * (min(1.0, max(0.0, total + 0.5 * error)) - dosed)
        added = 4.0 * dosed * reagent * 10.0 / 3600.0  # mol/s
        excess += step * (inflow * (entering - excess) - added) / 1.6
        basin += step * inflow * (excess - basin) / 2.4
        if now >= 60:
            out = 7.3 - asinh(basin / buffer) / log(10.0) * 2.2
            good += 6.0 < out < 9.0
            wrong += abs(out - 7.3) / (steps - 60)
            soda += dosed / (steps - 60)
    return good >= 0.96 * (steps - 60), 10.0 - 1.2 * min(wrong, 4.0) - 2.0 * abs(soda - 0.5)


def trotter(
    rng: np.random.Generator, floor: float, payload: float, grip: float, slope: float
) -> tuple[bool, float]:
    """Trot with a quadruped over 8 m of a yielding floor.

    Drifts: `floor`, stiffness of the floor (kN/m); `payload` (kg); `grip`, friction of the feet; `slope` (degrees). The
    legs are springs with dampers that push off 2.1 times per second. The walk passes if the body bounces by less than
    85 mm up and down and the feet slide by less than 0.5 m. The reward falls with bounces, slides and effort.
    """
    step, steps = 0.005, 1400
    mass = 28.0 + payload
    legs, ground = 11000.0 * float(rng.normal(1.0, 0.02)), 1000.0 * floor * float(rng.normal(1.0, 0.04))
    spring = legs * ground / (legs + ground)
    damping = 105.0
    pace = 2 * pi * 2.1 * float(rng.normal(1.0, 0.008))
    rough, phase = rng.normal(0.0, 30.0, 70).tolist(), float(rng.uniform(0.0, 2 * pi))
    rub = grip * float(rng.normal(1.0, 0.03))
    place, speed, slid, most, effort = 0.0, 0.0, 0.0, 0.0, 0.0
    down = mass * GRAVITY * cos(slope * pi / 180.0)
    back = mass * GRAVITY * sin(slope * pi / 180.0)
    for now in range(steps):
        time = step * now
        push = 86.0 * sin(pace * time + phase) + rough[now // 20]
        pressed = max(0.0, down - spring * place - damping * speed)
        speed += step * (pressed + push - down) / mass
        place += step * speed
        along = back + 55.0 * sin(0.5 * pace * time) + 0.3 * abs(push)
        if abs(along) > rub * pressed:
            slid += step * min(1.2, 0.004 * (abs(along) - rub * pressed) + 0.08)
        effort += step * abs(push * speed) / 100.0
        if now > 200:
            most = max(most, abs(place))
    walked = most < 0.085 and slid < 0.5
    return walked, 10.0 - 20.0 * min(most, 0.15) - 2.0 * min(slid, 2.0) - 0.4 * min(effort, 4.0)


def diver(
    rng: np.random.Generator, first: float, second: float, current: float, ballast: float
) -> tuple[bool, float]:
    """Follow a pipeline with an underwater vehicle, 2.6 m above a sea floor with dunes.

    Two sonars measure the height, with the offsets `first` and `second` (m). The vehicle uses their mean. If they
    differ by more than 0.35 m over some seconds, it follows the chart and a pressure gauge instead, at a greater
    height. `current` is along the pipeline (m/s), and `ballast` is the weight in water (N). The survey passes if the
    vehicle never comes within 0.5 m of the floor and sees the pipeline, at most 4.3 m away, for 85 % of the time. The
    reward falls with the distance from 2.6 m.
    """
    step, steps = 0.4, 420
    reads, white = rng.normal(0.0, 0.06, steps).tolist(), rng.normal(0.0, 0.06, steps).tolist()
    waves, chart = rng.uniform(0.0, 2 * pi, 2).tolist(), float(rng.normal(0.0, 0.15))
    heave = rng.normal(0.0, 0.03, steps).tolist()
    there, height, climb, total, apart, least, seen, wrong = 0.0, 2.6, 0.0, 0.0, 0.0, 9.0, 0, 0.0
    for now in range(steps):
        floor = 0.45 * sin(there / 7.0 + waves[0]) + 0.3 * sin(there / 3.1 + waves[1])
        above = height - floor
        one, two = above + first + reads[now], above + second + white[now]
        apart += 0.1 * (one - two - apart)
        charted = height - 0.45 * sin(there / 7.0 + waves[0]) + chart
        error = 3.2 - charted if abs(apart) > 0.35 else 2.6 - 0.5 * (one + two)
        total = clipped(total + 0.08 * step * error, 0.3)
        thrust = clipped(0.45 * error + total - 0.9 * climb, 0.7)
        climb += step * (0.5 * thrust - 0.006 * ballast - 0.2 * climb) + heave[now]
        height += step * climb
        there += step * max(0.15, 0.7 + current)
        above = height - floor
        if now > 40:
            least = min(least, above)
            seen += above < 4.3
            wrong += abs(above - 2.6) / (steps - 41)
    return least > 0.5 and seen >= 0.85 * (steps - 41), 10.0 - 2.0 * min(wrong, 3.0)


def shuttle(
    rng: np.random.Generator, grip: float, slope: float, load: float, delay: float
) -> tuple[bool, float]:
    """Stop a driverless shuttle of 2.4 t at a line, from 6 m/s, without an anti-lock system.

    Drifts: `grip`, friction of the road; `slope` (percent; positive is downhill); `load` (kg); `delay` of the brake
    (s). The brake holds a speed profile of 2.9 m/s². A wheel that locks keeps 70 % of the friction until the driver
    program releases the brake for 0.3 s. The stop passes if it ends between 1.2 m before and 0.6 m behind the line. The
    reward falls with the distance from the line and with the jerk.
    """
    step, steps = 0.05, 160
    rub, weak = grip * float(rng.normal(1.0, 0.015)), float(rng.normal(1.0, 0.02))
    reads, bumps = rng.normal(0.0, 0.03, steps).tolist(), rng.normal(0.0, 0.12, steps).tolist()
    left, speed, brake, free, locks, asked = 9.0, 6.0 + float(rng.normal(0.0, 0.05)), 0.0, 0, 0, [0.0] * 16
    total = 0.0
    for now in range(steps):
        profile = sqrt(2 * 2.9 * max(0.0, left))
        error = speed + reads[now] - profile
        total = clipped(total + 0.6 * step * error, 0.8)
        asked.append(0.0 if free else max(0.0, 2.9 + 1.8 * error + total if left < 6.4 else 0.0))
        free = max(0, free - 1)
        brake += step / 0.1 * (asked[-1 - round(delay / step)] - brake)
        pressed = min(brake, 7.0) * weak * 2400.0 / (2400.0 + load)
        limit = rub * GRAVITY
        if pressed > limit:
            locks += free == 0
            free = free or 6
            pressed = 0.7 * limit
        speed = max(0.0, speed - step * (pressed - 0.01 * GRAVITY * slope + bumps[now]))
        left -= step * speed
        if speed == 0.0:
            break
    return -0.6 < left < 1.2, 10.0 - 1.5 * min(abs(left), 4.0) - 0.1 * min(locks, 10)


SEVENTH_MACHINES: Mapping[str, Machine] = {
    "unloader": Machine(
        unloader,
        {
            "pores": Span(0.0, 1.6, 0.2),
            "mass": Span(4.0, 16.0, 8.0),
            "lip": Span(0.0, 1.0, 0.1),
            "supply": Span(2.5, 7.0, 6.0),
        },
        min_success=0.9,
        tolerance=3.0,
    ),
    "blade": Machine(
        blade,
        {
            "wind": Span(0.0, 13.0, 3.0),
            "latency": Span(0.0, 0.4, 0.05),
            "payload": Span(0.0, 0.9, 0.2),
            "volts": Span(13.2, 16.8, 15.8),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "neutraliser": Machine(
        neutraliser,
        {
            "acid": Span(0.3, 2.0, 1.0),
            "flow": Span(6.0, 18.0, 10.0),
            "lag": Span(5.0, 180.0, 15.0),
            "reagent": Span(0.6, 1.8, 1.0),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "trotter": Machine(
        trotter,
        {
            "floor": Span(2.5, 60.0, 45.0),
            "payload": Span(0.0, 12.0, 2.0),
            "grip": Span(0.25, 1.0, 0.7),
            "slope": Span(-6.0, 16.0, 0.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "diver": Machine(
        diver,
        {
            "first": Span(-2.5, 2.5, 0.0),
            "second": Span(-2.5, 2.5, 0.0),
            "current": Span(-0.5, 1.0, 0.1),
            "ballast": Span(-30.0, 30.0, 2.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "shuttle": Machine(
        shuttle,
        {
            "grip": Span(0.28, 0.9, 0.6),
            "slope": Span(-6.0, 6.0, 0.0),
            "load": Span(0.0, 1000.0, 300.0),
            "delay": Span(0.0, 0.4, 0.1),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
}


if __name__ == "__main__":
    command(SEVENTH_MACHINES)
