"""Claim a ROS domain on this machine for one simulator."""

from __future__ import annotations

import random
import socket
import sys
from contextlib import suppress

DOMAINS = range(1, 101)  # domains whose ports are below the kernel's ephemeral range


class Domain:
    """A ROS domain that this guardian claims until the process ends."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.number = 0
        candidates = random.SystemRandom().sample(DOMAINS, len(DOMAINS))
        if not sys.platform.startswith("linux"):
            # without abstract sockets, this system has no way to claim a domain
            self.number = candidates[0]
            return
        for number in candidates:
            with suppress(OSError):
                self._socket.bind(f"\0tarl-ros-domain-{number}")
                self.number = number
                return
        raise OSError(f"all {len(DOMAINS)} ROS domains are in use")

    def release(self) -> None:
        """Release the domain."""
        self._socket.close()
