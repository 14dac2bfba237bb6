"""`--tarl-total`: all comparisons of a run share a number of episodes; undecided ones get the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from pytest_tarl.accounts import Compared
from pytest_tarl.learning.sequential import FEWEST, Look
from pytest_tarl.learning.spending import Stage, Standing, chosen, next_look, schedule
from pytest_tarl.report.shares import Share, sentence


def shortage(total: int, comparisons: int) -> str:
    """Return a sentence if `total` episodes are too few for this number of comparisons, or an empty text."""
    if total >= FEWEST * comparisons:
        return ""
    return (
        f"--tarl-total={total} is too small: this run has {comparisons} comparisons, and each needs at least {FEWEST} "
        f"episodes. Raise it to {FEWEST * comparisons} or more, or compare fewer scenarios."
    )


@dataclass(frozen=True)
class SharedEpisodes:
    """How the comparisons of a run share its episodes.

    A look is one test for a verdict; each comparison has at most `most_looks`.
    """

    total: int
    comparisons: int
    most_looks: int

    @cached_property
    def looks(self) -> tuple[Look, ...]:
        """Return the looks of every comparison, which are the same for all and fixed before the first episode."""
        return schedule(self.total, self.comparisons, self.most_looks)

    @property
    def first(self) -> Stage:
        """Return the first stage of the comparisons, which ends at their first look."""
        return Stage(self.looks, self.looks[0].episodes)

    def following(self, outcomes: Sequence[object]) -> tuple[int, Stage] | None:
        """Return the index of the outcome whose comparison continues, with its next stage; None if none does."""
        standings = [_standing(one) for one in outcomes]
        number = chosen(standings, self.looks, self._left(outcomes))
        look = next_look(standings[number], self.looks) if number is not None else None
        return None if number is None or look is None else (number, Stage(self.looks, look.episodes))

    def notes(self, outcomes: Sequence[object]) -> list[str]:
        """Return for each comparison a note on how many episodes it got, and why; "" for other outcomes."""
        return [
            self._note(one, self._left(outcomes)) if isinstance(one, Compared) else "" for one in outcomes
        ]

    def _note(self, outcome: Compared, left: int) -> str:
        standing, seen = _standing(outcome), outcome.online.looks
        later = next((look.episodes for look in self.looks if look.episodes > standing.episodes), None)
        missing = later - standing.episodes if later is not None else None
        return sentence(Share(self.total, self.comparisons, seen, standing.decided, missing, left))

    def _left(self, outcomes: Sequence[object]) -> int:
        return self.total - sum(one.online.looks[-1][0] for one in outcomes if isinstance(one, Compared))


def _standing(outcome: object) -> Standing:
    """Return the progress of a comparison; a test without a comparison counts as decided."""
    if not isinstance(outcome, Compared):
        return Standing(0, decided=True)
    episodes, p_worse = outcome.online.looks[-1]
    return Standing(episodes, p_worse, outcome.online.decided)
