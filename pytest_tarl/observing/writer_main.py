"""The writer process: copy an observer's messages from shared memory to the log.

The writer stops on request, or when its standard input closes because the node's process has ended. In both cases it
first writes everything that was sent.
"""

from __future__ import annotations

import contextlib
import json
import marshal
import os
import select
import signal
import struct
import sys
from pathlib import Path
from time import monotonic
from typing import Any

from pytest_tarl.errors import LogError
from pytest_tarl.observing.log_format import LogFile
from pytest_tarl.observing.ring import Ring
from pytest_tarl.observing.writer import Rotation, Writer

PERIOD = 0.25  # seconds between two syncs; a power cut loses about one period of records
LENGTH = struct.Struct("<I")  # bytes of a message; 0 marks the end
READY = "ready"
NICER = 5  # nice value, which gives the node's threads priority
_POLL = 0.02  # seconds between two checks of the shared memory


def main() -> int:
    """Run the writer; print that it is ready, or why it cannot write."""
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        # signals are for the node's process, which decides when the writer stops
        signal.signal(one, signal.SIG_IGN)
    with contextlib.suppress(OSError, AttributeError):
        # the normal scheduler, even if the node has a real-time one
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    with contextlib.suppress(OSError):
        os.nice(NICER)
    order: dict[str, Any] = json.loads(sys.argv[1])
    try:
        writer = Writer(LogFile(Path(order["log"])), order["about"], Rotation(*order["rotation"]))
        ring = Ring(order["ring"])
        print(READY, flush=True)
        _serve(writer, ring)
        if ring.unread:
            print(
                f"{order['log']}: the last {ring.unread} bytes of records were damaged in memory and are lost."
            )
            return 1
    except LogError as problem:
        print(problem)
        return 1
    except OSError as problem:
        print(
            f"{order['log']} can no longer be written ({problem.strerror}): later records are lost. Free some space, "
            "or name another file with --log."
        )
        return 1
    return 0


def _serve(writer: Writer, ring: Ring) -> None:
    waiting, due, over = bytearray(), monotonic() + PERIOD, False
    while not over:
        # check for the end before reading, so that the last read misses nothing
        over = bool(select.select([sys.stdin.fileno()], [], [], _POLL)[0])
        while (piece := ring.read()) is not None:
            waiting += piece
            over = _take(writer, waiting) or over
            due = _synced(writer, due)
        due = _synced(writer, due)
    writer.close()


def _synced(writer: Writer, due: float) -> float:
    """Sync if it is due; return the time of the next sync."""
    if monotonic() < due:
        return due
    writer.sync()
    return monotonic() + PERIOD


def _take(writer: Writer, waiting: bytearray) -> bool:
    """Process and remove complete messages; return whether the end mark was among them."""
    at = 0
    while len(waiting) - at >= LENGTH.size:
        (length,) = LENGTH.unpack_from(waiting, at)
        if not length:
            return True
        end = at + LENGTH.size + length
        if len(waiting) < end:
            break
        writer.take(marshal.loads(waiting[at + LENGTH.size : end]))  # noqa: S302 - sent by the parent process
        at = end
    del waiting[:at]
    return False


if __name__ == "__main__":
    sys.exit(main())
