"""Try other constants together with a change that lets missions get further but gains no reward.

Two wrong constants may stop a mission at different stages. If the first constant is corrected, the mission only fails
later. All failures earn about the same, so the reward does not show that the first change is right. The statements that
run show it: the changed mission runs statements that designed missions run and that the unrepaired mission does not
reach.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit
from pytest_tarl.searching.unmasking import unmasked
from tarl_lint.model import Operand

# returns the constants of statements that only designed missions and a candidate's missions run; may run an episode
Entered = Callable[[Candidate], Sequence[Operand]]

MOST = 10  # maximum number of constants that are tried together with a change


def further_on(
    bases: Sequence[Joint], rest: Sequence[Unit], entered: Entered, selection: ForwardSelection
) -> Iterator[Candidate]:
    """Add one other unit to the first of `bases` that lets missions get further; yield what is confirmed.

    The constants of statements that run only with this base come first. Raise BudgetSpentError.
    """
    for base in bases:
        new = set(entered(base.candidate(selection.mutate)))
        if not new:
            continue
        held = {operand for unit, _ in base.parts for operand in unit.operands}
        others = [unit for unit in rest if not held & set(unit.operands)]
        others.sort(key=lambda unit: new.isdisjoint(unit.operands))
        yield from unmasked(base, others[:MOST], selection)
        return
