"""Move a constant to the value at which missions follow the designed ones most closely."""

from __future__ import annotations

from math import inf

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.closest_factor import nearest
from pytest_tarl.searching.search import Candidate, Mutate, Trials
from pytest_tarl.searching.units import Unit


def exactest(
    unit: Unit, factor: float, guard: Guard, seed: int, mutate: Mutate, trials: Trials
) -> tuple[float, float]:
    """Return the factor whose mission deviates least (see `course`) from the designed mission, and the deviation.

    The missions run on `seed`. Booleans and changes of sign keep their factor. Raise BudgetSpentError.
    """

    def deviation(step: float) -> float:
        try:
            return trials.deviation(Candidate(unit.mutations(mutate, step), guard), [seed])
        except RepairError:
            return inf

    if factor <= 0.0 or isinstance(unit.operands[0].value, bool):
        return factor, deviation(factor)
    return nearest(factor, deviation)
