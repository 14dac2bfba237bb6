"""Retry constants that had no effect alone, together with a change that makes missions last longer.

A mission that fails early never reaches the statements that come later, so their constants have no effect. For example,
a wrapping film tears after a few turns of a pallet. With less tension, the film does not tear, but then more turns are
needed to hold the load. The number of turns matters only after the tension was reduced.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from statistics import fmean

from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.plainness import kind
from pytest_tarl.searching.refining import between
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import NEAR, Unit

# other constants are tried together with a change only if the change gains at least this share of the wanted gain
GAINED = 0.3
LONGER = 1.2  # minimum ratio of the length of missions with the change to their length without it
MOST = 24  # maximum number of other constants that are tried together with the change
FINER = (1.5, 0.65)  # factors for a constant that has an effect together with the change
ROUNDS = 2  # how often the best factor of a constant is refined together with the change


def longer(base: Joint, selection: ForwardSelection) -> bool:
    """Return whether the missions of a combination that ran last longer than those of the unrepaired program."""
    return lasting(base, selection) >= LONGER


def lasting(base: Joint, selection: ForwardSelection) -> float:
    """Return the length of a combination's missions divided by the length of unrepaired ones, or 0 if unknown.

    Only missions of the same seeds are compared, since seeds differ in length.
    """
    candidate, trials = base.candidate(selection.mutate), selection.trials
    known = [(trials.steps(candidate, [pair]), pair.steps) for pair in selection.goal.pairs]
    ran = [(after[0], before) for after, before in known if after and before]
    return fmean(after for after, _ in ran) / fmean(before for _, before in ran) if ran else 0.0


def unmasked(base: Joint, hidden: Sequence[Unit], selection: ForwardSelection) -> Iterator[Candidate]:
    """Yield confirmed combinations of `base` and one of the `hidden` units. Raise BudgetSpentError.

    Each unit is first tried with a larger value. If this has no effect, the unit is tried with a smaller value later.
    If it has an effect, further factors are tried at once.
    """
    gain = yield from selection.gain(base)
    if gain is None:
        return
    waiting = sorted(hidden, key=kind)[:MOST]
    for factor in NEAR:
        selection.expect([base.with_part(unit, factor) for unit in waiting])
        still: list[Unit] = []
        for unit in waiting:
            wider = base.with_part(unit, factor)
            found = yield from selection.gain(wider)
            if found is None:
                continue
            if _alike(wider, base, selection):
                still.append(unit)
            else:
                yield from _refined(base, unit, {1.0: gain, factor: found}, selection)
        waiting = still


def _alike(one: Joint, other: Joint, selection: ForwardSelection) -> bool:
    mutate, trials = selection.mutate, selection.trials
    return bool(trials.same_as(one.candidate(mutate), other.candidate(mutate)))


def _refined(
    base: Joint, unit: Unit, gains: dict[float, float], selection: ForwardSelection
) -> Generator[Candidate, None, None]:
    """Try further factors of a unit, and factors between the best ones while the best factor is not 1."""
    yield from _tried(base, unit, FINER, gains, selection)
    for _ in range(ROUNDS):
        if max(gains, key=gains.__getitem__) == 1.0:
            return
        yield from _tried(base, unit, between(gains, selection.goal.wanted), gains, selection)


def _tried(
    base: Joint, unit: Unit, factors: Sequence[float], gains: dict[float, float], selection: ForwardSelection
) -> Generator[Candidate, None, None]:
    for factor in factors:
        found = yield from selection.gain(base.with_part(unit, factor))
        if found is not None:
            gains[factor] = found
