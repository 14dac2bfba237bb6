"""`tarl fleet`: judge the missions of a data set, by group and by robot."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field, replace
from datetime import date
from pathlib import Path

from pytest_tarl.errors import FleetError, SettingsError
from pytest_tarl.fleet import (
    changed_robots,
    clusters,
    dataset,
    decomposition,
    group_onsets,
    mission_groups,
    repairs,
)
from pytest_tarl.fleet.dask_tasks import Engine, cluster, local
from pytest_tarl.fleet.data_folder import Store, store
from pytest_tarl.fleet.database import BY, Database, Filter, opened
from pytest_tarl.fleet.dataset import Part
from pytest_tarl.fleet.schema import Origin, origin, repair_path
from pytest_tarl.fleet.scores import scored
from pytest_tarl.learning.fixture import Fixture, load, parsed
from pytest_tarl.monitoring.monitor import begun
from pytest_tarl.sensors import Cell

LOWEST = 10  # number of missions to list when only one robot is selected


@dataclass(frozen=True)
class Question:
    """The arguments of the command line."""

    data: str
    fixture: Path | None = None
    by: tuple[str, ...] = ("version", "site")
    since: date | None = None
    robot: str = ""
    alpha: float = 0.05
    tolerance: float | None = None
    cluster: str = ""  # address of a Dask scheduler; empty to use threads of this process
    workers: int = 1  # number of threads of this process, if there is no cluster


@dataclass(frozen=True)
class Mission:
    """A mission of one robot; `time` is in seconds since 1970."""

    time: float
    passed: bool
    total: float
    steps: int


@dataclass(frozen=True)
class Answer:
    """The answer from a data set; `left_out` counts the missions that cannot be compared."""

    question: Question
    fixture: Fixture
    missions: int
    copies: int  # number of duplicate rows that were ignored
    cells: tuple[Cell, ...]
    groups: tuple[mission_groups.Group, ...]
    onsets: changed_robots.Robots  # for each robot, the evidence of a change and when it began
    robots: changed_robots.Robots
    parts: decomposition.Decomposition | None  # None if there is only one robot
    clusters: clusters.Clusters
    repairs: tuple[repairs.Effect, ...]
    left_out: Mapping[str, int]
    accepted: Mapping[str, str] = field(default_factory=dict)  # repair → drift for which it was accepted
    # starts of the first and last mission; 0 if no start is known
    period: tuple[float, float] = (0.0, 0.0)
    lowest: tuple[Mission, ...] = ()  # the selected robot's missions with the lowest totals

    def meets(self, rule: str) -> bool:
        """Return whether the answer meets a rule of --fail-if."""
        results = {one.verdict.result for one in self.groups if one.verdict is not None}
        return {
            "degraded": "degraded" in results,
            "drifted": bool(results & {"degraded", "drifted"}),
            "changed": bool(self.onsets.drifted or self.onsets.below),
            "robot": bool(self.robots.drifted or self.robots.below),
        }[rule]


def answer(question: Question) -> Answer:
    """Judge the selected missions. Raise FleetError, FixtureError or SettingsError if there are none."""
    _check(question)
    where = store(question.data)
    parts = dataset.parts(where)
    if not parts:
        raise FleetError(
            f"{where.shown('')} holds no missions: add some with `tarl ingest LOG --to {question.data}`."
        )
    fixture, own = _recording(question, where, parts)
    fitting = [part for part in parts if part.origin.fits(own)]
    if not fitting:
        raise FleetError(
            f"{where.shown('')} holds no mission that fits the recording of {fixture.test}: "
            f"{'; '.join(_left_out(parts, own))}. Use --fixture FILE to name "
            "the recording that `tarl observe` used on the robots."
        )
    which = Filter(question.robot, question.since)
    with opened(where, fitting, question.by, which) as database:
        if not database.missions:
            raise FleetError(_nothing(where, question))
        with _engine(question) as engine:
            found = _judged(database, where, fixture, question, _left_out(parts, own), engine)
    return replace(found, accepted=_accepted(where, found.repairs))


def _accepted(where: Store, effects: Sequence[repairs.Effect]) -> dict[str, str]:
    """Return the drift for which each repair was accepted, where known."""
    found = {}
    for repair in sorted({one.repair for one in effects}):
        path = repair_path(repair)
        if where.holds(path):
            # the file may come from another program and have other content
            with suppress(ValueError, AttributeError):
                found[repair] = str(json.loads(where.read(path)).get("drift", ""))
    return {repair: drift for repair, drift in found.items() if drift}


def _engine(question: Question) -> AbstractContextManager[Engine]:
    return cluster(question.cluster) if question.cluster else local(question.workers)


def _judged(
    database: Database,
    where: Store,
    fixture: Fixture,
    question: Question,
    left_out: Mapping[str, int],
    engine: Engine,
) -> Answer:
    alpha, one = question.alpha, bool(question.robot)
    first = begun(fixture, alpha=alpha, seed=0)
    every_score = scored(database, where, first.scale, engine)
    cells = (*fixture.sample.cells, *every_score.others)
    every = changed_robots.judged(database, first, every_score, engine, alpha)
    found = mission_groups.judged(
        database,
        where,
        fixture,
        cells,
        question.by,
        engine,
        alpha=alpha,
        tolerance=question.tolerance,
    )
    return Answer(
        question=question,
        fixture=fixture,
        missions=database.missions,
        copies=int(database.names("SELECT sum(copies - 1) FROM missions")[0][0]),
        cells=cells,
        groups=found,
        onsets=group_onsets.judged(database, first, every_score, engine, found, alpha),
        robots=every,
        parts=None if one else decomposition.decomposed(database),
        clusters=clusters.clustered(database, where, engine, fixture, every, alpha),
        repairs=repairs.effects(database, question.by),
        left_out=left_out,
        period=_period(database),
        lowest=_lowest(database) if one else (),
    )


def _period(database: Database) -> tuple[float, float]:
    first, last = database.names("SELECT min(time), max(time) FROM missions WHERE time > 0")[0]
    return (float(first), float(last)) if first is not None else (0.0, 0.0)


def _lowest(database: Database) -> tuple[Mission, ...]:
    query = f"SELECT time, passed, total, steps FROM missions ORDER BY total, number LIMIT {LOWEST}"  # noqa: S608
    return tuple(Mission(*row) for row in database.names(query))


def _recording(question: Question, where: Store, parts: Sequence[Part]) -> tuple[Fixture, Origin]:
    """Return the named recording; without a name, the recording of the data set."""
    if question.fixture is not None:
        fixture = load(question.fixture)
        return fixture, origin(fixture, question.fixture.read_bytes())
    kinds = sorted({(part.origin.test, part.origin.sensors, part.origin.statements) for part in parts})
    if len(kinds) > 1:
        tests = sorted({test for test, _, _ in kinds})
        raise FleetError(
            f"{where.shown('')} holds missions of {len(kinds)} recordings (of {', '.join(tests)}): name one with "
            "--fixture."
        )
    count: Counter[str] = Counter()
    for part in parts:
        count[part.origin.recording] += part.missions
    digest = min(count, key=lambda one: (-count[one], one))
    path = f"recordings/{digest}.npz"
    content = where.read(path)
    fixture = parsed(content, where.shown(path))
    return fixture, origin(fixture, content)


def _left_out(parts: Sequence[Part], own: Origin) -> dict[str, int]:
    """Return how many missions cannot be compared, by reason."""
    found: Counter[str] = Counter()
    for part in parts:
        if part.origin.fits(own):
            continue
        test = part.origin.test
        if test != own.test:
            why = f"of {test}"
        elif part.origin.sensors != own.sensors:
            why = f"of {test} with other sensors or bins"
        else:
            why = f"of {test} with other statements"
        found[why] += part.missions
    return dict(sorted(found.items()))


def _nothing(where: Store, question: Question) -> str:
    of = f" of {question.robot}" if question.robot else ""
    since = f" since {question.since}" if question.since else ""
    return f"{where.shown('')} holds no mission{of}{since}: check --robot and --since."


def _check(question: Question) -> None:
    if question.workers < 1:
        raise SettingsError(f"--workers must be 1 or more, got {question.workers}.")
    if not 0.0 < question.alpha < 1.0:
        raise SettingsError(
            f"--alpha must be a probability between 0 and 1, such as 0.05, got {question.alpha:g}."
        )
    wrong = [one for one in question.by if one not in BY]
    if wrong or len(set(question.by)) < len(question.by):
        raise SettingsError(
            f"--by must name each of {', '.join(BY)} at most once, got {','.join(question.by)}."
        )
