"""Read missions from a log that another process may be writing."""

from __future__ import annotations

import hashlib
import os
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from pytest_tarl.framed import HEAD
from pytest_tarl.monitoring.assembling import Assembly, Expected
from pytest_tarl.monitoring.log_blocks import end_of, next_block
from pytest_tarl.monitoring.mission import Mission, Progress, mark
from pytest_tarl.observing.log_format import MAGIC, next_record


@dataclass
class LogReader:
    """A log that may grow, be rotated or truncated, or not exist yet.

    `problem` describes what is currently wrong with the log; it is empty if nothing is.
    """

    path: Path
    expected: Expected
    known: Mapping[str, Progress]  # progress in every log read so far, by log ID
    owners: dict[str, Path]  # paths of the open logs
    problem: str = ""
    _open: tuple[BinaryIO, Assembly] | None = None
    _ahead: bool = False  # whether the caller of `missions` stopped before the last mission

    def missions(self) -> Iterator[Mission]:
        """Yield the missions that ended since the last call.

        A rotated log is read to its end before the new log with the same name. If the caller does not consume all
        missions, the next call yields the rest, provided that the caller keeps `known` up to date.
        """
        if self._ahead:
            self.close()
        self._ahead = True
        while (there := self._open or self._opened()) is not None:
            yield from self._read(*there)
            if not self._rotated(*there):
                break
            self.close()
        self._ahead = False

    @property
    def progress(self) -> Progress | None:
        """Return the progress in the log, or None if it is not open."""
        return None if self._open is None else self._open[1].progress

    def close(self) -> None:
        """Close the file; reading resumes later at the progress in `known`."""
        if self._open is not None:
            file, assembly = self._open
            file.close()
            self.owners.pop(assembly.begun.log, None)
        self._open = None

    def _opened(self) -> tuple[BinaryIO, Assembly] | None:
        try:
            file = self.path.open("rb")
        except FileNotFoundError:
            self.problem = f"{self.path} does not exist yet."
            return None
        except OSError as problem:
            self.problem = f"{self.path} cannot be read ({problem.strerror}): check the path."
            return None
        begun = self._begun(file)
        if begun is None:
            file.close()
            return None
        self.problem, self.owners[begun.log] = begun.refused, self.path
        self._open = (
            file,
            Assembly(self.expected, self.path, begun, begun.offset, begun.missions, begun.unfinished),
        )
        return self._open

    def _begun(self, file: BinaryIO) -> Progress | None:
        """Identify the log; return its progress, or None if there is no log."""
        magic = file.read(len(MAGIC))
        if not MAGIC.startswith(magic):
            self.problem = f"{self.path} is not a log of `tarl observe` of this version: name such a log."
            return None
        self.problem = ""
        first = next_record(file) if magic == MAGIC else None
        if first is None:
            return None  # the log is still empty
        log = hashlib.sha256(first).hexdigest()[:16]
        if log in self.owners:
            self.problem = (
                f"{self.path} is the same log as {self.owners[log]}: its missions are counted once."
            )
            return None
        fresh = Progress(log, str(self.path), len(MAGIC), -1, "")
        begun = self.known.get(log, fresh)._replace(path=str(self.path))
        if begun.last >= 0 and not _unchanged(file, begun):
            self.problem = (
                f"{self.path} was truncated or changed since it was read up to byte {begun.offset}: the rest is not "
                "counted. Restore it, or let the node write a new log."
            )
            return None
        return begun

    def _rotated(self, file: BinaryIO, assembly: Assembly) -> bool:
        """Return whether the log was rotated or truncated.

        After a rotation, the path leads to another file. After a truncation, the file is shorter than what was read.
        """
        mine = os.fstat(file.fileno())
        try:
            there = self.path.stat()
        except OSError:
            return False
        other = (mine.st_ino, mine.st_dev) != (there.st_ino, there.st_dev)
        return other or mine.st_size < assembly.progress.offset

    def _read(self, file: BinaryIO, assembly: Assembly) -> Iterator[Mission]:
        """Yield missions up to the last complete record."""
        while (block := next_block(file, assembly.place)).left():
            yield from assembly.of_block(block)
            self.problem = assembly.begun.refused
            if block.left():
                break
        self._damaged(file, assembly.place)

    def _damaged(self, file: BinaryIO, place: int) -> None:
        """Set `problem` if a complete record cannot be read."""
        rest = os.fstat(file.fileno()).st_size - place
        file.seek(place)
        head = file.read(4)
        if len(head) == 4 and HEAD + int.from_bytes(head, "little") < rest:
            self.problem = (
                f"{self.path} is damaged at byte {place}: later missions are not counted. Let the node write "
                "a new log."
            )


def _unchanged(file: BinaryIO, at: Progress) -> bool:
    """Return whether the last record that was read is still in the file."""
    file.seek(at.last)
    payload = next_record(file)
    if payload is None:
        return False
    there = at.last, len(payload), zlib.crc32(payload)
    return end_of(there) == at.offset and mark(there) == at.mark
