"""Bytes that were sent to another process of this machine and that it has not read yet, from Linux's TCP tables."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

TABLES = (Path("/proc/net/tcp"), Path("/proc/net/tcp6"))


def unread(connections: Iterable[tuple[int, int]]) -> int:
    """Return how many bytes on connections (own port, other port) the other ends have not read; 0 without the tables.

    Such bytes are in the own end's queue of sent bytes, or in the other end's queue of received bytes.
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
