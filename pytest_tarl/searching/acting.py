"""Find out whether a change alters what the nodes publish, even if missions earn the same and last as long as before.

For example, the pulley of a watering gantry was replaced, and the gantry waters the wrong place. With any wrong number
of teeth, the mission fails after the same time and with the same reward. So neither time nor reward shows that the
number of teeth matters, but the commands to the motors show it.
"""

from __future__ import annotations

from pytest_tarl.searching.search import Candidate, Goal, Trials
from pytest_tarl.searching.units import Unit

SEEDS = 4  # number of seeds on which the messages of the changed and the unchanged program are compared
CHANGES = 8  # maximum number of changes of a unit whose messages are compared


class Acting:
    """Compare the outputs of changed programs with those of the unchanged one in the drifted world.

    The unchanged program runs once for each seed, when its outputs are first needed. This episode is charged to the
    budget.
    """

    def __init__(self, trials: Trials, goal: Goal) -> None:
        self.trials = trials
        self.goal = goal
        self._ran: dict[Unit, list[Candidate]] = {}
        self._acting: set[Unit] = set()
        self._usual: dict[int, object] = {}

    def ran(self, unit: Unit, candidate: Candidate) -> None:
        """Store a change of a unit that has run."""
        self._ran.setdefault(unit, []).append(candidate)

    def __call__(self, unit: Unit) -> bool:
        """Return whether a change of a unit altered what the nodes publish. Raise BudgetSpentError."""
        if unit not in self._acting and any(map(self._differs, self._ran.get(unit, [])[:CHANGES])):
            self._acting.add(unit)
        return unit in self._acting

    def _differs(self, candidate: Candidate) -> bool:
        for pair in self.goal.pairs[:SEEDS] if self.trials.unchanged is not None else ():
            for outcome in self.trials.ran(candidate, [pair]):
                if outcome.outputs and outcome.outputs != self._published(pair.seed):
                    return True
        return False

    def _published(self, seed: int) -> object:
        if seed not in self._usual and self.trials.unchanged is not None:
            self.trials.charge()
            self._usual[seed] = self.trials.unchanged(seed).outputs
        return self._usual.get(seed)
