"""Define the tables of a fleet's data set: Parquet files with a schema version and hashes of the recording.

    missions/test=…/version=…/date=…/KEY.parquet      one row per mission
    cells/…, same path                                one row per mission and transition between cells
    statements/…, same path                           one row per mission, statement and cell

KEY is a hash of the content. The file in `missions` is written last; if it is missing, the other two are ignored.

SCHEMA_VERSION history:
1  These three tables.
2  `missions` has `repair` and `formulas`.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from urllib.parse import quote

import pyarrow as pa

from pytest_tarl.files import slug
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.sensors import Cell, binning_digest

SCHEMA_VERSION = 2
READABLE = (1, 2)
TABLES = ("statements", "cells", "missions")  # in the order in which they are written
PREFIX = "tarl."
_NAME = pa.dictionary(pa.int32(), pa.string())

SCHEMAS = {
    "missions": pa.schema(
        [
            ("mission", pa.uint64()),  # mission ID: a hash of its content
            ("robot", _NAME),
            ("site", _NAME),
            ("time", pa.float64()),  # start in seconds since 1970; 0 if the clock was wrong
            ("passed", pa.bool_()),
            ("total", pa.float64()),
            ("steps", pa.int64()),
            ("repair", _NAME),  # name of the repair in the robot's software; empty if there is none
            ("formulas", pa.map_(pa.string(), pa.float64())),  # robustness, above 0 if the formula holds
        ]
    ),
    "cells": pa.schema(
        [
            ("mission", pa.uint64()),
            ("cell", _NAME),  # the bins of the sensors, as in "3,0"
            ("next_cell", _NAME),  # null for the last step of the mission
            ("count", pa.int64()),
            ("reward", pa.float64()),  # sum of the rewards of these `count` steps
        ]
    ),
    "statements": pa.schema(
        [
            ("mission", pa.uint64()),
            ("source", _NAME),
            ("sink", _NAME),
            ("statement", _NAME),
            ("cell", _NAME),
            ("count", pa.int64()),
            *((name, pa.float64()) for name in ("reward", "scaled", "reward_squared", "scaled_squared")),
        ]
    ),
}


@dataclass(frozen=True)
class Origin:
    """The recording with which missions were ingested.

    Missions can be compared if the test, sensors and statements of their origins are equal.
    """

    test: str
    sensors: str  # hash of the sensors and their bins
    statements: str  # hash of the statements in all taint lists
    recording: str  # hash of the recording's file

    def fits(self, other: Origin) -> bool:
        """Return whether missions of both origins can be counted together."""
        return (self.test, self.sensors, self.statements) == (other.test, other.sensors, other.statements)

    @property
    def folder(self) -> str:
        """Return the folder name of the test's partition."""
        return f"{slug(self.test)}-{hashlib.sha256(self.test.encode()).hexdigest()[:8]}"


def origin(fixture: Fixture, content: bytes) -> Origin:
    """Return the origin of missions, given the content of their recording."""
    sites = json.dumps(fixture.statements)
    return Origin(
        fixture.test,
        binning_digest(fixture.sensors),
        hashlib.sha256(sites.encode()).hexdigest()[:16],
        hashlib.sha256(content).hexdigest()[:16],
    )


def metadata(where: Origin) -> dict[str, str]:
    """Return the metadata that a file stores about its origin."""
    return {f"{PREFIX}schema": str(SCHEMA_VERSION), **{f"{PREFIX}{k}": v for k, v in asdict(where).items()}}


def partition(where: Origin, version: str, date: str) -> str:
    """Return the folder of a partition, relative to the table's folder."""
    return f"test={where.folder}/version={quote(version, safe='')}/date={date}"


def repair_path(repair: str) -> str:
    """Return the path of the file that describes an accepted patch."""
    return f"repairs/{quote(repair, safe='')}.json"


def name_of(cell: Cell) -> str:
    """Return a cell as text."""
    return ",".join(map(str, cell))


def cell_of(name: str) -> Cell:
    """Return the cell with this name. Raise ValueError if the text is no cell name."""
    return tuple(int(one) for one in name.split(",")) if name else ()
