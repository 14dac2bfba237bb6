"""More worlds of four directions, written after the search and not run while it was developed.

The conventions are those of stress_worlds.py: a drift x is in units of the ranges, and 0 is nominal. The first two
directions range from -0.5 to 0.5, the last two from 0 to 1.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from stress_worlds import NOISE, TOLERANCE, Vector, World


def loop(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Control a first-order system whose gain and bias change, and whose sensor becomes noisy and late."""
    gain, bias, noise, late = 1.0 + 1.6 * x[0], 0.3 * x[1], 0.3 * x[2], round(8 * x[3])
    state, error, seen = 0.0, 0.0, [0.0] * 9
    for _ in range(40):
        seen.append(state + bias + draws.normal(0.0, 0.02 + noise))
        state += 0.25 * gain * (1.0 - seen[-1 - late]) + 0.02 * (0.0 - state)
        error += abs(1.0 - state)
    return abs(1.0 - state) < 0.5, 10.0 - 0.1 * min(error, 100.0)


def saturated(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose nothing until a weighted sum exceeds what a controller can compensate, then lose reward quickly."""
    excess = abs(x[0]) + 0.7 * x[2] + 0.4 * x[3] - 0.45
    return True, 10.0 - 4.0 * TOLERANCE * max(float(excess), 0.0) / 0.3 + draws.normal(0.0, NOISE)


def one_sided(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """In each of two directions, lose reward for one sign and gain reward for the other."""
    lost = 1.3 * x[0] - 1.1 * x[1] + 0.3 * x[2] * x[3]
    return True, 10.0 - TOLERANCE * float(lost) / 0.7 + draws.normal(0.0, NOISE)


def forked(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose reward in a wide region far from nominal, and in a narrow region near it."""
    wide = 1.2 * float(np.linalg.norm(x - [0.0, 0.0, 0.9, 0.9]) < 0.5)
    away = float(np.linalg.norm(x - [-0.3, 0.25, 0.25, 0.2]))
    narrow = 1.8 * float(np.exp(-((away / 0.25) ** 2)))
    return True, 10.0 - TOLERANCE * max(wide, narrow) + draws.normal(0.0, NOISE)


def worn(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Fail more often and earn less, both slowly, with the mean square of three directions."""
    wear = float(x[0] ** 2 + 0.5 * x[1] ** 2 + 0.6 * x[2] ** 2)
    risk = 0.005 + 0.8 * min(wear, 1.0)
    return bool(draws.random() > risk), 10.0 - TOLERANCE * wear + draws.normal(0.0, NOISE)


def stairs(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose reward in steps of a sum, and fail beyond the last step."""
    level = np.floor(6.0 * (np.abs(x) @ [0.8, 0.8, 0.5, 0.3]))
    return bool(level < 5), 10.0 - 0.3 * TOLERANCE * float(level) + draws.normal(0.0, NOISE)


FRESH_WORLDS: Mapping[str, World] = {
    one.__name__: one for one in (loop, saturated, one_sided, forked, worn, stairs)
}
