"""List the files of a data set, with their missions and recordings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from pytest_tarl.errors import FleetError, first_line
from pytest_tarl.fleet.data_folder import ADVICE, Store
from pytest_tarl.fleet.schema import PREFIX, READABLE, Origin


@dataclass(frozen=True)
class Part:
    """A file of the table `missions`; its path is relative to the data set."""

    path: str
    origin: Origin
    missions: int

    def beside(self, table: str) -> str:
        """Return the file of another table that has the same missions."""
        return f"{table}/{self.path.partition('/')[2]}"


def parts(where: Store) -> list[Part]:
    """Return the files of a data set. Raise FleetError if one is damaged, incomplete or has another schema."""
    found = []
    cells = set(where.files("cells"))
    for path in where.files("missions"):
        about = _opened(where, path)
        told = {
            key.decode(): value.decode()
            for key, value in (about.schema.to_arrow_schema().metadata or {}).items()
        }
        part = Part(path, _origin(where, path, told), about.num_rows)
        if part.beside("cells") not in cells and not where.holds(
            part.beside("cells")
        ):  # a store's listing can be outdated, so files may be missing
            raise FleetError(
                f"{where.shown(part.beside('cells'))} is missing, so {where.shown(path)} cannot be judged: "
                "restore the missing file, or delete the other one and ingest its logs again."
            )
        found.append(part)
    return found


def known(where: Store, folder: str, date: str) -> Iterator[tuple[int, str]]:
    """Yield the ID and robot of each mission of a test on one day."""
    for path in where.files(f"missions/test={folder}"):
        if f"/date={date}/" in path:
            table = columns(where, path, ["mission", "robot"])
            yield from zip(table["mission"].to_pylist(), table["robot"].to_pylist(), strict=True)


def _origin(where: Store, path: str, told: dict[str, str]) -> Origin:
    schema = told.get(f"{PREFIX}schema", "")
    if not schema:
        raise FleetError(
            f"{where.shown(path)} was not written by `tarl ingest`: move it out of the data set."
        )
    if schema not in map(str, READABLE):
        raise FleetError(
            f"{where.shown(path)} has schema {schema}, but this version of tarl reads "
            f"{' and '.join(map(str, READABLE))}: use the version of tarl that wrote it."
        )
    return Origin(**{one.name: told.get(f"{PREFIX}{one.name}", "") for one in fields(Origin)})


def _opened(where: Store, path: str) -> Any:
    with _readable(where, path), where.opened(path) as file:
        return pq.read_metadata(file)


def columns(where: Store, path: str, names: Sequence[str]) -> Any:
    """Return columns of a file as an Arrow table. Raise FleetError if the file cannot be read."""
    with _readable(where, path), where.opened(path) as file:
        return pq.ParquetFile(file).read(columns=list(names), use_threads=False)


@contextmanager
def _readable(where: Store, path: str) -> Iterator[None]:
    try:
        yield
    except (pa.ArrowInvalid, OSError) as problem:
        raise FleetError(
            f"{where.shown(path)} is damaged or cannot be read ({first_line(problem)}): delete it and ingest "
            "its logs again."
        ) from problem
    # each kind of store has its own exceptions, for example those of an HTTP client
    except Exception as problem:
        raise FleetError(f"{where.shown(path)} cannot be read ({first_line(problem)}): {ADVICE}") from problem
