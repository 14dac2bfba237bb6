"""The format of a log: a format line, then records with length and checksum.

A record is `length, crc32` (two little-endian 32-bit numbers), followed by that many bytes of zlib-compressed JSON. All
complete records can be read even if the writer was killed. The next writer removes an incomplete last record.

FORMAT history:
1  Records start, mission, steps, end. With formulas, steps and end also have `changes` (of signals), steps has
   `times` (when steps were closed), and end has `lasted` (length of the mission); older readers ignore them.
"""

from __future__ import annotations

import fcntl
import glob
import json
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from pytest_tarl.errors import LogError
from pytest_tarl.framed import framed, next_payload

FORMAT = 1
MAGIC = b"tarl log 1\n"
# maximum size of a record in bytes; a larger length means that the log is damaged
LARGEST = 1 << 26

Record = dict[str, Any]


class LogFile:
    """A log that one process has opened for appending. Raise LogError."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._open()

    def _open(self) -> None:
        path = self.path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: BinaryIO = path.open("a+b")
        except OSError as problem:
            raise LogError(
                f"{path} cannot be written ({problem.strerror}): name another file with --log."
            ) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise LogError(
                f"{path} is being written by another observer: name another file with --log."
            ) from None
        try:
            self._file.truncate(_whole(self._file, path))
        except LogError:
            self._file.close()
            raise
        self._file.seek(0, os.SEEK_END)
        if not self._file.tell():
            self._file.write(MAGIC)
            self.sync()

    @property
    def size(self) -> int:
        """Return the size of the log in bytes."""
        return self._file.tell()

    def set_aside(self, keep: int = 0) -> None:
        """Rotate the log: rename it with the next free number (`missions.log.7`) and continue in a new file.

        Keep the `keep` newest rotated files, or all if it is 0, and remove the others.
        """
        self.close()
        older = set_aside(self.path)
        last = int(older[-1].name.rpartition(".")[2]) if older else 0
        self.path.rename(self.path.with_name(f"{self.path.name}.{last + 1}"))
        for old in older[: len(older) + 1 - keep] if keep else ():
            old.unlink(missing_ok=True)
        self._open()

    def append(self, record: Record) -> None:
        """Append a record; call `sync` to make it durable."""
        self._file.write(encoded(record))

    def sync(self) -> None:
        """Flush all records to disk, so that they survive a power cut."""
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Sync, then close."""
        self.sync()
        self._file.close()


def encoded(record: Record) -> bytes:
    """Return the bytes of a record as stored in the file."""
    return framed(zlib.compress(json.dumps(record, separators=(",", ":")).encode(), 1))


def set_aside(path: Path) -> list[Path]:
    """Return the rotated files of a log, oldest first."""
    found = [one for one in path.parent.glob(f"{glob.escape(path.name)}.*") if one.suffix[1:].isdecimal()]
    return sorted(found, key=lambda one: int(one.suffix[1:]))


def records(path: Path) -> Iterator[Record]:
    """Yield the complete records of a log; ignore an incomplete last one.

    Raise LogError if the file cannot be read or is not a log.
    """
    try:
        file = path.open("rb")
    except OSError as problem:
        raise LogError(
            f"{path} cannot be read ({problem.strerror}): check the path after --tarl-log."
        ) from None
    with file:
        _check_magic(file, path)
        while (payload := next_record(file)) is not None:
            yield json.loads(zlib.decompress(payload))


def _whole(file: BinaryIO, path: Path) -> int:
    """Return the offset after the last complete record."""
    file.seek(0)
    start = file.read(len(MAGIC))
    if start != MAGIC:
        if MAGIC.startswith(start):
            return 0  # the file is empty, or ends in its first line
        raise _foreign(path)
    end = file.tell()
    while next_record(file) is not None:
        end = file.tell()
    return end


def _check_magic(file: BinaryIO, path: Path) -> None:
    if not MAGIC.startswith(start := file.read(len(MAGIC))) or (start and start != MAGIC and file.read(1)):
        raise _foreign(path)


def next_record(file: BinaryIO) -> bytes | None:
    """Return the next record's payload, or None if it is incomplete."""
    return next_payload(file, LARGEST)


def _foreign(path: Path) -> LogError:
    return LogError(
        f"{path} is not a log of `python -m pytest_tarl observe` of this version: name such a log."
    )
