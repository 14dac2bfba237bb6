"""Six closed loops of a robot or a plant, each in four directions, written without knowledge of the search.

The conventions are those of stress_worlds.py: a drift x is in units of the ranges, and 0 is nominal. The first two
directions range from -0.5 to 0.5, the last two from 0 to 1. Each world steps a model with a controller that was tuned
at nominal. Its docstring gives the model, the controller, what passes, and the four directions in physical units, but
not where the failures are. `QUIET_WORLDS` are two of the six on a fraction of their ranges, where nothing fails.

    python benchmarks/stress_worlds_4.py     # sample each world: nominal episodes and the share of drifts that fail
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from math import atan2, cos, exp, hypot, sin, sqrt
from time import process_time

import numpy as np
from stress_worlds import NOISE, SHARED, TOLERANCE, Vector, World

GRAVITY = 9.81  # m/s²
LOW, HIGH = np.array([-0.5, -0.5, 0.0, 0.0]), np.array([0.5, 0.5, 1.0, 1.0])


def clip(value: float, size: float) -> float:
    """Return the value, limited to ±size."""
    return max(-size, min(size, value))


def quadrotor(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Fly a planar quadrotor 2 m sideways in gusts and hold it there, with delayed state estimates.

    A position loop commands a tilt, and an attitude loop commands a torque. Within limits, the thrust compensates for
    the nominal weight and the tilt. The flight passes if the quadrotor stays above 1 m, never tilts beyond 1 rad, and
    ends within 0.7 m of its goal. The reward falls with the mean error of the second half.

    Directions: mass (0.7 to 1.3 kg); centre of mass (±9 mm to the side); age of the estimates (40 to 240 ms); gusts
    (standard deviation of 0.3 to 1.3 m/s²).
    """
    p, q, r, s = x.tolist()
    mass, aside, age, gusts = 1.0 + 0.6 * p, 0.018 * q, 2 + round(10 * r), 0.3 + 1.0 * s
    side, height, tilt, inertia, step = 0.0, 3.0, 0.0, 0.012, 0.02
    sideways, upwards, turning, gust = 0.0, 0.0, 0.0, 0.0
    past = [(side, sideways, height, upwards)] * (age + 1)
    shocks = draws.normal(0.0, 1.0, 200).tolist()
    reads = draws.normal(0.0, 0.02, 200).tolist()
    error, passed = 0.0, True
    for tick in range(200):
        seen, pace, level, climb = past[-1 - age]
        asked = clip(2.6 * (2.0 - seen + reads[tick]) - 2.7 * pace, 5.0)
        torque = clip(1.1 * (asked / GRAVITY - tilt) - 0.2 * turning, 0.5)
        thrust = GRAVITY + 4.0 * (3.0 - level) - 3.5 * climb
        thrust = min(15.0, max(1.0, thrust / max(0.5, cos(tilt))))
        gust += step / 0.4 * -gust + gusts * sqrt(2 * step / 0.4) * shocks[tick]
        sideways += step * (thrust * sin(tilt) / mass + gust / mass - 0.2 * sideways)
        upwards += step * (thrust * cos(tilt) / mass - GRAVITY)
        turning += step * (torque + thrust * aside) / inertia
        side, height, tilt = side + step * sideways, height + step * upwards, tilt + step * turning
        past.append((side, sideways, height, upwards))
        if abs(tilt) > 1.0 or height < 1.0:
            passed = False
            break
        if tick >= 100:
            error += 0.01 * hypot(side - 2.0, height - 3.0)
    if not passed:
        return False, 10.0 - 4.0 * TOLERANCE
    return abs(side - 2.0) < 0.7, 10.0 - 1.4 * TOLERANCE * min(error, 2.0) + draws.normal(0.0, NOISE)


def forklift(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Drive a forklift over a ramp of 6 m and stop it, load first, at a rack 12 m away.

    The speed follows the braking distance to the rack. Drive and brake act on the front axle, which carries the load;
    its wheels slip beyond their grip. The run passes if the forklift stops 0 to 0.3 m before the rack within 15 s and
    never lifts its rear axle. The reward falls with the time taken.

    Directions: load (300 to 1500 kg); slope of the ramp (-0.13 to 0.13 rad; negative is downhill); fading of the brake
    (up to 65 %); water on the floor (friction from 0.5 down to 0.12).
    """
    p, q, r, s = x.tolist()
    load, slope, brake, friction = 900.0 + 1200 * p, 0.26 * q, 5200.0 * (1 - 0.65 * r), 0.5 - 0.38 * s
    friction += draws.normal(0.0, 0.012)
    mass, speed, place, force, rear, step = 2600.0 + load, 0.0, draws.normal(0.0, 0.05), 0.0, 1e4, 0.1
    reads = draws.normal(0.0, 0.02, 150).tolist()
    for tick in range(150):
        left = 11.85 - place + reads[tick]
        wanted = min(2.2, sqrt(2 * 0.4 * max(0.0, left)), 1.2 * max(0.0, left))
        force += 0.6 * (9000.0 * (wanted - speed) - force)
        force = max(-brake, min(3600.0, force))
        pitch = slope if 2.0 < place < 8.0 else 0.0
        applied = clip(force, friction * (mass * GRAVITY - rear))
        rear = (GRAVITY * (0.95 * 2600.0 - 1.2 * load) + applied / mass * (0.7 * 2600.0 + 2.2 * load)) / 1.6
        if rear < 0.0:
            return False, 10.0 - 2.0 * TOLERANCE
        speed += step * (applied / mass - GRAVITY * (pitch + 0.008 * (speed > 0)))
        if left < 0.3 and speed < 0.03:
            break
        speed = max(speed, -0.5)
        place += step * speed
        if place > 12.0:
            return False, 10.0 - 2.0 * TOLERANCE
    stopped = speed < 0.1 and place > 11.7
    return stopped, 10.0 - 0.06 * TOLERANCE * (step * tick - 8.0) + draws.normal(0.0, NOISE)


def corridor(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Drive a two-wheeled base along a bent corridor through two doors, by odometry and marks on the walls.

    Pure pursuit steers by the estimated pose. A mark every 2 m corrects the estimate, unless it appears at least 0.3 m
    to the side, which counts as a wrong match. The run passes if the base passes both doors within 0.25 m of their
    middle and always stays within 0.6 m of the path. The reward falls with the mean distance from the path.

    Directions: one wheel larger than the other (±2 %); bias of the gyro (±0.03 rad/s); latency of commands and marks (0
    to 0.4 s); slip of the wheels in turns (0 to 35 %).
    """
    p, q, r, s = x.tolist()
    wear, bias, late, slip = 0.04 * p, 0.06 * q, round(4 * r), 0.35 * s
    along, across, turned = 0.0, draws.normal(0.0, 0.03), draws.normal(0.0, 0.02)
    guess = [0.0, 0.0, 0.0]
    queue, past = [0.0] * (late + 1), [(across, 0.0)] * (late + 1)
    shakes, reads = draws.normal(0.0, 0.03, 190).tolist(), draws.normal(0.0, 0.03, 190).tolist()
    mark, away, ticks, passed = 1.0, 0.0, 0, True
    for ticks in range(1, 190):
        ahead = guess[0] + 0.7
        goal = 0.6 * sin(0.8 * ahead) - guess[1]
        queue.append(clip(2 * 0.5 * sin(atan2(goal, 0.7) - guess[2]) / hypot(goal, 0.7), 1.0))
        rate = queue[-1 - late]
        true = (1 - slip * min(1.0, abs(rate) / 0.5)) * rate + 0.5 * wear / 0.4 + shakes[ticks]
        turned += 0.1 * true
        guess[2] += 0.1 * (0.6 * (true + bias) + 0.4 * rate)
        along, across = along + 0.05 * cos(turned), across + 0.05 * sin(turned)
        guess[0], guess[1] = guess[0] + 0.05 * cos(guess[2]), guess[1] + 0.05 * sin(guess[2])
        past.append((across, turned))
        if along > mark:
            mark += 2.0
            lateral, facing = past[-1 - late]
            if abs(lateral + reads[ticks] - guess[1]) < 0.3:
                guess[0], guess[1] = along - 0.05 * late, lateral + reads[ticks]
                guess[2] += 0.6 * (facing - guess[2])
        off = abs(across - 0.6 * sin(0.8 * along))
        away += off
        door = 3.9 < along < 4.0 or 7.4 < along < 7.5
        passed = passed and off < (0.25 if door else 0.6)
        if along > 7.5 or not passed:
            break
    return passed and along > 7.5, 10.0 - 1.5 * TOLERANCE * min(away / ticks, 0.6) + draws.normal(0.0, NOISE)


def belt(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Pick up a box from a moving belt, guided by a camera above the belt.

    The camera sees the box every 0.1 s until the arm covers it. The arm follows the predicted place at a limited speed,
    and closes the gripper when it has been there for 0.24 s. The pick passes if the box fits between the fingers at its
    angle and does not slide out of the pads during the lift. All episodes earn the same reward.

    Directions: camera shifted across the belt (±11 mm); camera turned (±0.09 rad); belt faster than the arm expects (up
    to 110 %); dust on the pads (up to 50 % of the friction).
    """
    p, q, r, s = x.tolist()
    shift, turn, fast, dust = 22.0 * p, 0.18 * q, 1.0 + 1.1 * r, 1.0 - 0.5 * s
    pace, yaw, weight = (
        90.0 * fast * (1 + draws.normal(0.0, 0.03)),
        draws.normal(0.0, 0.09),
        draws.normal(1.0, 0.07),
    )
    place, side = -150.0 + draws.normal(0.0, 8.0), draws.normal(0.0, 12.0)  # relative to the axis (mm)
    reads = draws.normal(0.0, 0.8, (90, 2)).tolist()
    arm, reach, steady, seen, seen_side, since, speed = 120.0, -60.0, 0, -150.0, 0.0, 0.0, 90.0
    for tick in range(90):
        place += 0.03 * pace
        since += 0.03
        if tick % 3 == 0 and hypot(place - arm, side - reach) > 40.0:
            before = seen
            seen = place * cos(turn) - side * sin(turn) + reads[tick][0]
            seen_side = place * sin(turn) + side * cos(turn) + shift + reads[tick][1]
            if tick:
                speed += 0.15 * ((seen - before) / since - speed)
            since = 0.0
        ahead, beside = seen + speed * (since + 0.03) - arm, seen_side - reach
        share = min(1.0, 14.0 / max(1e-6, hypot(ahead, beside)))
        arm, reach = arm + share * ahead, reach + share * beside
        steady = steady + 1 if share == 1.0 else 0
        if steady == 8 or arm > 260.0:
            break
    angle = abs(yaw + turn)
    room = 46.0 - 30.0 * cos(angle) - 22.0 * sin(angle)  # free width between the fingers
    gap, ahead = abs(side - reach), abs(place - arm)
    pads = max(0.0, 1.0 - (ahead / 20.0) ** 2) * cos(1.5 * min(angle, 1.0))
    holds = 2.7 * dust * pads * (1 + draws.normal(0.0, 0.05)) > weight
    return bool(steady == 8 and gap < room and holds), 1.0


def tank(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Hold the level of a tank with a sticking valve, while the set point changes and a batch is drawn off.

    A PI controller with a limited integral reads the level with a lag. The valve moves only once the command differs
    from its position by more than its stiction. The run passes if the tank neither overflows (2 m) nor falls below the
    outlet (0.45 m). The reward falls with the mean error.

    Directions: pressure of the supply (-30 to 30 %); demand (-30 to 30 %); stiction (0.5 to 25 % of the stroke); lag of
    the reading (1 to 30 s).
    """
    p, q, r, s = x.tolist()
    supply, demand, stiction, lag = 1.0 + 0.6 * p, 1.0 + 0.6 * q, 0.005 + 0.245 * r, 1.0 + 29.0 * s
    level, read, valve, total = 1.0 + draws.normal(0.0, 0.02), 1.0, 0.5, 0.0
    error, passed = 0.0, True
    waves = draws.normal(0.0, 0.01, 200).tolist()
    hour = 1.0 + draws.normal(0.0, 0.03)
    for tick in range(200):
        wanted = 1.0 if tick < 50 else 1.35
        batch = 1.45 if 120 <= tick < 150 else 1.0
        read += (level + waves[tick] - read) * (1 - exp(-2.0 / lag))
        total = clip(total + 0.04 * (wanted - read), 0.5)
        asked = min(1.0, max(0.0, 0.5 + 1.8 * (wanted - read) + total))
        if abs(asked - valve) > stiction:
            valve = asked
        level += 2.0 * 0.05 * (1.2 * supply * valve - 0.6 * demand * hour * batch * sqrt(max(level, 0.0)))
        level = max(level, 0.0)
        error += 0.005 * abs(level - wanted)
        passed = passed and 0.45 < level < 2.0
    return passed, 10.0 - 9.0 * TOLERANCE * min(error, 0.5) + draws.normal(0.0, NOISE)


def berth(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Bring a boat into a berth beside a pier, in a current and gusts.

    Integral line-of-sight guidance steers the boat. Its two propellers set speed and turn rate, and the speed falls
    with the distance. The manoeuvre passes if the boat arrives within 60 s, less than 0.9 m from the middle of the
    berth, at less than 0.7 m/s, with a heading error below 0.5 rad, and without touching the pier 1.5 m to its right.
    The reward falls with the mean distance from the line.

    Directions: current across (-0.16 to 0.16 m/s, positive away from the pier); current along (-0.2 to 0.2 m/s,
    positive towards the berth); age of the position (0 to 2.5 s); thrust lost by the left propeller (0 to 70 %).
    """
    p, q, r, s = x.tolist()
    across, along, late, lost = 0.32 * p, 0.4 * q, round(5 * r), 0.7 * s
    ahead, side, heading, surge, turn = -24.0, draws.normal(0.6, 0.2), draws.normal(0.0, 0.05), 1.0, 0.0
    past, total, away, gust = [(ahead, side)] * (late + 1), 0.0, 0.0, 0.0
    shocks = draws.normal(0.0, 0.015, 120).tolist()
    ground, passed, tick = 0.0, False, 0
    for tick in range(1, 120):
        seen, beside = past[-1 - late]
        total = clip(total + 0.5 * 0.06 * beside, 0.35)
        course = -atan2(beside, 3.0) - total
        wanted = max(0.5, min(1.3, 0.12 * -seen))
        push, twist = 0.9 * (wanted - surge) + 0.35 * wanted, 1.2 * (course - heading) - 1.1 * turn
        left, right = (1 - lost) * clip(push - twist, 1.0), clip(push + twist, 1.0)
        surge += 0.5 * (0.5 * (left + right) - 0.35 * surge)
        turn += 0.5 * (0.4 * (right - left) - 0.5 * turn)
        heading += 0.5 * turn
        gust += -0.1 * gust + shocks[tick]
        ground = surge * cos(heading) + along
        ahead += 0.5 * ground
        side += 0.5 * (surge * sin(heading) + across + gust)
        past.append((ahead, side))
        away += abs(side)
        if side < -1.5 or side > 12.0 or ahead > 0.0:
            passed = ahead > 0.0 and abs(side) < 0.9 and ground < 0.7 and abs(heading) < 0.5
            break
    return passed, 10.0 - 0.8 * TOLERANCE * min(away / tick, 2.0) + draws.normal(0.0, NOISE)


FOURTH_WORLDS: Mapping[str, World] = {
    one.__name__: one for one in (quadrotor, forklift, corridor, belt, tank, berth)
}


def quiet_quadrotor(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Fly the quadrotor on 30 % of each range."""
    return quadrotor(0.3 * x, draws)


def quiet_tank(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Hold the level of the tank on 30 % of each range."""
    return tank(0.3 * x, draws)


QUIET_WORLDS: Mapping[str, World] = {one.__name__: one for one in (quiet_quadrotor, quiet_tank)}


def sampled(name: str, world: World, drifts: int, episodes: int) -> str:
    """Return a world's table row: the results of nominal episodes and of episodes under random drifts.

    Here, a drift counts as breaking the guarantee if one of its episodes fails or their mean reward is too low. With
    few episodes, this overestimates the share of failing drifts in a world whose failures are rare.
    """
    draws, started = np.random.default_rng(0), process_time()
    usual = [world(np.zeros(4), np.random.default_rng([1, seed])) for seed in range(2000)]
    spent = (process_time() - started) / len(usual)
    reward = float(np.mean([earned for _, earned in usual]))
    failed, losses = [], []
    for number, x in enumerate(draws.uniform(LOW, HIGH, (drifts, 4))):
        runs = [world(x, np.random.default_rng([2, number, seed])) for seed in range(episodes)]
        failed.append(float(np.mean([not passed for passed, _ in runs])))
        losses.append(reward - float(np.mean([earned for _, earned in runs])))
    broken = np.mean((np.array(failed) > 0.0) | (np.array(losses) > TOLERANCE))
    passes = np.mean([passed for passed, _ in usual])
    noise = float(np.hypot(np.std([earned for _, earned in usual]), SHARED))
    return (
        f"| {name} | {passes:.4f} | {reward:.2f} ± {noise:.2f} | {np.mean(failed):.4f} | {broken:.4f} "
        f"| {max(losses):.2f} | {1000 * spent:.2f} |"
    )


def main() -> None:
    """Print a row per world: nominal episodes, and those under uniformly drawn drifts."""
    every = {**FOURTH_WORLDS, **QUIET_WORLDS}
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("worlds", nargs="*", metavar="WORLD", help="default: all")
    parser.add_argument("--drifts", type=int, default=2000)
    parser.add_argument("--episodes", type=int, default=4, help="episodes of each drift")
    arguments = parser.parse_args()
    print("| world | nominal passes | nominal reward | episodes fail | drifts break it | largest loss | ms |")
    print("|---|---|---|---|---|---|---|")
    for name in arguments.worlds or every:
        print(sampled(name, every[name], arguments.drifts, arguments.episodes), flush=True)


if __name__ == "__main__":
    main()
