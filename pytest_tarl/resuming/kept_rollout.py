"""A rollout that keeps the episodes it runs, and reuses those kept by an interrupted run.

An episode is a function of its plan, so a kept episode can replace a run of the same plan. Equal plans are numbered,
because a recording runs its first episode twice.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial

from pytest_tarl.errors import RecordingError
from pytest_tarl.item_episode import Instruments
from pytest_tarl.recording import identical
from pytest_tarl.resuming.journal import Journal
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Pending, Rollout
from pytest_tarl.sensors import Sensor, stored
from pytest_tarl.workers import protocol


class KeptRollout:
    """Run only those episodes that are not in the journal; `shown` is the journal's path in messages."""

    def __init__(
        self, rollout: Rollout, journal: Journal, scope: bytes, shown: str, *, checked: bool = False
    ) -> None:
        self._rollout = rollout
        self._journal = journal
        self._scope = scope
        self._shown = shown
        self._begun: Counter[bytes] = Counter()
        self._checked = checked  # whether a kept episode was run again, with the same result

    @property
    def workers(self) -> int:
        """Return the number of parallel episodes."""
        return self._rollout.workers

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Return the episode, kept or run. Raise TarlError if the episode cannot run as planned."""
        return self.begin(plan).result()

    def begin(self, plan: EpisodePlan) -> Pending:
        """Request an episode. Raise RecordingError if the first kept episode gives another result when repeated."""
        key = episode_key(plan, self._scope)
        count = self._begun[key]
        self._begun[key] += 1
        kept = self._journal.taken(key, count)
        if kept is not None:
            run = protocol.answered(plan, kept)
            self._check(key, run)
            return _Kept(run)
        pending = self._rollout.begin(plan)
        pending.then(partial(self._keep, key))
        return _Begun(pending, partial(self._forget, key))

    def _keep(self, key: bytes, run: EpisodeRun) -> None:
        if not (run.broken or run.stuck or run.older):
            self._journal.keep(key, protocol.run_message(run))

    def _forget(self, key: bytes) -> None:
        self._begun[key] -= 1

    def _check(self, key: bytes, kept: EpisodeRun) -> None:
        """Run the first kept episode again, and keep the new result. Raise RecordingError if they differ."""
        if self._checked or kept.simulator:  # external simulators may give another result each time
            return
        self._checked = True
        again = self._rollout(kept.plan)
        if again.passed != kept.passed or not identical(again.trace, kept.trace):
            raise RecordingError(
                f"The run cannot be continued: its episode with seed {kept.plan.seed} now has another result. Either "
                "the episodes are not reproducible, or something changed that TARL does not check: a data file, a "
                f"library, the simulator. Undo the change, or delete {self._shown} to begin again."
            )
        self._keep(key, again)


@dataclass(frozen=True)
class _Kept:
    """An episode kept by an earlier run."""

    run: EpisodeRun

    def result(self) -> EpisodeRun:
        return self.run

    def cancel(self) -> bool:
        return True

    def then(self, call: Callable[[EpisodeRun], None]) -> None:
        call(self.run)


@dataclass(frozen=True)
class _Begun:
    """An episode of this run; `forget` is called if it is cancelled."""

    pending: Pending
    forget: Callable[[], None]

    def result(self) -> EpisodeRun:
        return self.pending.result()

    def cancel(self) -> bool:
        cancelled = self.pending.cancel()
        if cancelled:
            self.forget()
        return cancelled

    def then(self, call: Callable[[EpisodeRun], None]) -> None:
        self.pending.then(call)


def scope_of(instruments: Instruments, sensors: tuple[Sensor, ...]) -> bytes:
    """Return a digest of the sites, publishers and sensors that a rollout observes."""
    positions = {
        str(path): sorted([*place, number] for place, number in places.items())
        for path, places in sorted(instruments.positions.items())
    }
    observed = [positions, sorted(instruments.publishes), [asdict(stored(sensor)) for sensor in sensors]]
    return hashlib.sha256(json.dumps(observed, sort_keys=True).encode()).digest()


def episode_key(plan: EpisodePlan, scope: bytes) -> bytes:
    """Return the key of a plan in the journal, 32 bytes."""
    return hashlib.sha256(scope + protocol.plan_message(plan)).digest()
