"""Hold the change that gains a good part of the loss, and try the other constants under it.

A change may restore the easy missions and fail the hard ones, because a second constant is wrong as well. On an easy
mission nothing more can be gained, so the other constants run on the mission that the change restores least. They
include those that lose alone: a damping that is right for a larger gain is too strong for the old one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.errors import RepairError
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.forward_selection import STEPS, ForwardSelection, Joint
from pytest_tarl.searching.search import Pair
from pytest_tarl.searching.units import NEAR, Unit

GAINED = 0.3  # minimum gain of the change that is held, as a share of the wanted gain
SEEDS = 2  # minimum number of seeds on which it must have run: a gain on one seed may be luck
EPISODES = 20  # maximum number of tries of other constants


def held(base: Joint, rest: Sequence[Unit], selection: ForwardSelection) -> Iterator[tuple[Joint, Outcome]]:
    """Run the constants of `rest` under a change on the mission that it restores least; yield what earns more.

    Each constant is increased, then decreased; the best one is then moved further. Nothing runs if the change gains too
    little on average, or if it restores all missions that it ran. Raise BudgetSpentError.
    """
    pair = _hardest(base, selection)
    if pair is None:
        return
    alone = selection.trials(base.candidate(selection.mutate), pair.seed)
    best, most, begun = base, alone, selection.trials.spent
    for factor in NEAR:
        for unit in rest:
            if selection.trials.spent - begun >= EPISODES:
                break
            wider = base.with_part(unit, factor)
            outcome = _ran(wider, pair, selection)
            if outcome is not None and outcome.total > most.total + selection.slack:
                best, most = wider, outcome
                if selection.goal.reached(outcome, pair.seed):
                    yield best, most
    if best == base or selection.goal.reached(most, pair.seed):
        return
    (unit, factor), start = best.parts[-1], most
    for step in STEPS:
        moved = best.with_part(unit, round(factor * step, 3))
        outcome = _ran(moved, pair, selection)
        if outcome is not None and outcome.total > start.total:
            best, start = moved, outcome
            break
    yield best, start


def _hardest(base: Joint, selection: ForwardSelection) -> Pair | None:
    """Return the pair whose mission a change restores least, or None if it is not worth holding."""
    trials, goal, candidate = selection.trials, selection.goal, base.candidate(selection.mutate)
    try:
        for pair in goal.pairs:
            if len(trials.ran(candidate, goal.pairs)) >= SEEDS:
                break
            trials(candidate, pair.seed)
    except RepairError:
        return None
    if trials.gain(candidate, goal.pairs) < GAINED * goal.wanted:
        return None
    ran = [(pair, one) for pair in goal.pairs for one in trials.ran(candidate, [pair])]
    short = [(pair, one) for pair, one in ran if not goal.reached(one, pair.seed)]
    return min(short, key=lambda one: one[1].total, default=(None, None))[0]


def _ran(joint: Joint, pair: Pair, selection: ForwardSelection) -> Outcome | None:
    """Return the outcome of a combination on the seed of a pair, or None if it cannot be written."""
    candidate = joint.candidate(selection.mutate)
    try:
        return selection.trials(candidate, pair.seed) if candidate.mutations else None
    except RepairError:
        return None
