"""Variance components: how much of the missions' variance comes from versions, sites, seasons and robots.

The reward y of a mission is modelled as a sum of the effects of its version, site, season and robot, and a residual.
The effects of versions, sites and seasons are fixed, one per level. The effects of robots are random, with variance
σ_r².

- The variances σ_e² (residual) and σ_r² are estimated by fitting constants (Henderson 1953, "Estimation of variance and
  covariance components", Biometrics 9:226-252, method 3): the residual sums of squares with and without robot effects
  are set equal to their expectations, which gives two equations. No distribution is assumed.
- The effects are estimated by generalised least squares with these variances (Fuller & Battese 1973, JASA 68:626-632).
- The component of a factor is the variance of its effects over missions (a finite population; Gelman 2005, Annals of
  Statistics 33:1-53), Σ share·(effect - mean)², minus the contribution of the effects' estimation errors, tr(M·Cov).
- Intervals come from a bootstrap over robots, because missions of one robot are alike (Davison & Hinkley 1997, section
  3.8).

All sums are computed from one row per robot and combination of levels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan

import numpy as np

from pytest_tarl.learning.tables import Floats, Ints

REPLICATES = 200
FEWEST = 30  # an interval is given only for at least this many robots
RANDOM = 2  # number of random components: robots, and the residual
CONFOUNDED = (
    # a contrast is estimable if at most this share of it lies outside the row space of the design
    1e-6
)
SINGULAR = 1e-9  # eigenvalues below this share of the largest count as 0


@dataclass(frozen=True)
class Totals:
    """Sums over the missions of each robot and combination of levels; `levels` has shape (rows, factors).

    `squares` is the sum of squared rewards by robot.
    """

    robot: Ints
    levels: Ints
    count: Floats
    reward: Floats
    squares: Floats
    sizes: tuple[int, ...]  # number of levels of each factor


@dataclass(frozen=True)
class Component:
    """A variance and its two-sided interval; NaN if it cannot be estimated."""

    name: str
    variance: float
    low: float
    high: float
    levels: int
    # effect of each level, relative to the mean over missions; empty for robots and the residual
    effects: tuple[float, ...] = ()


@dataclass(frozen=True)
class _Fit:
    variances: Floats  # variance of each factor, of robots and of residuals
    noise: Floats  # share of each of `variances` that is estimation error
    effects: Floats  # effects of all levels of all factors


def components(
    totals: Totals, names: Sequence[str], confidence: float, rng: np.random.Generator
) -> tuple[Component, ...]:
    """Return the component of each factor, then those of "robot" and "mission" (residual)."""
    design = _Design(totals)
    robots = totals.squares.size
    found = design.fit(np.ones(robots))
    low, high = np.zeros(found.variances.size), np.full(found.variances.size, inf)
    if robots >= FEWEST:
        replicates = np.array([design.fit(weights).variances for weights in _resampled(robots, rng)])
        low, high = _interval(found, np.where(np.isnan(replicates), found.variances, replicates), confidence)
    unknown = np.isnan(found.variances)
    low[unknown], high[unknown] = nan, nan
    ends = np.cumsum(totals.sizes)
    effects = [tuple(part.tolist()) for part in np.split(found.effects, ends[:-1])]
    levels = (*totals.sizes, robots, int(totals.count.sum()))
    return tuple(
        Component(name, float(value), float(least), float(most), count, one)
        for name, value, least, most, count, one in zip(
            (*names, "robot", "mission"), found.variances, low, high, levels, (*effects, (), ()), strict=True
        )
    )


def _interval(found: _Fit, replicates: Floats, confidence: float) -> tuple[Floats, Floats]:
    """Return the ends of the intervals from bootstrap replicates, shape (replicates, components).

    A replicate is a sample of robots, drawn with replacement. Its estimates contain the errors of the original sample
    and of the replicate; the intervals subtract both. A replicate has fewer distinct robots per site, so the variance
    between them is smaller. The replicates of the random components are therefore scaled to have the estimate as their
    mean; the interval is a basic bootstrap interval of the logarithm. If some replicates are not positive, the interval
    spans the percentiles of the original, shifted and scaled replicates instead.
    """
    value, mean = found.variances, np.mean(replicates, axis=0)
    random = np.arange(value.size) >= value.size - RANDOM
    positive = random & (value > 0) & (np.min(replicates, axis=0) > 0)
    shift = np.where(random, mean - value, found.noise)
    tail = (1.0 - confidence) / 2
    ends = np.quantile(replicates, [tail, 1.0 - tail], axis=0)
    low, high = np.maximum(ends - shift, 0.0)
    low = np.where(random, np.minimum(low, np.maximum(ends[0], 0.0)), low)
    scale = np.ones(value.size)
    np.divide(value, mean, out=scale, where=random & (value > mean) & (mean > 0))
    high = np.where(random, np.maximum(high, ends[1] * scale), high)
    for n in np.flatnonzero(positive).tolist():
        ratio = np.quantile(replicates[:, n], [1.0 - tail, tail]) / mean[n]
        low[n], high[n] = value[n] / ratio
    return low, high


def _resampled(robots: int, rng: np.random.Generator) -> list[Floats]:
    """Return how often each robot occurs in each replicate."""
    share = np.full(robots, 1.0 / robots)
    return [rng.multinomial(robots, share).astype(np.float64) for _ in range(REPLICATES)]


class _Design:
    """The sums of squares and products of the data, with a weight per robot."""

    def __init__(self, totals: Totals) -> None:
        self.totals = totals
        self.first = np.concatenate([[0], np.cumsum(totals.sizes)]).astype(np.int64)
        self.columns = totals.levels + self.first[:-1]  # shape (rows, factors)
        self.width = int(self.first[-1])
        robots = totals.squares.size
        place = (totals.robot[:, None] * self.width + self.columns).ravel()
        counts = np.repeat(totals.count, len(totals.sizes))
        self.visits = np.bincount(place, counts, robots * self.width).reshape(robots, self.width)
        self.missions = np.bincount(totals.robot, totals.count, robots)
        self.reward = np.bincount(totals.robot, totals.reward, robots)

    def fit(self, weights: Floats) -> _Fit:
        """Return the components with weights per robot, shape (robots,)."""
        x, n, s = self.visits, self.missions, self.reward
        products, sums = self._products(weights), self._sums(weights * 1.0)
        squares = float(weights @ self.totals.squares)
        count = float(weights @ n)

        scaled = x * (weights / n)[:, None]
        inverse, rank = _inverse(products - scaled.T @ x)
        told = sums - scaled.T @ s
        freedom = float(weights @ (n - 1.0)) - rank
        rest = (
            (squares - float((weights / n) @ s**2) - float(told @ inverse @ told)) / freedom
            if freedom > 0
            else nan
        )

        inverse, rank = _inverse(products)
        between = count - float(np.sum(inverse * ((x * weights[:, None]).T @ x)))
        left = squares - float(sums @ inverse @ sums) - rest * (count - rank)
        robot = left / between if between > CONFOUNDED * count else nan

        known = max(0.0, robot) if robot == robot else 0.0
        share = known / (rest + n * known) if rest > 0 else np.zeros_like(n)
        scaled = x * (weights * share)[:, None]
        weighted = products - scaled.T @ x
        inverse, _ = _inverse(weighted)
        effects = inverse @ (sums - scaled.T @ s)
        variances, noise = self._factors(effects, inverse, weighted, max(rest, 0.0), weights)
        return _Fit(
            np.array([*variances, robot, rest]), np.array([*noise, 0.0, 0.0]), self._centred(effects, weights)
        )

    def _products(self, weights: Floats) -> Floats:
        """Return the number of missions for each pair of levels, shape (levels, levels)."""
        counts = self.totals.count * weights[self.totals.robot]
        found = np.zeros(self.width**2)
        for one in self.columns.T:
            for other in self.columns.T:
                found += np.bincount(one * self.width + other, counts, self.width**2)
        return found.reshape(self.width, self.width)

    def _sums(self, weights: Floats) -> Floats:
        """Return the total reward at each level."""
        reward = self.totals.reward * weights[self.totals.robot]
        return np.asarray(sum(np.bincount(one, reward, self.width) for one in self.columns.T), np.float64)

    def _shares(self, factor: int, weights: Floats) -> tuple[slice, Floats]:
        here = slice(int(self.first[factor]), int(self.first[factor + 1]))
        counts = weights @ self.visits[:, here]
        return here, counts / counts.sum()

    def _factors(
        self, effects: Floats, inverse: Floats, products: Floats, rest: float, weights: Floats
    ) -> tuple[list[float], list[float]]:
        outside = np.eye(self.width) - inverse @ products
        variances, noise = [], []
        for factor in range(len(self.totals.sizes)):
            here, share = self._shares(factor, weights)
            middle = np.diag(share) - np.outer(share, share)
            added = rest * float(np.sum(middle * inverse[here, here]))
            value = float(effects[here] @ middle @ effects[here]) - added
            known = float(np.abs(outside[:, here] @ middle).max(initial=0.0)) < CONFOUNDED
            variances.append(value if known else nan)
            noise.append(added if known else 0.0)
        return variances, noise

    def _centred(self, effects: Floats, weights: Floats) -> Floats:
        found = effects.copy()
        for factor in range(len(self.totals.sizes)):
            here, share = self._shares(factor, weights)
            found[here] -= share @ effects[here]
        return found


def _inverse(matrix: Floats) -> tuple[Floats, int]:
    """Return the Moore-Penrose inverse of a symmetric matrix, and its rank."""
    values, vectors = np.linalg.eigh(matrix)
    kept = values > SINGULAR * max(float(values.max(initial=0.0)), 0.0)
    inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    return np.asarray(inverse, np.float64), int(kept.sum())
