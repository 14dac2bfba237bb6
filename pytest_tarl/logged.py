"""`--tarl-log FILE`: missions that a robot has run, as the on-line side of a comparison."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pytest_tarl.errors import LogError
from pytest_tarl.formulas.declared import NOTHING_REQUIRED, Requirements
from pytest_tarl.formulas.judging import Judge as Judging
from pytest_tarl.formulas.judging import Judged
from pytest_tarl.formulas.parsing import Formula
from pytest_tarl.formulas.signals import NANOSECONDS
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.instrumentation.trace import Floats, Trace
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.observing.frames import Record, records
from pytest_tarl.observing.observer import unpacked
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending

FEWEST = 2  # missions that make a comparison
Judge = Callable[[Mapping[str, Any], Mapping[str, Any]], float]
_COLUMNS = {"site": "int32", "flow": "float64", "cell": "int32", "step": "int32", "thread": "int32"}


@dataclass
class Mission:
    """One mission as it is read."""

    sites: Sequence[str]
    chunks: list[Record] = field(default_factory=list)
    passed: bool = True
    failure: str = ""
    ended: bool = False
    changes: list[tuple[float, str, float]] = field(default_factory=list)  # of signals: seconds, name, value
    times: list[float] = field(default_factory=list)  # when steps were closed
    lasted: float | None = None  # seconds; None in a log without signals


def missions(path: Path, fixture: Fixture) -> list[Mission]:
    """Read all missions of a log, unfinished ones too. Raises LogError where it does not belong to the fixture."""
    found: list[Mission] = []
    sites: Sequence[str] = ()
    for record in records(path):
        kind = record["kind"]
        if kind == "start":
            sites = record["sites"]
            _check(record, path, fixture)
        elif kind == "mission":
            found.append(Mission(sites))
        elif kind == "steps" and found:
            found[-1].chunks.append(record)
            found[-1].changes += map(tuple, record.get("changes", ()))
            found[-1].times += record.get("times", ())
        elif kind == "end" and found:
            found[-1].passed, found[-1].failure, found[-1].ended = record["passed"], record["failure"], True
            found[-1].changes += map(tuple, record.get("changes", ()))
            found[-1].lasted = record.get("lasted")
    return found


class LoggedMissions:
    """A rollout that has happened: the n-th episode is the n-th finished mission of the log."""

    def __init__(
        self,
        whole: Sequence[Mission],
        traces: Sequence[Trace],
        topics: Mapping[str, str],
        notes: tuple[str, ...],
        judged: Sequence[_Judgement],
    ) -> None:
        self._whole = whole
        self._traces = traces
        self._topics = topics
        self._judged = judged
        self.count = len(whole)
        self.workers = 1
        self.notes = notes  # what is to be said about the rest

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Return the mission whose number is the plan's seed."""
        mission, found = self._whole[plan.seed], self._judged[plan.seed]
        return EpisodeRun(
            plan,
            self._traces[plan.seed],
            mission.passed and not found.violation,
            mission.failure or found.violation.partition("\n")[0],
            topics=self._topics,
            judged=found.judged,
        )

    def begin(self, plan: EpisodePlan) -> Pending:
        """Ask for a mission: it is there already."""
        return Deferred(self, plan)


def read_log(
    path: Path,
    fixture: Fixture,
    plan: Plan,
    judge: Judge | None,
    requirements: Requirements = NOTHING_REQUIRED,
) -> LoggedMissions:
    """Return the finished missions of a log as episodes. Raises LogError where they cannot be compared."""
    everything = missions(path, fixture)
    whole = [one for one in everything if one.ended and any(chunk["step_cell"] for chunk in one.chunks)]
    if len(whole) < FEWEST:
        raise LogError(
            f"{path} holds {len(whole)} finished missions with rewards; a comparison needs at least {FEWEST}. "
            "Tell missions apart with --mission-topic or --idle, and look whether the reward arrives."
        )
    number = {place.id: n for n, place in enumerate(plan.places)}
    known = _judgeable(whole, requirements)
    judged = [_judged_by(one, known, requirements) for one in whole]
    if requirements.rewarding:
        _check_rewarding(path, known, requirements)
    traces = [
        trace(one, number, fixture, judge, found.rewards) for one, found in zip(whole, judged, strict=True)
    ]
    notes = (*_notes(everything, whole, path), *_left_out(path, known, requirements))
    return LoggedMissions(whole, traces, fixture.topics, notes, judged)


@dataclass(frozen=True)
class _Judgement:
    """What formulas came to in a mission; `rewards` where the marker says that they give them."""

    judged: tuple[Judged, ...] = ()
    violation: str = ""
    rewards: Sequence[float] | None = None


def _judgeable(whole: Sequence[Mission], requirements: Requirements) -> tuple[Formula, ...]:
    """Return the formulas whose signals every mission of the log holds."""
    held = [{name for _, name, _ in one.changes} for one in whole if one.lasted]
    common = set.intersection(*held) if len(held) == len(whole) else set()
    return tuple(one for one in requirements.formulas if common.issuperset(one.signals))


def _judged_by(mission: Mission, known: Sequence[Formula], requirements: Requirements) -> _Judgement:
    """Judge a mission as an episode is, by the changes that the robot wrote down."""
    if not known or not mission.lasted:
        return _Judgement()
    judging = Judging(requirements.names, known)
    for time, name, value in mission.changes:
        if name in requirements.names:
            judging.give(name, value, round(time * NANOSECONDS))
    end = max(round(mission.lasted * NANOSECONDS), 1)
    judging.steps = [round(time * NANOSECONDS) for time in mission.times]
    judged = judging.conclude(end)
    rewards = judging.rewards(end, requirements.cap) if requirements.rewarding else None
    return _Judgement(judged, judging.violation(judged), rewards)


def _check_rewarding(path: Path, known: Sequence[Formula], requirements: Requirements) -> None:
    missing = next((one for one in requirements.formulas if one not in known), None)
    if missing is not None:
        raise LogError(
            f'{path} lacks signals of the formula {missing.text!r}, and reward="robustness" needs them all '
            f"({', '.join(missing.signals)}): give them a topic in the marker, record and observe again."
        )


def _left_out(path: Path, known: Sequence[Formula], requirements: Requirements) -> tuple[str, ...]:
    names = [repr(one.text) for one in requirements.formulas if one not in known]
    if not names:
        return ()
    return (
        (
            f"{path.name} does not hold all signals of {', '.join(names)}: not judged there. Signals with a topic are "
            "written down when the fixture was recorded with them."
        ),
    )


def trace(
    mission: Mission,
    number: Mapping[str, int],
    fixture: Fixture,
    judge: Judge | None,
    by_formulas: Sequence[float] | None = None,
) -> Trace:
    """Join a mission's chunks; sites that the node no longer has are left out."""
    here = np.array([number.get(site, -1) for site in mission.sites] or [-1], np.int32)
    cells = tuple(tuple(cell) for cell in mission.chunks[-1]["cells"])
    parts: list[dict[str, Any]] = []
    steps, rewards = [], []
    done = 0
    for chunk in mission.chunks:
        columns = {name: unpacked(chunk[name], kind) for name, kind in _COLUMNS.items()}
        columns["step"] = columns["step"] + done
        columns["site"] = here[columns["site"]]
        parts.append({name: column[columns["site"] >= 0] for name, column in columns.items()})
        steps.append(unpacked(chunk["step_cell"], "int32"))
        rewards.append(unpacked(chunk["reward"], "float64"))
        done += len(rewards[-1])
    joined = {name: np.concatenate([part[name] for part in parts]) for name in _COLUMNS}
    order = np.lexsort((joined["thread"], joined["step"]))
    joined = {name: column[order] for name, column in joined.items()}
    reward = np.concatenate(rewards)
    if by_formulas is not None and len(by_formulas) == len(reward):
        reward = np.array(by_formulas, np.float64)
    reward = _judged(reward, mission, fixture, judge)
    several = len(set(joined["thread"].tolist())) > 1
    return Trace(
        cells=cells,
        site=joined["site"],
        flow=joined["flow"],
        event_cell=joined["cell"],
        event_step=np.minimum(joined["step"], max(0, done - 1)).astype(np.int32),
        step_cell=np.concatenate(steps),
        reward=reward,
        parts={},
        thread=joined["thread"] if several else None,
    )


def _judged(reward: Floats, mission: Mission, fixture: Fixture, judge: Judge | None) -> Floats:
    """Return the rewards, those that the log leaves open computed from the sensors before and after the step."""
    if not np.isnan(reward).any():
        return reward
    if judge is None:
        raise LogError(
            "The log holds no rewards (it was written with --step): give the marker a function `judge=`, which is told "
            "the sensors' values before and after a step, two mappings, and returns the reward of the step."
        )
    names = [sensor.name for sensor in fixture.sensors]
    readings = [dict(zip(names, one, strict=True)) for chunk in mission.chunks for one in chunk["readings"]]
    for step in np.flatnonzero(np.isnan(reward)).tolist():
        amount = float(judge(readings[max(0, step - 1)], readings[step]))
        if not math.isfinite(amount):
            raise LogError(f"judge returned {amount}: rewards must be finite numbers.")
        reward[step] = amount
    return reward


def _check(start: Record, path: Path, fixture: Fixture) -> None:
    names = [sensor.name for sensor in fixture.sensors]
    if start["sensors"] != names:
        raise LogError(
            f"{path} was written with the sensors {', '.join(start['sensors'])}, the fixture of {fixture.test} has "
            f"{', '.join(names)}: observe again with that fixture, or name the log that belongs to it."
        )


def _notes(everything: Sequence[Mission], whole: Sequence[Mission], path: Path) -> tuple[str, ...]:
    notes = []
    left_out = len(everything) - len(whole)
    if left_out:
        which = "mission has" if left_out == 1 else "missions have"
        notes.append(f"{left_out} {which} no end or no reward in {path.name} and took no part.")
    dropped = max((chunk["dropped"] for one in whole for chunk in one.chunks), default=0)
    if dropped:
        notes.append(f"{dropped} events were dropped on the robot because its disk could not keep up.")
    return tuple(notes)
