"""From confirmed candidates to one that holds: under which guard, and does it on fresh seeds?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

from pytest_tarl import seeds
from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, Reason
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.neighbours import NOTHING_BESIDE, Beside, beside
from pytest_tarl.repairing.placing import Placing
from pytest_tarl.repairing.ranges import Ranged, over_the_range
from pytest_tarl.searching import candidates
from pytest_tarl.searching.accept import LOOKS, Acceptance, World, accept
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials

QUICK = 3  # seeds on which a guard is looked at before it is tested on fresh ones
CLOSE = 0.01  # share of the loss within which two gains on the same seeds are equal
HELD: tuple[Reason, ...] = ("nominal gets worse", "another test gets worse")  # in one world, in both of them
OLD_WORLD = 8  # episodes that show what a repair for good earns in the old world
MOST = 5  # candidates that are tested on fresh seeds


@dataclass(frozen=True)
class Accepted:
    """A repair that held: the candidate, and the episodes that show it."""

    candidate: Candidate
    acceptance: Acceptance
    beside: Beside = NOTHING_BESIDE


@dataclass(frozen=True)
class Refused:
    """The best that did not hold, and why; `mean` is its reward on fresh seeds, -inf where it got none."""

    candidate: Candidate | None
    reason: Reason
    mean: float = float("-inf")
    episodes: int = 0


@dataclass(frozen=True)
class Tried:
    """A candidate that was confirmed and then examined, and what became of it; accepted without a reason."""

    candidate: Candidate
    reason: Reason
    totals: tuple[float, ...]
    fresh: bool


class Examiner:
    """Tries guards on confirmed candidates and tests them at α/2ᵏ; remembers the best that was refused."""

    def __init__(self, mutants: Mutants, guards: Sequence[Guard]) -> None:
        self.mutants = mutants
        self.order = mutants.order
        self.guards = guards
        self.placing = Placing(mutants)
        self.ranged: dict[Candidate, Ranged] = {}  # where the drift has a range
        self.tested = 0
        self.spent = 0
        self.bar = float("-inf")  # what a candidate has to gain on known seeds, once one that did was refused
        self.refused = Refused(None, "no operand helps")
        self.tried: list[Tried] = []
        self.lost: tuple[str, ...] = ()  # what other tests lost under candidates
        self.cut = False  # whether the budget ended it

    def first(self, confirmed: Iterator[Candidate], trials: Trials) -> Accepted | None:
        """Take candidates until one is accepted, no more may be tested or the budget of the trials is spent."""
        try:
            for candidate in confirmed:
                for guard in self.guards:
                    if self.tested >= MOST:
                        return None
                    examined = self._examined(replace(candidate, guard=guard), trials)
                    if isinstance(examined, Accepted):
                        return examined
                    if examined == "gain too small" and guard in (candidate.guard, candidates.ALWAYS):
                        break  # where the guard is as wide as the search had it, no other one makes more of it
        except BudgetSpentError:
            self.cut = True
            if self.refused.candidate is None:
                self.refused = replace(self.refused, reason="budget")
        return None

    def _examined(self, candidate: Candidate, trials: Trials) -> Accepted | Reason:
        """Look at a candidate on a few known seeds, then test it on fresh ones; return what was wrong there, if any."""
        placed = self.placing(candidate, trials)
        if placed is None:
            self.tried.append(Tried(candidate, "not at its definition", (), fresh=False))
            self._refuse(Refused(candidate, "not at its definition"))
            return ""
        candidate = placed
        try:
            problem = self._known_to_fail(candidate, trials)
        except RepairError:
            return ""
        if problem:
            self.tried.append(Tried(candidate, problem, (), fresh=False))
            self._refuse(Refused(candidate, problem))
            return ""
        self.tested += 1
        found = self._tested(candidate)
        self.spent += len(found.drifted) + len(found.nominal)
        others = beside(self.mutants, candidate) if found.accepted else NOTHING_BESIDE
        self.spent += others.episodes
        if others.lost:
            self.lost += others.lost
            found = replace(found, accepted=False, reason="another test gets worse")
        totals = tuple(outcome.total for outcome in found.drifted)
        reason = self._named(found.reason, totals)
        self.tried.append(Tried(candidate, reason, totals, fresh=True))
        if found.accepted:
            return Accepted(candidate, self._with_old_world(found, candidate), others)
        if found.reason == "gain too small":
            close = CLOSE * (self.order.goal.enough - self.order.goal.online)
            self.bar = max(self.bar, trials.gain(candidate, self.order.goal.pairs[:QUICK]) - close)
        self._refuse(Refused(candidate, reason, fmean(totals), len(totals)))
        return found.reason

    def _with_old_world(self, found: Acceptance, candidate: Candidate) -> Acceptance:
        """Add what a repair earns in the world that is gone, to be shown; it decides nothing."""
        if not self.order.permanent:
            return found
        fresh = seeds.episode_seeds(self.order.options.seed, "old world", OLD_WORLD)
        self.mutants.foresee([(candidate, seed) for seed in fresh], None)
        self.spent += len(fresh)
        return replace(found, nominal=tuple(self.mutants.run(candidate, seed, None) for seed in fresh))

    def _named(self, reason: Reason, totals: Sequence[float]) -> Reason:
        """Tell what gained too little from what made the drifted world worse than it is without a repair."""
        worse = reason == "gain too small" and fmean(totals) < self.order.goal.online
        return "worse than unrepaired" if worse else reason

    def _known_to_fail(self, candidate: Candidate, trials: Trials) -> Reason:
        """Say why not, from on-line episodes that lost and off-line ones in which the candidate acts; "" if neither."""
        goal, offline = self.order.goal, self.order.fixture.sample
        known = dict(zip(offline.seeds, offline.total.tolist(), strict=True))
        slack = self.order.reference.mean - goal.near
        trials.expect((candidate, pair.seed) for pair in goal.pairs[:QUICK])
        for pair in goal.pairs[:QUICK]:
            if not goal.reached(trials(candidate, pair.seed)):
                return "gain too small"
        if trials.gain(candidate, goal.pairs[:QUICK]) < self.bar:
            return "gain too small"
        firing = self._firing(candidate)[:QUICK]
        self.mutants.foresee([(candidate, seed) for seed in firing], None)
        for seed in firing:
            trials.charge()
            if self.mutants.run(candidate, seed, None).total < known[seed] - slack:
                return "nominal gets worse"
        return ""

    def _tested(self, candidate: Candidate) -> Acceptance:
        """Test a candidate on fresh seeds, the k-th one at α/2ᵏ."""
        order = self.order
        firing = len(self._firing(candidate)) / order.fixture.sample.episodes
        losing = sum(total < order.goal.near for total in order.comparison.totals["online"])
        nominal = self._world(candidate, None, firing) if firing else None

        def test(fresh: Sequence[int], designed: bool) -> Acceptance:
            return accept(
                self._world(candidate, order.drift, losing / len(order.comparison.totals["online"]) or 1.0),
                nominal if designed else None,
                fresh,
                order.reference,
                order.options.alpha / 2**self.tested,
            )

        found, self.ranged[candidate] = over_the_range(order, f"acceptance {self.tested}", LOOKS[-1], test)
        return found

    def _world(self, candidate: Candidate, drift: str | None, exposure: float) -> World:
        return World(
            lambda seed: self.mutants.run(candidate, seed, drift),
            exposure,
            lambda chosen: self.mutants.foresee([(candidate, seed) for seed in chosen], drift),
        )

    def _firing(self, candidate: Candidate) -> tuple[int, ...]:
        """Return the off-line episodes in which the guard holds; none count where the change is for good."""
        if self.order.permanent:
            return ()
        return candidates.firing_episodes(
            candidate.guard, self.order.fixture.sample, self.order.comparison.sensors
        )

    def _refuse(self, refused: Refused) -> None:
        self.refused = furthest(self.refused, refused)


def furthest(one: Refused, other: Refused) -> Refused:
    """Return what came further: in how many worlds it held, or else which earned more on fresh seeds."""

    def came(refused: Refused) -> tuple[bool, int, float]:
        held = HELD.index(refused.reason) + 1 if refused.reason in HELD else 0
        return refused.candidate is not None, held, refused.mean

    return other if came(other) > came(one) else one
