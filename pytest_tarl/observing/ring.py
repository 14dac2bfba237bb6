"""A stream of bytes through memory that two processes share; neither side waits or makes system calls.

The memory holds two 64-bit counters (bytes written, bytes taken), and then a ring buffer. A piece is `length, crc32`
and that many bytes. On processors with weak memory ordering, the reader may see the new counter before the bytes. The
checksum then fails, and the reader tries again later.
"""

from __future__ import annotations

import mmap
import os
import tempfile
from zlib import crc32

from pytest_tarl.framed import HEAD, framed, unpack_head

SIZE = 1 << 20  # size of the buffer (bytes)
_START = 16  # size of the counters (bytes)


def shared_memory() -> int:
    """Return a file descriptor of new shared memory for a ring, filled with zeros.

    The memory is freed when its last descriptor is closed.
    """
    length = _START + SIZE
    if hasattr(os, "memfd_create"):
        descriptor = os.memfd_create("tarl-observe")
    else:
        with tempfile.TemporaryFile() as file:
            descriptor = os.dup(file.fileno())
    os.write(descriptor, bytes(length))
    return descriptor


class Ring:
    """One end of the stream, with one writing and one reading thread."""

    def __init__(self, descriptor: int, *, writes: bool = False) -> None:
        self._memory = mmap.mmap(descriptor, 0)
        if writes:
            self._memory[:] = bytes(len(self._memory))  # maps every page now, not during a control cycle
        self._size = len(self._memory) - _START
        self._counters = memoryview(self._memory)[:_START].cast("Q")

    @property
    def unread(self) -> int:
        """Return the number of written bytes that are still unread."""
        return self._counters[0] - self._counters[1]

    def write(self, data: bytes) -> bool:
        """Append a piece; return False if it does not fit at the moment."""
        written, taken = self._counters
        piece = framed(data)
        length = len(piece)
        if written + length - taken > self._size:
            return False
        start = _START + written % self._size
        room = len(self._memory) - start
        if length <= room:
            self._memory[start : start + length] = piece
        else:
            self._memory[start:] = piece[:room]
            self._memory[_START : _START + length - room] = piece[room:]
        self._counters[0] = written + length
        return True

    def read(self) -> bytes | None:
        """Take the next piece, or return None if there is no complete one."""
        written, taken = self._counters
        if written - taken < HEAD:
            return None
        length, checksum = unpack_head(self._at(taken, HEAD), 0)
        if length > written - taken - HEAD:
            return None
        piece = self._at(taken + HEAD, length)
        if crc32(piece) != checksum:
            return None
        self._counters[1] = taken + HEAD + length
        return piece

    def _at(self, position: int, length: int) -> bytes:
        start = _START + position % self._size
        room = len(self._memory) - start
        if length <= room:
            return self._memory[start : start + length]
        return self._memory[start:] + self._memory[_START : _START + length - room]
