"""Count the bytes that were sent to another local process, but not read by it."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

TABLES = (Path("/proc/net/tcp"), Path("/proc/net/tcp6"))


def unread(connections: Iterable[tuple[int, int]]) -> int:
    """Return the number of unread bytes; 0 if it is unknown.

    A connection is a pair: own port, other port.

    Unread bytes are in the send queue of the own end, or in the receive queue of the other end.
    """
    own = {*connections}
    others = {(there, here) for here, there in own}
    waiting = 0
    for table in TABLES if own else ():
        with suppress(OSError):
            for line in table.read_text().splitlines()[1:]:
                _, local, remote, _, queues, *_ = line.split()
                ends = _port(local), _port(remote)
                sent, received = (int(size, 16) for size in queues.split(":"))
                waiting += sent * (ends in own) + received * (ends in others)
    return waiting


def _port(address: str) -> int:
    return int(address.rpartition(":")[2], 16)
