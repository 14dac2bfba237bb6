"""The budget of one repair, in episodes or seconds, shared by all phases of the search."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import monotonic

from pytest_tarl.repairing.incumbent import Watch
from pytest_tarl.repairing.mutants import ORIGINAL, Mutants
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials


@dataclass
class Purse:
    """A budget that pays for the phases of a search, one after another.

    Each phase has a `share`: it ends when it has spent this share of the budget that was left at its start. `late` is
    set when the time is up.
    """

    episodes: int
    seconds: float | None = None
    spent: int = 0
    late: bool = False
    begun: float = field(default_factory=lambda: monotonic())  # a lambda, because tests replace `monotonic`

    def phase(self, mutants: Mutants, method: str, watch: Watch, share: float = 1.0) -> Trials:
        """Return the trials of a phase.

        The trials raise BudgetSpentError when the phase ends. Afterwards, pass them to `settle`.
        """
        order, passed = mutants.order, monotonic() - self.begun
        until = None if self.seconds is None else passed + share * (self.seconds - passed)

        def in_time() -> float:
            now = monotonic() - self.begun
            if until is not None and now > until:
                self.late = True
                raise BudgetSpentError
            return now

        def run(candidate: Candidate, seed: int) -> Outcome:
            now = in_time()
            done, total = (trials.spent, trials.budget) if until is None else (int(now), int(until))
            order.progress(done, total, watch.progress(method))
            outcome = mutants.run(candidate, seed, order.drift)
            watch.saw(candidate, seed, outcome)
            return outcome

        budget = round(share * (self.episodes - self.spent))
        trials = Trials(
            run,
            budget,
            foresee=lambda wanted: mutants.foresee(wanted, order.drift),
            design=lambda seed: mutants.run(ORIGINAL, seed, None),
            unchanged=lambda seed: mutants.run(ORIGINAL, seed, order.drift),
            in_time=in_time,
            limit=self.episodes - self.spent,
        )
        return trials

    def settle(self, trials: Trials) -> None:
        """Pay for the episodes that a phase spent."""
        self.spent += trials.spent
