"""The simulator's processes: one group, which ends with the guardian, whatever happens."""

from __future__ import annotations

import ctypes
import os
import random
import signal
import socket
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from time import monotonic, sleep

DOMAINS = range(1, 101)  # their ports are below the kernel's ephemeral range
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)
_STEPS = (
    (signal.SIGINT, 2.0),
    (signal.SIGTERM, 1.0),
    (signal.SIGKILL, 5.0),
)  # signals, and s to end after each


class Domain:
    """A ROS domain that no other guardian on this machine uses; the kernel gives it back when the process ends."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.number = 0
        candidates = random.SystemRandom().sample(DOMAINS, len(DOMAINS))
        if not sys.platform.startswith("linux"):
            self.number = candidates[0]  # there is no abstract socket to claim it by
            return
        for number in candidates:
            with suppress(OSError):
                self._socket.bind(f"\0tarl-ros-domain-{number}")
                self.number = number
                return
        raise OSError(f"all {len(DOMAINS)} ROS domains are in use")

    def release(self) -> None:
        """Give the domain back."""
        self._socket.close()


class Group:
    """A command in a process group of its own, so that everything it starts can be killed; output goes to stderr."""

    def __init__(self, command: Sequence[str], folder: str, environment: Mapping[str, str]) -> None:
        self._process = subprocess.Popen(
            list(command),
            cwd=folder,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
            stdout=2,
            stderr=2,
            start_new_session=True,
            preexec_fn=_die_with_parent,
        )

    @property
    def status(self) -> int | None:
        """Return the exit status of the command; None while it runs."""
        return self._process.poll()

    def end(self) -> None:
        """End all processes of the group: by SIGINT, SIGTERM, and SIGKILL."""
        for number, limit in _STEPS:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, number)
            deadline = monotonic() + limit
            while self._alive() and monotonic() < deadline:
                sleep(0.01)
            if not self._alive():
                break
        self._process.wait()

    def _alive(self) -> bool:
        self._process.poll()
        try:
            os.killpg(self._process.pid, 0)
        except (ProcessLookupError, PermissionError):
            return False
        return True


def _die_with_parent() -> None:
    """End the command if the guardian is killed."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
