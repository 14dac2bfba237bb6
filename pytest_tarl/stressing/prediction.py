"""Predict the nearest failing drift from the drifts tried so far.

The model of the margin is 1 minus the losses of margin along the single directions, which add up, corrected by Gaussian
process regression on all drifts tried (Rasmussen & Williams 2006, algorithm 2.1). The drift that promises most is tried
next, as in Bayesian optimisation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.stressing.coordinates import Coordinates, Vector
from pytest_tarl.stressing.findings import Curve
from pytest_tarl.stressing.guarantee import LOWEST

PAIRS, LOCAL = 4.0, 0.15  # prior variances: of products of two directions, and of local deviations
LENGTH = 0.25  # of local deviations, in units of the ranges
DEPTH = 0.1  # margin below 0 at which a drift counts as failing
DRAWN = 800  # drifts that the model compares
PART = 0.75  # probability that a direction takes part in one of them
ROUNDS, SPREAD = (
    4,
    0.15,
)  # refinements around the best one, each three times finer, and the first standard deviation


@dataclass(frozen=True)
class Sample:
    """A drift tried, by coordinates, its margin, and the standard deviation of that."""

    vector: Vector
    margin: float
    spread: float


class Prediction:
    """The model of the margin for the drifts with common options."""

    def __init__(self, coordinates: Coordinates, curves: Sequence[Curve], samples: Sequence[Sample]) -> None:
        self.coordinates = coordinates
        self._knots = [_knots(coordinates, curves, name) for name in coordinates.spans]
        self._vectors = np.array([one.vector for one in samples]).reshape(
            len(samples), len(coordinates.spans)
        )
        margins = np.array([max(one.margin, LOWEST) for one in samples])
        noise = np.array([one.spread**2 for one in samples])
        matrix = _covariance(self._vectors, self._vectors) + np.diag(noise)
        self._inverse = np.linalg.inv(np.linalg.cholesky(matrix))
        self._weights = self._inverse.T @ (self._inverse @ (margins - self._added(self._vectors)))

    def promising(self, limit: float, draws: np.random.Generator) -> tuple[Vector, float]:
        """Return the vector with the largest expected gain over a failing drift at the distance `limit`, and the gain.

        The gain is the probability that the drift fails, times by how much it is nearer, in units of the ranges
        (constrained expected improvement, Gelbart et al. 2014, whose objective is known here).
        """
        low, high = self.coordinates.low, self.coordinates.high
        shape = (DRAWN, len(low))
        vectors = np.where(draws.random(shape) < PART, low + (high - low) * draws.random(shape), 0.0)
        best, gain = self._largest(vectors, limit, draws)
        for number in range(ROUNDS):
            spread = SPREAD / 3**number
            around = best + spread * draws.standard_normal((DRAWN // 4, len(low)))
            around[draws.random(around.shape) < 1.0 - PART] = 0.0
            other, larger = self._largest(np.clip(around, low, high), limit, draws)
            if larger > gain:
                best, gain = other, larger
        return best, gain

    def _largest(self, vectors: Vector, limit: float, draws: np.random.Generator) -> tuple[Vector, float]:
        """Return the vector with the largest gain, after shortening those that are too long by chance."""
        lengths = np.linalg.norm(vectors, axis=1)
        room = np.sqrt(max(limit**2 - self.coordinates.options, 0.0))
        shares = np.where(
            lengths > room, room / np.maximum(lengths, 1e-9) * draws.random(len(vectors)) ** 0.25, 1.0
        )
        vectors = vectors * shares[:, None]
        lengths = lengths * shares
        mean, deviation = self.moments(vectors)
        failing = 1.0 / (
            1.0 + np.exp(np.clip(1.702 * (mean + DEPTH) / deviation, -50, 50))
        )  # about the normal tail
        gains = failing * np.maximum(room - lengths, 0.0)
        place = int(np.argmax(gains))
        return vectors[place], float(gains[place])

    def margins(self, vectors: Vector) -> Vector:
        """Return the predicted margins at vectors of shape (drifts, ranges)."""
        return self.moments(vectors)[0]

    def moments(self, vectors: Vector) -> tuple[Vector, Vector]:
        """Return the means and the standard deviations of the margins at vectors."""
        cross = _covariance(vectors, self._vectors)
        mean = self._added(vectors) + cross @ self._weights
        explained = self._inverse @ cross.T
        variance = _variance(vectors) - (explained**2).sum(axis=0)
        return mean, np.sqrt(np.maximum(variance, 1e-6))

    def _added(self, vectors: Vector) -> Vector:
        """Return the margins if the losses along the single directions add up."""
        losses = np.zeros(len(vectors))
        for column, one in zip(vectors.T, self._knots, strict=True):
            losses += np.interp(column, *one)
        return np.maximum(1.0 - losses, LOWEST)


def _covariance(one: Vector, other: Vector) -> NDArray[np.float64]:
    """Return the prior covariances: quadratic in vectors and in their absolute values, plus a squared exponential."""
    squares = (one**2).sum(axis=1)[:, None] + (other**2).sum(axis=1) - 2 * one @ other.T
    local = np.exp(-np.maximum(squares, 0.0) / (2 * LENGTH**2))
    found: NDArray[np.float64] = (
        PAIRS * ((one @ other.T) ** 2 + (np.abs(one) @ np.abs(other).T) ** 2) + LOCAL * local
    )
    return found


def _variance(vectors: Vector) -> Vector:
    found: Vector = 2 * PAIRS * (vectors**2).sum(axis=1) ** 2 + LOCAL
    return found


def _knots(coordinates: Coordinates, curves: Sequence[Curve], name: str) -> tuple[Vector, Vector]:
    """Return coordinates along a direction, ascending, and the margin lost at each."""
    index = list(coordinates.spans).index(name)
    found = {0.0: 0.0}
    for curve in curves:
        if curve.ray.names == (name,):
            for t, one in curve.evidence.items():
                place = float(coordinates.vector(curve.ray.point(t))[index])
                found[place] = 1.0 - max(one.margin, LOWEST)
    places = sorted(found)
    return np.array(places), np.array([found[one] for one in places])
