"""A stream of bytes through memory shared by two processes; neither side waits or makes system calls.

The memory starts with two 64-bit counters (bytes written, bytes taken), followed by a ring buffer. A piece is `length,
crc32` and that many bytes. With weak memory ordering, the reader may see the new counter before the bytes; the checksum
then fails, and the reader tries again later.
"""

from __future__ import annotations

import mmap
import os
import tempfile
from zlib import crc32

from pytest_tarl.framed import HEAD, framed, unpack_head

SIZE = 1 << 20  # bytes of the buffer
_START = 16  # bytes of the counters


def shared_memory() -> int:
    """Return a file descriptor of new, zero-filled shared memory for a ring.

    The memory is freed when the last descriptor is closed.
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
    """One end of the stream; one thread writes and one reads."""

    def __init__(self, descriptor: int, *, writes: bool = False) -> None:
        self._memory = mmap.mmap(descriptor, 0)
        if writes:
            self._memory[:] = bytes(len(self._memory))  # maps every page now rather than in a control cycle
        self._size = len(self._memory) - _START
        self._counters = memoryview(self._memory)[:_START].cast("Q")

    @property
    def unread(self) -> int:
        """Return the number of bytes written but not yet read."""
        return self._counters[0] - self._counters[1]

    def write(self, data: bytes) -> bool:
        """Append a piece; return False if it does not fit now."""
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
