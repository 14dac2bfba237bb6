"""Let a constant follow a varying quantity, if no single value is better than the old one.

For example, a stage light has the right brightness for actors at its mark. If the actors walk over the whole stage, any
other fixed brightness is worse on average: half of the places need more light and half need less. A brightness that is
a power of the distance suits all places.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from pytest_tarl.errors import RepairError
from pytest_tarl.searching.forward_selection import ForwardSelection
from pytest_tarl.searching.polishing import polished
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand

# takes constants and returns candidates in which one of them is proportional to a sensor or a variable
Proportional = Callable[[Sequence[Operand]], Iterator[Candidate]]

CONSTANTS = 4  # maximum number of constants that are tried
ADJUSTED = 2  # maximum number of laws whose exponent is adjusted
SIGNS = (1.0, -1.0)  # exponents that are tried first
STEPS = (1.5, 1.2, 1.08)  # ratios by which an exponent that gains is moved
# if other missions do not confirm an exponent, it is divided by each of these numbers in turn
BACK = (1.0, 1.13, 1.28, 1.44)
SEEDS = 2  # number of seeds on which exponents are compared


def laws(
    constants: Sequence[Unit], proportional: Proportional, selection: ForwardSelection
) -> Iterator[Candidate]:
    """Yield confirmed candidates in which one of the constants follows a quantity. Raise BudgetSpentError.

    The laws that gain most are adjusted first. A constant may be listed several times, as a whole and at single uses,
    but is tried once.
    """
    distinct: dict[object, Unit] = {}
    for unit in constants:
        distinct.setdefault((unit.operands[0].code, unit.operands[0].definition), unit)
    gaining = [
        (gain, law, power)
        for unit in list(distinct.values())[:CONSTANTS]
        for law in proportional(unit.operands)
        for power in SIGNS
        if (gain := _gain(law, power, selection)) is not None and gain > selection.slack
    ]
    for _, law, power in sorted(gaining, key=lambda one: -one[0])[:ADJUSTED]:
        yield from _adjusted(law, power, selection)


def _with_power(law: Candidate, power: float) -> Candidate:
    return replace(law, mutations=tuple(replace(one, value=round(power, 2)) for one in law.mutations))


def _gain(law: Candidate, power: float, selection: ForwardSelection) -> float | None:
    """Return the gain of a law on the first seed, or None if it cannot be written."""
    pair = selection.goal.pairs[0]
    try:
        return selection.goal.gain(selection.trials(_with_power(law, power), pair.seed), pair.total)
    except RepairError:
        return None


def _adjusted(law: Candidate, power: float, selection: ForwardSelection) -> Iterator[Candidate]:
    """Move the exponent while the mean reward grows; yield the law with the first exponent that is confirmed."""
    trials, goal = selection.trials, selection.goal
    seeds = [pair.seed for pair in goal.pairs[:SEEDS]]

    def earned(factors: tuple[float, ...], seed: int) -> float:
        return trials(_with_power(law, power * factors[0]), seed).total

    (by,) = polished((1.0,), earned, seeds, goal.wanted, STEPS, goal.enough_on(seeds))
    for back in BACK if by != 1.0 else BACK[:1]:
        best = _with_power(law, power * by / back)
        if selection.settled.holds(best, trials, goal, 0):
            yield best
            return
