"""The mission of a bag, with its ID and its statistics."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from pytest_tarl.bagged import misfit
from pytest_tarl.bags.reading import ENDINGS, opened
from pytest_tarl.errors import LogError
from pytest_tarl.fleet.logged_samples import BYTES, plan_of
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.judgements import judgements
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.rollout import EpisodeRun

Replay = Callable[[Path, int], EpisodeRun]


@dataclass(frozen=True)
class Bagged:
    """The ID of a bag's mission, and its start in seconds since 1970."""

    mission: int
    time: float


def is_bag(path: Path) -> bool:
    """Return whether the name of a file or folder is that of a bag."""
    return path.is_dir() or path.name.endswith(ENDINGS)


def identified(path: Path, fixture: Fixture) -> Bagged:
    """Return the ID and start of a bag's mission, without replaying the bag.

    The ID is a hash of the messages' times, topics and contents. It does not depend on the container, the compression
    or the nodes that replay the bag. Raise LogError if the bag cannot be read to its end, or does not fit the
    recording.
    """
    bag = opened(path)
    if why := misfit(bag, fixture):
        raise LogError(f"{why}: bag left out.")
    digest = hashlib.sha256()
    for one in bag.messages():
        digest.update(f"{one.time} {one.topic} {len(one.data)}\n".encode())
        digest.update(one.data)
    # a truncated bag has no mission ID, because the complete bag would have a different one
    if bag.notes:
        raise LogError(
            f"{path}: {bag.notes[0].rstrip('.')}; but only whole missions are ingested: restore the index of the "
            "bag with "
            "`rosbag reindex` or `ros2 bag reindex`, and ingest it again."
        )
    return Bagged(int.from_bytes(digest.digest()[:BYTES], "big"), bag.start / 1e9)


def replayed(path: Path, mission: int, fixture: Fixture, replay: Replay) -> tuple[Sample, tuple[str, ...]]:
    """Replay a bag; return its statistics and notes. Raise LogError if it has no rewards."""
    run = replay(path, mission)
    if not run.trace.steps:
        raise LogError(
            f"{path} holds no step with rewards: at no moment did all sensors have a value and the monitor a reward."
        )
    found = sample(replace(run.trace, parts={}), mission, run.passed, plan_of(fixture).members)
    return replace(found, judgements=judgements(run.judged)), run.notes
