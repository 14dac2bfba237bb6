"""Sweep and confirm, the default search: one factor over all operands, then the next.

Each run is paired with the unmutated run of the same seed; whatever comes near the off-line reward is confirmed
on further seeds. Between sweeps the most improving operand is refined on a log scale.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import sqrt

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.searching.search import FACTORS, Candidate, Goal, Mutate, Trials, confirmed, operand_effect
from tarl_lint.model import Operand


class Sweep:
    """Sweep and confirm, operands in the given order, each mutated at its use under `guard`."""

    def __init__(
        self, operands: Sequence[Operand], mutate: Mutate, guards: Sequence[Guard], trials: Trials, goal: Goal
    ) -> None:
        self.operands = operands
        self.mutate = mutate
        self.guards = guards
        self.trials = trials
        self.goal = goal
        self._gains: dict[tuple[Operand, Guard], dict[float, float]] = {}  # factor → gain in reward
        self._tried: set[Candidate] = set()

    def candidates(self) -> Iterator[Candidate]:
        """Yield candidates that hold on every seed they were tried on."""
        for turn, factor in enumerate(FACTORS):
            pair = turn % len(self.goal.pairs)
            for guard in self.guards:
                for operand in self.operands:
                    yield from self._try(operand, guard, factor, pair)
            yield from self._refine(pair)

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, per site, what each operand's best value gained over the unmutated runs of the same seeds."""
        best: dict[Operand, OperandEffect] = {}
        for (operand, _), gains in self._gains.items():
            factor = max(gains.keys() - {1.0}, key=lambda one: (gains[one], -one))
            mutation = self.mutate(operand, factor)
            if mutation is not None and (operand not in best or gains[factor] > best[operand].effect):
                best[operand] = operand_effect(mutation, gains[factor])
        found: dict[str, list[OperandEffect]] = {}
        for operand, effect in best.items():
            found.setdefault(str(operand.site), []).append(effect)
        return found

    def _try(self, operand: Operand, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        mutation = self.mutate(operand, factor)
        if mutation is None:
            return
        candidate = Candidate((mutation,), guard)
        if candidate in self._tried:
            return
        self._tried.add(candidate)
        base = self.goal.pairs[pair]
        try:
            near = self.goal.reached(self.trials(candidate, base.seed))
        except RepairError:
            return
        gains = self._gains.setdefault((operand, guard), {1.0: 0.0})
        gains[factor] = self.trials.gain(candidate, self.goal.pairs)
        if near:
            holds = confirmed(candidate, self.trials, self.goal, pair)
            gains[factor] = self.trials.gain(candidate, self.goal.pairs)
            if holds:
                yield candidate

    def _refine(self, pair: int) -> Iterator[Candidate]:
        """Try the most improving operand between its best factor and that factor's neighbours, on a log scale."""
        best = max(self._gains, key=lambda tried: max(self._gains[tried].values()), default=None)
        if best is None:
            return
        gains = self._gains[best]
        factor = max(gains, key=gains.__getitem__)
        if factor == 1.0 or gains[factor] <= 0:
            return
        ordered = sorted(gains)
        place = ordered.index(factor)
        for neighbour in ordered[max(place - 1, 0) : place] + ordered[place + 1 : place + 2]:
            yield from self._try(*best, round(sqrt(factor * neighbour), 3), pair)
