"""Keep failing drifts of earlier runs in a Hypothesis database below `.tarl/stress`, and replay them first.

The replay only reports whether they still fail; it does not influence the search.
"""

from __future__ import annotations

import errno
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Any

from pytest_tarl.files import check_writable
from pytest_tarl.finite_numbers import finite_number
from pytest_tarl.rollout import EpisodePlan, Rollout, in_order
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Choice, Point, Space
from pytest_tarl.stressing.findings import Failure
from pytest_tarl.stressing.guarantee import Guarantee, Outcome, outcome
from pytest_tarl.stressing.rays import distance

if TYPE_CHECKING:
    from hypothesis.database import ExampleDatabase

MOST = 5  # maximum number of failing drifts to keep
EPISODES = 4  # number of episodes per replayed drift


@dataclass(frozen=True, slots=True)
class Kept:
    """The failing drifts of a test in a space, stored in the database in `folder`; `key` names test and space.

    Hypothesis stores each drift in its own file, so runs of several tests do not interfere.
    """

    folder: Path
    key: str

    def write(self, failures: Sequence[Failure]) -> None:
        """Replace the stored drifts by the first MOST of these. Raise OSError if they cannot be written."""
        after = {_as_bytes(one.point) for one in failures[:MOST]}
        if after or self.folder.exists():
            check_writable(self.folder / "check")
        before = self._values()
        database = self._database()
        for value in before - after:
            database.delete(self._name, value)
        for value in after - before:
            database.save(self._name, value)
        if self._values() != after:  # Hypothesis raises no error when it cannot write
            raise OSError(errno.EIO, "Hypothesis could not store the failing drifts", str(self.folder))

    def read(self, space: Space) -> list[Point]:
        """Return the stored drifts of the space except the nominal one, nearest first.

        Return an empty list if the database is missing or damaged. Drifts of another space are skipped.
        """
        try:
            points = [point for value in sorted(self._values()) if (point := _as_point(value, space))]
        except OSError:
            return []
        return sorted(points, key=lambda point: distance(space, point))[:MOST]

    @property
    def _name(self) -> bytes:
        return self.key.encode("utf-8", "surrogatepass")

    def _database(self) -> ExampleDatabase:
        from hypothesis.database import DirectoryBasedExampleDatabase

        return DirectoryBasedExampleDatabase(str(self.folder))

    def _values(self) -> set[bytes]:
        """Return the stored values. Raise OSError if the folder contains a pipe or a device, which could block."""
        for path in self.folder.rglob("*"):
            if not path.is_file() and not path.is_dir():
                raise OSError(errno.EINVAL, "it is not a regular file", str(path))
        return set(self._database().fetch(self._name))


def _as_bytes(point: Point) -> bytes:
    return json.dumps(dict(point), sort_keys=True, ensure_ascii=False).encode("utf-8", "surrogatepass")


def _as_point(value: bytes, space: Space) -> Point | None:
    """Return the point for a stored value, or None if it is not a point of the space."""
    try:
        found = json.loads(value.decode("utf-8", "surrogatepass"))
        return {name: found[name] for name in space.extents} if _inside(space, found) else None
    except (ValueError, RecursionError, MemoryError):
        return None


@dataclass(frozen=True, slots=True)
class Replayed:
    """A replayed drift: how many episodes passed, and the mean loss of reward."""

    point: Point
    fails: bool
    passed: int
    loss: float


def replayed(
    points: Sequence[Point], rollout: Rollout, drift: str, seed: int, given: Guarantee
) -> Iterator[Replayed]:
    """Run EPISODES episodes at each stored drift, and yield the results.

    The drift still fails if one of these episodes fails, or if their mean loss is too large.
    """
    seeds = episode_seeds(seed, f"stress {drift} search", EPISODES)
    for point in points:
        plans = (EpisodePlan(each, drift, point=point) for each in seeds)
        yield _judged(point, [outcome(one.result()) for one in in_order(rollout, plans)], given)


def _judged(point: Point, outcomes: Sequence[Outcome], given: Guarantee) -> Replayed:
    passed = sum(one.passed for one in outcomes)
    loss = fmean(given.totals) - fmean(one.total for one in outcomes)
    return Replayed(point, passed < len(outcomes) or loss > given.tolerance, passed, loss)


def _inside(space: Space, point: Any) -> bool:
    if not isinstance(point, dict) or point.keys() != space.extents.keys():
        return False
    for name, extent in space.extents.items():
        number = finite_number(point[name])
        if number is None:
            return False
        if isinstance(extent, Choice):
            if number not in range(len(extent.options)):
                return False
        elif not extent.low <= number <= extent.high:
            return False
    return bool(point != space.nominal)
