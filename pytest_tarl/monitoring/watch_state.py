"""Save the state of a watch to a small file, atomically, so that the watch can resume.

The file is a `.npz` without pickle, like a recording: a JSON header with a hash, the columns of the processes, and the
pool.

FORMAT history:
1  First version.
2  Adds the onset of each process at its largest evidence.
"""

from __future__ import annotations

import fcntl
import hashlib
import io
import json
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from pytest_tarl.errors import MonitorError
from pytest_tarl.files import read_regular
from pytest_tarl.learning.archive import read_arrays
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.monitoring.mission import Progress
from pytest_tarl.monitoring.moments import Moments
from pytest_tarl.monitoring.monitor import Counts, Monitor, begun
from pytest_tarl.monitoring.restarts import Processes
from tarl_lint.files import write_atomically

FORMAT = 2
HEADER = "header"
KIND = "state of a watch"  # distinguishes the file from a recording
_UNREADABLE = (
    ValueError,
    LookupError,
    EOFError,
    TypeError,
    AttributeError,
    zlib.error,
    BadZipFile,
)


def save(path: Path, monitor: Monitor, logs: Mapping[str, Progress], fixture: str) -> None:
    """Write the state and the recording's hash `fixture`, atomically. Raise MonitorError."""
    columns = _columns(monitor)
    header: dict[str, Any] = {
        "kind": KIND,
        "format": FORMAT,
        "fixture": fixture,
        "alpha": monitor.alpha,
        "seed": monitor.seed,
        "counts": asdict(monitor.counts),
        "moments": asdict(monitor.moments),
        "new": [[list(cell), count] for cell, count in monitor.new.items()],
        "logs": [one._asdict() for one in logs.values()],
    }
    header["digest"] = _digest(header, columns)
    buffer = io.BytesIO()
    text = np.frombuffer(json.dumps(header).encode(), np.uint8)
    arrays: dict[str, Any] = {HEADER: text, **columns}
    np.savez_compressed(buffer, **arrays)  # pass no options: numpy before 2.1 stores them as arrays
    try:
        write_atomically(path, buffer.getvalue(), parents=True)
    except OSError as problem:
        raise MonitorError(
            f"The state {path} cannot be written ({problem.strerror}): name another file with --state."
        ) from problem


def load(
    path: Path, fixture: Fixture, digest: str, *, alpha: float, seed: int
) -> tuple[Monitor, dict[str, Progress]]:
    """Return the monitor and the progress in its logs; without a state file, a new monitor.

    Raise MonitorError if the file is damaged, or belongs to another recording, α or seed. Raise FixtureError if the
    recording has too few episodes.
    """
    fresh = begun(fixture, alpha=alpha, seed=seed)
    if not path.exists():
        return fresh, {}
    header, columns = _read(path)
    again = f"Name another file with --state, or remove {path} to start again."
    if header["fixture"] != digest:
        raise MonitorError(
            f"The state {path} belongs to another recording of the test, so its evidence does not apply. {again}"
        )
    for what, mine, theirs in (("alpha", alpha, header["alpha"]), ("seed", seed, header["seed"])):
        if mine != theirs:
            raise MonitorError(
                f"The state {path} was begun with --{what} {theirs}, which cannot be changed to {mine} during a "
                f"watch. {again}"
            )
    return _restored(fresh, header, columns), {one["log"]: Progress(**one) for one in header["logs"]}


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Lock a state file during the block.

    Raise MonitorError if another watch holds the lock or the file cannot be written.
    """
    if path.is_dir():
        raise MonitorError(f"The state {path} is a folder: name a file with --state.")
    lock = path.with_name(f".{path.name}.lock")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = lock.open("a")
    except OSError as problem:
        raise MonitorError(
            f"The state {path} cannot be written ({problem.strerror}): name another file with --state."
        ) from problem
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise MonitorError(
                f"The state {path} is in use by another watch: stop that watch, or name another file with --state."
            ) from None
        yield


def _columns(monitor: Monitor) -> dict[str, np.ndarray[Any, Any]]:
    processes = {one.name: getattr(monitor.processes, one.name) for one in fields(Processes)}
    return processes | {"pool": monitor.pool}


def _restored(
    fresh: Monitor, header: Mapping[str, Any], columns: Mapping[str, np.ndarray[Any, Any]]
) -> Monitor:
    fresh.processes = Processes(**{one.name: columns[one.name] for one in fields(Processes)})
    fresh.pool = columns["pool"]
    fresh.counts = Counts(**header["counts"])
    fresh.moments = Moments(**header["moments"])
    fresh.new = {tuple(cell): count for cell, count in header["new"]}
    return fresh


def _read(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray[Any, Any]]]:
    try:
        columns = read_arrays(read_regular(path))
        header: dict[str, Any] = json.loads(columns.pop(HEADER).tobytes().decode())
        digest = header.pop("digest")
        whole = digest == _digest(header, columns)
    except OSError as problem:
        raise MonitorError(f"The state {path} cannot be read ({problem.strerror}).") from problem
    except _UNREADABLE as problem:
        raise _damaged(path) from problem
    if not whole or header.get("kind") != KIND:
        raise _damaged(path)
    if header["format"] != FORMAT:
        raise MonitorError(
            f"The state {path} has format {header['format']}, but this version of tarl reads {FORMAT}: use the "
            "version that wrote it, or remove it to start again."
        )
    return header, columns


def _damaged(path: Path) -> MonitorError:
    return MonitorError(
        f"The state {path} is damaged or not a state of `tarl watch`: restore it from a backup, or remove it to "
        "start again."
    )


def _digest(header: Mapping[str, Any], columns: Mapping[str, np.ndarray[Any, Any]]) -> str:
    digest = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
    for name in sorted(columns):
        digest.update(f"{name}:{columns[name].dtype.str}:{columns[name].shape}".encode())
        digest.update(np.ascontiguousarray(columns[name]).tobytes())
    return digest.hexdigest()
