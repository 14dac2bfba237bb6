"""Failing drifts of earlier runs, stored below `.tarl/stress`; they are replayed first.

The replay only reports whether they still fail. It does not affect the search.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pytest_tarl.files import read_regular, write_atomically
from pytest_tarl.finite_numbers import finite_number
from pytest_tarl.rollout import EpisodePlan, Rollout, in_order
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Choice, Point, Space
from pytest_tarl.stressing.evaluating import outcome
from pytest_tarl.stressing.findings import Failure
from pytest_tarl.stressing.guarantee import Guarantee, Outcome

FORMAT_VERSION = 1  # 1: first version
MOST = 5  # maximum number of failing drifts to keep
EPISODES = 4  # number of episodes per replayed drift


def write(failures: Sequence[Failure], path: Path) -> None:
    """Write the first MOST failing drifts, or remove the file if there are none.

    Raise OSError if the file cannot be written or removed.
    """
    if not failures:
        path.unlink(missing_ok=True)
        return
    document = {"format": FORMAT_VERSION, "failing": [dict(one.point) for one in failures[:MOST]]}
    write_atomically(path, f"{json.dumps(document, indent=1, ensure_ascii=False)}\n".encode())


def read(path: Path, space: Space) -> list[Point]:
    """Return the stored drifts of the space, except the nominal one.

    Return an empty list if the file is missing or damaged. Drifts of another space are skipped.
    """
    try:
        found = json.loads(read_regular(path).decode("utf-8"))
        points = found["failing"] if found["format"] == FORMAT_VERSION else []
        return [point for point in points if _inside(space, point)][:MOST]
    except (OSError, ValueError, KeyError, TypeError, RecursionError, MemoryError):
        return []


def replayed(
    points: Sequence[Point], rollout: Rollout, drift: str, seed: int, given: Guarantee
) -> Iterator[tuple[Point, bool]]:
    """Yield each stored drift, and whether it still fails in EPISODES episodes."""
    seeds = episode_seeds(seed, f"stress {drift} search", EPISODES)
    for point in points:
        plans = (EpisodePlan(each, drift, point=point) for each in seeds)
        yield point, _fails([outcome(one.result()) for one in in_order(rollout, plans)], given)


def _fails(outcomes: Sequence[Outcome], given: Guarantee) -> bool:
    mean = sum(one.total for one in outcomes) / len(outcomes)
    recorded = sum(given.totals) / len(given.totals)
    return not all(one.passed for one in outcomes) or recorded - mean > given.tolerance


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
