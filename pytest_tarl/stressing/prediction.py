"""Predict the nearest failing drift from the drifts tried so far.

A model of the loss and a model of the failure rate give the probability that a drift fails. The search then tries the
most promising drift, as in Bayesian optimisation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import log, sqrt
from statistics import fmean

import numpy as np

from pytest_tarl.stressing.coordinates import Coordinates, Vector
from pytest_tarl.stressing.fields import Counts, Fit, loss_fit, rate_fit
from pytest_tarl.stressing.guarantee import LOWEST, Guarantee
from pytest_tarl.stressing.one_thread import one_thread
from pytest_tarl.stressing.surrogates import LossField, Matrix, RateField, covariance, variance

DRAWN = 400  # number of random drifts that the model compares
PART = 0.75  # probability that a direction changes in a random drift
# number of refinements around the best drift; standard deviation of the first one, which is halved each time
ROUNDS, SPREAD = 5, 0.15
STRETCHED = (0.9, 1.0, 1.1)  # tried drifts are also compared after scaling by these factors
NEAR = 64  # maximum number of tried drifts that are scaled by STRETCHED
RAREST = 0.007  # minimum failure rate assumed at nominal
LEAST_LOSS = 0.25  # minimum predicted loss of the drifts from which the factors of seeds are estimated
LOGIT = 4.0  # difference of logits that corresponds to the tolerated loss


@dataclass(frozen=True)
class Sample:
    """A tried drift: its vector, mean loss, number of failed episodes, and episode seeds.

    `loss` is in units of the tolerated loss, with standard error `spread`. For each episode, `sources` has its pool and
    seed number, and `losses` its loss, in the same order.
    """

    vector: Vector
    loss: float
    spread: float
    failed: int
    sources: Sequence[tuple[str, int]]
    losses: Sequence[float] = ()


@dataclass(frozen=True)
class Shown:
    """The smallest excess loss and failure rate that fresh episodes detect reliably.

    `depth` is how far the loss exceeds the tolerated loss, in units of the tolerated loss.
    """

    depth: float
    share: float

    @property
    def logit(self) -> float:
        """Return the logit of the failure rate."""
        return log(self.share / (1.0 - self.share))


class Prediction:
    """A model of the margins of all drifts with the same options."""

    @one_thread
    def __init__(
        self,
        coordinates: Coordinates,
        given: Guarantee,
        samples: Sequence[Sample],
        shown: Shown,
        typical: float,
        paired: float,
        counted: Sequence[tuple[Vector, float, int]] = (),
        origin: float = 0.0,
        before: Prediction | None = None,
    ) -> None:
        """Fit the model; `typical` is the variance of a loss, of which the nominal episode contributes `paired`.

        `counted` are further drifts that ran on fresh seeds: vector, number of failures, number of episodes. `origin`
        is the loss at the zero vector; it differs from 0 if the drifts have options that are not nominal. `before` is
        an earlier model of fewer drifts, which makes fitting faster.
        """
        self.coordinates, self.given, self.shown = coordinates, given, shown
        self._samples, self._typical = samples, typical
        self._origin = min(max(origin, LOWEST), 1.0 - LOWEST)
        self._vectors = np.array([one.vector for one in samples]).reshape(
            len(samples), len(coordinates.spans)
        )
        losses = np.array([min(max(one.loss, LOWEST), 1.0 - LOWEST) - self._origin for one in samples])
        counts = np.array([float(len(one.sources)) for one in samples])
        # drifts with the same seeds share the nominal episodes, so their errors are correlated
        places = {
            source: place
            for place, source in enumerate(dict.fromkeys(chain(*(one.sources for one in samples))))
        }
        used = np.zeros((len(samples), len(places)))
        for row, one in zip(used, samples, strict=True):
            row[[places[source] for source in one.sources]] = 1.0 / len(one.sources)
        common = paired * (used @ used.T)
        own = np.maximum(
            np.array([one.spread**2 for one in samples]) - paired / counts, typical / 8.0 / counts
        )
        self._loss_fit: Fit[LossField] = loss_fit(
            self._vectors, losses, common + np.diag(own), None if before is None else before._loss_fit
        )
        failed = np.array([*(float(one.failed) for one in samples), *(one for _, one, _ in counted)])
        episodes = np.array([*counts, *(float(one) for _, _, one in counted)])
        self._counted = np.array([*self._vectors, *(one for one, _, _ in counted)])
        self._rate_fit: Fit[RateField] | None = None
        if failed.any():
            usual = max(1.0 - given.share, RAREST)
            shared = np.diag(1.0 / episodes)
            shared[: len(used), : len(used)] = used @ used.T
            self._rate_fit = rate_fit(
                Counts(self._counted, failed, episodes, log(usual / (1.0 - usual)), shared),
                None if before is None else before._rate_fit,
                {} if before is None else before._logits,
            )

    @property
    def luck(self) -> float:
        """Return the variance of a seed's effect on the logit of the failure rate, which is common to all drifts."""
        return 0.0 if self._rate_fit is None else self._rate_fit.luck

    @property
    def _logits(self) -> dict[tuple[float, ...], float]:
        """Return the logit of the failure rate at each vector that the model was fitted to."""
        if self._rate_fit is None:
            return {}
        logits = self._rate_fit.field.logits.tolist()
        return dict(zip(map(tuple, self._counted.tolist()), logits, strict=True))

    def deeper(self, times: float) -> Prediction:
        """Return a copy that requires `times` as much excess over the guarantee as fresh episodes can detect."""
        other = copy(self)
        other.shown = Shown(self.shown.depth * times, self.shown.share ** (1.0 / times))
        return other

    @one_thread
    def promising(self, limit: float, draws: np.random.Generator) -> tuple[Vector, float]:
        """Return the vector with the largest expected gain, and the gain.

        The gain is the probability that the drift fails, multiplied by how much nearer than `limit` it is, in units of
        the ranges. This is constrained expected improvement (Gelbart et al. 2014) with a known objective.
        """
        room = float(np.sqrt(max(limit**2 - self.coordinates.options, 0.0)))

        def gains(vectors: Vector) -> Vector:
            nearer = np.maximum(room - np.linalg.norm(vectors, axis=1), 0.0)
            found: Vector = self.failing(vectors) * nearer
            return found

        return self._largest(gains, room, draws)

    @one_thread
    def shortest(self, errors: float, limit: float, draws: np.random.Generator) -> Vector | None:
        """Return the shortest vector up to length `limit` that the model expects to fail, or None.

        The failure must be expected even if the true losses are `errors` standard deviations below the predictions. The
        search is random and may miss the shortest vector.
        """

        def scores(vectors: Vector) -> Vector:
            excess = self.excess(vectors, errors)
            lengths = np.linalg.norm(vectors, axis=1)
            found: Vector = np.where(excess >= 0.0, 10.0 - lengths, np.maximum(excess, -5.0))
            return found

        vector, score = self._largest(scores, limit, draws)
        return vector if score > 5.0 else None

    def failing(self, vectors: Vector) -> Vector:
        """Return for each vector the probability that fresh episodes show a failure; shape (drifts,)."""
        by_loss, by_rate = self.shown_by(vectors)
        found: Vector = 1.0 - (1.0 - by_loss) * (1.0 - by_rate)
        return found

    @one_thread
    def shown_by(self, vectors: Vector) -> tuple[Vector, Vector]:
        """Return, for each vector, the probabilities that fresh episodes show a large loss and a large failure rate."""
        (mean, deviation), rates = self._moments(vectors)
        by_loss = _normal((mean - 1.0 - self.shown.depth) / deviation)
        if rates is None:
            return by_loss, np.zeros_like(by_loss)
        logits, spreads = rates
        return by_loss, _normal((logits - self.shown.logit) / spreads)

    @one_thread
    def excess(self, vectors: Vector, errors: float = 0.0) -> Vector:
        """Return how far each vector's predicted loss or failure rate exceeds what fresh episodes can detect.

        The prediction is first lowered by `errors` standard deviations. The result is the larger of the two excesses,
        in units of the tolerated loss, with shape (drifts,).
        """
        if errors == 0.0:
            return self._excess(*self._means(vectors))
        (mean, deviation), rates = self._moments(vectors)
        logits = None if rates is None else rates[0] - errors * rates[1]
        return self._excess(mean - errors * deviation, logits)

    def _excess(self, losses: Vector, logits: Vector | None) -> Vector:
        found: Vector = losses - 1.0 - self.shown.depth
        return found if logits is None else np.maximum(found, (logits - self.shown.logit) / LOGIT)

    @one_thread
    def moments(self, vectors: Vector) -> tuple[Vector, Vector]:
        """Return the means and the standard deviations of the margins at vectors, as two arrays of shape (drifts,)."""
        (mean, deviation), rates = self._moments(vectors)
        margins: Vector = np.maximum(1.0 - mean, LOWEST)
        if rates is not None:
            logits, spreads = rates
            middle, high = (self._rate_margins(logits + change) for change in (0.0, spreads))
            lower = middle < margins
            margins = np.where(lower, middle, margins)
            deviation = np.where(lower, np.maximum(middle - high, 1e-3), deviation)
        return np.minimum(margins, 1.0), deviation

    def margins(self, vectors: Vector) -> Vector:
        """Return the predicted margins at vectors of shape (drifts, ranges)."""
        return self.moments(vectors)[0]

    def _means(self, vectors: Vector) -> tuple[Vector, Vector | None]:
        """Return the predicted losses at vectors, and the predicted logits of the failure rate or None."""
        for_losses, for_rates = self._priors(vectors)
        mean: Vector = self._loss_fit.field.means(for_losses) + self._origin
        if self._rate_fit is None or for_rates is None:
            return mean, None
        return mean, self._rate_fit.field.means(for_rates)

    def _moments(self, vectors: Vector) -> tuple[tuple[Vector, Vector], tuple[Vector, Vector] | None]:
        """Return the means and standard deviations at vectors: of the losses, and of the logits or None."""
        for_losses, for_rates = self._priors(vectors)
        mean, deviation = self._loss_fit.field.moments(for_losses, variance(vectors * self._loss_fit.units))
        mean = mean + self._origin
        losses = mean, np.hypot(deviation, self._shared * np.maximum(mean, 0.0))
        if self._rate_fit is None or for_rates is None:
            return losses, None
        return losses, self._rate_fit.field.moments(for_rates, variance(vectors * self._rate_fit.units))

    @cached_property
    def _shared(self) -> float:
        """Return the relative error of all predicted losses that comes from the choice of common seeds."""
        if not self._samples:
            return 0.0
        return shared_error(self._samples, self._at_known[0], self._typical)

    @cached_property
    def _at_known(self) -> tuple[Vector, Vector | None]:
        """Return the predictions of `_means` at the tried drifts."""
        return self._means(self._vectors)

    def _priors(self, vectors: Vector) -> tuple[Matrix, Matrix | None]:
        """Return the prior covariances of vectors with the fitted drifts: of losses, and of logits or None."""
        units, rates = self._loss_fit.units, self._rate_fit
        if rates is None:
            return covariance(vectors * units, self._vectors * units), None
        logits = covariance(vectors * rates.units, self._counted * rates.units)
        if (units == rates.units).all():
            return logits[:, : len(self._vectors)], logits
        return covariance(vectors * units, self._vectors * units), logits

    def _rate_margins(self, logits: Vector) -> Vector:
        shares = 1.0 / (1.0 + np.exp(-np.clip(logits, -30.0, 30.0)))
        found: Vector = np.array([max(self.given.margin(1.0 - one, 0.0), LOWEST) for one in shares])
        return found

    def _promising_known(self, room: float) -> Vector:
        """Return the shortest tried vectors that the model expects to fail, and those closest to failing.

        There are at most NEAR vectors, none longer than `room`; shape (drifts, ranges).
        """
        excess, lengths = self._excess(*self._at_known), np.linalg.norm(self._vectors, axis=1)
        scores = np.where(excess >= 0.0, 10.0 - lengths, np.maximum(excess, -5.0))
        scores[lengths * min(STRETCHED) > room] = -10.0
        found: Vector = self._vectors[np.argsort(-scores, kind="stable")[:NEAR]]
        return found

    def _largest(
        self, score: Callable[[Vector], Vector], room: float, draws: np.random.Generator
    ) -> tuple[Vector, float]:
        """Return the random vector of length at most `room` with the best score, and its score."""
        low, high = self.coordinates.low, self.coordinates.high
        shape = (DRAWN, len(low))
        drawn = np.where(draws.random(shape) < PART, low + (high - low) * draws.random(shape), 0.0)
        known = self._promising_known(room)
        near = np.concatenate([np.clip(share * known, low, high) for share in STRETCHED])
        vectors = _within(np.concatenate([drawn, near]), room, draws)
        scores = score(vectors)
        place = int(np.argmax(scores))
        best, highest = vectors[place], float(scores[place])
        for number in range(ROUNDS):
            spread = SPREAD / 2**number
            around = best + spread * draws.standard_normal((DRAWN // 4, len(low)))
            around[draws.random(around.shape) < 0.1] = 0.0
            vectors = _within(np.clip(around, low, high), room, draws)
            scores = score(vectors)
            place = int(np.argmax(scores))
            if scores[place] > highest:
                best, highest = vectors[place], float(scores[place])
        return best, highest


def shared_error(samples: Sequence[Sample], means: Vector, typical: float) -> float:
    """Return the relative error of all predicted losses that comes from the choice of common seeds.

    With some seeds, all drifts lose more than average by the same factor, for example because there is more reward to
    lose. Drifts with the same seeds share this error, so more drifts do not reduce it. `means` are the predicted losses
    of the samples, and `typical` is the variance of a loss.
    """
    products: dict[tuple[str, int], float] = {}
    squares: dict[tuple[str, int], float] = {}
    for one, mean in zip(samples, means.tolist(), strict=True):
        for source, loss in zip(one.sources, one.losses, strict=False):
            if LEAST_LOSS <= mean < 1.0 - LOWEST:
                products[source] = products.get(source, 0.0) + mean * (loss - mean)
                squares[source] = squares.get(source, 0.0) + mean**2
    if len(squares) < 2:
        return 0.0
    excess = fmean((products[source] / size) ** 2 - typical / size for source, size in squares.items())
    return sqrt(max(excess, 0.0) / len(squares))


def _within(vectors: Vector, room: float, draws: np.random.Generator) -> Vector:
    """Return the vectors, with those longer than `room` shortened to a random length."""
    lengths = np.linalg.norm(vectors, axis=1)
    shares = np.where(
        lengths > room, room / np.maximum(lengths, 1e-9) * draws.random(len(vectors)) ** 0.25, 1.0
    )
    found: Vector = vectors * shares[:, None]
    return found


def _normal(values: Vector) -> Vector:
    """Return the standard normal distribution function, approximated by a logistic function."""
    found: Vector = 1.0 / (1.0 + np.exp(-np.clip(1.702 * values, -50.0, 50.0)))
    return found
