"""Six more worlds of four directions, written without knowledge of the search and never run with it before.

The conventions are those of stress_worlds.py: a drift x is in units of the ranges, and 0 is nominal. The first two
directions range from -0.5 to 0.5, the last two from 0 to 1. Each world is a small simulation; its docstring names the
shape of its failures.

    python benchmarks/stress_worlds_3.py     # sample each world: nominal episodes and the share of drifts that fail
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping

import numpy as np
from stress_worlds import NOISE, TOLERANCE, Vector, World


def touchdown(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Land a rocket with a proportional law; heavy, weak and late engines hit the ground. One region."""
    mass, height_bias, weak, late = 1.0 + 0.4 * x[0], 0.8 * x[1], 0.25 * x[2], round(4 * x[3])
    height, speed, used = 20.0 + draws.normal(0.0, 0.3), -4.0 + draws.normal(0.0, 0.2), 0.0
    queue = [9.81] * (late + 1)
    for _ in range(300):
        wanted = -1.2 - 0.3 * max(0.0, height + height_bias)
        queue.append(min(22.0, max(0.0, 9.81 + 3.0 * (wanted - speed))))
        push = queue[-2 - late] * (1.0 - weak) / mass
        speed += 0.1 * (push - 9.81)
        height += 0.1 * speed
        used += 0.1 * push
        if height <= 0.0:
            break
    hit = abs(min(speed, 0.0))
    return hit < 2.7 and height <= 0.0, 10.0 - 0.02 * max(0.0, hit - 1.2) + draws.normal(0.0, NOISE)


def rotor(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Run between two resonances of a shaft; drifts in speed or stiffness approach one of them.

    Two separate regions.
    """
    speed, stiffness = 1.0 + 0.7 * x[0], 1.0 + 0.35 * x[1]
    unbalance, damping = 0.02 * (1.0 + x[2]), 0.06 * (1.0 - 0.6 * x[3])
    swing = 0.0
    for mode, share in ((0.72, 1.0), (1.31, 0.8)):
        ratio = speed / (mode * np.sqrt(stiffness))
        swing += share * ratio**2 / np.hypot(1.0 - ratio**2, 2.0 * damping * ratio)
    swing = float(unbalance * swing * (1.0 + draws.normal(0.0, 0.03)))
    return swing < 0.28, 10.0 - TOLERANCE * max(0.0, swing - 0.04) / 0.24 + draws.normal(0.0, NOISE)


def supplies(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Supply a load for 36 h from panel, turbine and battery; it fails only if several lose much. A corner."""
    sun, wind, battery = 1.0 - 1.6 * max(0.0, x[0]), 1.0 - 1.4 * max(0.0, x[1]), 1.0 - 0.55 * x[2]
    load, stored, dark = 0.30 + 0.02 * x[3], 3.5 * battery, 0.0
    for hour in range(36):
        day = max(0.0, np.sin(2 * np.pi * (hour - 6) / 24))
        made = 1.3 * sun * day + 0.36 * wind * max(0.0, 1.0 + draws.normal(0.0, 0.25))
        stored = min(4.2 * battery, stored + made - load)
        dark += max(0.0, -stored)
        stored = max(0.0, stored)
    return dark < 0.3, 10.0 - 0.1 * TOLERANCE * min(dark, 5.0) + draws.normal(0.0, NOISE)


def aliased(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Reject a vibration by sampling at 50 Hz; a vibration close to 50 Hz looks constant. A thin band."""
    speed, gear, strong, noise = 1.0 + 0.5 * x[0], 1.0 + 0.25 * x[1], 0.6 + 0.5 * x[2], 0.02 + 0.05 * x[3]
    frequency = 41.0 * speed * gear
    times = np.arange(150) / 50.0
    phase = draws.uniform(0.0, 2 * np.pi)
    read = 0.3 * strong * np.cos(2 * np.pi * frequency * times + phase) + draws.normal(0.0, noise, 150)
    kept = np.convolve(read, np.full(40, 1 / 40), mode="valid")
    error = float(np.sqrt(np.mean(kept**2)))
    return error < 0.1, 10.0 - TOLERANCE * min(error, 0.4) / 0.3 + draws.normal(0.0, NOISE)


def bend(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Drive through a bend: speed or a wet road alone does little; both together take the car off the road.

    An interaction.
    """
    fast, camber, wet, load = 1.0 + 0.5 * x[0], 0.12 * x[1], x[2], 0.1 * x[3]
    grip = 0.95 - 0.5 * wet + draws.normal(0.0, 0.015)
    speed, off = 12.0 * fast + draws.normal(0.0, 0.1), 0.0
    for angle in np.linspace(0.0, np.pi / 2, 30):
        radius = 45.0 - 10.0 * np.sin(2 * angle)
        excess = speed**2 / (9.81 * radius) * (1.0 + load) - grip - camber
        off += 0.15 * max(0.0, float(excess)) * speed
    return off < 1.5, 10.0 - 0.1 * TOLERANCE * min(off, 20.0) + draws.normal(0.0, NOISE)


def swell(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Hold a ship upright in swell, whose period passes through the ship's own and beyond. Not monotone."""
    own, damping, height = 9.0 * (1.0 + 0.3 * x[0]), 0.16 * (1.0 + 0.8 * x[1]), 0.8 + 1.2 * x[3]
    period = 4.5 + 13.0 * x[2]
    pull, roll, rate, worst = 2 * np.pi / own, 0.0, 0.0, 0.0
    phase = draws.uniform(0.0, 2 * np.pi)
    slope = 0.035 * height * (1.0 + draws.normal(0.0, 0.04))
    for step in range(300):
        force = slope * np.sin(2 * np.pi * 0.3 * step / period + phase)
        rate += 0.3 * (pull**2 * (force - roll) - 2 * damping * pull * rate)
        roll += 0.3 * rate
        worst = max(worst, abs(roll))
    return worst < 0.16, 10.0 - TOLERANCE * min(float(worst), 0.4) / 0.25 + draws.normal(0.0, NOISE)


NEW_WORLDS: Mapping[str, World] = {
    one.__name__: one for one in (touchdown, rotor, supplies, aliased, bend, swell)
}


def main() -> None:
    """Print a line per world: nominal episodes, random drifts, and drifts of a single direction."""
    asked = argparse.ArgumentParser(description=main.__doc__)
    asked.add_argument("worlds", nargs="*", metavar="WORLD", help="default: all")
    worlds = asked.parse_args().worlds or NEW_WORLDS
    print("| world | nominal passes | nominal reward | drifts that break it | one direction alone |")
    print("|---|---|---|---|---|")
    for name in worlds:
        world = NEW_WORLDS[name]
        draws = np.random.default_rng(0)
        low, high = np.array([-0.5, -0.5, 0.0, 0.0]), np.array([0.5, 0.5, 1.0, 1.0])
        nominal = [world(np.zeros(4), np.random.default_rng(seed)) for seed in range(400)]
        reward = float(np.mean([earned for _, earned in nominal]))

        def broken(x: Vector, reward: float = reward, world: World = world) -> bool:
            runs = [world(x, np.random.default_rng(seed)) for seed in range(20)]
            passes = np.mean([passed for passed, _ in runs])
            return bool(passes < 0.95 or reward - np.mean([earned for _, earned in runs]) > TOLERANCE)

        share = np.mean([broken(draws.uniform(low, high)) for _ in range(400)])
        alone = []
        for axis, end in [(0, -0.5), (0, 0.5), (1, -0.5), (1, 0.5), (2, 1.0), (3, 1.0)]:
            points = np.linspace(0.0, end, 21)[1:]
            alone.append(next((f"{p:.2f}" for p in points if broken(p * np.eye(4)[axis])), "-"))
        passed = float(np.mean([one for one, _ in nominal]))
        print(f"| {name} | {passed:.3f} | {reward:.2f} | {share:.3f} | {' '.join(alone)} |", flush=True)


if __name__ == "__main__":
    main()
