"""`--tarl-log FILE`: compare a robot's logged missions with the recording of a test."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from pytest_tarl.errors import LogError
from pytest_tarl.formulas.lookback import Followed, LookedBack, judgeable, left_out, looked_back
from pytest_tarl.formulas.marker_arguments import NOTHING_REQUIRED, Requirements
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.instrumentation.trace import Floats, Trace
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.observing.log_format import Record, records, set_aside
from pytest_tarl.observing.writer import unpacked
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.sensors import binning_digest

FEWEST = 2  # minimum number of missions for a comparison
Judge = Callable[[Mapping[str, Any], Mapping[str, Any]], float]
_COLUMNS = {"site": "int32", "flow": "float64", "cell": "int32", "step": "int32", "thread": "int32"}


@dataclass
class Mission:
    """A logged mission, as chunks of consecutive steps; `time` is its start in seconds since 1970."""

    sites: Sequence[str]
    time: float = 0.0
    chunks: list[Record] = field(default_factory=list)
    passed: bool = True
    failure: str = ""
    ended: bool = False
    followed: Followed = field(default_factory=Followed)


def missions(path: Path, fixture: Fixture) -> list[Mission]:
    """Read all missions, including unfinished ones, from a log and its rotated files.

    Raise LogError if the log does not fit the recording.
    """
    found: list[Mission] = []
    sites: Sequence[str] = ()
    for record in chain.from_iterable(map(records, (*set_aside(path), path))):
        kind = record["kind"]
        if kind == "start":
            sites = record["sites"]
            _check(record, path, fixture)
        elif kind == "mission":
            found.append(Mission(sites, record["time"]))
        elif kind == "steps" and found:
            found[-1].chunks.append(record)
            found[-1].followed.add(record)
        elif kind == "end" and found:
            found[-1].passed, found[-1].failure, found[-1].ended = record["passed"], record["failure"], True
            found[-1].followed.add(record)
    return found


class LoggedMissions:
    """A rollout that returns logged missions: episode n is the log's n-th finished mission."""

    def __init__(
        self,
        whole: Sequence[Mission],
        traces: Sequence[Trace],
        topics: Mapping[str, str],
        notes: tuple[str, ...],
        judged: Sequence[LookedBack],
    ) -> None:
        self._whole = whole
        self._traces = traces
        self._topics = topics
        self._judged = judged
        self.count = len(whole)
        self.workers = 1
        self.notes = notes  # names the skipped missions

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Return the mission whose index is the plan's seed."""
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
        """Return a mission as an episode that has already run."""
        return Deferred(self, plan)


def read_log(
    path: Path,
    fixture: Fixture,
    plan: Plan,
    judge: Judge | None,
    requirements: Requirements = NOTHING_REQUIRED,
) -> LoggedMissions:
    """Return a log's finished missions as episodes. Raise LogError if they cannot be compared."""
    everything = missions(path, fixture)
    whole = [one for one in everything if one.ended and any(chunk["step_cell"] for chunk in one.chunks)]
    if len(whole) < FEWEST:
        raise LogError(
            f"{path} holds {len(whole)} finished missions with rewards; a comparison needs at least {FEWEST}. "
            "Separate the missions with --mission-topic or --idle, and check that the reward arrives."
        )
    number = {place.id: n for n, place in enumerate(plan.places)}
    followed = [one.followed for one in whole]
    known = judgeable(followed, requirements)
    judged = [looked_back(one, known, requirements) for one in followed]
    notes = (*_notes(everything, whole, path), *left_out(path.name, known, requirements))
    traces = [
        trace(one, number, fixture, judge, found.rewards) for one, found in zip(whole, judged, strict=True)
    ]
    return LoggedMissions(whole, traces, fixture.topics, notes, judged)


def trace(
    mission: Mission,
    number: Mapping[str, int],
    fixture: Fixture,
    judge: Judge | None,
    by_formulas: Sequence[float] | None = None,
) -> Trace:
    """Join a mission's chunks into a trace, without events of sites that the node no longer has."""
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
    """Return the rewards, shape (steps,).

    If the log has no rewards, compute them from the sensors before and after each step.
    """
    if not np.isnan(reward).any():
        return reward
    if judge is None:
        raise LogError(
            "The log holds no rewards (it was written with --step): give the marker a function `judge=` that takes "
            "two mappings, the sensors' values before and after a step, and returns the reward of the step."
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
            f"{path} was written with the sensors {', '.join(start['sensors'])}, but the recording of {fixture.test} "
            "has "
            f"{', '.join(names)}: observe again with that recording, or name the log that belongs to it."
        )
    if start.get("test", fixture.test) != fixture.test:
        raise LogError(
            f"{path} was written for the recording of {start['test']}, not of {fixture.test}: name the recording that "
            "it belongs to."
        )
    if start.get("bins", digest := binning_digest(fixture.sensors)) != digest:
        raise LogError(
            f"{path} was written when the sensors of {fixture.test} had other bins, so its cells cannot be compared: "
            "observe again with the current recording."
        )


def _notes(everything: Sequence[Mission], whole: Sequence[Mission], path: Path) -> tuple[str, ...]:
    notes = []
    left_out = len(everything) - len(whole)
    if left_out:
        which = "mission has" if left_out == 1 else "missions have"
        notes.append(f"{left_out} {which} no end or no reward in {path.name}: skipped.")
    dropped = max((chunk["dropped"] for one in whole for chunk in one.chunks), default=0)
    if dropped:
        notes.append(f"{dropped} events were dropped on the robot because its disk could not keep up.")
    return tuple(notes)
