"""Sums over the messages that nodes publish, which show whether a change alters what a node does.

A change may alter every command of a failing mission without changing its reward or length. If the sums are equal, the
node very likely behaved the same.
"""

from __future__ import annotations

from typing import Any

from pytest_tarl.instrumentation.magnitude import magnitude


class Outputs:
    """Sum the sizes of all messages by topic, and again weighted by index, to detect another order.

    The third number is the largest size.
    """

    def __init__(self) -> None:
        self.sums: dict[str, tuple[float, float, float]] = {}
        self._count = 0

    def __call__(self, topic: str, message: Any) -> None:
        """Add a message."""
        self._count += 1
        size, (plain, weighted, most) = magnitude(message), self.sums.get(topic, (0.0, 0.0, 0.0))
        self.sums[topic] = (plain + size, weighted + size * self._count, max(most, size))
