"""Search a few constants jointly: Bayesian optimisation over the logarithms of their steps.

A step multiplies a constant by a factor. If two constants have to grow together, a step in one of them alone loses
reward. A Gaussian process is fitted to all trials. Proposals change one to three constants of a good point (Regis &
Shoemaker 2013). The proposal with the largest expected improvement runs next (Jones, Schonlau & Welch 1998). The value
of a trial combines its reward with the deviation of its missions from the designed ones. The deviation matters because
a mission that fails late is closer to the goal than one that fails at once, even with the same reward.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from math import erf, exp, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.plainness import Oddness, kind
from pytest_tarl.searching.search import Candidate, Goal, Trials
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand

Floats = NDArray[np.float64]

DIMENSIONS = 8  # maximum number of constants that are moved together
LEAST = 2  # minimum number of constants that are moved together
EPISODES = 50  # maximum number of trials of the joint search
PATIENCE = 25  # maximum number of consecutive trials without an improvement
# maximum number of consecutive trials that earn the same reward, if it is larger than the unrepaired program's: such
# trials only avoid the part of the mission that costs reward
FLAT = 12
FARTHEST = 3.0  # maximum |log(step)|; e³ is a factor of 20
CHANGED = 3  # maximum number of constants in which a trial differs from the point where it starts
SPREADS = (0.1, 0.3, 0.8)  # standard deviations of the random changes of a log step
PROPOSALS = 400  # random proposals per trial; the one with the largest expected improvement runs
STARTS = 4  # number of best points to start from
ASUNDER = 0.2  # two points to start from must differ by at least this amount in at least one log step
# maximum number of hidden constants: they are moved, too, although alone they hardly changed the reward
HIDDEN = 2
SELDOM = 0.25  # frequency with which hidden constants are moved, relative to the others
# length scales of a constant that the fit may choose, in units of its log step
LENGTHS = (0.4, 1.0, 2.5, 8.0)
REFITTED = 4  # number of trials between two fits of the length scales
# noise levels of a trial that the fit may choose, as a share of the standard deviation of all trials
NOISES = (0.05, 0.2)
WORST = 2.0  # maximum deviation from the designed mission; larger deviations are clipped
REFUSED = 0.5  # penalty for a point that is good on this seed but was refused because of other seeds
SMALL = 0.02  # a constant whose factor has a smaller |log| than this is left unchanged


@dataclass
class Surrogate:
    """A Gaussian process with a Matérn kernel (ν = 5/2) and a length scale for each coordinate.

    `points` has shape (n, k), `values` shape (n,). `lengths` has shape (k,); if it is not given, the lengths that
    maximise the marginal likelihood are chosen, one coordinate at a time.
    """

    points: Floats
    values: Floats
    lengths: Floats | None = None

    def __post_init__(self) -> None:
        """Fit the process."""
        self._level, self._size = float(self.values.mean()), float(self.values.std()) or 1.0
        self._scaled = (self.values - self._level) / self._size
        self._apart = (self.points[:, None, :] - self.points[None, :, :]) ** 2
        self.fitted = self._likeliest() if self.lengths is None else self.lengths
        noise = max(NOISES, key=lambda one: self._likelihood(self.fitted, one))
        self._factor = self._cholesky(self.fitted, noise)
        self._weights = self._solved(self._factor)

    def predict(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the means and standard deviations at points of shape (m, k)."""
        between = _kernel((points[:, None, :] - self.points[None, :, :]) ** 2, self.fitted)
        mean = self._level + self._size * (between @ self._weights)
        explained = np.linalg.solve(self._factor, between.T)
        variance = np.maximum(1.0 - (explained**2).sum(axis=0), 1e-9)
        return mean, self._size * np.sqrt(variance)

    def _likeliest(self) -> Floats:
        """Return the length scales with the highest marginal likelihood found."""
        found = np.full(self.points.shape[1], 1.0)
        best = self._likelihood(found, NOISES[-1])
        for at in range(len(found)):
            for length in LENGTHS:
                other = found.copy()
                other[at] = length
                likelihood = self._likelihood(other, NOISES[-1])
                if likelihood > best:
                    best, found = likelihood, other
        return found

    def _likelihood(self, lengths: Floats, noise: float) -> float:
        factor = self._cholesky(lengths, noise)
        return float(-0.5 * self._scaled @ self._solved(factor) - np.log(np.diag(factor)).sum())

    def _cholesky(self, lengths: Floats, noise: float) -> Floats:
        kernel = _kernel(self._apart, lengths) + noise**2 * np.eye(len(self.points))
        return np.asarray(np.linalg.cholesky(kernel), np.float64)

    def _solved(self, factor: Floats) -> Floats:
        return np.asarray(np.linalg.solve(factor.T, np.linalg.solve(factor, self._scaled)), np.float64)


def _kernel(apart: Floats, lengths: Floats) -> Floats:
    """Return correlations of shape (m, n); `apart` holds squared distances by coordinate, shape (m, n, k)."""
    scaled = np.sqrt(5.0 * (apart @ lengths**-2.0))
    return np.asarray((1.0 + scaled + scaled**2 / 3.0) * np.exp(-scaled), np.float64)


def expected_improvement(mean: Floats, deviation: Floats, best: float) -> Floats:
    """Return the expected improvement of points over `best`, shape (m,)."""
    ahead = (mean - best) / deviation
    normal = np.array([0.5 * (1.0 + erf(one / sqrt(2.0))) for one in ahead])
    return np.asarray((mean - best) * normal + deviation * np.exp(-0.5 * ahead**2) / sqrt(2.0 * pi))


class Jointly:
    """Joint search of units, starting at given points; `selection` runs and confirms the combinations.

    The last `hidden` units hardly changed the reward alone, so they are moved less often.
    """

    def __init__(
        self,
        units: Sequence[Unit],
        selection: ForwardSelection,
        trials: Trials,
        goal: Goal,
        generator: np.random.Generator,
        hidden: int = 0,
    ) -> None:
        self.units = tuple(units)
        self._often = np.array([1.0] * (len(units) - hidden) + [SELDOM] * hidden)
        self.selection = selection
        self.trials = trials
        self.goal = goal
        self.generator = generator
        self._points: list[tuple[float, ...]] = []
        self._values: list[float] = []
        self._lengths: Floats | None = None

    def candidates(self, starts: Sequence[Joint], guard: Guard) -> Iterator[Candidate]:
        """Yield confirmed combinations. Raise BudgetSpentError."""
        begun, since, best = self.trials.spent, 0, -float("inf")
        earned: list[float] = []  # rewards of the trials on the first seed
        waiting = [(0.0,) * len(self.units), *(self._point(start) for start in starts)]
        while self.trials.spent - begun < EPISODES and since < PATIENCE:
            if since >= FLAT and len(set(earned[-FLAT:])) == 1 and earned[-1] > self.goal.pairs[0].total:
                return
            point = waiting.pop(0) if waiting else self._next()
            joint = Joint(tuple((u, exp(x)) for u, x in zip(self.units, point, strict=True) if x), guard)
            value = yield from self._value(self._rounded(joint), best)
            earned += self._earned(self._rounded(joint))
            since += 1
            if value is None:
                value = min(self._values, default=-WORST)
            if value > best:
                best, since = value, 0 if self._values else since
            self._points.append(point)
            self._values.append(value)

    def _earned(self, joint: Joint) -> list[float]:
        candidate = joint.candidate(self.selection.mutate)
        return [one.total for one in self.trials.ran(candidate, self.goal.pairs[:1])]

    def _point(self, joint: Joint) -> tuple[float, ...]:
        steps = dict(joint.parts)
        return tuple(log(steps[unit]) if unit in steps else 0.0 for unit in self.units)

    @staticmethod
    def _rounded(joint: Joint) -> Joint:
        return Joint(tuple((unit, float(f"{step:.3g}")) for unit, step in joint.parts), joint.guard)

    def _value(self, joint: Joint, best: float) -> Generator[Candidate, None, float | None]:
        """Run a combination; return its share of the wanted gain minus its missions' deviation.

        A result on one seed may be luck. A combination that would be the best so far therefore also runs on a second
        seed, and its gain is the mean of both seeds.
        """
        gain = yield from self.selection.gain(joint)
        if gain is None:
            return None
        candidate, pairs = joint.candidate(self.selection.mutate), self.goal.pairs
        try:
            away = self.trials.deviation(candidate, [pairs[0].seed])
            if self._valued(gain, away) > best and joint.parts:
                self.trials(candidate, pairs[1 % len(pairs)].seed)
        except RepairError:
            return None
        refused = REFUSED if candidate in self.selection.settled.tried else 0.0
        return self._valued(self.trials.gain(candidate, self.goal), away) - refused

    def _valued(self, gain: float, away: float) -> float:
        return float(np.clip(gain / (self.goal.wanted or 1.0), -1.0, 1.0)) - min(away, WORST)

    def _next(self) -> tuple[float, ...]:
        """Return the proposal with the largest expected improvement over the best trial."""
        points, values = np.array(self._points), np.array(self._values)
        known = None if len(values) % REFITTED == 1 else self._lengths
        surrogate = Surrogate(points, values, known)
        self._lengths = surrogate.fitted
        proposals = self._proposals(_best_apart(points, values))
        mean, deviation = surrogate.predict(proposals)
        gains = expected_improvement(mean, deviation, float(values.max()))
        return tuple(float(one) for one in proposals[int(np.argmax(gains))])

    def _proposals(self, starts: Floats) -> Floats:
        """Move up to `CHANGED` coordinates of the starts, shape (m, k); 0 replaces steps below `SMALL`."""
        draw, size = self.generator, (PROPOSALS, starts.shape[1])
        many = draw.integers(1, CHANGED + 1, PROPOSALS)
        ranks = (draw.random(size) ** (1.0 / self._often)).argsort(axis=1)[:, ::-1].argsort(axis=1)
        chosen = ranks < many[:, None]
        spreads = np.array(SPREADS)[draw.integers(len(SPREADS), size=PROPOSALS)]
        moved = starts[np.arange(PROPOSALS) % len(starts)]
        moved = np.clip(moved + chosen * draw.normal(0.0, 1.0, size) * spreads[:, None], -FARTHEST, FARTHEST)
        return np.where(np.abs(moved) < SMALL, 0.0, moved)


def _best_apart(points: Floats, values: Floats) -> Floats:
    """Return the best points, shape (m, k), so that no two of them are close to each other."""
    found: list[Floats] = []
    for at in np.argsort(-values, kind="stable"):
        if len(found) < STARTS and all(np.abs(points[at] - one).max() >= ASUNDER for one in found):
            found.append(points[at])
    return np.array(found)


def sensitive(among: Sequence[Unit], gains: Gains, guard: Guard) -> tuple[list[Unit], int]:
    """Return the units to move jointly, and how many of them are hidden (see `HIDDEN`). Hidden units come last.

    Each constant moves on the scale on which it gained most. Named constants come first. Among constants of the same
    kind, those that changed the reward more come first. Booleans, zeros and constants of nature are left out.
    """
    best: dict[tuple[Operand, ...], tuple[float, Unit]] = {}
    for unit in among:
        gained = max(
            (
                most
                for each, most in _most(gains, guard)
                if set(each.operands) <= set(unit.operands) and each.chart == unit.chart
            ),
            default=0.0,
        )
        if unit.operands not in best or gained > best[unit.operands][0]:
            best[unit.operands] = gained, unit
    chosen = [
        unit
        for _, unit in best.values()
        if kind(unit) in (Oddness.NAMED, Oddness.INNER)
        and unit.operands[0].value is not None
        and not isinstance(unit.operands[0].value, bool)
    ]
    moved = _changes(gains, guard)

    def change(unit: Unit) -> float:
        return max((moved.get(one, 0.0) for one in unit.operands), default=0.0)

    chosen.sort(key=lambda unit: (kind(unit) != Oddness.NAMED, -change(unit)))
    seen = [unit for unit in chosen if change(unit) > gains.slack][:DIMENSIONS]
    hidden = [unit for unit in chosen if change(unit) <= gains.slack and kind(unit) == Oddness.NAMED]
    hidden = hidden[: min(HIDDEN, DIMENSIONS - len(seen))]
    return [*seen, *hidden], len(hidden)


def _most(gains: Gains, guard: Guard) -> list[tuple[Unit, float]]:
    return [(unit, max(found.values())) for unit, found in gains.under(guard).items()]


def _changes(gains: Gains, guard: Guard) -> dict[Operand, float]:
    """Return the largest change of the reward by each operand."""
    found: dict[Operand, float] = {}
    for unit, by_factor in gains.under(guard).items():
        for operand in unit.operands:
            found[operand] = max(found.get(operand, 0.0), *(abs(gain) for gain in by_factor.values()))
    return found
