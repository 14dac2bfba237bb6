"""Fit the fields of the search's model, and choose their hyperparameters by the evidence (marginal likelihood).

The hyperparameters are a scale factor for each direction, the prior variance of the logit, and the effect of a seed.
Choosing them takes several fits, so they are kept until there are clearly more drifts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from pytest_tarl.stressing.coordinates import Vector
from pytest_tarl.stressing.surrogates import LossField, Matrix, RateField, covariance, scaled_covariances

# candidates for the prior variance of the logit, relative to that of the loss
SCALES = (9.0, 36.0, 144.0)
# candidates for the variance of a seed's effect on the logit, which is common to all drifts; 0 is also tried
LUCK = (1.0, 4.0)
IRRELEVANT = 0.3  # scale factor of a direction with little influence
GROWN = 1.2  # hyperparameters are chosen again after the number of drifts has grown by this factor

Field = TypeVar("Field", LossField, RateField)


@dataclass(frozen=True)
class Fit(Generic[Field]):
    """A fitted field.

    - `units`: the scale factor of each direction
    - `luck`: the variance of a seed's effect
    - `chosen`: the number of drifts when the hyperparameters were chosen
    """

    field: Field
    units: Vector
    chosen: int
    luck: float = 0.0

    def lasts(self, drifts: int) -> bool:
        """Return whether the hyperparameters can be kept for this number of drifts."""
        return self.chosen <= drifts <= GROWN * self.chosen


@dataclass(frozen=True)
class Counts:
    """Numbers of failed episodes at vectors; arrays of shape (drifts,).

    `usual` is the logit of the failure rate at nominal. `shared` holds the covariances of drifts that ran on the same
    seeds, computed for a seed effect of variance 1.
    """

    vectors: Vector
    failed: Vector
    episodes: Vector
    usual: float
    shared: Matrix

    def field(self, prior: Matrix, scale: float, start: Vector | None = None, luck: float = 0.0) -> RateField:
        """Fit a field with these hyperparameters, starting from the logits in `start`."""
        shared = luck * self.shared if luck > 0.0 else None
        return RateField(prior, scale, self.failed, self.episodes, self.usual, start, shared)

    def logits(self, known: Mapping[tuple[float, ...], float]) -> Vector:
        """Return the logits at vectors: the known one, or the usual one for a new vector."""
        return np.array([known.get(tuple(vector), self.usual) for vector in self.vectors.tolist()])


def loss_fit(
    vectors: Vector, losses: Vector, errors: Matrix, before: Fit[LossField] | None
) -> Fit[LossField]:
    """Fit mean losses of shape (drifts,); `errors` are the covariances of their errors.

    `before` is the fit to fewer drifts, if there was one.
    """
    if before is not None and before.lasts(len(vectors)):
        scaled = vectors * before.units
        field = LossField(covariance(scaled, scaled), losses, errors)
        return Fit(field, before.units, before.chosen)
    field, units = relevant(lambda prior: LossField(prior, losses, errors), vectors)
    return Fit(field, units, len(vectors))


def rate_fit(
    counts: Counts, before: Fit[RateField] | None, known: Mapping[tuple[float, ...], float]
) -> Fit[RateField]:
    """Fit counts of failed episodes; `before` is an earlier fit to fewer drifts, and `known` holds its logits."""
    vectors = counts.vectors
    if before is not None and before.lasts(len(vectors)):
        scaled = vectors * before.units
        field = counts.field(
            covariance(scaled, scaled), before.field.scale, counts.logits(known), before.luck
        )
        return Fit(field, before.units, before.chosen, before.luck)
    whole = covariance(vectors, vectors)
    best = max((counts.field(whole, scale) for scale in SCALES), key=lambda one: one.evidence)
    scale, start, luck = best.scale, best.logits, 0.0
    for size in LUCK:
        other = counts.field(whole, scale, start, size)
        if other.evidence > best.evidence:
            best, luck = other, size
    field, units = relevant(lambda prior: counts.field(prior, scale, best.logits, luck), vectors)
    return Fit(field, units, len(vectors), luck)


def relevant(field: Callable[[Matrix], Field], vectors: Vector) -> tuple[Field, Vector]:
    """Choose a scale factor for each direction; return the fitted field and the factors.

    The factor of a direction is IRRELEVANT if this increases the evidence, and 1 otherwise.
    """
    units = np.ones(vectors.shape[1])
    prior = scaled_covariances(vectors)
    best = field(prior(units))
    for place in range(len(units)):
        fewer = units.copy()
        fewer[place] = IRRELEVANT
        other = field(prior(fewer))
        if other.evidence > best.evidence:
            best, units = other, fewer
    return best, units
