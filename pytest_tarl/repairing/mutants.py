"""Write candidates into the source and run them as episodes of the test."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

from pytest_tarl.errors import RepairError, StaleTextError, TarlError
from pytest_tarl.model import Guard
from pytest_tarl.patching.crossed_limits import crosses
from pytest_tarl.patching.mutate import Mutation, analysed_document, is_integral, located, mutations
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.recording import sound
from pytest_tarl.repairing.request import Order
from pytest_tarl.rollout import Ahead, EpisodePlan, EpisodeRun, Rollout
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import Candidate, Wanted
from tarl_lint.model import Operand

ORIGINAL = Candidate((), Guard())  # the unrepaired program
MOST_KEPT = 128  # maximum number of candidates whose source is cached
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?")  # matches a number in the text of a failure


class Mutants:
    """Write candidates into the source and run them; workers may run them before they are requested."""

    def __init__(self, order: Order) -> None:
        self.order = order
        self._ahead = Ahead(order.rollout)
        self.texts: dict[str, str] = {}  # files that define constants but are outside the analysis
        self._sources: dict[Candidate, Mapping[Path, str]] = {}

    def mutate(self, operand: Operand, factor: float) -> Mutation | None:
        """Return the mutation of an operand by a factor; None if nothing changes or limits cross (see `crosses`)."""
        found = mutations(operand, factor, is_integral(self.order.analysis, operand))
        if found is None or not operand.literal or isinstance(found.value, bool):
            return found
        source = analysed_document(self.order.analysis, operand.span.path)
        return None if crosses(source, source.find(operand.span), float(found.value)) else found

    def source(self, candidate: Candidate) -> Mapping[Path, str]:
        """Return the text of every file that a candidate changes, by path. Raise RepairError."""
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
        """Read the files outside the analysis in which the candidate changes constants."""
        for mutation in map(located, candidate.mutations):
            path = mutation.place.path if mutation.place is not None else ""
            if path and path not in self.order.analysis.sources and path not in self.texts:
                self.texts[path] = (self.order.root / path).read_bytes().decode("utf-8")

    def foresee(self, wanted: Iterable[Wanted], drift: str | None) -> None:
        """Announce, in order, the episodes that are likely to be requested next."""
        self._ahead.foresee(self._foreseen(wanted, drift))

    def run(self, candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        """Run one episode of a candidate. Raise RepairError if the candidate cannot be written into the source."""
        plan = EpisodePlan(seed, drift, self.source(candidate), outputs=True)
        return _outcome(lambda: self._ahead((candidate, seed, drift), plan), self.order.worst)

    def run_at(
        self, rollout: Rollout, worst: float, candidate: Candidate | None, seed: int, drift: str | None = None
    ) -> Outcome:
        """Run one episode of another test with a candidate, or with the unrepaired program if `candidate` is None.

        `worst` is the total reward that counts if the candidate breaks the test. Raise RepairError.
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
                continue  # `run` meets the same error and raises it
            yield (candidate, seed, drift), EpisodePlan(seed, drift, source, outputs=True)


def _check_text(ended: EpisodeRun) -> None:
    """Raise StaleTextError if an episode ran older source than the candidate's."""
    if ended.older:
        names = ", ".join(path.name for path in ended.older)
        raise StaleTextError(
            f"{names}: the candidate was written into the file, but the episode ran the previous text, so the search "
            "cannot judge its constants. Something outside the node keeps objects imported from this file: import it "
            "inside the test function, and not in tests, conftest.py or installed packages."
        )


def _outcome(run: Callable[[], EpisodeRun], worst: float) -> Outcome:
    """Run an episode of a candidate and return its outcome. Raise StaleTextError.

    The unrepaired program ran in this test without an error, so the candidate causes any error now, such as a reward
    that is not a number. A node that publishes nothing is not an error: for example, a watchdog with a higher threshold
    may rightly stay silent in a mission, and the reward shows whether it should. After an error or a crash of the node,
    the reward so far is meaningless, so the total is at most that of the worst recorded episode.
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
    earned = min(total, worst) if ended.crashed else total
    rewards = tuple(ended.trace.reward.tolist())
    outputs = tuple((topic, tuple(sums)) for topic, sums in sorted(ended.outputs.items()))
    failure = "" if ended.passed or ended.crashed else _NUMBER.sub("0", ended.failure)
    return Outcome(earned, ended.passed, ended.judged, ended.trace.steps, rewards, outputs, failure)
