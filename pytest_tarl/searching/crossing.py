"""Cross a plateau, where all failing missions earn the same: try the steps of `plateau` in turn."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.model import Guard
from pytest_tarl.searching import plateau
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit

# the finer steps on a few constants stop when a change gains this share of the wanted gain
CLEARLY = 0.3


class Crossing:
    """Try steps across the plateau of one search."""

    def __init__(self, attempts: Attempts) -> None:
        self.attempts = attempts
        self._inside: set[Guard] = set()

    def across(self, guard: Guard, steps: Sequence[plateau.Step]) -> Iterator[Candidate]:
        """Try the steps of `plateau` under a guard while no unit gains reward."""
        tries, gains = self.attempts, self.attempts.gains
        for factor, before in () if tries.proposed else steps:
            if gains.anything():
                return
            yield from tries.sweep(factor, guard, plateau.among(before, tries.units, gains, guard))

    def of_few(self, guard: Guard, few: Sequence[Unit]) -> Iterator[Candidate]:
        """Try steps up to `plateau.FINE_UNTIL` on a few units, with half of the episodes left.

        Stop when the gain of a unit is at least `CLEARLY`. Smaller gains do not count, because a wrong constant may
        gain a little on one seed.
        """
        tries, gains = self.attempts, self.attempts.gains
        until = tries.trials.spent + (tries.trials.budget - tries.trials.spent) // 2
        for factor, before in plateau.STEPS[: plateau.FINE_UNTIL]:
            if gains.anything(CLEARLY * tries.goal.wanted) or tries.trials.spent >= until:
                return
            yield from tries.sweep(factor, guard, plateau.among(before, few, gains, guard))

    def inward(self, guard: Guard) -> Iterator[Candidate]:
        """Try the inward steps (see `plateau`) under a guard, once, if a large change gains most."""
        tries, gains = self.attempts, self.attempts.gains
        if tries.proposed or guard in self._inside or not plateau.best_is_far(gains, guard):
            return
        self._inside.add(guard)
        matter, steps = plateau.inward(tries.units, gains)
        for factor in steps:
            if not plateau.best_is_far(gains, guard):
                return
            yield from tries.sweep(factor, guard, matter)
