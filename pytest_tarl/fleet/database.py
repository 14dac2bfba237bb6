"""Load the selected missions into an in-memory DuckDB, deduplicated, sorted by robot, time and mission ID.

The database has one row per mission; the rows of cells stay in their files (partitions.py). DuckDB only counts integers
and sorts rows. Sums of floats are computed elsewhere, from rows in a fixed order. Results are therefore identical to
the last bit, however the data is split into files, partitions or threads.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import date, datetime, timezone
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import duckdb
import numpy as np
import pyarrow as pa

from pytest_tarl.errors import FleetError, first_line
from pytest_tarl.files import advice_on
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.dataset import Part
from pytest_tarl.fleet.partitions import Wanted

MEMORY = "1GB"  # memory limit; DuckDB moves further rows to the folder SPILLED
SPILLED = Path(".tarl/fleet")
BY = {
    "version": "version",
    "site": "site",
    "robot": "robot",
    "repair": "repair",
    "month": "strftime(make_timestamp(CAST(floor(time * 1000000) AS BIGINT)), '%Y-%m')",  # UTC
    "week": "strftime(make_timestamp(CAST(floor(time * 1000000) AS BIGINT)), '%G-W%V')",  # ISO 8601, UTC
}
# an empty table with the columns that files of schema 1 lack
EMPTY = "SELECT '' AS repair, MAP {'': 0.0::DOUBLE} AS formulas WHERE false"
KEY = r"regexp_extract(filename, 'test=[^/]*/version=[^/]*/date=[^/]*/[^/]*$', 0)"

Columns = Mapping[str, Any]


@dataclass(frozen=True)
class Filter:
    """Select missions by robot, by first day (UTC), or both."""

    robot: str = ""
    since: date | None = None


class Database:
    """The selected missions, numbered from 0; `wanted` lists them by file."""

    def __init__(self, connection: Any, wanted: Sequence[Wanted]) -> None:
        self._connection = connection
        self.wanted = wanted

    def columns(self, query: str, *arguments: object) -> Columns:
        """Return the result of a query as columns."""
        found: Columns = self._connection.execute(query, list(arguments)).fetchnumpy()
        return found

    def run(self, statement: str, *arguments: object) -> None:
        """Run a statement."""
        self._connection.execute(statement, list(arguments))

    def names(self, query: str) -> list[tuple[Any, ...]]:
        """Return the rows of a query with a small result."""
        found: list[tuple[Any, ...]] = self._connection.execute(query).fetchall()
        return found

    @property
    def missions(self) -> int:
        """Return the number of selected missions."""
        return int(self.names("SELECT count(*) FROM missions")[0][0])


@contextmanager
def opened(where: Store, parts: Sequence[Part], by: Sequence[str], which: Filter) -> Iterator[Database]:
    """Load the missions of some files, grouped by the columns `by` (keys of BY).

    Raise FleetError if a file cannot be read.
    """
    with _spilled() as folder:
        settings: dict[str, str | bool | int | float | list[str]] = {
            "memory_limit": MEMORY,
            "temp_directory": folder,
            "preserve_insertion_order": "true",
        }
        connection = duckdb.connect(":memory:", config=settings)
        try:
            if where.protocol != "file":
                connection.register_filesystem(where.fs)
            keys = [part.path.partition("/")[2] for part in parts]
            connection.register(
                "parts", pa.table({"key": keys, "part": np.arange(len(keys), dtype=np.int32)})
            )
            _missions(connection, [where.address(part.path) for part in parts], by, which)
            yield Database(connection, tuple(_wanted(connection, parts)))
        except duckdb.Error as problem:
            raise FleetError(
                f"{where.shown('')} cannot be read ({first_line(problem)}): check the files and the free "
                f"disk space of {SPILLED}, and run the command again."
            ) from problem
        finally:
            connection.close()


@contextmanager
def _spilled() -> Iterator[str]:
    """Create a folder for rows that do not fit into memory; remove it afterwards.

    Each run has its own folder. Parent folders that it had to create are removed as well.
    """
    made = [one for one in (SPILLED, *SPILLED.parents) if not one.exists()]
    try:
        SPILLED.mkdir(parents=True, exist_ok=True)
        folder = TemporaryDirectory(prefix="rows-", dir=SPILLED, ignore_cleanup_errors=True)
    except OSError as problem:
        raise FleetError(
            f"{SPILLED} cannot be created ({problem.strerror}): {advice_on(problem)}"
        ) from problem
    with folder as name:
        yield name
    for one in made:
        with suppress(OSError):  # another run is using the folder
            one.rmdir()


def _missions(connection: Any, files: Sequence[str], by: Sequence[str], which: Filter) -> None:
    """Load each mission once; of several copies, keep the first."""
    grouped = ", ".join(f"{BY[one]} AS by_{one}" for one in by)
    order = ", ".join(f"by_{one}" for one in by) or "1"
    since = -1.0
    if which.since is not None:
        since = datetime.combine(which.since, datetime.min.time(), timezone.utc).timestamp()
    connection.execute(
        f"""
        CREATE TEMP TABLE missions AS
        SELECT *, CAST(row_number() OVER (ORDER BY robot, time, mission) - 1 AS INTEGER) AS number,
            CAST(dense_rank() OVER (ORDER BY robot) - 1 AS INTEGER) AS robot_number,
            CAST(dense_rank() OVER (ORDER BY {order}) - 1 AS INTEGER) AS group_number
        FROM (
            SELECT *{"," if grouped else ""} {grouped}
            FROM (
                SELECT mission, robot, site, version, coalesce(repair, '') AS repair, time, passed, total, steps,
                    formulas, part,
                    count(*) OVER same AS copies,
                    row_number() OVER (same ORDER BY version, robot, site, part) AS copy
                FROM (SELECT * FROM ({EMPTY}) UNION ALL BY NAME SELECT * FROM read_parquet(
                    ?, filename = true, hive_partitioning = true, hive_types_autocast = false, union_by_name = true
                )) JOIN parts ON {KEY} = parts.key
                WINDOW same AS (PARTITION BY mission)
            )
            WHERE copy = 1 AND time >= ? AND (? = '' OR robot = ?)
        )
        ORDER BY number
        """,  # noqa: S608 - names of columns come from BY
        [list(files), since, which.robot, which.robot],
    )


def _wanted(connection: Any, parts: Sequence[Part]) -> Iterator[Wanted]:
    """Yield the selected missions of each file."""
    rows = connection.execute(
        "SELECT part, mission, number FROM missions ORDER BY part, mission"
    ).fetchnumpy()
    ends = np.searchsorted(rows["part"], np.arange(len(parts) + 1)).tolist()
    for part, begin, end in zip(parts, ends, ends[1:], strict=False):
        mine = slice(begin, end)
        yield Wanted(
            part.beside("cells"),
            part.path,
            np.asarray(rows["mission"][mine]).astype(np.uint64),
            np.asarray(rows["number"][mine]).astype(np.int64),
        )
