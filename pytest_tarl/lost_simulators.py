"""Count the episodes whose external simulator was lost, and report why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from pytest_tarl.item_episode import Instruments
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Pending, Rollout
from pytest_tarl.sensors import Sensor

SHOWN = 3  # maximum number of reasons in the note

RolloutWith = Callable[[Instruments, tuple[Sensor, ...]], Rollout]


class LostSimulators:
    """How many episodes of a test have run, and why some of them had to run again."""

    def __init__(self) -> None:
        self._episodes: list[tuple[str, ...]] = []

    def watched(self, rollout_with: RolloutWith) -> RolloutWith:
        """Return a function that makes the same rollouts as `rollout_with`, and counts their episodes."""
        return lambda instruments, sensors: _Watched(rollout_with(instruments, sensors), self.count)

    def count(self, run: EpisodeRun) -> None:
        """Count an episode; any thread may call this."""
        self._episodes.append(run.lost)

    def notes(self) -> tuple[str, ...]:
        """Return a note if simulators were lost, with the most frequent reasons first; otherwise nothing."""
        lost = [reasons for reasons in self._episodes if reasons]
        if not lost:
            return ()
        counted = Counter(reason for reasons in lost for reason in reasons)
        ordered = sorted(counted.items(), key=lambda item: (-item[1], item[0]))
        told = "; ".join(f"{count} × {reason}" for reason, count in ordered[:SHOWN])
        more = f"; and {len(ordered) - SHOWN} more" if len(ordered) > SHOWN else ""
        whose, were = ("its simulator", "was") if len(lost) == 1 else ("their simulator", "were")
        note = (
            f"{len(lost)} of {len(self._episodes)} episodes lost {whose} and {were} run again with a new one: "
            f"{told}{more}."
        )
        return (note,)


@dataclass(frozen=True)
class _Watched:
    """A rollout that passes each episode's result to `seen`."""

    rollout: Rollout
    seen: Callable[[EpisodeRun], None]

    @property
    def workers(self) -> int:
        return self.rollout.workers

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        run = self.rollout(plan)
        self.seen(run)
        return run

    def begin(self, plan: EpisodePlan) -> Pending:
        pending = self.rollout.begin(plan)
        pending.then(self.seen)
        return pending
