"""Check whether a finished episode is usable, and what to tell the user about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pytest_tarl.errors import RecordingError, SettingsError, TarlError
from pytest_tarl.faults.installing import Faults
from pytest_tarl.formulas.marker_arguments import Requirements
from pytest_tarl.situation import Situation

if TYPE_CHECKING:
    from pytest_tarl.bags.replay import Replay
    from pytest_tarl.instrumentation.sites import Position
    from pytest_tarl.ros import Ros


@dataclass(frozen=True)
class EndedEpisode:
    """What is left of an episode when it ends."""

    rewards: int  # number of steps with a reward
    requirements: Requirements
    situation: Situation
    faults: Faults
    # whether a drift or a fault is active; it is then not an error if nodes publish nothing
    drifted: bool
    # whether a repair candidate runs; with a good one, a watchdog node may have nothing to publish
    changed: bool
    ros: Ros | None  # the ROS of the episode; None if the test did not use ROS
    drives_ros: bool  # whether nodes were started
    replay: Replay | None  # the recorded mission, if the episode replays one
    unrecorded: Mapping[Path, tuple[Position, ...]]  # by file, the statements that cannot be recorded

    def notes(self) -> tuple[str, ...]:
        """Return notes for the user on a usable episode; complete only after `close`."""
        late = self.ros.shutdown_errors if self.ros is not None else ()
        ended = [f"{error} The node was being shut down, so the episode still counts." for error in late]
        missing = [
            f"cannot record {path.name}:{', '.join(map(str, sorted({line for line, _ in positions})))}: "
            "slices of these lines stay empty."
            for path, positions in self.unrecorded.items()
        ]
        started = self.ros.notes if self.ros is not None else ()
        replayed = self.replay.notes if self.replay is not None else ()
        return (*ended, *missing, *started, *replayed, *self._silence())

    def _silence(self) -> tuple[str, ...]:
        """Return a note if a drift of the world, rather than a declared fault, kept the nodes silent."""
        if not self.drifted or self.faults.active or not self._silent:
            return ()
        told = (
            "The node published nothing in a whole episode of this drift. If the drift should not silence it, check "
            f"that it receives the messages that it waits for (it subscribes to {self._heard})."
        )
        return (told,)

    def problem(self) -> TarlError | None:
        """Return why the episode is unusable (such as a test without rewards), or None if it is usable."""
        if self.replay is not None:
            return self._unplayed(self.replay)
        if not self.rewards and self.requirements.rewarding:
            return RecordingError(
                'The test never called tarl.step, so there is no step to reward: reward="robustness" rewards '
                "steps of virtual time."
            )
        if not self.rewards:
            return RecordingError(
                "The test never called tarl.reward: call it once in each simulation step, for example "
                "tarl.reward(world.monitor())."
            )
        if self.drifted:
            return None  # not an error, because a drift may silence sensors and nodes
        return self._unmet()

    def silence(self) -> str:
        """Return which sensor or node was silent in the whole episode and what to check, or an empty text.

        A mission without messages is no error if other missions have some: a door may stay closed, or a battery may
        stay full. Drifts and repair candidates may silence a node in all missions.
        """
        if self.replay is not None or self.drifted:
            return ""
        problem = self.situation.problem()
        if problem is not None:
            return str(problem)
        if not self._silent or self.changed:
            return ""
        return (
            "The node published nothing in the whole episode, so nothing can be learned: check that it receives the "
            f"messages that it waits for (it subscribes to {self._heard})."
        )

    @property
    def _silent(self) -> bool:
        """Return whether nodes ran, published nothing and called no service."""
        return self.drives_ros and self.ros is not None and self.ros.silent

    @property
    def _heard(self) -> str:
        """Return the topics that nodes subscribe to."""
        return ", ".join(sorted(self.ros.subscribed if self.ros is not None else ())) or "no topic"

    def _unmet(self) -> SettingsError | None:
        """Return the error for a declared fault whose topic or node did not occur, or None."""
        if self.ros is None:
            return None
        try:
            self.faults.check(self.ros)
        except SettingsError as problem:
            return problem
        return None

    def _unplayed(self, replay: Replay) -> RecordingError | None:
        """Return why nothing can be learned from a bag's replay, or None."""
        name = replay.bag.path.name
        if not replay.begun:
            return RecordingError(
                f"{name} was not replayed: the test ended before its first tarl.step, where the replay begins. Only "
                "nodes that run through tarl.start and tarl.step receive the messages of a bag."
            )
        if not self.rewards:
            return RecordingError(
                f"Nothing was learned from {name}: no step ended with a value for every sensor."
            )
        return None
