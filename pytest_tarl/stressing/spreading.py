"""Spread drifts evenly around nominal, in direction and distance, with a Halton sequence (Halton 1960)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from statistics import NormalDist

import numpy as np

from pytest_tarl.stressing.coordinates import Coordinates, Vector

CLOSEST = 0.4  # minimum length of a random vector; the maximum is 1
PART = 0.8  # share of the vectors that change a given direction
# minimum and maximum length of the vectors from `around`, as shares of the given vector's length
SHORTER = (0.8, 0.98)
ASIDE = 0.25  # standard deviation of the change of each coordinate, as a share of the given vector's length


def spread(coordinates: Coordinates, draws: np.random.Generator) -> Iterator[Vector]:
    """Yield endless vectors, spread evenly over directions, signs and lengths from CLOSEST to 1.

    A direction has only one sign if its nominal value is an end of its range. The caller scales the vectors by the
    maximum distance of its search.
    """
    size = len(coordinates.spans)
    bases, shift = _primes(2 * size + 1), draws.random(2 * size + 1)
    for number in count(1):
        drawn = (np.array([_inverse(number, base) for base in bases]) + shift) % 1.0
        vector = np.array([NormalDist().inv_cdf(min(max(one, 1e-9), 1.0 - 1e-9)) for one in drawn[:size]])
        vector[drawn[size:-1] > PART] = 0.0
        vector = np.where(coordinates.low == 0.0, np.abs(vector), vector)
        vector = np.where(coordinates.high == 0.0, -np.abs(vector), vector)
        length = float(np.linalg.norm(vector))
        if length > 0.0:
            yield vector / length * (CLOSEST + (1.0 - CLOSEST) * drawn[-1])


def around(coordinates: Coordinates, vector: Vector, draws: np.random.Generator) -> Iterator[Vector]:
    """Yield endless vectors that are slightly shorter than `vector` and have a similar direction."""
    length = float(np.linalg.norm(vector))
    while True:
        moved = vector + ASIDE * length * draws.standard_normal(len(vector))
        moved = np.clip(moved, coordinates.low, coordinates.high)
        size = float(np.linalg.norm(moved))
        if size > 0.0:
            yield moved / size * min(draws.uniform(*SHORTER) * length, size)


def _inverse(number: int, base: int) -> float:
    """Return the radical inverse: the digits of a number in this base, mirrored at the radix point."""
    found, unit = 0.0, 1.0 / base
    while number:
        number, digit = divmod(number, base)
        found += digit * unit
        unit /= base
    return found


def _primes(number: int) -> list[int]:
    found: list[int] = []
    for one in count(2):
        if len(found) == number:
            return found
        if all(one % prime for prime in found):
            found.append(one)
    raise AssertionError
