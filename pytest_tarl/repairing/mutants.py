"""Candidates as what they are in the end: patched sources, run as episodes of the test."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

from pytest_tarl.errors import RepairError, StaleTextError, TarlError
from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import Mutation, is_integral, mutations, rewrite
from pytest_tarl.recording import sound
from pytest_tarl.repairing.request import Order
from pytest_tarl.rollout import Ahead, EpisodePlan, EpisodeRun, Rollout
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import Candidate, Wanted
from tarl_lint.model import Operand

ORIGINAL = Candidate((), Guard())  # the program as it is
MOST_KEPT = 128  # sources of candidates that are not written anew


class Mutants:
    """Writes candidates into the source and runs them, where there are workers also ahead of being asked."""

    def __init__(self, order: Order) -> None:
        self.order = order
        self._ahead = Ahead(order.rollout)
        self.texts: dict[str, str] = {}  # files beside the analysed ones, which constants are defined in
        self._sources: dict[Candidate, Mapping[Path, str]] = {}

    def mutate(self, operand: Operand, factor: float) -> Mutation | None:
        """Return one sweep step of an operand."""
        return mutations(operand, factor, is_integral(self.order.analysis, operand))

    def source(self, candidate: Candidate) -> Mapping[Path, str]:
        """Return path → text of every file that a candidate changes. Raises RepairError when it cannot be written."""
        if candidate not in self._sources:
            order = self.order
            self._read_places(candidate)
            texts = rewrite(
                order.analysis, candidate.mutations, candidate.guard, order.fixture.topics, self.texts
            )
            while len(self._sources) >= MOST_KEPT:
                del self._sources[next(iter(self._sources))]
            self._sources[candidate] = {order.root / path: text for path, text in texts.items()}
        return self._sources[candidate]

    def _read_places(self, candidate: Candidate) -> None:
        """Read the files, beside the analysed ones, that constants are changed in and that nobody has read yet."""
        for place in {mutation.place for mutation in candidate.mutations if mutation.place is not None}:
            if place.path not in self.order.analysis.sources and place.path not in self.texts:
                self.texts[place.path] = (self.order.root / place.path).read_bytes().decode("utf-8")

    def foresee(self, wanted: Iterable[Wanted], drift: str | None) -> None:
        """Tell which episodes will probably be asked for next, in this order."""
        self._ahead.foresee(self._foreseen(wanted, drift))

    def run(self, candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        """Run one episode of a candidate. Raises RepairError when it cannot be written into the source."""
        plan = EpisodePlan(seed, drift, self.source(candidate))
        return _outcome(lambda: self._ahead((candidate, seed, drift), plan), self.order.worst)

    def run_at(
        self, rollout: Rollout, worst: float, candidate: Candidate | None, seed: int, drift: str | None = None
    ) -> Outcome:
        """Run one episode of another test, of the node as it is without a candidate.

        `worst` is what a candidate earns that breaks that test.
        """
        plan = EpisodePlan(seed, drift, self.source(candidate) if candidate else {})
        return _outcome(lambda: rollout(plan), worst)

    def _foreseen(
        self, wanted: Iterable[Wanted], drift: str | None
    ) -> Iterator[tuple[tuple[Candidate, int, str | None], EpisodePlan]]:
        for candidate, seed in wanted:
            try:
                source = self.source(candidate)
            except RepairError:
                continue  # whoever asks for it will hear why
            yield (candidate, seed, drift), EpisodePlan(seed, drift, source)


def _check_text(ended: EpisodeRun) -> None:
    """Raise StaleTextError where an episode ran an older text than the candidate's."""
    if ended.older:
        names = ", ".join(path.name for path in ended.older)
        raise StaleTextError(
            f"{names}: a candidate was written into it, and the text of before ran all the same, so nothing can be "
            "said of its constants. Something outside of the node keeps what was imported from it: import it inside "
            "the test function, or not at all in tests, conftest.py and installed packages."
        )


def _outcome(run: Callable[[], EpisodeRun], worst: float) -> Outcome:
    """Run an episode with a candidate in the nodes and say what it earned.

    The test ran before, so whatever breaks it now (a node that fell silent, a reward that is no number) is the
    candidate's doing. Such an episode, or one that the node did not live to see the end of, earns as little as the
    worst one recorded: what it had until then says nothing.
    """
    try:
        ended = run()
        _check_text(ended)
        ended = sound(ended)
    except StaleTextError:
        raise
    except TarlError:
        return Outcome(worst, passed=False)
    total = float(ended.trace.reward.sum())
    return Outcome(min(total, worst) if ended.crashed else total, ended.passed, ended.judged)
