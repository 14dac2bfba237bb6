"""Send messages to the writer process through shared memory."""

from __future__ import annotations

import json
import marshal
import os
import subprocess
import sys
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from time import sleep
from typing import Any

from pytest_tarl.errors import LogError
from pytest_tarl.observing.ring import SIZE, Ring, shared_memory
from pytest_tarl.observing.writer import Rotation
from pytest_tarl.observing.writer_main import LENGTH, PERIOD, READY

MOST_WAITING = 1 << 26  # maximum bytes of queued messages; beyond this, events are dropped
ENDED = (
    f"The process that writes the log was ended: the last {PERIOD:g} s before that may be missing from the log, and "
    "all later records are lost."
)
_PIECE = SIZE // 4  # larger messages are sent in pieces of this many bytes
_PLAIN = 2  # version of marshal without references to repeated objects, which is faster to write
_LOOKS = 10  # calls of `pump` between two checks that the writer is still running
_PAUSE = 0.005  # seconds between two attempts while closing


class Outlet:
    """The sender of messages to the writer process.

    `put` and `pump` never wait. Callers hold a lock to keep messages in order. A forked child of the node's process
    sends nothing. Raise LogError if the log cannot be written.
    """

    def __init__(self, log: Path, about: Mapping[str, Any], rotation: Rotation) -> None:
        self.problem = ""  # why writing stopped
        self._waiting: deque[bytes] = deque()  # pieces that did not fit into the shared memory yet
        self._held = 0  # total bytes of the waiting pieces
        self._pumped = 0  # calls of `pump`
        self._owner = os.getpid()
        memory = shared_memory()
        order = {
            "log": str(log),
            "about": dict(about),
            "rotation": [rotation.size, rotation.keep],
            "ring": memory,
        }
        command = [sys.executable, "-m", "pytest_tarl.observing.writer_main", json.dumps(order)]
        try:
            self._ring = Ring(memory, writes=True)
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0, pass_fds=(memory,)
            )
        finally:
            os.close(memory)
        said = self._said()
        if said != READY:
            self._process.communicate()
            raise LogError(said or f"{log} cannot be written: the writer's process did not start.")

    @property
    def full(self) -> bool:
        """Return whether more than MOST_WAITING bytes are unsent, which means that events must be dropped."""
        return self._held > MOST_WAITING

    @property
    def unsent(self) -> int:
        """Return the number of unread bytes, queued here and in shared memory."""
        return self._held + self._ring.unread

    def put(self, *message: Any) -> None:
        """Send a message, or queue it if the shared memory is full."""
        if self.problem or os.getpid() != self._owner:
            return
        text = marshal.dumps(message, _PLAIN)
        data = LENGTH.pack(len(text)) + text
        if self._waiting or len(data) > _PIECE or not self._ring.write(data):
            self._queue(data)

    def pump(self) -> None:
        """Send as many queued pieces as fit, and check the writer."""
        if os.getpid() != self._owner:
            return
        self._pumped += 1
        if not self.problem and self._pumped % _LOOKS == 0 and self._process.poll() is not None:
            self.problem = self._said() or ENDED
            self._waiting.clear()
            self._held = 0
        while self._waiting and self._ring.write(self._waiting[0]):
            self._held -= len(self._waiting.popleft())

    def close(self) -> None:
        """Send all queued messages and wait until they are written."""
        if os.getpid() != self._owner:
            return
        self._queue(LENGTH.pack(0))
        self.pump()
        while self._waiting and not self.problem:
            sleep(_PAUSE)
            self.pump()
        if self._process.stdin is not None:
            # closing the pipe ends the writer, even if it has not read the end mark
            self._process.stdin.close()
            self._process.stdin = None
        last = self._said()
        self._process.communicate()
        self.problem = self.problem or last or (ENDED if self._process.returncode else "")

    def _queue(self, data: bytes) -> None:
        self._waiting += [data[at : at + _PIECE] for at in range(0, len(data), _PIECE)]
        self._held += len(data)

    def _said(self) -> str:
        stream = self._process.stdout
        return stream.readline().decode(errors="replace").strip() if stream is not None else ""
