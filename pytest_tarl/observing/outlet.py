"""Send an observer's messages from the node's process through a pipe to a writer process."""

from __future__ import annotations

import contextlib
import fcntl
import json
import marshal
import os
import subprocess
import sys
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pytest_tarl.errors import LogError
from pytest_tarl.observing.writer import Rotation
from pytest_tarl.observing.writer_main import LENGTH, READY

MOST_WAITING = 1 << 26  # maximum size in bytes of waiting messages; while more wait, events are dropped
_PIPE = 1 << 20  # size of the pipe's buffer in bytes, if the system allows it
_PLAIN = 2  # version of marshal without references to repeated objects, which is faster to write


class Outlet:
    """Messages to the writer. `put` and `pump` never wait; `pump` belongs to one thread."""

    def __init__(self, log: Path, about: Mapping[str, Any], rotation: Rotation) -> None:
        self.problem = ""  # why writing stopped
        self._waiting: deque[bytes | memoryview] = deque()
        self._put = self._sent = 0  # bytes
        order = {"log": str(log), "about": dict(about), "rotation": [rotation.size, rotation.keep]}
        command = [sys.executable, "-m", "pytest_tarl.observing.writer_main", json.dumps(order)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
        said = self._said()
        if said != READY:
            self._process.communicate()
            raise LogError(said or f"{log} cannot be written: the writer's process did not start.")
        with contextlib.suppress(OSError, AttributeError):
            fcntl.fcntl(self._pipe(), fcntl.F_SETPIPE_SZ, _PIPE)
        os.set_blocking(self._pipe(), False)

    @property
    def full(self) -> bool:
        """Return whether more than MOST_WAITING bytes are unsent; callers then put nothing more."""
        return self._put - self._sent > MOST_WAITING

    def put(self, *message: Any) -> None:
        """Queue a message. Callers hold a lock to keep messages in order."""
        if not self.problem:
            text = marshal.dumps(message, _PLAIN)
            self._waiting.append(LENGTH.pack(len(text)) + text)
            self._put += LENGTH.size + len(text)

    def pump(self) -> None:
        """Send as many queued bytes as the pipe accepts now."""
        try:
            while self._waiting and not self.problem:
                piece = self._waiting.popleft()
                rest = memoryview(piece)[os.write(self._pipe(), piece) :]
                self._sent += len(piece) - len(rest)
                if rest:
                    self._waiting.appendleft(rest)
        except BlockingIOError:
            self._waiting.appendleft(piece)
        except OSError:
            self.problem = (
                self._said() or "The process that writes the log was ended: later records are lost."
            )
            self._waiting.clear()

    def close(self) -> None:
        """Send the rest and wait until it is written."""
        os.set_blocking(self._pipe(), True)
        self._waiting.append(LENGTH.pack(0))
        self.pump()
        last = self._said()
        self._process.communicate()
        self.problem = self.problem or last

    def _pipe(self) -> int:
        assert self._process.stdin is not None  # noqa: S101 - for the type checker
        return self._process.stdin.fileno()

    def _said(self) -> str:
        stream = self._process.stdout
        return stream.readline().decode(errors="replace").strip() if stream is not None else ""
