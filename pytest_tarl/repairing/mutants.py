"""Candidates as what they are in the end: patched sources, run as episodes of the test."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pytest_tarl.errors import TarlError
from pytest_tarl.patching.mutate import Mutation, is_integral, mutations, rewrite
from pytest_tarl.recording import sound
from pytest_tarl.repairing.order import Order
from pytest_tarl.rollout import EpisodePlan, Rollout
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import Candidate
from tarl_lint.model import Operand

MOST_KEPT = 128  # sources of candidates that are not written anew


class Mutants:
    """Writes candidates into the source and runs them."""

    def __init__(self, order: Order) -> None:
        self.order = order
        self._sources: dict[Candidate, Mapping[Path, str]] = {}

    def mutate(self, operand: Operand, factor: float) -> Mutation | None:
        """Return one sweep step of an operand."""
        return mutations(operand, factor, is_integral(self.order.analysis, operand))

    def source(self, candidate: Candidate) -> Mapping[Path, str]:
        """Return path → text of every file that a candidate changes. Raises RepairError when it cannot be written."""
        if candidate not in self._sources:
            order = self.order
            texts = rewrite(order.analysis, candidate.mutations, candidate.guard, order.fixture.topics)
            while len(self._sources) >= MOST_KEPT:
                del self._sources[next(iter(self._sources))]
            self._sources[candidate] = {order.root / path: text for path, text in texts.items()}
        return self._sources[candidate]

    def run(self, candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        """Run one episode of a candidate. Raises RepairError when it cannot be written into the source."""
        return self.run_at(self.order.rollout, self.order.worst, candidate, seed, drift)

    def run_at(
        self, rollout: Rollout, worst: float, candidate: Candidate, seed: int, drift: str | None
    ) -> Outcome:
        """Run one episode of a test with a candidate in its nodes; `worst` is what it earns that breaks the test.

        The test ran before, so whatever breaks it now (a node that fell silent, a reward that is no number) is the
        candidate's doing. Such an episode, or one that the node did not live to see the end of, earns as little as the
        worst one recorded: what it had until then says nothing.
        """
        source = self.source(candidate)
        try:
            run = sound(rollout(EpisodePlan(seed, drift, source)))
        except TarlError:
            return Outcome(worst, passed=False)
        total = float(run.trace.reward.sum())
        return Outcome(min(total, worst) if run.crashed else total, run.passed)
