"""Examine confirmed candidates in turn, each under suitable guards and on fresh seeds, until one is accepted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

from pytest_tarl import seeds
from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, Reason
from pytest_tarl.patching.rewriting import conditional_definition
from pytest_tarl.repairing.between import STRONG, WEAK, further
from pytest_tarl.repairing.centring import THIN, centred
from pytest_tarl.repairing.good_range import GoodRange
from pytest_tarl.repairing.known_missions import firing, harmed, harms_again, known_to_fail, lost_as_designed
from pytest_tarl.repairing.ledger import Ledger, Refused, Tried, alike, furthest, of_fresh_seeds, operands
from pytest_tarl.repairing.missed import Missed
from pytest_tarl.repairing.mutants import ORIGINAL, Mutants
from pytest_tarl.repairing.other_values import Others, OtherValues
from pytest_tarl.repairing.placing import Placing
from pytest_tarl.repairing.ranges import Ranged, over_the_range
from pytest_tarl.repairing.regression_tests import NOTHING_BESIDE, Beside, beside
from pytest_tarl.repairing.smoothing import smoothed
from pytest_tarl.searching import candidates
from pytest_tarl.searching.accept import SEEDS, TOO_LITTLE, Acceptance, Outcome, World, accept, risk_of
from pytest_tarl.searching.confirming import CONFIRMATIONS
from pytest_tarl.searching.plainness import oddness
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials

UNWRITABLE: Reason = "cannot be written"
WORLDS = 3  # a test runs missions of three kinds: drifted, designed, and designed without the candidate
# if the drift is permanent, number of episodes in the old world, whose reward is only displayed
OLD_WORLD = 8
MOST = 5  # maximum number of candidates to test per search
# maximum number of tests of the same operands while there are untested candidates of other operands
SHARE = 2
WORSE: Reason = "nominal gets worse"
# Minimum number of search episodes for finding a confirmed candidate's guard: three missions in each world for about
# six guards. Without these episodes, the candidate cannot be used and the search for it was in vain.
EXAMINED = 40
SAME = (
    # a condition counts as holding throughout drifted missions if this many missions are the same without it
    3
)
SCREENED = 20  # maximum number of candidates per search that are run on fresh seeds


@dataclass(frozen=True)
class Accepted:
    """An accepted repair: the candidate and the episodes of its test."""

    candidate: Candidate
    acceptance: Acceptance
    beside: Beside = NOTHING_BESIDE


class Examiner:
    """Try guards on confirmed candidates, test each candidate once, and keep the best refused candidate."""

    def __init__(self, mutants: Mutants, guards: Sequence[Guard]) -> None:
        self.mutants = mutants
        self.order = mutants.order
        self.guards = guards
        self.placing = Placing(mutants)
        # results for each part of the range, if the drift has a range of sizes
        self.ranged: dict[Candidate, Ranged] = {}
        self.ledger = Ledger()
        # candidates that pass on known seeds; they wait because `SHARE` other candidates of the same operands have
        # been tested
        self.waiting: list[Candidate] = []
        self._missed = Missed()
        self.others = Others(mutants, self.ledger, self._missed)
        self.good_range = GoodRange(mutants.mutate)
        self.tested = 0
        self._ran = 0  # number of episodes run in the current test
        self.turns = 1  # number of searches so far; each may spend `MOST` tests
        self.spent = 0
        self.refused = Refused(None, "no operand helps")
        self.lost: tuple[str, ...] = ()  # one sentence for each other test that lost reward with a candidate
        self.cut = False  # whether the budget ended the search

    @property
    def tried(self) -> Sequence[Tried]:
        """Return the examined candidates and their results, in order."""
        return self.ledger.tried

    def first(self, confirmed: Iterator[Candidate], trials: Trials) -> Accepted | None:
        """Examine candidates until one is accepted, no more tests are allowed, or the budget is spent."""
        trials.loses = lambda candidate: self._missed.again(candidate, trials, self.order.goal)
        trials.lost_missions = self._missed.latest
        trials.harms = lambda candidate: operands(candidate) in self._missed.harmed
        try:
            for candidate in confirmed:
                with trials.granting(EXAMINED):
                    accepted = self._under_guards(candidate, trials)
                if accepted is not None or self._exhausted():
                    return accepted
        except BudgetSpentError:
            self.cut = True
            if self.refused.candidate is None:
                self.refused = replace(self.refused, reason="budget")
        return self._of_those_waiting()

    def _under_guards(self, candidate: Candidate, trials: Trials) -> Accepted | None:
        """Examine a candidate under every guard, then with other values (stronger, milder and neighbouring values)."""
        edges: list[Candidate] = []  # candidates that pass on known seeds but fail on some fresh seeds
        weak: list[Guard] = []  # guards under which the reward in the drifted world stays too low
        for guard in self.guards:
            if any(_narrower(guard, known) for known in weak):
                continue
            examined = self._examined(replace(candidate, guard=guard), trials)
            if isinstance(examined, Accepted) or self._exhausted():
                return examined if isinstance(examined, Accepted) else None
            if examined.reason in WEAK:
                weak.append(guard)
                edges += [examined.candidate] if examined.fresh else []
            for others in self._other_values(candidate, examined, weak, trials):
                accepted = self._followed(others, trials)
                if accepted is not None or self._exhausted():
                    return accepted
            if operands(examined.candidate) == operands(candidate):
                candidate = replace(
                    candidate, mutations=examined.candidate.changes
                )  # keep the centred values, so that they are not centred again
            wide = guard == candidate.guard or (examined.fresh and guard == candidates.ALWAYS)
            if wide and self._too_little(examined):
                # this guard holds wherever the guard of the search holds, so narrower guards cannot gain more
                break
            if examined.fresh and self._too_little(examined) and self._holds_throughout(examined, trials):
                break  # without the condition, drifted missions are the same, so no other condition can gain more
        for others in (
            *(self.others.inward(edge, trials) for edge in edges),
            *(self.others.beyond(edge) for edge in edges),
            *(
                self.others.milder(replace(candidate, guard=guard))
                for guard in dict.fromkeys((candidates.ALWAYS, candidate.guard))
            ),
            self.others.beside(trials),
            *(self.others.following(one) for one in self._harmful(candidate)),
        ):
            accepted = self._followed(others, trials)
            if accepted is not None or self._exhausted():
                return accepted
        return None

    def _too_little(self, examined: Tried) -> bool:
        """Return whether a candidate earns too little under the drift.

        A loss in the designed world does not count, even if the test did not show its size: a narrower condition can
        prevent such a loss.
        """
        return examined.reason in (*TOO_LITTLE, *WEAK) and examined.candidate not in self._missed.costly

    def _holds_throughout(self, examined: Tried, trials: Trials) -> bool:
        """Return whether the condition never held in the designed world and makes no difference in drifted missions."""
        candidate = replace(examined.candidate, mutations=examined.candidate.changes)
        known = trials.same_as(candidate, replace(candidate, guard=candidates.ALWAYS))
        return bool(candidate.guard.conjuncts) and known >= SAME and not firing(self.order, candidate)

    def _harmful(self, candidate: Candidate) -> Iterator[Candidate]:
        """Yield the candidate without its condition if it then helps the drifted world but harms the designed one."""
        known = self.ledger.alike(replace(candidate, guard=candidates.ALWAYS))
        if known is not None and known.reason in STRONG:
            yield known.candidate

    def _other_values(
        self, candidate: Candidate, examined: Tried, weak: list[Guard], trials: Trials
    ) -> Iterator[OtherValues]:
        """Yield generators of other values, which are tried before the candidate's next guard. Update `weak`."""
        guard = examined.candidate.guard
        if guard == candidates.ALWAYS and examined.reason in (*WEAK, *STRONG):
            yield self.others.unguarded(candidate, examined.reason, trials)
        if examined.fresh and examined.reason in WEAK:
            yield self.others.following(examined.candidate)
        if examined.fresh and self._missed.nearly_right(examined.candidate):
            weak.append(guard)
            yield self.others.improved(examined.candidate, trials)

    def _followed(self, others: OtherValues, trials: Trials) -> Accepted | None:
        """Examine other values of a candidate; each result determines the next value."""
        told: Tried | None = None
        while True:
            try:
                candidate = next(others) if told is None else others.send(told)
            except StopIteration:
                return None
            examined = self._examined(candidate, trials)
            if not isinstance(examined, Accepted) and examined.fresh and examined.reason == WORSE:
                examined = self._conditionally(examined, trials)
            if isinstance(examined, Accepted) or self._exhausted():
                return examined if isinstance(examined, Accepted) else None
            told = examined

    def _conditionally(self, examined: Tried, trials: Trials) -> Accepted | Tried:
        """If a value passes in the drifted world but harms the designed one, examine it under every condition."""
        candidate, found = examined.candidate, examined
        weak: list[Guard] = []
        for guard in self.guards if not candidate.guard.conjuncts else ():
            if any(_narrower(guard, known) for known in weak):
                continue
            with_guard = self._examined(replace(candidate, guard=guard, mutations=candidate.changes), trials)
            if isinstance(with_guard, Accepted) or self._exhausted():
                return with_guard
            found = with_guard
            if self._too_little(found):
                weak.append(guard)
                if guard == candidates.ALWAYS:
                    break  # no narrower condition can gain more reward
        return found

    def _examined(self, candidate: Candidate, trials: Trials) -> Accepted | Tried:
        """Examine a candidate on known seeds, then on fresh seeds, unless a similar candidate was examined before."""
        if conditional_definition(candidate.mutations, candidate.guard):
            return self._refused(candidate, UNWRITABLE)
        chosen = candidate in self.others.chosen
        if self._harms_again(candidate, trials):
            return self._refused(candidate, WORSE)
        value = candidate if chosen else self._centred(candidate, trials)
        if isinstance(value, Tried):
            return value
        problem = self._failing_at_once(value, trials)
        value = value if problem or chosen else self._cheaper(value, trials)
        placed = None if problem else self.placing(value, trials)
        if placed is None:
            return self._refused(value, problem or "not at its definition")
        self._missed.equate(value, candidate := placed)
        try:
            problem = known_to_fail(self.mutants, candidate, trials, self._missed)
        except RepairError:
            problem = UNWRITABLE
        if problem:
            return self._refused(candidate, problem)
        for nicer in smoothed(self.order, candidate):
            examined = self._examined(nicer, trials)
            if isinstance(examined, Accepted):
                return examined
        if self.ledger.tests(candidate) >= SHARE and not chosen and not self.others.bracketed(candidate):
            self.waiting.append(candidate)
            return Tried(candidate, "never tested", ())
        for plainer in [one for one in self.waiting if oddness(one.mutations) < oddness(candidate.mutations)]:
            self.waiting.remove(plainer)
            examined = self._on_fresh_seeds(plainer)
            if isinstance(examined, Accepted) or self._exhausted():
                return examined
        return self._on_fresh_seeds(candidate)

    def _harms_again(self, candidate: Candidate, trials: Trials) -> bool:
        """Return whether one designed mission shows that a new candidate does harm, although it reaches the goal."""
        if operands(candidate) not in self._missed.harmed or self._known(candidate) is not None:
            return False
        try:
            near = trials.reaches(candidate, self.order.goal.pairs[0].seed, self.order.goal)
            return near and harms_again(self.mutants, candidate, trials, self._missed)
        except RepairError:
            return False

    def _failing_at_once(self, candidate: Candidate, trials: Trials) -> Reason:
        """Return why a candidate fails on the first seed or in the designed world, or "" if it passes."""
        goal = self.order.goal
        first = goal.pairs[0].seed
        try:
            if not trials.reaches(candidate, first, goal):
                trials.misses[first] += 1
                return "gain too small"
            return WORSE if harmed(self.mutants, candidate, trials, self._missed) else ""
        except RepairError:
            return ""

    def _cheaper(self, candidate: Candidate, trials: Trials) -> Candidate:
        """If a structural change loses much of the margin in designed missions, return a smaller change.

        With such a loss, a test can hardly show that the loss stays below the margin, and would only use up a share of
        α. A change of a constant is returned unchanged: a smaller change may lie at the end of the range of good
        values, and a condition may prevent the loss.
        """
        if all(mutation.form is None for mutation in candidate.mutations):
            return candidate
        lost, margin = lost_as_designed(self.mutants, candidate, self._missed), self.order.reference.margin
        for smaller in self.others.nearer(candidate, trials) if lost > THIN * margin else ():
            if self._passes(smaller, trials) and not self._failing_at_once(smaller, trials):
                less = lost_as_designed(self.mutants, smaller, self._missed)
                return smaller if less < lost else candidate
        return candidate

    def _passes(self, candidate: Candidate, trials: Trials) -> bool:
        """Return whether a candidate reaches the goal on the first known seeds."""
        goal = self.order.goal
        try:
            return all(trials.reaches(candidate, pair.seed, goal) for pair in goal.pairs[:CONFIRMATIONS])
        except RepairError:
            return False

    def _refused(self, candidate: Candidate, reason: Reason) -> Tried:
        """Store that a candidate fails on known missions."""
        self._refuse(Refused(candidate, reason))
        return self.ledger.enter(Tried(candidate, reason, ()))

    def _centred(self, candidate: Candidate, trials: Trials) -> Candidate | Tried:
        """Return the candidate with the best value nearby. If a similar candidate has a result, return that instead."""
        known = self._known(candidate)
        if known is not None:
            return known
        if self._goes_further(candidate):
            return self.ledger.enter(Tried(candidate, "a smaller step breaks it", ()))
        same = self._acting_alike(candidate, trials)
        if same is not None:
            return self.ledger.enter(Tried(candidate, same.reason, ()))
        if self._missed.again(candidate, trials, self.order.goal):
            # test this value at once: if it loses the missions that rejected values lost, its neighbours lose them, too
            return candidate
        goal, reference = self.order.goal, self.order.reference
        better = self.good_range.amid(candidate, trials, goal, reference)
        if better == candidate:
            better = centred(candidate, trials, self.mutants.mutate, goal, reference, self.ledger.knows)
        # if the centred value was examined before, examine the original value
        return candidate if self.ledger.knows(better) else better

    def _known(self, candidate: Candidate) -> Tried | None:
        """Return the result of a similar candidate, examined or waiting for its test, or None."""
        waiting = (Tried(one, "never tested", ()) for one in self.waiting if alike(one, candidate))
        return self.ledger.alike(candidate) or next(waiting, None)

    def _acting_alike(self, candidate: Candidate, trials: Trials) -> Tried | None:
        """Return a tested candidate that earned too little and had the same outcomes on all known seeds.

        Tested candidates whose missions failed do not count: a candidate with the same outcomes on known seeds may
        still pass on harder seeds.
        """
        return next(
            (
                one
                for one in self.tried
                if one.candidate in self._missed.poor
                and one.reason in (*WEAK, *TOO_LITTLE)
                and trials.same_as(candidate, one.candidate) >= CONFIRMATIONS
            ),
            None,
        )

    def _goes_further(self, candidate: Candidate) -> bool:
        """Return whether a smaller change of the same operands under the same guard has already done harm."""
        return any(
            one.reason in STRONG
            and one.candidate.guard == candidate.guard
            and further(candidate, one.candidate)
            for one in self.tried
        )

    def _of_those_waiting(self) -> Accepted | None:
        """Test the waiting candidates while any tests are left."""
        while self.waiting and not self._exhausted():
            examined = self._on_fresh_seeds(self.waiting.pop(0))
            if isinstance(examined, Accepted):
                return examined
        for candidate in self.waiting:
            self.ledger.enter(Tried(candidate, "never tested", ()))
            self._refuse(Refused(candidate, "never tested"))
        self.waiting.clear()
        return None

    def _exhausted(self) -> bool:
        most, screened = MOST * self.turns, SCREENED * self.turns
        return self.tested >= most or of_fresh_seeds(self.tried) >= screened

    def _on_fresh_seeds(self, candidate: Candidate) -> Accepted | Tried:
        """Test a candidate once, then run the other recorded tests that use the changed files."""
        found = self._tested(candidate)
        self.spent += found.episodes
        others = beside(self.mutants, candidate) if found.accepted else NOTHING_BESIDE
        self.spent += others.episodes
        if others.lost:
            self.lost += others.lost
            found = replace(found, accepted=False, reason="another test gets worse")
        totals = tuple(outcome.total for outcome in found.drifted)
        reason = self._named(found.reason, totals)
        tried = self.ledger.enter(Tried(candidate, reason, totals, fresh=True, tested=found.tested))
        if found.accepted:
            return Accepted(candidate, self._with_old_world(found, candidate), others)
        self._refuse(Refused(candidate, reason, fmean(totals), len(totals)))
        self._missed.learn(candidate, found, self.order.goal, self.order.reference)
        return tried

    def _with_old_world(self, found: Acceptance, candidate: Candidate) -> Acceptance:
        """Add the reward of a permanent repair in the old world, for display only."""
        if not self.order.permanent:
            return found
        fresh = seeds.episode_seeds(self.order.options.seed, "old world", OLD_WORLD)
        self.mutants.foresee([(candidate, seed) for seed in fresh], None)
        self.spent += len(fresh)
        return replace(found, nominal=tuple(self.mutants.run(candidate, seed, None) for seed in fresh))

    def _named(self, reason: Reason, totals: Sequence[float]) -> Reason:
        """Replace the reason "gain too small" if the reward is even lower than that of the unrepaired program."""
        worse = reason == "gain too small" and fmean(totals) < self.order.goal.online
        return "worse than unrepaired" if worse else reason

    def _tested(self, candidate: Candidate) -> Acceptance:
        """Test a candidate on its own fresh seeds."""
        order, number = self.order, of_fresh_seeds(self.tried) + 1
        self._ran = 0
        nominal = self._world(candidate, None) if firing(self.order, candidate) else None

        def test(fresh: Sequence[int]) -> Acceptance:
            return accept(
                self._world(candidate, order.drift),
                nominal,
                self._world(ORIGINAL, None),
                fresh,
                order.reference,
                risk_of(order.options.alpha, self.tested),
            )

        found, self.ranged[candidate] = over_the_range(order, f"acceptance {number}", SEEDS, test)
        self.tested += found.tested
        return found

    def _world(self, candidate: Candidate, drift: str | None) -> World:
        def run(seed: int) -> Outcome:
            self._ran += 1
            self.order.progress(
                self._ran, WORLDS * SEEDS, f"acceptance of candidate {self.tested + 1}, at most"
            )
            return self.mutants.run(candidate, seed, drift)

        return World(
            run,
            lambda chosen: self.mutants.foresee([(candidate, seed) for seed in chosen], drift),
        )

    def _refuse(self, refused: Refused) -> None:
        self.refused = furthest(self.refused, refused)


def _narrower(guard: Guard, known: Guard) -> bool:
    """Return whether a guard consists of a known guard and additional conditions."""
    return bool(known.conjuncts) and set(known.conjuncts) < set(guard.conjuncts)
