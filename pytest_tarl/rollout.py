"""Episodes as the stages above ask for them: what to run, and what came of it."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from pytest_tarl.formulas.judging import Judged
from pytest_tarl.instrumentation.trace import Trace

AHEAD = 2  # episodes per worker that are begun before anybody asks for them
KEPT = 6  # and that are kept though something else was asked for


@dataclass(frozen=True)
class EpisodePlan:
    """One run of the designated test. `overlay` replaces the text of files; `record` instruments the nodes.

    With a `bag` the mission that it holds takes the place of the test's own world.
    """

    seed: int
    drift: str | None = None
    overlay: Mapping[Path, str] = field(default_factory=dict)
    record: bool = False
    bag: Path | None = None


@dataclass(frozen=True)
class EpisodeRun:
    """What came of it. `failure` says why the test failed, one line; `topics` are message types by sensor topic.

    `crashed` tells that the node ended it before its time, `stuck` that it did so by never waiting. `notes` are
    what else the user should hear. `values` is what sensors read whose bins are yet to be learned. `judged` tells of
    formulas.

    `older` are files of the overlay whose text of before ran all the same: nothing can be learned of the overlay.

    `broken` holds what is neither a pass nor a failed mission, such as an error in the test's own code, as text.
    """

    plan: EpisodePlan
    trace: Trace
    passed: bool
    failure: str = ""
    broken: str = ""
    topics: Mapping[str, str] = field(default_factory=dict)
    crashed: bool = False
    stuck: bool = False
    notes: tuple[str, ...] = ()
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    judged: tuple[Judged, ...] = ()
    older: tuple[Path, ...] = ()


class Pending(Protocol):
    """An episode that was asked for."""

    def result(self) -> EpisodeRun:
        """Return what came of it, when it has been run. Raises TarlError where it could not be."""

    def cancel(self) -> bool:
        """Do without it; tell whether it will not be run."""


class Rollout(Protocol):
    """Runs episodes of one test, `workers` at a time."""

    @property
    def workers(self) -> int:
        """Return how many episodes run at a time."""

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode. Raises TarlError where the test cannot be run as asked."""

    def begin(self, plan: EpisodePlan) -> Pending:
        """Ask for an episode without waiting for it."""


@dataclass(frozen=True)
class Deferred:
    """An episode that is run when its result is asked for."""

    rollout: Rollout
    plan: EpisodePlan

    def result(self) -> EpisodeRun:
        """Run it."""
        return self.rollout(self.plan)

    def cancel(self) -> bool:
        """Do without it."""
        return True


def in_order(rollout: Rollout, plans: Iterable[EpisodePlan]) -> Iterator[Pending]:
    """Yield the episodes in the order of their plans, with as many begun ahead as keep the workers busy.

    What is yielded does not depend on how many workers there are; whoever stops early wastes at most what was ahead.
    """
    ahead = AHEAD * rollout.workers if rollout.workers > 1 else 0
    begun: deque[Pending] = deque()
    try:
        for plan in plans:
            begun.append(rollout.begin(plan))
            if len(begun) > ahead:
                yield begun.popleft()
        while begun:
            yield begun.popleft()
    finally:
        for one in begun:
            one.cancel()


class Ahead:
    """Begins episodes that are foreseen, so that workers are busy while one result is looked at.

    What is run for whom does not depend on it: an episode that is asked for is the same, begun before or not, and one
    that is never asked for leaves no trace but the time it took. Keys tell episodes apart.
    """

    def __init__(self, rollout: Rollout) -> None:
        self.rollout = rollout
        self._foreseen: Iterator[tuple[Hashable, EpisodePlan]] = iter(())
        self._begun: dict[Hashable, Pending] = {}
        self._lately: set[Hashable] = set()  # begun since something was foreseen, and not asked for yet

    def foresee(self, wanted: Iterable[tuple[Hashable, EpisodePlan]]) -> None:
        """Tell what will probably be asked for next, in this order, in place of what was told before."""
        if self.rollout.workers > 1:
            self._foreseen, self._lately = iter(wanted), set()
            self._begin()

    def __call__(self, key: Hashable, plan: EpisodePlan) -> EpisodeRun:
        """Run an episode, or wait for it where it was begun. Raises TarlError where it cannot be run."""
        pending = self._begun.pop(key, None) or self.rollout.begin(plan)
        self._lately.discard(key)
        self._begin()
        return pending.result()

    def _begin(self) -> None:
        while len(self._lately) < AHEAD * self.rollout.workers:
            following = next(self._foreseen, None)
            if following is None:
                break
            key, plan = following
            if key not in self._begun:
                self._begun[key] = self.rollout.begin(plan)
            self._lately.add(key)
        for key in [key for key in self._begun if key not in self._lately]:
            if len(self._begun) <= KEPT * self.rollout.workers:
                break
            self._begun.pop(key).cancel()
