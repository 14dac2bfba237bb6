"""Sweep and confirm, the default search: one factor over all operands, then the next.

Each run is paired with the unmutated run of the same seed; whatever comes near the off-line reward is confirmed
on further seeds. Between sweeps the most improving operand is refined on a log scale.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import sqrt

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.mutate import Mutation
from pytest_tarl.search import FACTORS, Candidate, Goal, Mutate, Trials, confirmed, known_value
from tarl_lint.model import Operand


class Sweep:
    """Sweep and confirm, operands in the given order, each mutated at its use under `guard`."""

    def __init__(
        self, operands: Sequence[Operand], mutate: Mutate, guard: Guard, trials: Trials, goal: Goal
    ) -> None:
        self.operands = operands
        self.mutate = mutate
        self.guard = guard
        self.trials = trials
        self.goal = goal
        self._gains: dict[Operand, dict[float, float]] = {operand: {} for operand in operands}
        self._factors: dict[Operand, dict[float, float]] = {operand: {1.0: 0.0} for operand in operands}
        self._tried: set[Mutation] = set()

    def candidates(self) -> Iterator[Candidate]:
        """Yield candidates that hold on every seed they were tried on."""
        for turn, factor in enumerate(FACTORS):
            pair = turn % len(self.goal.pairs)
            for operand in self.operands:
                yield from self._try(operand, factor, pair)
            yield from self._refine(pair)

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, per site, what each operand's best value gained over the unmutated run of the same seed."""
        found: dict[str, list[OperandEffect]] = {}
        for operand, gains in self._gains.items():
            if gains:
                best = max(gains, key=gains.__getitem__)
                effect = OperandEffect(operand.code, known_value(operand), best, gains[best])
                found.setdefault(str(operand.site), []).append(effect)
        return found

    def _try(self, operand: Operand, factor: float, pair: int) -> Iterator[Candidate]:
        mutation = self.mutate(operand, factor)
        if mutation is None or mutation in self._tried:
            return
        self._tried.add(mutation)
        candidate = Candidate((mutation,), self.guard)
        base = self.goal.pairs[pair]
        try:
            total = self.trials(candidate, base.seed).total
        except RepairError:
            return
        self._gains[operand][float(mutation.value)] = total - base.total
        self._factors[operand][factor] = total - base.total
        if total >= self.goal.near and confirmed(candidate, self.trials, self.goal, pair):
            yield candidate

    def _refine(self, pair: int) -> Iterator[Candidate]:
        """Try the most improving operand between its best factor and that factor's neighbours, on a log scale."""
        best = max(self.operands, key=lambda operand: max(self._factors[operand].values()), default=None)
        if best is None:
            return
        gains = self._factors[best]
        factor = max(gains, key=gains.__getitem__)
        if factor == 1.0 or gains[factor] <= 0:
            return
        ordered = sorted(gains)
        place = ordered.index(factor)
        for neighbour in ordered[max(place - 1, 0) : place] + ordered[place + 1 : place + 2]:
            yield from self._try(best, round(sqrt(factor * neighbour), 3), pair)
