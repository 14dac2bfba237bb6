"""The missions that a question is about, in an embedded DuckDB: each once, in the order of robot, time and identity.

Only integers are counted and rows sorted here. Sums of floats are computed from rows in that order, so results do not
depend on files, partitions or threads, to the last bit.
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

from pytest_tarl.errors import FleetError
from pytest_tarl.files import advice_on
from pytest_tarl.fleet.dataset import Part
from pytest_tarl.fleet.schema import cell_of, name_of
from pytest_tarl.fleet.store import Store
from pytest_tarl.sensors import Cell

MEMORY = "1GB"  # beyond it, DuckDB moves rows to SPILLED
SPILLED = Path(".tarl/fleet")
BY = {
    "version": "version",
    "site": "site",
    "robot": "robot",
    "repair": "repair",
    "month": "strftime(make_timestamp(CAST(floor(time * 1000000) AS BIGINT)), '%Y-%m')",  # UTC
    "week": "strftime(make_timestamp(CAST(floor(time * 1000000) AS BIGINT)), '%G-W%V')",  # ISO 8601, UTC
}
# Columns that files of schema 1 lack, and no row.
EMPTY = "SELECT '' AS repair, MAP {'': 0.0::DOUBLE} AS formulas WHERE false"
KEY = r"regexp_extract(filename, 'test=[^/]*/version=[^/]*/date=[^/]*/[^/]*$', 0)"

Columns = Mapping[str, Any]


@dataclass(frozen=True)
class Filter:
    """The missions in question: of one robot if given, and since a day (UTC) if given."""

    robot: str = ""
    since: date | None = None


class Database:
    """Missions numbered from 0 by robot, time and identity; `cells` are those of the recording, then all others."""

    def __init__(self, connection: Any, cells: tuple[Cell, ...]) -> None:
        self._connection = connection
        self.cells = cells

    def columns(self, query: str, *arguments: object) -> Columns:
        """Return the result of a query as columns."""
        found: Columns = self._connection.execute(query, list(arguments)).fetchnumpy()
        return found

    def run(self, statement: str, *arguments: object) -> None:
        """Run a statement."""
        self._connection.execute(statement, list(arguments))

    def names(self, query: str) -> list[tuple[Any, ...]]:
        """Return the rows of a query, for few rows."""
        found: list[tuple[Any, ...]] = self._connection.execute(query).fetchall()
        return found

    @property
    def missions(self) -> int:
        """Return the number of missions in question."""
        return int(self.names("SELECT count(*) FROM missions")[0][0])


@contextmanager
def opened(
    where: Store, parts: Sequence[Part], recorded: Sequence[Cell], by: Sequence[str], which: Filter
) -> Iterator[Database]:
    """Load the missions of some files, grouped by the columns `by`, keys of BY.

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
            _missions(connection, [where.address(part.path) for part in parts], by, which)
            cells = _cells(connection, [where.address(part.beside("cells")) for part in parts], recorded)
            yield Database(connection, cells)
        except duckdb.Error as problem:
            raise FleetError(
                f"{where.shown('')} cannot be read ({str(problem).splitlines()[0]}): check the files and the free "
                f"disk space of {SPILLED}, and run the command again."
            ) from problem
        finally:
            connection.close()


@contextmanager
def _spilled() -> Iterator[str]:
    """Make a folder for rows that do not fit into memory, one for each run; remove it, and what was made for it."""
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
        with suppress(OSError):  # another run uses it
            one.rmdir()


def _missions(connection: Any, files: Sequence[str], by: Sequence[str], which: Filter) -> None:
    """Load the missions; of several copies of one, the first by version, robot and site counts."""
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
                    formulas, {KEY} AS key,
                    count(*) OVER same AS copies,
                    row_number() OVER (same ORDER BY version, robot, site, filename) AS copy
                FROM (SELECT * FROM ({EMPTY}) UNION ALL BY NAME SELECT * FROM read_parquet(
                    ?, filename = true, hive_partitioning = true, hive_types_autocast = false, union_by_name = true
                ))
                WINDOW same AS (PARTITION BY mission)
            )
            WHERE copy = 1 AND time >= ? AND (? = '' OR robot = ?)
        )
        ORDER BY number
        """,  # noqa: S608 - names of columns come from BY
        [list(files), since, which.robot, which.robot],
    )


def _cells(connection: Any, files: Sequence[str], recorded: Sequence[Cell]) -> tuple[Cell, ...]:
    """Load the transitions of the missions between cells, in any order, and return the cells by number.

    Names become numbers on the way, so that no text is held in memory.
    """
    cells = _coded(connection, recorded, _names(connection, files))
    connection.execute(
        f"""
        CREATE TEMP TABLE cells AS
        SELECT m.number, a.code AS cell, coalesce(b.code, -1) AS next_cell, c.count, c.reward
        FROM (
            SELECT mission, cell, next_cell, count, reward, {KEY} AS key FROM read_parquet(?, filename = true)
        ) AS c JOIN missions AS m ON c.mission = m.mission AND c.key = m.key
            JOIN codes AS a ON c.cell = a.cell LEFT JOIN codes AS b ON c.next_cell = b.cell
        """,  # noqa: S608
        [list(files)],
    )
    found = connection.execute("SELECT cell FROM cells UNION SELECT next_cell FROM cells").fetchall()
    used = {code for (code,) in found} | {-1, *range(len(recorded))}
    if len(used) > len(cells):
        return cells
    kept = [code for code in range(len(cells)) if code in used]  # the others are of missions not in question
    renumbered = pa.table(
        {"old": pa.array([-1, *kept], pa.int32()), "new": pa.array(range(-1, len(kept)), pa.int32())}
    )
    connection.register("renumbered", renumbered)
    connection.execute(
        """
        CREATE OR REPLACE TEMP TABLE cells AS
        SELECT c.number, a.new AS cell, b.new AS next_cell, c.count, c.reward
        FROM cells AS c JOIN renumbered AS a ON c.cell = a.old JOIN renumbered AS b ON c.next_cell = b.old
        """
    )
    return tuple(cells[code] for code in kept)


def _names(connection: Any, files: Sequence[str]) -> set[str]:
    """Return the names of all cells in the files."""
    found = connection.execute(
        "SELECT DISTINCT unnest([cell, next_cell]) AS name FROM read_parquet(?)", [list(files)]
    ).fetchall()
    return {name for (name,) in found if name is not None}


def _coded(connection: Any, recorded: Sequence[Cell], names: set[str]) -> tuple[Cell, ...]:
    """Number the cells, those of the recording first, in the table `codes`."""
    cells = (*recorded, *sorted({cell_of(name) for name in names} - set(recorded)))
    codes = {"cell": list(map(name_of, cells)), "code": np.arange(len(cells), dtype=np.int32)}
    connection.register("codes", pa.table(codes))
    return cells
