"""Three models of the ARCH-COMP falsification category, as difference equations with a fixed step.

Sources, as cited by the category's reports (Ernst et al., ARCH-COMP 2020, EPiC Series in Computing 74):

- Automatic transmission: Hoxha, Abbas, Fainekos, Benchmarks for temporal logic requirements for automotive systems,
  ARCH 2014, after the model of MathWorks with its engine and shift maps.
- Chasing cars: Hu, Lygeros, Sastry, Towards a theory of stochastic hybrid systems, HSCC 2000.
- Wind turbine: Schuler, Adegas, Anta, Hybrid modelling of a wind turbine, ARCH 2016, with the data of the NREL 5 MW
  turbine.

The shift logic and the modes of the cars follow the Simulink models with which participants of the competition run
(AT/Autotrans_shift.mdl and CC/cars.mdl of MasWag/FalCAuN-ARCH-COMP, commit e8b40ee). tests/test_arch_comp.py compares
both models with published figures of the participant FalStar.

Each function takes inputs of shape (steps, inputs) and returns outputs by name, each of shape (steps,).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

Signal = NDArray[np.float64]
AT_STEP, CC_STEP, WT_STEP = 0.01, 0.01, 0.02  # s

# Automatic transmission: engine torque in ft lb as a function of throttle in % and speed in rpm
ENGINE_THROTTLE = (0, 20, 30, 40, 50, 60, 70, 80, 90, 100)
ENGINE_SPEED = (800, 1200, 1600, 2000, 2400, 2800, 3200, 3600, 4000, 4400, 4800)
ENGINE_TORQUE = (
    (-40, -44, -49, -53, -57, -61, -65, -70, -74, -78, -82),
    (215, 117, 85, 66, 44, 29, 10, -2, -13, -22, -32),
    (245, 208, 178, 148, 122, 104, 85, 66, 48, 33, 18),
    (264, 260, 241, 219, 193, 167, 152, 133, 119, 96, 85),
    (264, 279, 282, 275, 260, 238, 223, 208, 189, 171, 152),
    (267, 290, 293, 297, 290, 275, 260, 256, 234, 212, 193),
    (267, 297, 305, 305, 305, 301, 293, 282, 267, 249, 226),
    (267, 301, 308, 312, 319, 323, 319, 316, 297, 279, 253),
    (267, 301, 312, 319, 327, 327, 327, 327, 312, 293, 267),
    (267, 301, 312, 319, 327, 334, 334, 334, 319, 305, 275),
)
# speeds in mph at which gears 1, 2, 3 shift up and gears 2, 3, 4 shift down, as functions of throttle in %
UP_THROTTLE, UP = (
    (0, 25, 35, 50, 90, 100),
    ((10, 10, 15, 23, 40, 40), (30, 30, 30, 41, 70, 70), (50, 50, 50, 60, 100, 100)),
)
DOWN_THROTTLE = (0, 5, 40, 50, 90, 100)
DOWN = ((5, 5, 5, 5, 30, 30), (20, 20, 25, 30, 50, 50), (35, 35, 40, 50, 80, 80))
# torque converter: capacity factor and torque ratio as functions of the speed ratio
RATIOS = (
    0,
    0.1,
    0.2,
    0.3,
    0.4,
    0.5,
    0.6,
    0.7,
    0.8,
    0.81,
    0.82,
    0.83,
    0.84,
    0.85,
    0.86,
    0.87,
    0.88,
    0.89,
    0.9,
    0.92,
    0.94,
)
CAPACITY = (
    137.47, 137.07, 135.86, 135.66, 137.57, 140.37, 145.27, 152.87, 162.98, 164.28, 166.18,
    167.98, 170.08, 172.78, 175.38, 179.59, 183.59, 189.89, 197.69, 215.90, 244.52,
)  # fmt: skip
TORQUE_RATIO = (
    2.232, 2.075, 1.975, 1.846, 1.72, 1.564, 1.409, 1.254, 1.096, 1.08, 1.061,
    1.043, 1.028, 1.012, 1.002, 1.002, 1.001, 0.998, 0.999, 1.001, 1.002,
)  # fmt: skip
GEARS = (2.393, 1.45, 1.0, 0.677)
ENGINE_INERTIA, VEHICLE_INERTIA, FINAL_DRIVE = 0.021991488283555904, 12.0941, 3.23
DRAG, ROLLING = 0.02, 40.0  # road load in ft lb: DRAG · mph² + ROLLING
MPH = 2 * pi * 60 / 5280  # mph per rpm of a wheel with a radius of 1 ft
SHIFT_EVERY = 4  # steps between two decisions of the shift logic
SHIFT_WAIT = 2  # decisions that must repeat a request before the gear changes


def line(xs: Sequence[float], ys: Sequence[float], x: float) -> float:
    """Return a value of the piecewise linear function through points, extrapolated beyond them."""
    at = min(max(bisect_right(xs, x), 1), len(xs) - 1)
    share = (x - xs[at - 1]) / (xs[at] - xs[at - 1])
    return ys[at - 1] + share * (ys[at] - ys[at - 1])


def engine_torque(throttle: float, rpm: float) -> float:
    """Return the torque of the engine map by bilinear interpolation."""
    at = min(max(bisect_right(ENGINE_THROTTLE, throttle), 1), len(ENGINE_THROTTLE) - 1)
    low, high = ENGINE_THROTTLE[at - 1], ENGINE_THROTTLE[at]
    one = line(ENGINE_SPEED, ENGINE_TORQUE[at - 1], rpm)
    other = line(ENGINE_SPEED, ENGINE_TORQUE[at], rpm)
    return one + (throttle - low) / (high - low) * (other - one)


def drive_rates(rpm: float, wheel: float, gear: int, throttle: float, brake: float) -> tuple[float, float]:
    """Return the rates of change of the engine's speed and of the wheels' speed, in rpm/s; `gear` counts from 0."""
    ratio = FINAL_DRIVE * wheel * GEARS[gear] / rpm
    impeller = (rpm / line(RATIOS, CAPACITY, ratio)) ** 2
    out = impeller * line(RATIOS, TORQUE_RATIO, ratio) * GEARS[gear]
    load = brake + ROLLING + DRAG * (MPH * wheel) ** 2
    engine = (engine_torque(throttle, rpm) - impeller) / ENGINE_INERTIA
    return engine, (FINAL_DRIVE * out - (load if wheel >= 0.0 else -load)) / VEHICLE_INERTIA


def automatic_transmission(inputs: Signal) -> Mapping[str, Signal]:
    """Return `speed` in mph, `rpm` and `gear`, from throttle in % (0 to 100) and brake torque in ft lb (0 to 325)."""
    rpm, wheel, gear = 1000.0, 0.0, 0  # gears count from 0
    requested, waited = 0, 0
    speeds, rpms, gears = (np.empty(len(inputs)) for _ in range(3))
    for step, (throttle, brake) in enumerate(inputs.tolist()):
        speed = MPH * wheel
        if step % SHIFT_EVERY == 0:
            wanted = 0
            if gear < 3 and speed > line(UP_THROTTLE, UP[gear], throttle):
                wanted = 1
            elif gear > 0 and speed < line(DOWN_THROTTLE, DOWN[gear - 1], throttle):
                wanted = -1
            waited = waited + 1 if wanted and wanted == requested else 0
            requested = wanted
            if waited == SHIFT_WAIT:
                gear, waited, requested = gear + wanted, 0, 0
        speeds[step], rpms[step], gears[step] = speed, rpm, gear + 1
        engine, wheels = drive_rates(rpm, wheel, gear, throttle, brake)
        half = min(max(rpm + AT_STEP / 2 * engine, 600.0), 6000.0)  # midpoint method
        engine, wheels = drive_rates(half, wheel + AT_STEP / 2 * wheels, gear, throttle, brake)
        rpm = min(max(rpm + AT_STEP * engine, 600.0), 6000.0)
        wheel += AT_STEP * wheels
    return {"speed": speeds, "rpm": rpms, "gear": gears}


CHASING, KEEPING, BRAKING = range(3)


def chasing_cars(inputs: Signal) -> Mapping[str, Signal]:
    """Return the positions `y1` to `y5` of five cars, from throttle and brake of the first (0 to 1).

    The first car drives towards lower values. Every other car begins by keeping its distance. At a distance of 15 it
    chases the car in front until the distance is 10; at a distance of 5 it brakes until the distance is 20. As in the
    model of the competition, a car that keeps its distance drives backwards with its last speed.
    """
    places, speeds, modes = [0.0, 10.0, 20.0, 30.0, 40.0], [0.0] * 5, [KEEPING] * 5
    found = np.empty((5, len(inputs)))
    for step, (throttle, brake) in enumerate(inputs.tolist()):
        found[:, step] = places
        before = list(places)
        for car in range(5):
            ahead = 1.0
            if car == 0:
                push = throttle - brake * speeds[0]
            else:
                modes[car] = _mode(modes[car], before[car] - before[car - 1])
                push = {CHASING: 1.0, KEEPING: 0.0, BRAKING: -speeds[car]}[modes[car]]
                ahead = -1.0 if modes[car] == KEEPING else 1.0
            places[car] -= CC_STEP * ahead * speeds[car]
            speeds[car] += CC_STEP * push
    return {f"y{car + 1}": found[car] for car in range(5)}


def _mode(mode: int, gap: float) -> int:
    if mode == CHASING:
        return KEEPING if gap <= 10.0 else CHASING
    if mode == KEEPING:
        return CHASING if gap >= 15.0 else BRAKING if gap <= 5.0 else KEEPING
    return CHASING if gap >= 20.0 else BRAKING


# Wind turbine: NREL 5 MW
AIR, ROTOR, GEARBOX = 1.225, 63.0, 1.0 / 97.0  # units: kg/m³, m, ratio
TOWER_MASS = 522617.0 / 4 + 240000.0 + 56780.0 + 3 * 17740.0  # kg, modal
TOWER_FREQUENCY, TOWER_DAMPING = 0.31994, 0.01  # Hz, -
INERTIA = (
    115926.0 + 3 * 11776047.0 + 534.116 * GEARBOX**2
)  # moment of inertia, computed as in the published parameter file (kg m²)
RATED = 12.1 * 2 * pi / 60 / GEARBOX  # speed of the generator (rad/s)
WIND = (0.0, 11.4, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0, 21.0, 22.0, 23.0, 24.0, 25.0)
PITCH = (
    0.0, 0.0, 0.0529, 0.1152, 0.1518, 0.1824, 0.2105, 0.2363,
    0.2604, 0.2833, 0.3049, 0.3264, 0.348, 0.3697, 0.3901, 0.4096,
)  # fmt: skip
# units: rad/s, rad/s, rad/s, W
CUT_IN, REGION_2, RATED_99, POWER = 70.16224, 91.21091, 121.6805, 5296610.0
OPTIMAL, REGION_3_PITCH, MOST_TORQUE, TORQUE_RATE = 2.332287, 0.01745329, 47402.91, 15000.0
SLIP = RATED_99 / 1.1
SLOPE_2 = POWER / RATED_99 / (RATED_99 - SLIP)
TRANSITION = (SLOPE_2 - sqrt(SLOPE_2 * (SLOPE_2 - 4 * OPTIMAL * SLIP))) / (2 * OPTIMAL)
GAIN_P, GAIN_I, SCHEDULE = 0.01882681, 0.008068634, 0.1099965
PITCH_RATE, ACTUATOR, DAMPING, FILTER = np.deg2rad(8.0), 2 * pi, 0.7, 1.0 / (2 * pi * 0.25)


def coefficients(ratio: float, pitch: float) -> tuple[float, float]:
    """Return the power and thrust coefficients: published polynomials of the tip speed ratio and the pitch (rad)."""
    terms = (
        ratio**3, ratio**2 * pitch, ratio**2, ratio * pitch**2, ratio * pitch, ratio, pitch**3, pitch**2, pitch, 1.0,
    )  # fmt: skip
    power = (
        -0.000464550681271132, -0.0747804872950038, -0.002458175859067, -0.372740535667247, 0.0711147525908799,
        0.175932463831508, 3.89808785329087, -3.51436345740801, 1.59939029665458, -0.404129012120541,
    )  # fmt: skip
    thrust = (
        0.00168223358976263, -0.00515118049598468, -0.0472197248103825, 1.16475825684817, -1.52576164855595,
        0.553206918519747, 6.914278352507, -10.9675429628383, 6.00063627824827, -0.98017278861894,
    )  # fmt: skip
    return (
        sum(one * other for one, other in zip(terms, power, strict=True)),
        sum(one * other for one, other in zip(terms, thrust, strict=True)),
    )


def wanted_torque(speed: float, pitch: float) -> float:
    """Return the generator torque in N m that the controller requests at a filtered generator speed in rad/s."""
    if speed >= RATED_99 or pitch >= REGION_3_PITCH:
        return POWER / speed
    if speed <= CUT_IN:
        return 0.0
    if speed < REGION_2:
        return OPTIMAL * REGION_2**2 / (REGION_2 - CUT_IN) * (speed - CUT_IN)
    if speed < TRANSITION:
        return OPTIMAL * speed * speed
    return SLOPE_2 * (speed - SLIP)


def wind_turbine(inputs: Signal) -> Mapping[str, Signal]:
    """Return `pitch` and `pitch_wanted` in °, `rotor` and `generator` in rpm, `torque` in N m, from the wind in m/s."""
    wind0 = float(inputs[0, 0])
    pitch = filtered_pitch = wanted = line(WIND, PITCH, wind0)
    rate = 0.0
    rotor = 1.2671 * min(wind0 / 11.4, 1.0)  # rad/s
    generator = rotor / GEARBOX
    stiffness = TOWER_MASS * (2 * pi * TOWER_FREQUENCY) ** 2
    damping = 4 * pi * TOWER_MASS * TOWER_DAMPING * TOWER_FREQUENCY
    rest = wind0**2 * AIR / 2 * pi * ROTOR**2 / stiffness
    tower, tower_speed, torque = rest, 0.0, wanted_torque(generator, wanted)
    integral = pitch * (pitch / SCHEDULE + 1.0)
    names = ("pitch", "pitch_wanted", "rotor", "generator", "torque")
    found = np.empty((5, len(inputs)))
    for step, wind in enumerate(inputs[:, 0].tolist()):
        found[:, step] = (
            np.rad2deg(filtered_pitch), np.rad2deg(wanted), rotor * 30 / pi, generator * 30 / pi, torque,
        )  # fmt: skip
        scheduled = 1.0 / (pitch / SCHEDULE + 1.0)
        error = generator - RATED
        free = scheduled * (GAIN_P * error + integral)
        bounded = min(max(free, 0.0), pi / 2)
        integral += WT_STEP * (GAIN_P * error - (free - bounded)) * GAIN_I / GAIN_P
        move = WT_STEP * float(PITCH_RATE)
        wanted += min(max(bounded - wanted, -move), move)
        target = wanted_torque(generator, wanted)
        torque += min(max(target - torque, -WT_STEP * TORQUE_RATE), WT_STEP * TORQUE_RATE)
        torque = min(torque, MOST_TORQUE)
        relative = max(wind - tower_speed, 0.1)
        ratio = rotor * ROTOR / relative
        power, thrust = coefficients(ratio, pitch)
        turning = power / ratio * AIR / 2 * pi * ROTOR**3 * relative**2
        pushing = thrust * AIR / 2 * pi * ROTOR**2 * relative**2
        rotor += WT_STEP * (turning - torque / GEARBOX) / INERTIA
        tower, tower_speed = (
            tower + WT_STEP * tower_speed,
            tower_speed
            + WT_STEP * (pushing - damping * tower_speed - stiffness * (tower - rest)) / TOWER_MASS,
        )
        pitch, rate = (
            pitch + WT_STEP * rate,
            rate + WT_STEP * (ACTUATOR**2 * (wanted - pitch) - 2 * DAMPING * ACTUATOR * rate),
        )
        filtered_pitch += WT_STEP * (pitch - filtered_pitch) / FILTER
        generator += WT_STEP * (rotor / GEARBOX - generator) / FILTER
    return dict(zip(names, found, strict=True))
