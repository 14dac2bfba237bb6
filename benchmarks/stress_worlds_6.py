"""Six more machines with drifts in physical units, written without knowledge of the search and its results.

The form is that of stress_worlds_5.py: each mission is a small simulation that takes a generator and four drifts; an
episode's noise depends only on its seed; and each machine has the success rate and tolerance that a tester would
choose. A mission's docstring gives the model, the controller and what passes, but not where it fails. `QUIET_MACHINES`
are two of the six on part of their ranges, where nothing breaks the guarantee.

    python benchmarks/stress_worlds_6.py [MACHINE ...]       # how safe nominal is, and how many random drifts fail
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import atan, atan2, copysign, cos, degrees, exp, hypot, pi, radians, sin, sqrt

import numpy as np
from stress_machines import GRAVITY, Machine, clipped, command

from pytest_tarl.spaces import Span


def glider(
    rng: np.random.Generator, headwind: float, pitot: float, mass: float, gusts: float
) -> tuple[bool, float]:
    """Land a fixed-wing drone at a mark, down a glide path of 5.7°, with a flare at 2 m.

    The throttle holds the indicated airspeed at 12 m/s, and the lift follows the glide path; `pitot` is the airspeed
    sensor's offset. The landing passes if the drone touches down between 25 m before and 45 m behind the mark with a
    sink rate below 1.7 m/s. The reward falls with the distance from the mark and the sink rate.
    """
    step, density, wing = 0.1, 1.225, 0.45  # s, kg/m³, m²
    shocks, reads = rng.normal(0.0, 1.0, 700).tolist(), rng.normal(0.0, 0.3, 700).tolist()
    there, height, speed, path = -260.0, 26.0 + float(rng.normal(0.0, 0.7)), 12.0, -0.1
    thrust, total, bent, gust, sink = 3.0, 0.0, 0.0, 0.0, 0.0
    for now in range(700):
        error = 12.0 - (speed + pitot + reads[now])
        total = clipped(total + 0.15 * step * error, 4.0)
        thrust += 0.3 * (min(9.0, max(0.0, 3.0 + 1.5 * error + total)) - thrust)
        above = height - max(-0.1 * there, 0.0)
        bent = clipped(bent + 0.012 * step * above, 0.2)
        wanted = -0.1 - clipped(0.03 * above + bent, 0.2) if height > 2.0 else -0.05
        pressure = 0.5 * density * wing * speed * speed
        turn = 2.0 * clipped(wanted - path, 0.15) * speed / GRAVITY
        lift = min(1.3, max(0.0, 2.5 * GRAVITY * (1.0 + turn) / pressure + 0.8 * (wanted - path)))
        drag = 0.05 + 0.06 * lift * lift
        before = gust
        gust += -gust * step / 2.0 + gusts * sqrt(2 * step / 2.0) * shocks[now]
        path += step * (pressure * lift / mass - GRAVITY * cos(path)) / speed
        speed += step * ((thrust - pressure * drag) / mass - GRAVITY * sin(path)) + gust - before
        speed = max(speed, 4.0)
        sink = -speed * sin(path)
        there += step * (speed * cos(path) - headwind - gust)
        height -= step * sink
        if height <= 0.0:
            break
    landed = height <= 0.0 and -25.0 < there < 45.0 and sink < 1.7
    return landed, 10.0 - 0.06 * min(abs(there), 80.0) - 1.5 * clipped(max(sink - 0.8, 0.0), 2.0)


def lathe(
    rng: np.random.Generator, depth: float, turns: float, clamping: float, hardness: float
) -> tuple[bool, float]:
    """Turn a shaft for 16 revolutions; each cut follows the waves left by the last revolution.

    A monitor lowers the feed by 15 % after each revolution that shakes too much. `depth` is in mm, `turns` in 1/min.
    The part passes if the last four revolutions leave waves below 24 µm. The reward falls with the waves and the feed
    given up.
    """
    step, stiffness = 0.0004, 2.0e7 * clamping  # s, N/m
    natural = 2 * pi * 140.0 * sqrt(clamping) * float(rng.normal(1.0, 0.01))
    mass, damping = 2.0e7 / (2 * pi * 140.0) ** 2, 0.05
    cutting = 8.0e8 * hardness * 1e-3 * depth * float(rng.normal(1.0, 0.03))  # N/m
    rough = rng.normal(0.0, 4.0, 2000).tolist()
    period = max(2, round(60.0 / turns / step))
    feed, place, speed = 1.0e-4, 0.0, 0.0  # m per revolution, m, m/s
    past, waves, kept = [0.0] * period, [], 0.0
    for lap in range(16):
        laid, low, high = [], 1.0, -1.0
        for now in range(period):
            chip = max(0.0, feed + past[now] - place)
            force = cutting * chip + rough[(lap * period + now) % 2000]
            speed += step * (force / mass - 2 * damping * natural * speed - stiffness / mass * place)
            place += step * speed
            laid.append(place)
            low, high = min(low, place), max(high, place)
        past = laid
        waves.append(1e6 * (high - low))
        kept += feed / 1.6e-3
        if lap > 3 and waves[-1] > 15.0:
            feed *= 0.85
    worst = max(waves[-4:])
    return worst < 24.0, 10.0 - 0.08 * min(worst, 40.0) - 5.0 * (1.0 - kept)


def gripper(
    rng: np.random.Generator, friction: float, mass: float, offset: float, hurry: float
) -> tuple[bool, float]:
    """Lift a tomato, carry it and put it down with a two-finger gripper that feels slip.

    The gripper starts at 3 N and adds 0.4 N whenever the slip sensor reports movement. `offset` is the force sensor's
    offset (N), and `hurry` the arm's acceleration (m/s²). The pick passes if the tomato slips by less than 20 mm and
    the true force stays below 8 N. One tomato in 80 is soft and breaks anyway. The reward falls with the slip and the
    force on the skin.
    """
    step, motor = 0.01, 0.0
    rub = friction * float(rng.normal(1.0, 0.05))
    weight = mass * float(rng.normal(1.0, 0.04))
    reads, slips = rng.normal(0.0, 0.1, 300).tolist(), rng.normal(0.0, 0.004, 300).tolist()
    wanted, slid, moving, most, bump = 3.0, 0.0, 0.0, 0.0, float(rng.uniform(90.0, 200.0))
    firm = bool(rng.random() > 1 / 80)
    for now in range(300):
        seen = motor + offset + reads[now]
        motor = max(0.0, motor + 0.2 * clipped(wanted - seen, 3.0))
        lifting = hurry if 40 <= now < 75 else -0.6 * hurry if 75 <= now < 110 else 0.0
        lifting += 1.5 * exp(-(((now - bump) / 3.0) ** 2)) + 0.8 * hurry * (220 <= now < 240)
        most = max(most, motor)
        if now < 35:
            continue  # still on the table
        carried, hold = weight * (GRAVITY + lifting), 2.0 * rub * motor
        if carried > hold or moving > 0.0:
            moving = max(0.0, moving + step * (carried - 0.9 * hold) / weight)
            slid += step * moving
        if moving + slips[now] > 0.012:
            wanted = min(wanted + 0.4, 12.0)
        if slid > 0.06:
            return False, 2.0
    held = slid < 0.02 and most < 8.0 and firm
    return held, 10.0 - 120.0 * min(slid, 0.03) - 0.4 * max(0.0, most - 4.0)


def mower(
    rng: np.random.Generator, multipath: float, bank: float, wet: float, grass: float
) -> tuple[bool, float]:
    """Mow four lanes along a pond by satellite positions and wheel odometry.

    Drifts: `multipath`, standard deviation of a position's slow error (m); `bank`, slope towards the pond (degrees);
    `wet`, how slippery the lawn is; `grass`, its height (cm), which costs charge. The mission passes if the mower never
    comes within 0.1 m of the pond (the first lane is 0.65 m away) and its battery lasts. The reward is the mown share
    in percent.
    """
    step, lane, steps = 0.2, 75, 300  # the mower needs 15 s for a lane
    shocks, white = rng.normal(0.0, 1.0, steps).tolist(), rng.normal(0.0, 0.04, steps).tolist()
    shakes = rng.normal(0.0, 0.02, steps).tolist()
    error = multipath * float(rng.normal(0.0, 1.0))
    side, heading, guess, charge, missed, safe = 0.0, float(rng.normal(0.0, 0.02)), 0.0, 1.0, 0.0, True
    keep = exp(-step / 12.0)
    for now in range(steps):
        error = keep * error + multipath * sqrt(1 - keep * keep) * shocks[now]
        sliding = 0.012 * bank * (0.3 + wet)  # speed towards the pond (m/s)
        guess += step * 0.8 * heading
        guess += 0.12 * (side + error + white[now] - guess)
        turn = clipped(-1.2 * guess - 1.8 * heading, 0.8) * (1.0 - 0.4 * wet)
        heading += step * turn + shakes[now] * (0.5 + wet)
        side += step * (0.8 * sin(heading) + sliding)
        charge -= 0.0004 + 0.00004 * grass + 0.0002 * abs(turn)
        missed += max(0.0, abs(side) - 0.2) / 0.6  # lanes overlap, so the first 0.2 m do no harm
        safe = safe and 0.65 + 0.45 * (now // lane) - side > 0.1
    return safe and charge > 0.15, 100.0 * (1.0 - min(1.0, missed / steps))


def dish(
    rng: np.random.Generator, clock: float, wind: float, tilt: float, friction: float
) -> tuple[bool, float]:
    """Follow a satellite with an antenna of 1.6° half beam width, through a pass that culminates at 78°.

    The antenna follows the ephemeris at its own time (`clock`, error in s), on a mount that is not quite level (`tilt`,
    in degrees). The azimuth drive has a rate loop with Coulomb friction (°/s²) and a limited speed. The pass succeeds
    if the signal is received for 88 % of it. The reward is the received share in percent.
    """
    step, steps = 0.5, 400
    turned, angle = radians(tilt), float(rng.uniform(-0.6, 0.6)) + 0.9  # rad
    shocks, reads = rng.normal(0.0, 1.0, steps).tolist(), rng.normal(0.0, 0.08, steps).tolist()
    skew = float(rng.normal(0.0, 0.12))  # error of the ephemeris (s)
    azimuth, rate, gust, held, received = degrees(atan2(-760.0, 117.0)), 0.0, 0.0, 0, 0.0
    for now in range(steps):
        true, own = step * (now - steps / 2), step * (now - steps / 2) + clock + skew
        across = degrees(atan2(7.6 * own, 117.0))
        ahead = degrees(7.6 * 117.0 / (117.0**2 + (7.6 * own) ** 2))
        wanted = clipped(ahead + 0.8 * (across - azimuth + reads[now]), 5.0)
        gust += -0.1 * gust + 0.2 * shocks[now]
        blown = wind * (1.0 + gust)
        pushed = 0.006 * blown * abs(blown) * sin(radians(azimuth) - angle)
        for _ in range(4):  # the rate loop
            pull = 5.0 * (wanted - rate) + pushed
            slowed = clipped(friction, abs(pull)) if abs(rate) < 0.02 else friction
            rate += 0.25 * step * (pull - copysign(slowed, rate if abs(rate) >= 0.02 else pull))
            azimuth += 0.25 * step * rate
        up = atan(550.0 / hypot(7.6 * true, 117.0))
        seen = atan(550.0 / hypot(7.6 * own, 117.0)) + turned * cos(radians(azimuth))
        off = azimuth - degrees(atan2(7.6 * true, 117.0))
        beside = off * cos(up) + tilt * sin(radians(azimuth)) * sin(up)
        signal = exp(-0.69 * (hypot(beside, degrees(seen - up)) / 1.6) ** 2)
        held += signal > 0.5
        received += signal / steps
    return held >= 0.88 * steps, 100.0 * received


def reflow(
    rng: np.random.Generator, load: float, belt: float, draught: float, probe: float
) -> tuple[bool, float]:
    """Solder a board in an oven with eight zones, each with its own heater and thermocouple.

    Drifts: `load`, heat capacity of the board relative to the usual one; `belt`, speed (m/min); `draught`, additional
    losses of the zones; `probe`, offset of the thermocouples (°C). The heaters are limited. The board passes if its
    peak is between 228 and 256 °C and it is above 217 °C for 20 to 85 s. The reward falls with the distance of both
    from the middle of their windows.
    """
    step, length = 1.0, 0.4  # s, m
    settings = (115.0, 145.0, 165.0, 180.0, 205.0, 262.0, 264.0, 90.0)  # °C
    shift = float(rng.normal(0.0, 1.5))
    ambient = 24.0 + float(rng.normal(0.0, 2.0))
    zones = [one + float(each) for one, each in zip(settings, rng.normal(0.0, 1.0, 8), strict=True)]
    board, place, peak, above = ambient, 0.0, ambient, 0.0
    reads = rng.normal(0.0, 0.8, 500).tolist()
    lag = 39.0 * load * float(rng.normal(1.0, 0.02))  # s
    for now in range(500):
        inside = min(7, int(place / length))
        for zone in range(8):
            held = zones[zone]
            seen = held + probe + shift + reads[(now + 61 * zone) % 500]
            power = min(1.0, max(0.0, 0.0028 * settings[zone] + 0.06 * (settings[zone] - seen)))
            lost = 0.01 * (1.0 + draught * (1.6 if zone in (0, 5, 6) else 0.6)) * (held - ambient)
            taken = 0.25 * load * (held - board) / lag if zone == inside else 0.0
            zones[zone] = held + step * (4.0 * power - lost - taken)
        board += step * (zones[inside] - board) / lag
        peak = max(peak, board)
        above += step * (board > 217.0)
        place += step * belt / 60.0
        if place >= 8 * length:
            break
    soldered = 228.0 < peak < 256.0 and 20.0 < above < 85.0
    return soldered, 10.0 - 0.12 * min(abs(peak - 243.0), 40.0) - 0.03 * min(abs(above - 50.0), 60.0)


SIXTH_MACHINES: Mapping[str, Machine] = {
    "glider": Machine(
        glider,
        {
            "headwind": Span(-5.0, 9.0, 2.0),
            "pitot": Span(-3.0, 4.0, 0.0),
            "mass": Span(2.2, 3.4, 2.5),
            "gusts": Span(0.0, 3.5, 0.4),
        },
        min_success=0.9,
        tolerance=1.0,
    ),
    "lathe": Machine(
        lathe,
        {
            "depth": Span(0.4, 3.0, 1.3),
            "turns": Span(1200.0, 4200.0, 2400.0),
            "clamping": Span(0.4, 1.2, 1.0),
            "hardness": Span(0.6, 1.8, 1.0),
        },
        min_success=0.95,
        tolerance=1.5,
    ),
    "gripper": Machine(
        gripper,
        {
            "friction": Span(0.3, 1.0, 0.6),
            "mass": Span(0.05, 0.3, 0.15),
            "offset": Span(-2.0, 2.0, 0.0),
            "hurry": Span(1.0, 8.0, 3.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
    "mower": Machine(
        mower,
        {
            "multipath": Span(0.0, 0.4, 0.06),
            "bank": Span(-8.0, 10.0, 2.0),
            "wet": Span(0.0, 1.0, 0.2),
            "grass": Span(3.0, 12.0, 5.0),
        },
        min_success=0.95,
        tolerance=20.0,
    ),
    "dish": Machine(
        dish,
        {
            "clock": Span(-1.2, 1.2, 0.0),
            "wind": Span(0.0, 25.0, 6.0),
            "tilt": Span(-0.7, 0.9, 0.0),
            "friction": Span(0.0, 4.0, 0.5),
        },
        min_success=0.95,
        tolerance=15.0,
    ),
    "reflow": Machine(
        reflow,
        {
            "load": Span(0.65, 1.6, 1.0),
            "belt": Span(0.65, 1.1, 0.8),
            "draught": Span(0.0, 0.55, 0.1),
            "probe": Span(-6.0, 10.0, 0.0),
        },
        min_success=0.95,
        tolerance=2.0,
    ),
}


QUIET_MACHINES: Mapping[str, Machine] = {
    "quiet_gripper": replace(
        SIXTH_MACHINES["gripper"],
        directions={
            "friction": Span(0.55, 0.75, 0.6),
            "mass": Span(0.12, 0.18, 0.15),
            "offset": Span(-0.7, 0.5, 0.0),
            "hurry": Span(2.0, 5.0, 3.0),
        },
    ),
    "quiet_dish": replace(
        SIXTH_MACHINES["dish"],
        directions={
            "clock": Span(-0.5, 0.5, 0.0),
            "wind": Span(0.0, 12.0, 6.0),
            "tilt": Span(-0.35, 0.35, 0.0),
            "friction": Span(0.0, 1.2, 0.5),
        },
    ),
}  # worlds in which no point of the ranges breaks the guarantee


if __name__ == "__main__":
    command({**SIXTH_MACHINES, **QUIET_MACHINES})
