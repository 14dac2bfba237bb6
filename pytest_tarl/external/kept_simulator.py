"""A simulator that keeps running and is reset for later episodes."""

from __future__ import annotations

import atexit

from pytest_tarl.external.arguments import Setup
from pytest_tarl.external.client import Client


class Kept:
    """This process's guardian and its running simulator."""

    def __init__(self) -> None:
        self.client: Client | None = None
        self.running: Setup | None = None

    def opened(self) -> Client:
        """Return the guardian, which starts when first needed."""
        if self.client is None or not self.client.alive:
            self.close()
            self.client = Client()
        return self.client

    def close(self) -> None:
        """End the guardian and the simulator."""
        if self.client is not None:
            self.client.close()
        self.client = self.running = None


KEPT = Kept()
atexit.register(KEPT.close)
