"""The interface for running episodes: plans, results, and rollouts, which run plans."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from pytest_tarl.formulas.judging import Judged
from pytest_tarl.instrumentation.trace import Trace

AHEAD = 2  # episodes per worker that are started before their results are requested
# started episodes per worker that are kept, although other episodes are requested first
KEPT = 6


@dataclass(frozen=True)
class EpisodePlan:
    """A planned run of a test. `overlay` maps files to replacement texts; with `record`, nodes are instrumented.

    With `outputs`, the messages published by nodes are summed. With `signed`, which needs `record`, the trace has
    numbers with their signs instead of flow values.

    With a `bag`, its mission replaces the test's world. If `drift` is a space, `point` is a point of it; without
    `point`, the seed determines a random one.
    """

    seed: int
    drift: str | None = None
    overlay: Mapping[Path, str] = field(default_factory=dict)
    record: bool = False
    bag: Path | None = None
    point: Mapping[str, float] | None = None
    outputs: bool = False
    signed: bool = False


@dataclass(frozen=True)
class EpisodeRun:
    """The result of an episode. `failure` says in one line why the test failed; `topics` maps topics to types.

    `crashed` is true if the node ended the episode early; `stuck` is also true if this was because it never waited.
    `notes` are for the user. `values` has the values of sensors whose bins are learned. `judged` has the results of
    formulas.

    `older` lists the files of the overlay whose old text was run. If there are any, the result says nothing about the
    overlay.

    `outputs` has sums over the messages published by nodes, by topic, if the plan asks for them and the nodes run in
    this process.

    `parameters` has the numbers that nodes in this process got as parameters from outside (such as launch files or the
    test), by absolute name.

    `silent` says which sensor or node was silent in the whole episode, in a world without drift. It is an error only if
    this is so in all missions.

    `simulator` is true if an external simulator was the world. Repeating the same plan may then give another result.

    If the simulator died or hung, the episode was repeated; the result is that of the last run. `lost` has a brief
    reason for each lost simulator.

    `broken` is the text of an error outside the mission, such as one in the test's own code.
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
    simulator: bool = False
    outputs: Mapping[str, Sequence[float]] = field(default_factory=dict)
    lost: tuple[str, ...] = ()
    parameters: Mapping[str, bool | int | float] = field(default_factory=dict)
    silent: str = ""


class Pending(Protocol):
    """A requested episode."""

    def result(self) -> EpisodeRun:
        """Wait for the result and return it. Raise TarlError if the episode could not run."""

    def cancel(self) -> bool:
        """Cancel the episode if it has not started; return whether it was cancelled."""

    def then(self, call: Callable[[EpisodeRun], None]) -> None:
        """Call a function with the result, perhaps in another thread; after an error, it is not called."""


class Rollout(Protocol):
    """Run episodes of a test, `workers` of them in parallel."""

    @property
    def workers(self) -> int:
        """Return the number of parallel episodes."""

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode. Raise TarlError if the test cannot run as planned."""

    def begin(self, plan: EpisodePlan) -> Pending:
        """Request an episode without waiting for it."""


@dataclass(frozen=True)
class Deferred:
    """An episode that runs when its result is requested."""

    rollout: Rollout
    plan: EpisodePlan
    _calls: list[Callable[[EpisodeRun], None]] = field(default_factory=list, repr=False, compare=False)

    def result(self) -> EpisodeRun:
        """Run the episode and return its result."""
        run = self.rollout(self.plan)
        for call in self._calls:
            call(run)
        return run

    def then(self, call: Callable[[EpisodeRun], None]) -> None:
        """Call a function with the result once the episode has run."""
        self._calls.append(call)

    def cancel(self) -> bool:
        """Return True: the episode has not started and will not run."""
        return True


def in_order(rollout: Rollout, plans: Iterable[EpisodePlan]) -> Iterator[Pending]:
    """Yield the episodes in the order of their plans; start enough of them early to keep all workers busy.

    The result does not depend on the number of workers. A caller that stops early wastes only the episodes that have
    been started.
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
    """Start the episodes that a search will probably request, so that workers stay busy while it evaluates a result.

    This is only prefetching: an episode has the same result whether or not it was started early, and one that is never
    requested only takes time. Keys identify episodes.
    """

    def __init__(self, rollout: Rollout) -> None:
        self.rollout = rollout
        self._foreseen: Iterator[tuple[Hashable, EpisodePlan]] = iter(())
        self._begun: dict[Hashable, Pending] = {}
        # keys of the episodes started since the last forecast and not requested yet
        self._lately: set[Hashable] = set()

    def foresee(self, wanted: Iterable[tuple[Hashable, EpisodePlan]]) -> None:
        """Set the new forecast: the episodes that will probably be requested next, in this order."""
        if self.rollout.workers > 1:
            self._foreseen, self._lately = iter(wanted), set()
            self._begin()

    def __call__(self, key: Hashable, plan: EpisodePlan) -> EpisodeRun:
        """Run an episode, or wait for it if it has started. Raise TarlError if it cannot run."""
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
