"""Many e-processes in parallel, each a mixture over bets and start times (one before each mission).

Bet k multiplies its stake by a factor f ≥ 0 whose mean is at most 1. If the bet starts before observation τ, its value
is 1 before τ, and the product of all f_t with t ≥ τ afterwards. A mixture over k and τ whose weights sum to 1 is again
an e-process (Shin, Ramdas & Rinaldo 2023, e-detectors). By Ville's inequality, the probability that it ever exceeds 1/α
is at most α. Although there is a start before every observation, each observation costs only one product, because

    Σ_{τ ≤ t} w_τ ∏_{s=τ..t} f_s = (Σ_{τ < t} w_τ ∏_{s=τ..t-1} f_s + w_t) · f_t.

Half of the weight is on a start before the first observation. The other half is spread over later starts: from one
octave of τ to the next, the weight falls by a factor of 2^(-1/8). A change that comes only after 100,000 missions
therefore costs only about 15 in the natural logarithm of the evidence.

Only sums, products and square roots are used, which IEEE 754 rounds equally on all platforms. Equal observations
therefore give equal bits, no matter how they are divided into portions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats, Ints

BETS = 12  # number of bets per evidence process
LARGE = 600  # stakes above 2^LARGE are scaled down; a single factor is below 2^70
# Stakes are scaled down only after a multiple of this many missions, so that the result does not depend on how missions
# are divided into calls.
LOOK = 4


@dataclass
class Processes:
    """The state of several e-processes, one per column.

    The arrays have shape (processes,), except for `stake`, `best` and `since`: (bets, processes).

    - `stake`: Σ_τ w_τ ∏f, divided by 2^exponent
    - `best`: the largest term of this sum, divided by 2^exponent
    - `since`: the mission before which this term started
    - `age`: number of observations
    - `peak`: log2 of the largest evidence so far
    - `onset`: `since` of the largest term at the time of this peak
    - `alarm`: the mission at which the evidence reached `threshold`, or -1
    """

    stake: Floats
    best: Floats
    since: Ints
    exponent: Ints
    age: Ints
    peak: Floats
    onset: Ints
    alarm: Ints
    threshold: Floats  # log2 of the evidence at which an alarm is raised

    @property
    def count(self) -> int:
        """Return the number of processes."""
        return len(self.age)


def begun(threshold: Floats) -> Processes:
    """Return new processes; `threshold` is log2 of the evidence, shape (processes,)."""
    count = len(threshold)
    return Processes(
        stake=np.zeros((BETS, count)),
        best=np.zeros((BETS, count)),
        since=np.zeros((BETS, count), np.int64),
        exponent=np.zeros(count, np.int64),
        age=np.zeros(count, np.int64),
        peak=np.zeros(count),
        onset=np.zeros(count, np.int64),
        alarm=np.full(count, -1, np.int64),
        threshold=threshold,
    )


def reserve(age: NDArray[np.int64]) -> Floats:
    """Return the total weight of later starts after `age` observations: 1 at age 0, then ½·age^(-1/8).

    The result has the shape of `age`.
    """
    root = np.sqrt(np.sqrt(np.sqrt(np.maximum(age, 1).astype(np.float64))))
    return np.where(age > 0, 0.5 / root, 1.0)


def advance(
    processes: Processes,
    taken: NDArray[np.bool_],
    factors: Floats,
    first: int,
    ends: Ints | None = None,
    onsets: bool = True,
) -> None:
    """Update with consecutive missions, starting with number `first`.

    - `taken`, shape (missions, processes): whether a mission has an observation for a process
    - `factors`, shape (missions, bets, processes): factors for the stakes; 1 where there is no observation
    - `ends`, shape (processes,): the number of missions per process, if they differ; later rows are padding
    - `onsets`: False leaves `best`, `since` and `onset` unchanged, which halves the time
    """
    rows = np.flatnonzero(taken.any(axis=0))
    if not rows.size:
        return
    if rows.size < processes.count:
        taken, factors = taken[:, rows], factors[:, :, rows]
        ends = None if ends is None else ends[rows]
    age = processes.age[rows] + np.cumsum(taken, axis=0)
    left = reserve(age)
    weight = np.where(taken, reserve(age - taken) - left, 0.0)
    products = _multiplied(processes, rows, weight, factors, first, ends)
    exponent = products.exponents
    evidence: Floats = np.log2(products.sums / BETS + np.ldexp(left, -exponent)) + exponent
    if onsets:
        _started(processes, rows, products, first, evidence)
    processes.age[rows] = age[-1]
    processes.peak[rows] = np.maximum(processes.peak[rows], evidence.max(axis=0))
    above = evidence >= processes.threshold[rows]
    raised = np.where(above.any(axis=0), first + above.argmax(axis=0), -1)
    processes.alarm[rows] = np.where(processes.alarm[rows] < 0, raised, processes.alarm[rows])


@dataclass(frozen=True)
class _Products:
    """The sums of the stakes over the bets after each mission, with exponents; each of shape (missions, rows).

    `added`, `multiplied` and `shrinks` are the operands of three operations on all stakes for each mission, in this
    order.
    """

    sums: Floats
    exponents: Ints
    added: Floats
    multiplied: Floats
    shrinks: Mapping[int, Floats]


def _multiplied(
    processes: Processes, rows: Ints, weight: Floats, factors: Floats, first: int, ends: Ints | None
) -> _Products:
    """Update the stakes mission by mission.

    The first row of the local array `stake` has the stakes of all bets and processes before the first mission; each
    further row has the stakes after one mission.
    """
    count, shape = len(weight), (len(weight), BETS, len(rows))
    exponents = np.repeat(processes.exponent[rows][None, :], count, axis=0)
    stake = np.empty((count + 1, BETS * len(rows)))
    stake[0] = processes.stake[:, rows].ravel()
    added = np.tile(np.ldexp(weight, -exponents), BETS)
    multiplied = factors.reshape(count, -1)
    shrinks: dict[int, Floats] = {}
    for index, (before, after, more, factor) in enumerate(
        zip(stake, stake[1:], added, multiplied, strict=False)
    ):
        np.add(before, more, out=after)
        np.multiply(after, factor, out=after)
        if (first + index) % LOOK == 0 and after.max() > 2.0**LARGE:
            shrunk = np.where(after.reshape(BETS, -1).max(axis=0) > 2.0**LARGE, LARGE, 0)
            if ends is not None:
                shrunk[index >= ends] = 0
            shrinks[index] = np.tile(np.ldexp(1.0, -shrunk), BETS)
            after *= shrinks[index]
            exponents[index:] += shrunk
            added[index + 1 :] = np.tile(np.ldexp(weight[index + 1 :], -exponents[index + 1 :]), BETS)
    processes.stake[:, rows] = stake[-1].reshape(BETS, -1)
    processes.exponent[rows] = exponents[-1]
    return _Products(_summed(stake[1:].reshape(shape)), exponents, added, multiplied, shrinks)


def _started(processes: Processes, rows: Ints, products: _Products, first: int, evidence: Floats) -> None:
    """Update the largest term of each stake, and the mission before which that term started.

    `evidence`, shape (missions, rows), is log2 of the evidence after each mission.
    """
    added, count = products.added, len(products.added)
    best = np.empty((count + 1, BETS * len(rows)))
    best[0] = processes.best[:, rows].ravel()
    for index, (before, after, more, factor) in enumerate(
        zip(best, best[1:], added, products.multiplied, strict=False)
    ):
        np.maximum(before, more, out=after)
        np.multiply(after, factor, out=after)
        if index in products.shrinks:
            after *= products.shrinks[index]
    fresh = best[:-1] < added
    earlier = processes.since[:, rows]
    higher = np.flatnonzero(evidence.max(axis=0) > processes.peak[rows])
    at = evidence[:, higher].argmax(axis=0)
    bet = best.reshape(count + 1, BETS, -1)[at + 1, :, higher].argmax(axis=1)
    until = fresh.reshape(count, BETS, -1)[:, bet, higher] & (np.arange(count)[:, None] <= at)
    processes.onset[rows[higher]] = _latest(until, earlier[bet, higher], first)
    processes.since[:, rows] = _latest(fresh.reshape(count, BETS, -1), earlier, first)
    processes.best[:, rows] = best[-1].reshape(BETS, -1)


def _latest(fresh: NDArray[np.bool_], earlier: Ints, first: int) -> Ints:
    """Return, for each column, the last mission with `fresh`, or `earlier` if there is none."""
    last = first + len(fresh) - 1 - fresh[::-1].argmax(axis=0)
    return np.where(fresh.any(axis=0), last, earlier)


def _summed(stake: Floats) -> Floats:
    """Sum stakes (missions, bets, processes) over the bets in a fixed order."""
    total: Floats = stake[:, 0] + stake[:, 1]
    for bet in range(2, BETS):
        total += stake[:, bet]
    return total


def log_evidence(processes: Processes) -> Floats:
    """Return log2 of the current evidence of each process, shape (processes,)."""
    left = np.ldexp(reserve(processes.age), -processes.exponent)
    found: Floats = np.log2(_summed(processes.stake[None])[0] / BETS + left) + processes.exponent
    return found
