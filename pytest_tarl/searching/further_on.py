"""Try other constants together with a change that lets missions get further, although it gains nothing.

If two constants stop a mission one after the other, the right value of the first one only moves the failure to a later
stage. All failures earn about the same, so the reward does not lead to the pair, but the statements that run do: if the
mission runs statements that designed missions run and the unrepaired one does not, the change is probably right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit
from pytest_tarl.searching.unmasking import unmasked
from tarl_lint.model import Operand

# the constants of the statements that only designed missions and those of a candidate run; may run an episode
Entered = Callable[[Candidate], Sequence[Operand]]

MOST = 10  # maximum number of constants that are tried under a change


def further_on(
    bases: Sequence[Joint], rest: Sequence[Unit], entered: Entered, selection: ForwardSelection
) -> Iterator[Candidate]:
    """Yield confirmed combinations of one other unit with the first of `bases` that lets missions get further.

    The constants of the statements that missions enter only with this change come first. Raise BudgetSpentError.
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
