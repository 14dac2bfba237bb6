"""Show progress on a terminal: finished episodes, their rate, and the time left.

The line appears immediately and changes at most ten times per second. The clock affects only what is displayed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic

INTERVAL = 0.1  # seconds between two updates
SETTLED = 0.5  # seconds until the rate is stable enough to be shown


@dataclass
class ProgressLine:
    """The finished and planned episodes of each phase; `write` replaces the previous line."""

    name: str
    write: Callable[[str], None]
    clock: Callable[[], float] = monotonic
    done: int = 0
    total: int = 0
    _phase: str = ""
    _begun: tuple[float, int] = field(default=(0.0, 0))  # start of the phase, and episodes finished before it
    _shown: float = 0.0

    def __call__(self, done: int, total: int, phase: str) -> None:
        """Show how many episodes of a phase have finished."""
        now = self.clock()
        fresh = phase != self._phase or done < self.done
        if fresh:
            self._phase, self._begun = phase, (now, done)
        self.done, self.total = done, total
        if fresh or now - self._shown >= INTERVAL:
            self._shown = now
            self.write(f"{self.name} {phase} {done}/{total}{self._pace(now)} ")

    def _pace(self, now: float) -> str:
        seconds, episodes = now - self._begun[0], self.done - self._begun[1]
        if seconds < SETTLED or episodes < 1:
            return ""
        rate = episodes / seconds
        return f", {rate:.3g}/s, {duration((self.total - self.done) / rate)} left"


def duration(seconds: float) -> str:
    """Format a duration in its two largest units, such as `8 s`, `3 min 20 s` or `2 h 5 min`."""
    whole = max(0, round(seconds))
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
