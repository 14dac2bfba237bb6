"""The test's connection to a simulator's guardian process."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from time import monotonic
from typing import Any

PACKAGES = Path(__file__).resolve().parents[2]
PATIENCE = 30.0  # seconds to wait for the guardian to end; longer than the guardian's own limits
TAIL = 3  # maximum lines of simulator output in a message

Event = dict[str, Any]


class Client:
    """A guardian process, which runs one simulator after another."""

    def __init__(self) -> None:
        self._log = TemporaryFile()  # noqa: SIM115 - open as long as the process runs
        self._process = subprocess.Popen(
            [sys.executable, "-c", "from pytest_tarl.external.guardian import main; main()"],
            cwd=PACKAGES,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            text=True,
            encoding="utf-8",
            start_new_session=True,  # the guardian must outlive the test's process group, to end the simulator
        )
        self.events: queue.SimpleQueue[Event] = queue.SimpleQueue()
        self._shown = 0
        self._gone = False  # whether the guardian has closed its end of the pipe
        threading.Thread(target=self._read, name="tarl-simulator", daemon=True).start()

    @property
    def alive(self) -> bool:
        """Return whether the guardian is running."""
        return self._process.poll() is None

    def do(self, what: str, **arguments: Any) -> None:
        """Send a command, unless the guardian has ended."""
        assert self._process.stdin is not None  # noqa: S101 - for the type checker
        with suppress(OSError, ValueError):
            self._process.stdin.write(json.dumps({"do": what, **arguments}) + "\n")
            self._process.stdin.flush()

    def stop(self) -> None:
        """End the simulator and wait for its processes; discard events."""
        deadline = monotonic() + PATIENCE
        self.do("stop")
        while not self._gone and (left := deadline - monotonic()) > 0:
            with suppress(queue.Empty):
                if self.events.get(timeout=left)["kind"] == "stopped":
                    return

    def close(self) -> None:
        """End the simulator and the guardian."""
        assert self._process.stdin is not None  # noqa: S101
        with suppress(OSError, ValueError):
            self._process.stdin.close()
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()
        self._log.close()

    def output(self) -> str:
        """Return the output of the simulator since the previous call."""
        new = self._unread()
        self._shown += len(new)
        return new.decode(errors="replace")

    def last_words(self) -> str:
        """Return the last lines of the output, without consuming them."""
        lines = self._unread().decode(errors="replace").strip().splitlines()
        return " | ".join(line.strip() for line in lines[-TAIL:])

    def _unread(self) -> bytes:
        with suppress(
            OSError, ValueError
        ):  # pread leaves the file offset alone, at which the simulator writes
            size = os.fstat(self._log.fileno()).st_size
            return os.pread(self._log.fileno(), size - self._shown, self._shown)
        return b""

    def _read(self) -> None:
        assert self._process.stdout is not None  # noqa: S101
        with suppress(OSError, ValueError):
            for line in self._process.stdout:
                self.events.put(json.loads(line))
        self._gone = True
        self.events.put({"kind": "gone"})
