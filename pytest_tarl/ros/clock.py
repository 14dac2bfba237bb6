"""Virtual time in whole nanoseconds, so that equal times compare equal on every machine."""

from __future__ import annotations

NANOSECONDS = 1_000_000_000


def nanoseconds(seconds: float) -> int:
    """Round seconds to whole nanoseconds."""
    return round(seconds * NANOSECONDS)


def seconds(time: int) -> float:
    """Return nanoseconds as float seconds, correctly rounded."""
    return time / NANOSECONDS
