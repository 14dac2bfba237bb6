"""The file of a run's finished episodes: appended one by one, and read after an interruption.

The first line names the format. The first record has the conditions of the run as JSON; each other record has a key and
an episode. If the last record is incomplete because of an interruption, it is ignored and removed.
"""

from __future__ import annotations

import json
import os
import threading
import zlib
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Any, BinaryIO

from pytest_tarl.framed import framed, next_payload

try:
    import fcntl
except ImportError:  # pragma: no cover - Windows: two runs of one test at a time are not detected there
    fcntl = None  # type: ignore[assignment]

MAGIC = b"tarl episodes 1\n"
KEY = 32  # bytes of an episode's key
LARGEST = 1 << 30  # maximum bytes of a record
SYNC = 1.0  # seconds between two syncs; a power cut loses at most the episodes that ended in this time


class TakenError(OSError):
    """Another run is writing the file."""


class Journal:
    """The kept episodes of one run.

    Any thread may call `keep`. If the disk fails, no more episodes are kept, but the run continues.
    """

    def __init__(self, path: Path, conditions: dict[str, Any]) -> None:
        self.path = path
        self.conditions = conditions
        self.problem: OSError | None = None  # why no more episodes are kept
        self._lock = threading.Lock()
        self._file: BinaryIO | None = None
        self._places: dict[bytes, list[int]] = {}  # key → offsets of its records
        self._synced = 0.0

    @property
    def episodes(self) -> int:
        """Return the number of kept episodes."""
        return sum(map(len, self._places.values()))

    def resume(self) -> None:
        """Continue the file: read its episodes and append new ones. Raise OSError if this fails."""
        file = _locked(self.path, "r+b")
        end = _start(file)
        while (payload := next_payload(file, LARGEST)) is not None:
            self._places.setdefault(payload[:KEY], []).append(end)
            end = file.tell()
        file.truncate(end)
        file.seek(end)
        self._file = file

    def taken(self, key: bytes, count: int) -> bytes | None:
        """Return the `count`-th episode (from 0) with this key, or None if there are fewer."""
        places = self._places.get(key, ())
        if count >= len(places):
            return None
        with self.path.open("rb") as file:
            file.seek(places[count])
            payload = next_payload(file, LARGEST)
        return None if payload is None else zlib.decompress(payload[KEY:])

    def keep(self, key: bytes, episode: bytes) -> None:
        """Append an episode."""
        record = framed(key + zlib.compress(episode, 1))
        with self._lock:
            if self.problem is not None:
                return
            try:
                self._places.setdefault(key, []).append(self._append(record))
            except OSError as problem:
                self.problem = problem

    def close(self) -> None:
        """Write everything to disk and close the file."""
        with self._lock:
            file, self._file = self._file, None
            if file is not None:
                with suppress(OSError), file:
                    self._sync(file)

    def remove(self) -> None:
        """Delete the file, and its folder unless other runs keep episodes there."""
        self.close()
        with suppress(OSError):
            self.path.unlink(missing_ok=True)
            self.path.parent.rmdir()

    def _append(self, record: bytes) -> int:
        """Append a record and return its offset."""
        if self._file is None:
            self._file = self._new()
        offset = self._file.tell()
        self._file.write(record)
        self._file.flush()
        if monotonic() - self._synced >= SYNC:
            self._sync(self._file)
        return offset

    def _new(self) -> BinaryIO:
        """Replace the file by one without episodes."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        file = _locked(self.path, "ab")
        try:
            file.truncate(0)
            file.write(MAGIC + framed(json.dumps(self.conditions).encode()))
            self._sync(file)
        except OSError:
            with suppress(OSError):
                file.close()
            raise
        _sync_folder(self.path.parent)
        return file

    def _sync(self, file: BinaryIO) -> None:
        file.flush()
        os.fsync(file.fileno())
        self._synced = monotonic()


def conditions_of(path: Path) -> tuple[dict[str, Any], int] | None:
    """Return the conditions and the number of a file's episodes; None if it has no episodes."""
    try:
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC or (first := next_payload(file, LARGEST)) is None:
                return None
            count = 0
            while next_payload(file, LARGEST) is not None:
                count += 1
            found = json.loads(first)
    except (OSError, ValueError):
        return None
    return (found, count) if count and isinstance(found, dict) else None


def _start(file: BinaryIO) -> int:
    """Return the offset of the first episode."""
    file.seek(len(MAGIC))
    next_payload(file, LARGEST)
    return file.tell()


def _locked(path: Path, mode: str) -> BinaryIO:
    """Open a file for this run only. Raise TakenError if another run has it open."""
    file: Any = path.open(mode)
    if fcntl is not None:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as problem:
            file.close()
            raise TakenError(problem.errno, "another run of this test is writing it", str(path)) from None
    opened: BinaryIO = file
    return opened


def _sync_folder(folder: Path) -> None:
    """Write a new file's directory entry to disk, if the system supports this."""
    with suppress(OSError):
        place = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(place)
        finally:
            os.close(place)
