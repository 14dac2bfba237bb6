"""Watch growing logs, with a monitor whose state is saved."""

from __future__ import annotations

import hashlib
import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from time import monotonic

import numpy as np

from pytest_tarl.errors import FixtureError
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.fixture import load as load_fixture
from pytest_tarl.monitoring import watch_state
from pytest_tarl.monitoring.assembling import Expected
from pytest_tarl.monitoring.log_reader import LogReader
from pytest_tarl.monitoring.mission import Mission, Progress, columns, latest
from pytest_tarl.monitoring.monitor import PORTION, Monitor
from pytest_tarl.monitoring.scores import Missions
from pytest_tarl.monitoring.status import Status, status
from pytest_tarl.sensors import binning_digest

SAVED = 1.0  # seconds between two saves of the state while missions are left to read


@dataclass
class Watch:
    """The watched logs; `known` is the progress in each, by log ID."""

    fixture: Fixture
    digest: str
    path: Path
    monitor: Monitor
    readers: tuple[LogReader, ...]
    known: dict[str, Progress]

    def poll(self) -> Iterator[None]:
        """Count the missions that ended since the last call, in order of time.

        Yield after each portion. Save the state every `SAVED` seconds and at the end. Raise MonitorError if it cannot
        be saved.
        """
        logs = [one.missions() for one in self.readers]
        coming = logs[0] if len(logs) == 1 else heapq.merge(*logs, key=lambda mission: mission.time)
        saved, fresh = monotonic(), False
        while portion := [*islice(coming, PORTION)]:
            self.monitor.observe(joined(portion))
            self.known.update(latest(portion))
            fresh = True
            if monotonic() - saved > SAVED:
                self.save()
                saved, fresh = monotonic(), False
            yield
        if fresh:
            self.save()

    def save(self) -> None:
        """Write the state. Raise MonitorError if the file cannot be written."""
        watch_state.save(self.path, self.monitor, self.known, self.digest)

    def status(self) -> Status:
        """Return the status of the watch."""
        found = status(self.monitor)
        unfinished = sum(one.unfinished for one in self.known.values())
        more = [f"{unfinished:,} missions have no end and are not counted."] if unfinished else []
        return replace(found, notes=(*found.notes, *more))

    @property
    def problems(self) -> tuple[str, ...]:
        """Return the current problems of the logs as sentences."""
        return tuple(one.problem for one in self.readers if one.problem)

    def close(self) -> None:
        """Close the logs."""
        for reader in self.readers:
            reader.close()


def begun(logs: Sequence[Path], fixture: Path, path: Path, *, alpha: float, seed: int) -> Watch:
    """Return a watch that continues from its state file; without such a file, return a new watch.

    Raise FixtureError or MonitorError if the recording or the state cannot be used.
    """
    loaded = load_fixture(fixture)
    digest = hashlib.sha256(fixture.read_bytes()).hexdigest()
    monitor, known = watch_state.load(path, loaded, digest, alpha=alpha, seed=seed)
    expected = expectation(loaded, monitor)
    owners: dict[str, Path] = {}
    readers = tuple(LogReader(log, expected, known, owners) for log in logs)
    return Watch(loaded, digest, path, monitor, readers, known)


def expectation(fixture: Fixture, monitor: Monitor) -> Expected:
    """Return the test and sensors of the logs. Raise FixtureError."""
    if not fixture.sensors:
        raise FixtureError(f"The recording of {fixture.test} has no sensors.")
    names = tuple(sensor.name for sensor in fixture.sensors)
    return Expected(fixture.test, names, binning_digest(fixture.sensors), monitor.scale.number)


def joined(missions: Sequence[Mission]) -> Missions:
    """Return missions as columns."""
    mission, cell, reward = columns(missions)
    return Missions(
        passed=np.array([one.passed for one in missions]),
        time=np.array([one.time for one in missions]),
        mission=mission,
        cell=cell,
        reward=reward,
        new=tuple(cell for one in missions for cell in one.new),
    )
