"""A ROS domain for one simulator, claimed on this machine."""

from __future__ import annotations

import random
import socket
import sys
from contextlib import suppress

DOMAINS = range(1, 101)  # the ports of these domains are below the kernel's ephemeral range


class Domain:
    """A ROS domain of this guardian, claimed until the process ends."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.number = 0
        candidates = random.SystemRandom().sample(DOMAINS, len(DOMAINS))
        if not sys.platform.startswith("linux"):
            # this system has no abstract sockets, with which a process could claim a domain for itself
            self.number = candidates[0]
            return
        for number in candidates:
            with suppress(OSError):
                self._socket.bind(f"\0tarl-ros-domain-{number}")
                self.number = number
                return
        raise OSError(f"all {len(DOMAINS)} ROS domains are in use")

    def release(self) -> None:
        """Release the claim on the domain."""
        self._socket.close()
