"""Six machines with drifts in physical units, written without knowledge of the search and its results.

Each mission is a small simulation that takes a generator and four drifts, whose nominal values can be anywhere in their
ranges. As in a test that uses `tarl.rng`, an episode's noise depends only on its seed, so gusts and pushes are the same
under all drifts. Each machine has the success rate and tolerance that a tester would choose.

    python benchmarks/stress_worlds_5.py [MACHINE ...]       # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, exp, hypot, pi, sin, sqrt

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Span


def crane(rng: np.random.Generator, rope: float, wind: float, load: float, late: float) -> tuple[bool, float]:
    """Carry a container over 24 m with a speed profile shaped for a rope of 9 m, then hold it over the mark.

    The gusts come about every 7.4 s, the period of a rope of 13.6 m.
    """
    step, steps = 0.2, 210
    period, phase = float(rng.normal(7.4, 0.15)), float(rng.uniform(0.0, 2 * pi))
    rough = rng.normal(0.0, 0.25, steps)
    shaped = round(
        pi * sqrt(9.0 / GRAVITY) / step
    )  # half a period: the second half of each push cancels the sway
    delay, seen = round(late / step), [0.0] * 8
    trolley = speed = sway = rate = worst = 0.0
    limit = min(0.6, 14.0 / (load + 4.0))  # maximum acceleration by the motor (m/s²)
    for now in range(steps):
        seen.append(rope * sin(sway))
        if now < 110:
            wanted = 0.75 * ((10 <= now < 90) + (10 + shaped <= now < 90 + shaped))
        else:
            wanted = clipped(0.3 * (24.0 - trolley) + 0.5 * seen[-1 - delay], 0.8)
        force = clipped((wanted - speed) / step, limit)
        gust = wind * (1.0 + 0.3 * sin(2 * pi * now * step / period + phase)) + rough[now]
        pressed = 22.0 * (gust * abs(gust) - wind * wind) / (1000.0 * load)
        rate += step * (-GRAVITY / rope * sin(sway) - force / rope * cos(sway) + pressed / rope - 0.02 * rate)
        sway += step * rate
        speed += step * force
        trolley += step * speed
        if now >= steps - 40:
            worst = max(worst, abs(trolley + rope * sin(sway) - 24.0))
    return worst < 1.0, 20.0 - 6.0 * clipped(max(worst - 0.5, 0.0), 2.0)


def balancer(
    rng: np.random.Generator, height: float, slope: float, tilt: float, volts: float
) -> tuple[bool, float]:
    """Keep a two-wheeled robot in place while somebody pushes it twice.

    `tilt` is the offset of the tilt sensor, which may add to the slope or compensate for it.
    """
    step, steps = 0.04, 150
    first, second = int(rng.integers(20, 50)), int(rng.integers(80, 110))
    shove = float(rng.normal(0.0, 0.25)), float(rng.normal(0.0, 0.25))
    noise = rng.normal(0.0, 0.004, steps)
    pitch = rate = place = speed = 0.0
    error, limit = 0.0, 7.0 * (volts / 24.0) ** 2
    for now in range(steps):
        seen = pitch + tilt + noise[now]
        push = clipped(38.0 * seen + 9.0 * rate + 1.6 * place + 3.4 * speed, limit)
        if now == first:
            rate += shove[0] / height
        if now == second:
            rate += shove[1] / height
        driven = push - GRAVITY * slope - 0.4 * speed
        rate += step * (GRAVITY * sin(pitch) - driven * cos(pitch)) / height
        pitch += step * rate
        speed += step * driven
        place += step * speed
        error += max(abs(place) - 0.6, 0.0)
        if abs(pitch) > 0.8:
            return False, 0.0
    return abs(place) < 1.6, 10.0 - 6.0 * min(error / steps, 1.5)


def infusion(
    rng: np.random.Generator, sensitivity: float, meal: float, late: float, leak: float
) -> tuple[bool, float]:
    """Hold a patient's glucose between 70 and 180 mg/dl for eight hours and a meal, with a pump.

    The patient always announces a usual meal, so a smaller one leads to too much insulin.
    """
    steps = 96  # number of steps of five minutes
    eaten = int(rng.integers(14, 24))
    strong, noise = float(rng.normal(1.0, 0.08)), rng.normal(0.0, 4.0, steps)
    glucose, gut, stored, active = 118.0, 0.0, 0.0, 1.0
    delay, seen = round(late / 5.0), [118.0] * 9
    lowest, inside = glucose, 0
    for now in range(steps):
        seen.append(glucose + noise[now])
        known = seen[-1 - delay]
        trend = known - seen[-4 - delay]
        dose = max(0.0, 1.0 + 0.04 * (known - 112.0) + 0.04 * trend)
        if known < 78.0:
            dose = 0.0
        if now == eaten:
            dose += 18.0  # the dose for a usual meal, whatever the patient eats
        gut += meal if now == eaten else 0.0
        absorbed, gut = 0.075 * gut, 0.925 * gut
        stored += 0.12 * (min(dose, 20.0) * (1.0 - leak) - stored)
        active += 0.12 * (stored - active)
        glucose += 4.2 * absorbed - 3.4 * sensitivity * strong * active * glucose / 118.0 + 3.4
        glucose = max(glucose, 20.0)
        lowest = min(lowest, glucose)
        inside += 70.0 <= glucose <= 180.0
    return lowest > 60.0, 100.0 * inside / steps


def centrifuge(
    rng: np.random.Generator, stiffness: float, imbalance: float, damping: float, ramp: float
) -> tuple[bool, float]:
    """Spin a sample up to 3,000 rpm; the rotor trips if it shakes too much.

    The critical speed grows with the stiffness of the bearings. At nominal, it is below the working speed; a medium
    increase makes the two equal. A slow ramp stays near the critical speed for longer.
    """
    weight = abs(imbalance + float(rng.normal(0.0, 0.6)))
    critical = 2350.0 * sqrt(stiffness) * float(rng.normal(1.0, 0.008))
    noise = rng.normal(0.0, 0.12, 120)
    speed = shaking = done = 0.0
    worst = 0.0
    for now in range(120):
        speed = min(speed + ramp, 3000.0)
        ratio = (speed / critical) ** 2
        settled = 0.55 * weight * ratio / hypot(1.0 - ratio, 2.0 * damping * sqrt(ratio))
        quick = 0.07 + 1.6 * damping
        shaking += quick * (settled - shaking)
        worst = max(worst, shaking + abs(noise[now]))
        done += (speed / 3000.0) ** 2 * (1.0 if shaking < 9.0 else 0.2)
        if worst > 15.0:
            return False, done / 10.0
    return True, done / 10.0


def picker(
    rng: np.random.Generator, light: float, sway: float, colour: float, wear: float
) -> tuple[bool, float]:
    """Pick the ripe ones among 24 fruits with a camera and a soft gripper before the time is up.

    The camera sees badly in dim light and in glare. In dim light, fruits also look less ripe.
    """
    ripe = rng.random(24) < 0.65
    looks = np.where(ripe, 0.75, 0.25) + rng.normal(0.0, 0.09, 24)
    luck, places = rng.random((24, 3)), np.abs(rng.normal(0.0, 1.0, (24, 3)))
    dim, glare = 1.0 / (1.0 + exp((light - 190.0) / 45.0)), 1.0 / (1.0 + exp((1500.0 - light) / 130.0))
    seen = looks + colour - 0.22 * dim
    blur = 0.55 + 1.3 * dim + 1.6 * glare
    left, basket, wrong = 62.0, 0, 0
    for fruit in range(24):
        if seen[fruit] < 0.5:
            continue
        for attempt in range(3):
            left -= 1.0 + 0.12 * sway
            if left < 0.0:
                break
            off = hypot(blur * places[fruit, attempt] * 0.6, 0.45 * sway * places[fruit, attempt - 1])
            if off < 1.9 and luck[fruit, attempt] > 0.03 + 0.5 * wear**2 * (1.0 + 0.25 * off):
                basket += bool(ripe[fruit])
                wrong += not ripe[fruit]
                break
    share = basket / max(int(ripe.sum()), 1)
    return share >= 0.7 and wrong <= 4, 10.0 * share - 0.8 * max(wrong - 1, 0)


def ward_tug(
    rng: np.random.Generator, capacity: float, lift: float, crowd: float, docking: float
) -> tuple[bool, float]:
    """Deliver six trolleys to other floors of a hospital, each in time; charge if the battery gets low.

    There is slack, so lifts or crowds alone matter only near the ends of their ranges. Charging costs minutes, and a
    smaller battery may charge at a quieter time. In one mission in a hundred, a trolley is not where it should be.
    """
    charge, clock, late, hours = 0.9 * capacity, 0.0, 0, 0.0
    for delivery in range(6):
        ways, wait = rng.normal(150.0, 12.0, 2), rng.gamma(6.0, 1.0 / 6.0, 2)
        tries = rng.random(6)
        busy = crowd * (1.6 if delivery in (2, 3) else 0.8)
        slow = 1.0 + 0.35 * busy**2
        spent = float(ways.sum()) * slow + float(wait.sum()) * lift
        for one in tries:
            spent += 18.0
            if one > docking:
                break
        used = 0.085 + 0.04 * busy + 0.00012 * spent
        if charge - used < 0.12:
            spent += 420.0 * min(1.0, (0.9 * capacity - charge) / 0.5 + 0.3)
            charge = 0.9 * capacity
        charge -= used
        clock += spent
        over = clock - 600.0 * (delivery + 1) - 230.0
        late += over > 0.0
        hours += max(over, 0.0) / 60.0
        clock = max(clock, 480.0 * (delivery + 1))  # the next trolley is not ready earlier
    return late <= 1 and bool(rng.random() > 0.01), 30.0 - hours


MACHINES: Mapping[str, Machine] = {
    "crane": Machine(
        crane,
        {
            "rope": Span(4.0, 16.0, 9.0),
            "wind": Span(0.0, 18.0, 5.0),
            "load": Span(3.0, 40.0, 18.0),
            "late": Span(0.0, 1.4, 0.2),
        },
        min_success=0.9,
        tolerance=1.5,
    ),
    "balancer": Machine(
        balancer,
        {
            "height": Span(0.25, 1.5, 0.6),
            "slope": Span(-0.25, 0.25, 0.0),
            "tilt": Span(-0.1, 0.1, 0.0),
            "volts": Span(14.0, 26.0, 24.0),
        },
        min_success=0.95,
        tolerance=1.0,
    ),
    "infusion": Machine(
        infusion,
        {
            "sensitivity": Span(0.4, 2.5, 1.0),
            "meal": Span(0.0, 110.0, 45.0),
            "late": Span(0.0, 25.0, 5.0),
            "leak": Span(0.0, 0.7, 0.0),
        },
        min_success=0.95,
        tolerance=10.0,
    ),
    "centrifuge": Machine(
        centrifuge,
        {
            "stiffness": Span(0.5, 2.4, 0.8),
            "imbalance": Span(0.0, 12.0, 3.0),
            "damping": Span(0.02, 0.3, 0.2),
            "ramp": Span(20.0, 160.0, 100.0),
        },
        min_success=0.9,
        tolerance=1.0,
    ),
    "picker": Machine(
        picker,
        {
            "light": Span(50.0, 2000.0, 700.0),
            "sway": Span(0.0, 6.0, 0.5),
            "colour": Span(-0.3, 0.3, 0.0),
            "wear": Span(0.0, 1.0, 0.1),
        },
        min_success=0.85,
        tolerance=1.0,
    ),
    "ward_tug": Machine(
        ward_tug,
        {
            "capacity": Span(0.4, 1.0, 0.95),
            "lift": Span(10.0, 120.0, 40.0),
            "crowd": Span(0.0, 1.0, 0.2),
            "docking": Span(0.0, 0.6, 0.05),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
}


if __name__ == "__main__":
    command(MACHINES)
