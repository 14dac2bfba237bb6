"""Keep a change that removes much of the loss, and add other constants to it.

A change may restore the easy missions but not the hard ones, because a second constant is wrong as well. On an easy
mission nothing more can be gained, so the other constants run on the mission that the change restores least. Constants
that lose reward alone are also tried. For example, a damping that is right for a larger controller gain is too strong
for the old gain.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.errors import RepairError
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.forward_selection import STEPS, ForwardSelection, Joint
from pytest_tarl.searching.search import Pair
from pytest_tarl.searching.units import NEAR, Unit
from tarl_lint.model import Operand

GAINED = 0.3  # minimum gain of the change that is kept, as a share of the wanted gain
SEEDS = 2  # the change must have run on at least this number of seeds, because a gain on one seed may be luck
EPISODES = 20  # maximum number of tries of other constants
MOVED = 2  # maximum number of combinations whose added constant is moved further


def held(base: Joint, rest: Sequence[Unit], selection: ForwardSelection) -> Iterator[tuple[Joint, Outcome]]:
    """Add one constant of `rest` to a change, on the mission that the change restores least; yield what earns more.

    Each constant is increased, then decreased. Then the best constants are moved further. This is done for several
    constants, because the constant that is best after a large step need not be best with a suitable value. Nothing runs
    if the change gains too little on average or already restores all its missions. Raise BudgetSpentError.
    """
    pair = _hardest(base, selection)
    if pair is None:
        return
    alone = selection.trials(base.candidate(selection.mutate), pair.seed)
    found, begun = list[tuple[Outcome, Joint]](), selection.trials.spent
    for factor in NEAR:
        for unit in rest:
            if selection.trials.spent - begun >= EPISODES:
                break
            wider = base.with_part(unit, factor)
            outcome = _ran(wider, pair, selection)
            if outcome is not None and outcome.total > alone.total + selection.slack:
                found.append((outcome, wider))
                if selection.goal.reached(outcome, pair.seed):
                    yield wider, outcome
    found.sort(key=lambda one: -one[0].total)
    if not found or selection.goal.reached(found[0][0], pair.seed):
        return
    for outcome, wider in _apart(found)[:MOVED]:
        yield _moved(wider, outcome, pair, selection)


def _apart(found: Sequence[tuple[Outcome, Joint]]) -> list[tuple[Outcome, Joint]]:
    """Return the combinations without those that add the same constant as an earlier combination."""
    kept: list[tuple[Outcome, Joint]] = []
    taken: set[Operand] = set()
    for outcome, joint in found:
        added = joint.parts[-1][0].operands
        if taken.isdisjoint(added):
            kept.append((outcome, joint))
        taken.update(added)
    return kept


def _moved(joint: Joint, outcome: Outcome, pair: Pair, selection: ForwardSelection) -> tuple[Joint, Outcome]:
    """Move the last constant of a combination a little; return the best combination and its outcome."""
    unit, factor = joint.parts[-1]
    for step in STEPS:
        moved = joint.with_part(unit, round(factor * step, 3))
        other = _ran(moved, pair, selection)
        if other is not None and other.total > outcome.total:
            return moved, other
    return joint, outcome


def _hardest(base: Joint, selection: ForwardSelection) -> Pair | None:
    """Return the pair whose mission a change restores least, or None if the change is not worth keeping."""
    trials, goal, candidate = selection.trials, selection.goal, base.candidate(selection.mutate)
    try:
        for pair in goal.pairs:
            if len(trials.ran(candidate, goal.pairs)) >= SEEDS:
                break
            trials(candidate, pair.seed)
    except RepairError:
        return None
    if trials.gain(candidate, goal) < GAINED * goal.wanted:
        return None
    ran = [(pair, one) for pair in goal.pairs for one in trials.ran(candidate, [pair])]
    short = [(pair, one) for pair, one in ran if not goal.reached(one, pair.seed)]
    return min(short, key=lambda one: one[1].total, default=(None, None))[0]


def _ran(joint: Joint, pair: Pair, selection: ForwardSelection) -> Outcome | None:
    """Return a combination's outcome on the seed of a pair, or None if it cannot be written."""
    candidate = joint.candidate(selection.mutate)
    try:
        return selection.trials(candidate, pair.seed) if candidate.mutations else None
    except RepairError:
        return None
