"""Gaussian processes over drifts: regression for the loss, classification for the failure rate.

Both follow Rasmussen & Williams 2006, algorithms 2.1, 3.1 and 3.2, with a binomial likelihood for the failure rate.
Their values at nominal are fixed: a loss of 0, and a constant logit of the failure rate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.stressing.coordinates import Vector

Matrix = NDArray[np.float64]

LINEAR, PAIRS = 1.0, 4.0  # prior variances of the slopes and of the products of two directions
SINGLE = 0.3  # prior variance of the smooth function of each direction
LOCAL = 0.15  # prior variance of local deviations
LENGTH = 0.3  # length scale of the smooth functions and of the local deviations
STEPS = 50  # maximum number of Newton steps
CLOSE = 0.05  # Newton's method stops when every logit changes by less than this
LEAP = 4.0  # maximum change of a logit in one Newton step
JITTER = 1e-8
BLOCK = 48  # triangular matrices up to this size are inverted at once


def covariance(one: Vector, other: Vector) -> Matrix:
    """Return the prior covariances between vectors of shape (drifts, ranges); they are 0 at nominal."""
    columns = zip(one.T, other.T, strict=True)
    return _summed(one, other, [_smooth(column, against) for column, against in columns])


def scaled_covariances(vectors: Vector) -> Callable[[Vector], Matrix]:
    """Return a function that scales the vectors by a factor per range and returns their prior covariances.

    The function caches the part of the covariances that depends on a single range and its factor.
    """

    @cache
    def single(place: int, factor: float) -> Matrix:
        column: Vector = vectors[:, place] * factor
        return _smooth(column, column)

    def scaled(factors: Vector) -> Matrix:
        moved = vectors * factors
        return _summed(moved, moved, [single(place, float(one)) for place, one in enumerate(factors)])

    return scaled


def _summed(one: Vector, other: Vector, singles: Sequence[Matrix]) -> Matrix:
    """Return the covariances of the whole model; `singles` has one squared-exponential matrix per range.

    The squared-exponential covariance of several ranges is the product of those of the single ranges. All covariances
    are conditioned on the value 0 at nominal.
    """
    plain, sizes = one @ other.T, np.abs(one) @ np.abs(other).T
    found: Matrix = LINEAR * (plain + sizes) + PAIRS * (plain**2 + sizes**2)
    if not len(singles):
        return found
    own, others = (np.exp(-(vectors**2) / (2 * LENGTH**2)) for vectors in (one, other))
    local = singles[0].copy()
    for part in singles[1:]:
        local *= part
    local -= np.outer(own.prod(axis=1), others.prod(axis=1))
    found += LOCAL * local
    total = singles[0].copy()
    for part in singles[1:]:
        total += part
    found += SINGLE * (total - own @ others.T)
    return found


def variance(vectors: Vector) -> Vector:
    """Return the prior variances at vectors of shape (drifts, ranges)."""
    squares = (vectors**2).sum(axis=1)
    single = (1.0 - np.exp(-(vectors**2) / LENGTH**2)).sum(axis=1)
    local = 1.0 - np.exp(-squares / LENGTH**2)
    found: Vector = 2 * LINEAR * squares + 2 * PAIRS * squares**2 + SINGLE * single + LOCAL * local
    return found


def _smooth(column: Vector, against: Vector) -> Matrix:
    """Return the squared-exponential covariances of one range, not conditioned on the value at nominal."""
    found: Matrix = column[:, None] - against
    found *= found
    found /= -2 * LENGTH**2
    return np.exp(found, out=found)


def inverted(lower: NDArray[np.floating[Any]]) -> Matrix:
    """Return the inverse of a lower triangular matrix of shape (n, n).

    The matrix is split in halves recursively, so that most of the work is done by fast matrix products.
    """
    size = len(lower)
    if size <= BLOCK:
        small: Matrix = np.linalg.inv(lower)
        return small
    half = size // 2
    found: Matrix = np.zeros(lower.shape)
    found[:half, :half], found[half:, half:] = inverted(lower[:half, :half]), inverted(lower[half:, half:])
    found[half:, :half] = -found[half:, half:] @ (lower[half:, :half] @ found[:half, :half])
    return found


class LossField:
    """The mean loss at each drift: a Gaussian process, fitted to mean losses of shape (drifts,).

    `errors` holds the covariances of the errors of the mean losses.
    """

    def __init__(self, prior: Matrix, losses: Vector, errors: Matrix) -> None:
        whole = prior + errors + JITTER * np.eye(len(losses))
        self._lower = np.linalg.cholesky(whole)
        self._weights = np.linalg.solve(whole, losses)
        self.evidence = -0.5 * float(losses @ self._weights) - float(np.log(np.diag(self._lower)).sum())

    @cached_property
    def _inverse(self) -> Matrix:
        return inverted(self._lower)

    def means(self, cross: Matrix) -> Vector:
        """Return the means at new vectors; `cross` holds their prior covariances with the fitted drifts."""
        found: Vector = cross @ self._weights
        return found

    def moments(self, cross: Matrix, prior: Vector) -> tuple[Vector, Vector]:
        """Return means and standard deviations at new vectors.

        `cross` holds the prior covariances of the new vectors with the fitted drifts, and `prior` their prior
        variances.
        """
        explained = self._inverse @ cross.T
        left = prior - (explained**2).sum(axis=0)
        return self.means(cross), np.sqrt(np.maximum(left, 1e-6))


class RateField:
    """The logit of the failure rate at each drift: a Gaussian process, fitted to numbers of failed episodes."""

    def __init__(
        self,
        prior: Matrix,
        scale: float,
        failed: Vector,
        episodes: Vector,
        usual: float,
        start: Vector | None = None,
        luck: Matrix | None = None,
    ) -> None:
        """Find the most probable logits by Newton's method, starting from `start`, the logits of a similar field.

        `luck` holds the covariances that arise because the drifts ran on the same seeds.
        """
        self._usual, self.scale, self.luck = usual, scale, luck
        matrix, identity = scale * prior, np.eye(len(failed))
        if luck is not None:
            matrix = matrix + luck
        weights: Vector = np.zeros(len(failed))
        logits: Vector = np.full(len(failed), usual) if start is None else start
        for number in range(STEPS):
            roots, pull = _newton(logits, usual, failed, episodes)
            middle = identity + roots[:, None] * matrix * roots
            step = pull - roots * np.linalg.solve(middle, roots * (matrix @ pull)) - weights
            change = float(np.abs(matrix @ step).max())
            # At the first step, the weights are zero. If logits are given, this step only computes the matching
            # weights, so it is not shortened.
            whole = start is not None and number == 0
            weights = weights + (1.0 if whole else min(1.0, LEAP / max(change, 1e-9))) * step
            logits = usual + matrix @ weights
            if change < CLOSE:
                break
        self.weights: Vector = weights
        self.logits: Vector = logits
        roots, _ = _newton(logits, usual, failed, episodes)
        lower = np.linalg.cholesky(identity + roots[:, None] * matrix * roots)
        self._roots, self._lower = roots, lower
        likelihood = -failed @ np.logaddexp(0.0, -logits) - (episodes - failed) @ np.logaddexp(0.0, logits)
        curvature = float(np.log(np.diag(lower)).sum())
        self.evidence = float(likelihood) - 0.5 * float(weights @ (logits - usual)) - curvature

    @cached_property
    def _reduce(self) -> Matrix:
        """Return the matrix that gives the reduction of the variances when multiplied with `cross`."""
        found: Matrix = inverted(self._lower) * self._roots
        return found

    def means(self, cross: Matrix) -> Vector:
        """Return the means of the logits; `cross` is as in `LossField.means`."""
        found: Vector = self._usual + self.scale * (cross @ self.weights)
        return found

    def moments(self, cross: Matrix, prior: Vector) -> tuple[Vector, Vector]:
        """Return means and standard deviations of the logits; parameters as in `LossField.moments`."""
        explained = self.scale * (self._reduce @ cross.T)
        left = self.scale * prior - (explained**2).sum(axis=0)
        return self.means(cross), np.sqrt(np.maximum(left, 1e-4))


def _newton(logits: Vector, usual: float, failed: Vector, episodes: Vector) -> tuple[Vector, Vector]:
    """Return the square roots of the likelihood's curvatures, and the right-hand side of Newton's equation."""
    shares = _share(logits)
    roots = np.sqrt(np.maximum(episodes * shares * (1.0 - shares), JITTER))
    return roots, roots**2 * (logits - usual) + failed - episodes * shares


def _share(logits: Vector) -> Vector:
    found: Vector = 1.0 / (1.0 + np.exp(-np.clip(logits, -30.0, 30.0)))
    return found
