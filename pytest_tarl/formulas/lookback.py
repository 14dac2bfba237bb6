"""Evaluate formulas for finished missions, from the signal changes in a log."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pytest_tarl.errors import LogError
from pytest_tarl.formulas.judging import Judge, Judged
from pytest_tarl.formulas.marker_arguments import Requirements
from pytest_tarl.formulas.parsing import Formula
from pytest_tarl.formulas.signals import NANOSECONDS


@dataclass
class Followed:
    """The signals of a mission, collected from its log records; times are in seconds since its start."""

    changes: list[tuple[float, str, float]] = field(default_factory=list)  # (time, name, new value)
    times: list[float] = field(default_factory=list)  # end of each step
    lasted: float | None = None  # length of the mission; None if the log has no signals

    def add(self, record: Mapping[str, Any]) -> None:
        """Add the signals in a record."""
        self.changes += map(tuple, record.get("changes", ()))
        self.times += record.get("times", ())
        self.lasted = record.get("lasted", self.lasted)


@dataclass(frozen=True)
class LookedBack:
    """The results of a mission's formulas; `rewards` is set only if the marker has reward="robustness"."""

    judged: tuple[Judged, ...] = ()
    violation: str = ""
    rewards: Sequence[float] | None = None


def judgeable(missions: Sequence[Followed], requirements: Requirements) -> tuple[Formula, ...]:
    """Return the formulas whose signals are in the log of every mission.

    Raise LogError if robustness gives the rewards and a formula's signal is missing.
    """
    held = [{name for _, name, _ in one.changes} for one in missions if one.lasted]
    common = set.intersection(*held) if held and len(held) == len(missions) else set()
    known = tuple(one for one in requirements.formulas if common.issuperset(one.signals))
    missing = next((one for one in requirements.formulas if one not in known), None)
    if missing is not None and requirements.rewarding:
        raise LogError(
            f'The log lacks signals of the formula {missing.text!r}, and reward="robustness" needs them all '
            f"({', '.join(missing.signals)}): give them a topic in the marker, record and observe again."
        )
    return known


def looked_back(mission: Followed, known: Sequence[Formula], requirements: Requirements) -> LookedBack:
    """Evaluate a mission's formulas as if it were an episode."""
    if not known or not mission.lasted:
        return LookedBack()
    judge = Judge(requirements.names, known)
    for time, name, value in mission.changes:
        if name in requirements.names:
            judge.give(name, value, round(time * NANOSECONDS))
    end = max(round(mission.lasted * NANOSECONDS), 1)
    judge.steps = [round(time * NANOSECONDS) for time in mission.times]
    judged = judge.conclude(end)
    rewards = judge.rewards(end, requirements.cap) if requirements.rewarding else None
    return LookedBack(judged, judge.violation(judged), rewards)


def left_out(log: str, known: Sequence[Formula], requirements: Requirements) -> tuple[str, ...]:
    """Name the signals missing from a log, and the formulas that therefore cannot be judged."""
    names = [repr(one.text) for one in requirements.formulas if one not in known]
    if not names:
        return ()
    return (
        (
            f"{log} lacks signals of {', '.join(names)}, which is not judged. Declare topics "
            "for these signals on the marker, record, and observe again."
        ),
    )
