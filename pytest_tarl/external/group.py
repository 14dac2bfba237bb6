"""The simulator's processes: one process group, which always ends with the guardian."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress
from time import monotonic, sleep

from pytest_tarl.external.descendants import adopt, adopted, die_with_parent, reap

PERIOD = 0.01  # seconds between two checks of the group
STEPS = (
    (signal.SIGINT, 2.0),
    (signal.SIGTERM, 1.0),
    (signal.SIGKILL, 5.0),
)  # (signal, seconds for the processes to end)


class Group:
    """A command in its own process group, so that all processes that it starts can be killed.

    The command's output goes to stderr. On Linux, this process adopts the group's orphans and reaps them itself,
    because the init process of a container may not do so. It also kills processes that left the group.
    """

    def __init__(self, command: Sequence[str], folder: str, environment: Mapping[str, str]) -> None:
        adopt()
        self._process = subprocess.Popen(
            list(command),
            cwd=folder,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
            stdout=2,
            stderr=2,
            start_new_session=True,
            preexec_fn=die_with_parent(),
        )

    @property
    def status(self) -> int | None:
        """Return the command's exit status, or None while it is running."""
        return self._process.poll()

    def end(self) -> None:
        """End the group's processes with SIGINT, then SIGTERM, then SIGKILL.

        Processes that left the group only get SIGKILL.
        """
        for number, limit in STEPS:
            self._send(number)
            deadline = monotonic() + limit
            while (alive := self._alive()) and monotonic() < deadline:
                sleep(PERIOD)
            if not alive:
                break
        deadline = monotonic() + STEPS[-1][1]
        while (left := adopted()) and monotonic() < deadline:
            for pid in left:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            sleep(PERIOD)
            reap(-1)

    def kill(self) -> None:
        """Send SIGKILL to the group. Any thread may call this."""
        self._send(signal.SIGKILL)

    def _send(self, number: int) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, number)

    def _alive(self) -> bool:
        """Return whether any process of the group is still running."""
        if self._process.poll() is None:
            return True
        reap(-self._process.pid)
        try:
            os.killpg(self._process.pid, 0)
        except (ProcessLookupError, PermissionError):
            return False
        return True
