"""`--tarl-bag FILE`: compare recorded missions with the recording of a test."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pytest_tarl.bags.reading import Bag, opened
from pytest_tarl.bags.replay import NO_REWARDS
from pytest_tarl.designation import Designation
from pytest_tarl.errors import LogError, SettingsError
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.options import Options
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Pending, Rollout
from pytest_tarl.ros.names import absolute
from pytest_tarl.seeds import episode_seeds


@dataclass(frozen=True)
class BaggedMissions:
    """A rollout that replays bags instead of running the test's world; `bags` maps seeds to bags."""

    rollout: Rollout
    bags: Mapping[int, Path]
    notes: tuple[str, ...] = ()  # one note per skipped bag, with the reason

    @property
    def workers(self) -> int:
        """Return the number of missions replayed in parallel."""
        return self.rollout.workers

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Replay one mission."""
        return self.rollout(replace(plan, bag=self.bags[plan.seed]))

    def begin(self, plan: EpisodePlan) -> Pending:
        """Start replaying a mission, without waiting for the result."""
        return self.rollout.begin(replace(plan, bag=self.bags[plan.seed]))


def bagged(rollout: Rollout, fixture: Fixture, designation: Designation, options: Options) -> BaggedMissions:
    """Return a rollout of all bags that can be compared.

    Raise LogError if no bag can be compared, and SettingsError if the test cannot judge bags.
    """
    check(designation)
    taking_part: list[Path] = []
    notes: list[str] = []
    for path in options.bags:
        if not path.exists():
            raise LogError(f"{path}: no such bag.")
        try:
            problem = misfit(opened(path), fixture)
        except LogError as unreadable:
            problem = str(unreadable).rstrip(".")
        if problem:
            notes.append(f"{problem}: bag skipped.")
        else:
            taking_part.append(path)
    if not taking_part:
        raise LogError("No bag can be compared with the recording. " + " ".join(notes))
    seeds = episode_seeds(options.seed, "bag", len(taking_part))
    return BaggedMissions(rollout, dict(zip(seeds, taking_part, strict=True)), tuple(notes))


def misfit(bag: Bag, fixture: Fixture) -> str:
    """Return why a bag cannot be compared, without a full stop; empty if it can be."""
    held = {absolute(topic): one for topic, one in bag.channels.items()}
    for sensor in fixture.sensors:
        if sensor.topic is None:
            continue
        channel = held.get(absolute(sensor.topic))
        if channel is None:
            return (
                f"{bag.path.name} has no messages on {sensor.topic}, the topic of sensor {sensor.name!r} (it holds "
                f"{_listed(sorted(held))})"
            )
        designed = fixture.topics.get(sensor.topic, "")
        if designed and designed != channel.type:
            return (
                f"{bag.path.name} has {channel.type} on {sensor.topic}, but sensor {sensor.name!r} reads "
                f"{designed}"
            )
    return ""


def check(designation: Designation) -> None:
    """Raise SettingsError if a test cannot judge bags."""
    judged = designation.monitor is not None or designation.judge is not None
    if not judged and not designation.requirements.rewarding:
        raise SettingsError(NO_REWARDS)
    mute = next((sensor.name for sensor in designation.sensors if sensor.topic is None), None)
    if mute is not None:
        raise SettingsError(
            f"Sensor {mute!r} has no topic, so no bag contains its values: give it a topic and a field in the "
            "marker and "
            "record again."
        )


def _listed(topics: Sequence[str], most: int = 8) -> str:
    more = f" and {len(topics) - most} more" if len(topics) > most else ""
    return ", ".join(topics[:most]) + more
