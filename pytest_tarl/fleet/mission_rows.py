"""Store the statistics of missions as Arrow tables and Parquet files."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from math import isnan
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from pytest_tarl.fleet.schema import SCHEMAS, Origin, metadata, name_of
from pytest_tarl.learning.tables import END, START, Sample
from pytest_tarl.model import TaintList


@dataclass(frozen=True)
class Row:
    """A mission: robot, site, start, repair and statistics.

    The sample has one episode.
    """

    robot: str
    site: str
    time: float
    sample: Sample
    repair: str = ""  # the repair that the robot's software includes

    @property
    def mission(self) -> int:
        """Return the mission ID."""
        return self.sample.seeds[0]

    @property
    def date(self) -> str:
        """Return the day of the mission in UTC; 1970-01-01 if the clock was wrong."""
        return date(self.time)


def date(time: float) -> str:
    """Return the day of a time in UTC."""
    return datetime.fromtimestamp(time, timezone.utc).date().isoformat()


def files(rows: Sequence[Row], where: Origin, lists: Sequence[TaintList]) -> tuple[str, dict[str, bytes]]:
    """Return the files of some missions, one per table: name → content."""
    rows = sorted(rows, key=lambda row: (row.robot, row.time, row.mission))
    tables = {"missions": _missions(rows), "cells": _cells(rows), "statements": _statements(rows, lists)}
    about = metadata(where)
    digest = hashlib.sha256(repr(sorted(about.items())).encode())
    for row in rows:
        digest.update(f"{row.mission} {row.time!r} {row.robot!r} {row.site!r} {row.repair!r}\n".encode())
    found = {name: _parquet(name, columns, about) for name, columns in tables.items()}
    return digest.hexdigest()[:24], found


def _parquet(name: str, columns: dict[str, Any], about: dict[str, str]) -> bytes:
    schema = SCHEMAS[name].with_metadata(about)
    arrays = [_array(columns[one.name], one.type) for one in schema]
    sink = pa.BufferOutputStream()
    pq.write_table(pa.Table.from_arrays(arrays, schema=schema), sink, compression="zstd")
    content: bytes = sink.getvalue().to_pybytes()
    return content


def _array(column: Any, kind: Any) -> Any:
    if isinstance(column, list):
        return pa.array(column, kind)
    return pa.array(column).cast(kind, safe=True)


def _missions(rows: Sequence[Row]) -> dict[str, Any]:
    return {
        "mission": np.array([row.mission for row in rows], np.uint64),
        "robot": _named([row.robot for row in rows]),
        "site": _named([row.site for row in rows]),
        "time": np.array([row.time for row in rows], np.float64),
        "passed": np.array([bool(row.sample.passed[0]) for row in rows]),
        "total": np.array([float(row.sample.total[0]) for row in rows]),
        "steps": np.array([int(row.sample.steps[0]) for row in rows], np.int64),
        "repair": _named([row.repair for row in rows]),
        "formulas": [formulas_of(row.sample) for row in rows],
    }


def formulas_of(sample: Sample) -> list[tuple[str, float]]:
    """Return the formulas that were judged in a mission, with their robustness."""
    found = sample.judgements
    if found is None:
        return []
    pairs = zip(found.formulas, found.robustness[0].tolist(), strict=True)
    return [(formula, value) for formula, value in pairs if not isnan(value)]


def _cells(rows: Sequence[Row]) -> dict[str, Any]:
    names = _Names()
    cell, following = [], []
    for row in rows:
        here = np.array([*names.of(row.sample), END], np.int64)
        cell.append(here[row.sample.chain.cell])
        following.append(here[row.sample.chain.next_cell])
    chains = [row.sample.chain for row in rows]
    return {
        "mission": _repeated(rows, [chain.cell.size for chain in chains]),
        "cell": names.column(cell),
        "next_cell": names.column(following),
        "count": np.concatenate([chain.count for chain in chains]),
        "reward": np.concatenate([chain.reward for chain in chains]),
    }


def _statements(rows: Sequence[Row], lists: Sequence[TaintList]) -> dict[str, Any]:
    """Return the visits to statements; the start of a mission does not count."""
    names = _Names()
    size: list[int] = []
    owner, place, cells = [], [], []
    sums: dict[str, list[Any]] = {
        name: [] for name in ("count", "reward", "scaled", "reward_squared", "scaled_squared")
    }
    before = np.cumsum([0, *(len(one.sites) for one in lists)])
    for row in rows:
        here = np.array([*names.of(row.sample), END], np.int64)
        for number, one in enumerate(row.sample.lists):
            inside = one.visits.state > START
            cell, site = np.divmod(one.visits.state[inside] - 1, max(one.width, 1))
            size.append(cell.size)
            owner.append(row.mission)
            place.append(before[number] + site)
            cells.append(here[cell])
            for name, column in sums.items():
                column.append(getattr(one.visits, name)[inside])
    where = np.concatenate([np.empty(0, np.int64), *place])
    every = [(one.source, one.sink, site.id) for one in lists for site in one.sites]
    kinds = {"count": np.int64}
    joined = {
        name: np.concatenate([np.empty(0, kinds.get(name, np.float64)), *column])
        for name, column in sums.items()
    }
    named = {
        column: _codes(where, [one[index] for one in every])
        for index, column in enumerate(("source", "sink", "statement"))
    }
    return {
        "mission": np.repeat(np.array(owner, np.uint64), size),
        **named,
        "cell": names.column(cells),
        **joined,
    }


class _Names:
    """The cells of some missions, numbered in order of first occurrence."""

    def __init__(self) -> None:
        self.number: dict[tuple[int, ...], int] = {}

    def of(self, sample: Sample) -> list[int]:
        return [self.number.setdefault(cell, len(self.number)) for cell in sample.cells]

    def column(self, codes: Sequence[Any]) -> Any:
        return _codes(np.concatenate([np.empty(0, np.int64), *codes]), [name_of(one) for one in self.number])


def _codes(codes: Any, names: Sequence[str]) -> Any:
    """Return a dictionary-encoded column; a negative code is null."""
    distinct = sorted(set(names))
    number = {name: place for place, name in enumerate(distinct)}
    place = np.array([*(number[name] for name in names), 0], np.int32)[codes]
    index = pa.array(place, pa.int32(), mask=np.asarray(codes) < 0)
    return pa.DictionaryArray.from_arrays(index, pa.array(distinct, pa.string()))


def _named(names: Sequence[str]) -> Any:
    return _codes(np.arange(len(names)), names)


def _repeated(rows: Sequence[Row], sizes: Sequence[int]) -> Any:
    return np.repeat(np.array([row.mission for row in rows], np.uint64), sizes)
