"""Judge groups of missions (for example of one version and site): bounds, verdict, and where they differ.

Each group is compared with the recording, just as one robot is (learning/drift.py).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pytest_tarl.fleet import samples
from pytest_tarl.fleet.dask_tasks import Engine
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.database import Database
from pytest_tarl.learning.bounds import Range, mean_of, rate
from pytest_tarl.learning.drift import Difference, compare, corrected
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.guarantees import CONFIDENCE
from pytest_tarl.learning.permutation import permutations_for
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import Bound, Region, Verdict
from pytest_tarl.seeds import generator
from pytest_tarl.sensors import Cell, Sensor

MOST = 1000  # maximum number of missions per group in the comparison; bounds use all missions
FEWEST = 2  # minimum number of missions for a verdict


@dataclass(frozen=True)
class Judged:
    """The results of one formula in a group of missions."""

    formula: str
    missions: int
    violated: int
    least: float


@dataclass(frozen=True)
class Group:
    """A group of missions with its bounds and, if there are enough missions, its verdict."""

    values: tuple[str, ...]
    missions: int
    robots: int
    passed: int
    reward: float  # mean total reward of the missions
    success: Bound
    mean: Bound
    # number of totals outside the declared range; if there are any, the bound on the mean is approximate
    outside: int
    compared: int
    verdict: Verdict | None
    region: Region
    formulas: tuple[Judged, ...] = ()


def judged(
    database: Database,
    where: Store,
    fixture: Fixture,
    cells: tuple[Cell, ...],
    by: Sequence[str],
    engine: Engine,
    *,
    alpha: float,
    tolerance: float | None,
    seed: int = 0,
) -> tuple[Group, ...]:
    """Return all groups in order; verdicts are corrected for the number of groups (Holm).

    `cells` are the cells of the recording, followed by all other cells.
    """
    columns = ", ".join((*(f"any_value(by_{one})" for one in by), "count(*)", "count(DISTINCT robot_number)"))
    rows = database.names(f"SELECT {columns} FROM missions GROUP BY group_number ORDER BY group_number")  # noqa: S608 - from BY
    every = samples.groups(database, where, engine, cells, len(rows), MOST)
    verdicts = engine.each(_compared, _tasks(fixture, every, rows, alpha, tolerance, seed))
    violations = _violations(database)
    found = []
    for number, (row, (compared, difference)) in enumerate(zip(rows, verdicts, strict=True)):
        group = _group(database, fixture, number, row)
        if difference is not None:
            group = replace(group, verdict=difference.verdict, region=difference.region)
        found.append(replace(group, compared=compared, formulas=violations.get(number, ())))
    return _corrected(found, alpha)


def _tasks(
    fixture: Fixture,
    every: Iterable[Sample],
    rows: Sequence[tuple[object, ...]],
    alpha: float,
    tolerance: float | None,
    seed: int,
) -> Iterator[tuple[object, ...]]:
    """Yield the arguments for the comparison of each group."""
    recorded = replace(fixture.sample, lists=(), judgements=None)
    for sample, (*values, _, _) in zip(every, rows, strict=True):
        name = "/".join(map(str, values))
        yield recorded, fixture.sensors, sample, name, alpha, len(rows), tolerance, seed


FORMULAS = """
    SELECT group_number, one.key, count(*), count_if(one.value <= 0), min(one.value)
    FROM (SELECT group_number, unnest(map_entries(formulas)) AS one FROM missions)
    GROUP BY ALL ORDER BY ALL
"""


def _violations(database: Database) -> dict[int, tuple[Judged, ...]]:
    """Return the results of the formulas in each group."""
    found: dict[int, tuple[Judged, ...]] = {}
    for number, *one in database.names(FORMULAS):
        found[number] = (*found.get(number, ()), Judged(*one))
    return found


def _group(database: Database, fixture: Fixture, number: int, row: tuple[object, ...]) -> Group:
    """Return a group, still without a verdict."""
    *values, missions, robots = row
    results = database.columns(
        "SELECT passed, total FROM missions WHERE group_number = ? ORDER BY number", number
    )
    passed = int(np.count_nonzero(results["passed"]))
    totals = np.asarray(results["total"], np.float64)
    declared = _declared(fixture)
    outside = 0 if declared is None else int(((totals < declared.low) | (totals > declared.high)).sum())
    confidence = fixture.stated.success.confidence if fixture.stated else CONFIDENCE
    return Group(
        values=tuple(map(str, values)),
        missions=int(str(missions)),
        robots=int(str(robots)),
        passed=passed,
        reward=float(totals.mean()),
        success=rate(passed, totals.size, confidence),
        mean=mean_of(totals.tolist(), confidence, None if outside else declared),
        outside=outside,
        compared=0,
        verdict=None,
        region=Region(),
    )


def _compared(
    recorded: Sample,
    sensors: tuple[Sensor, ...],
    sample: Sample,
    name: str,
    alpha: float,
    groups: int,
    tolerance: float | None,
    seed: int,
) -> tuple[int, Difference | None]:
    """Return the number of compared missions and their difference, or None if there are too few."""
    if sample.episodes < FEWEST:
        return sample.episodes, None
    return sample.episodes, compare(
        recorded,
        sample,
        alpha=alpha,
        tolerance=tolerance,
        generator=generator(seed, f"fleet/{name}"),
        sensors=sensors,
        permutations=permutations_for(alpha, groups),
    )


def _declared(fixture: Fixture) -> Range | None:
    told = fixture.stated.declared if fixture.stated else None
    return None if told is None else Range(*told)


def _corrected(groups: Sequence[Group], alpha: float) -> tuple[Group, ...]:
    verdicts = iter(corrected([one.verdict for one in groups if one.verdict is not None], alpha))
    return tuple(one if one.verdict is None else _with_verdict(one, next(verdicts)) for one in groups)


def _with_verdict(group: Group, verdict: Verdict) -> Group:
    region = group.region if verdict.result != "no difference" else Region()
    return replace(group, verdict=verdict, region=region)
