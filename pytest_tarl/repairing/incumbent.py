"""Track the candidates of a search: the best one so far, and the dropped ones with the reasons."""

from __future__ import annotations

from collections.abc import Iterable
from statistics import fmean

from pytest_tarl.repairing.ledger import Refused, Tried
from pytest_tarl.repairing.request import Order
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import Candidate

LEAST = 2  # a candidate with more runs than this reached the confirmation stage


class Watch:
    """Store the outcomes of all candidates that searches run in the drifted world."""

    def __init__(self, order: Order) -> None:
        self.order = order
        self.without = {pair.seed: pair.total for pair in order.goal.pairs}
        self.seen: dict[Candidate, dict[int, Outcome]] = {}
        self.best: Candidate | None = None

    def saw(self, candidate: Candidate, seed: int, outcome: Outcome) -> None:
        """Store the outcome of one episode."""
        self.seen.setdefault(candidate, {})[seed] = outcome
        if self.best is None or self._worth(candidate) > self._worth(self.best):
            self.best = candidate

    def gain(self, candidate: Candidate) -> float:
        """Return a candidate's gain per episode, relative to unmutated runs with the same seeds."""
        goal = self.order.goal
        known = self.seen[candidate].items()
        return fmean(goal.gain(run, self.without.get(seed, goal.online)) for seed, run in known)

    def best_so_far(self, refused: Refused) -> Refused:
        """Return `refused` if it has a candidate, or else the best candidate of the search with its figures."""
        if refused.candidate is not None or self.best is None:
            return refused
        totals = [run.total for run in self.seen[self.best].values()]
        return Refused(self.best, refused.reason, fmean(totals), len(totals))

    def unconfirmed(self, tried: Iterable[Tried]) -> list[Tried]:
        """Return, in order, the candidates that nearly reached the goal but were not confirmed."""
        examined = {one.candidate.changes for one in tried}
        dropped = []
        for candidate, runs in self.seen.items():
            first = next(iter(runs))
            near = self.order.goal.reached(runs[first], first) and len(runs) > LEAST
            if near and all(self.order.goal.reached(run, seed) for seed, run in runs.items()):
                continue  # this candidate was confirmed, but another one was preferred to it
            if near and candidate.changes not in examined:
                totals = tuple(run.total for run in runs.values())
                dropped.append(Tried(candidate, "not confirmed", totals, fresh=False))
        return dropped

    def progress(self, method: str) -> str:
        """Return the name of the search and the gain of its best candidate so far."""
        if self.best is None:
            return method
        wanted = self.order.goal.wanted
        return f"{method} (best so far {self.gain(self.best):+.3g} of {wanted:.3g})"

    def _worth(self, candidate: Candidate) -> float:
        """Return a candidate's gain, shrunk towards 0 if it has few runs."""
        runs = len(self.seen[candidate])
        return self.gain(candidate) * runs / (runs + 1)
