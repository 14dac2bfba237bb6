"""Propose other values of an examined candidate: larger steps, neighbouring values or smaller steps.

Each method is a generator that yields the next candidate to examine and receives its result by `send`.
"""

from __future__ import annotations

import itertools
from collections.abc import Generator, Iterator, Sequence
from dataclasses import replace
from math import sqrt

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, Reason
from pytest_tarl.repairing.between import STRONG, WEAK, Between, common_factor, stronger
from pytest_tarl.repairing.centring import ASIDE, in_place, moved, neighbours
from pytest_tarl.repairing.following import following
from pytest_tarl.repairing.ledger import Ledger, Tried, operands
from pytest_tarl.repairing.missed import Lost, Missed
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.searching.accept import TOO_LITTLE
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Trials
from tarl_lint.model import Operand

# if a candidate is at the edge of the range of good values, its factors are raised to these powers
POWERS = (1.5, 2.0)
# if a candidate's missions succeed but earn too little, its factors are raised to these powers
MILDER = (0.75, 0.5)
# if a value loses too much in its test, its neighbours are tried, spaced by these ratios
RATIOS = (1.1, 1.03)
MOVES = 3  # maximum number of moves in one direction with one ratio
BETTER = 0.1  # a neighbour is better if it earns more by at least this share of the margin
KNOWN = 3  # number of known seeds on which a smaller change must reach the goal
UNGUARDED = 3  # maximum number of values of a candidate that are tried without its condition
# while a neighbour acts exactly like a refused value, its ratio to the refused value is raised to these powers
PLATEAU = (1, 2, 4, 8)
CLOSE = 1.3  # maximum ratio of two rejected values between which good values may lie

OtherValues = Generator[Candidate, Tried, None]
Place = tuple[frozenset[Operand], Guard]


class Others:
    """Propose other values of a candidate. Each method does so at most once for the same operands and guard."""

    def __init__(self, mutants: Mutants, ledger: Ledger, missed: Missed) -> None:
        self.mutants = mutants
        self.ledger = ledger
        self.missed = missed
        self._pushed: set[Place] = set()
        self._unguarded: set[frozenset[Operand]] = set()
        self._following: set[frozenset[Operand]] = set()
        self._bisected: set[Place] = set()
        self._inward: set[Place] = set()
        self._nearer: set[Place] = set()
        self._mended: set[Candidate] = set()
        self._recentred: set[Place] = set()
        # values that earned more than a refused value in missions of the refused value's acceptance test
        self.chosen: set[Candidate] = set()

    def beyond(self, candidate: Candidate) -> OtherValues:
        """Propose larger steps if a candidate fails on some seeds, or smaller ones if it earns too little.

        A candidate that fails on only some seeds is at the edge of the range of good values.
        """
        place = (operands(candidate), candidate.guard)
        if place in self._pushed:
            return
        self._pushed.add(place)
        for power in MILDER if candidate in self.missed.poor else POWERS:
            moved = stronger(candidate, power, self.mutants.mutate)
            if moved is None:
                return
            examined = yield moved
            if not examined.fresh or examined.reason not in (*WEAK, *TOO_LITTLE):
                return

    def following(self, candidate: Candidate) -> OtherValues:
        """Propose that the constant follows a sensor, because one value fits only some missions or one world."""
        if operands(candidate) in self._following:
            return
        self._following.add(operands(candidate))
        yield from following(self.mutants.order, in_place(candidate))

    def unguarded(self, candidate: Candidate, reason: Reason, trials: Trials) -> OtherValues:
        """Propose smaller changes that may work in both worlds without the condition of a candidate.

        For example, the threshold that was found may be too low where the condition does not hold, but a threshold that
        is a little higher may suit both worlds. Bisect between the original value and the value that was found. If a
        value fails without the condition, run it under the condition to see whether it is too small. Move a value that
        reaches the goal to the middle of the good range. `reason` says why the candidate fails without its condition.
        Raise BudgetSpentError.
        """
        if not candidate.guard.conjuncts or operands(candidate) in self._unguarded:
            return
        self._unguarded.add(operands(candidate))
        between = Between(replace(in_place(candidate), guard=ALWAYS), self.mutants.mutate)
        for _ in range(UNGUARDED):
            middle = between.middle()
            if middle is None:
                return
            if self._reaches(middle, trials):
                examined = yield self._amid(between, middle, reason in STRONG, trials)
                # keep the remaining tests for the candidate under its condition
                if examined.fresh or not between.told(examined.reason):
                    return
                continue
            enough = self._reaches(replace(middle, guard=candidate.guard), trials)
            between.told(STRONG[0] if enough else WEAK[0])

    def _amid(self, between: Between, good: Candidate, harmful: bool, trials: Trials) -> Candidate:
        """Try values inward and outward of `good`; return the mean of those that reach the goal.

        If larger changes harm the designed world (`harmful`), do not try the outward value.
        """
        low, high = (between.weak + between.share) / 2, (between.share + between.strong) / 2
        beside = (low,) if harmful else (low, high)
        held = [
            share for share in beside if (one := between.at(share)) is not None and self._reaches(one, trials)
        ]
        amid = between.at(sum((between.share, *held)) / (len(held) + 1))
        return good if amid is None else amid

    def inward(self, refused: Candidate, trials: Trials) -> OtherValues:
        """Propose a smaller change than `refused`, which lost reward in a few missions.

        Bisect between the original value and the refused one. A change that fails on the first seed of the search is
        too small; a change that passes may be too large. Find the values that also pass in the missions in which
        `refused` lost reward, and propose the middle one. Raise BudgetSpentError.
        """
        place = (operands(refused), refused.guard)
        if not self.missed.few.get(refused) or place in self._inward:
            return
        self._inward.add(place)
        between, good = Between(in_place(refused), self.mutants.mutate), list[Candidate]()
        while (middle := between.middle()) is not None:
            enough = self._reaches(middle, trials)
            if enough and self._mends(middle, refused, trials):
                good.append(middle)
            between.told(STRONG[0] if enough else WEAK[0])
        if good and not self.ledger.knows(good[len(good) // 2]):
            # the refused value earned more on known missions, so centring would move this value back towards it
            self.chosen.add(good[len(good) // 2])
            yield good[len(good) // 2]

    def improved(self, refused: Candidate, trials: Trials) -> OtherValues:
        """Propose a value that loses less in the world in which a candidate lost too much. Raise BudgetSpentError."""
        costly = refused in self.missed.costly
        yield from self.nearer(refused, trials) if costly else self.recentred(refused, trials)

    def nearer(self, costly: Candidate, trials: Trials) -> OtherValues:
        """Propose a value nearer to the original value if `costly` may lose too much in the designed world.

        A smaller change does less harm in the designed world. Bisect for the smallest change that succeeds on the known
        seeds (the hardest seeds run first) and in the missions that other refused candidates lost. Propose the middle
        of the good values. Raise BudgetSpentError.
        """
        place = (operands(costly), costly.guard)
        if place in self._nearer:
            return
        self._nearer.add(place)
        between, good = Between(in_place(costly), self.mutants.mutate), list[Candidate]()
        while (middle := between.middle()) is not None:
            enough = self._holds(middle, trials)
            good += [middle] if enough else []
            between.told(STRONG[0] if enough else WEAK[0])
        if good and not self.ledger.examined(good[len(good) // 2]):
            self.chosen.add(good[len(good) // 2])
            yield good[len(good) // 2]

    def _holds(self, candidate: Candidate, trials: Trials) -> bool:
        """Return whether a candidate reaches the goal on the seeds that most candidates failed and in lost missions."""
        goal = self.mutants.order.goal
        hardest = sorted(goal.pairs, key=lambda pair: -trials.misses[pair.seed])[:KNOWN]
        try:
            reaches = all(trials.reaches(candidate, pair.seed, goal) for pair in hardest)
            return reaches and not self.missed.again(candidate, trials, goal)
        except RepairError:
            return False

    def _reaches(self, candidate: Candidate, trials: Trials) -> bool:
        goal = self.mutants.order.goal
        seed = goal.pairs[0].seed
        try:
            return trials.reaches(candidate, seed, goal)
        except RepairError:
            return False

    def beside(self, trials: Trials) -> OtherValues:
        """If a candidate lost reward in only a few missions of its test, propose neighbouring values.

        A neighbour is proposed only if it loses no reward in these missions. If another close value was rejected as
        well, the value halfway between both comes first. A neighbour may be close to a rejected value, because the
        missions show that it is better. If no neighbour is better, but one acts exactly like the refused value, values
        farther away follow (see `_off_plateau`). Raise BudgetSpentError.
        """
        while refused := next((one for one in self.missed.few if one not in self._mended), None):
            self._mended.add(refused)
            near = (*self._between(refused), *neighbours(refused, self.mutants.mutate))
            for other in itertools.chain(near, self._off_plateau(refused, trials)):
                if not self.ledger.examined(other) and self._mends(other, refused, trials):
                    self.chosen.add(other)
                    yield other
                    break

    def _off_plateau(self, refused: Candidate, trials: Trials) -> Iterator[Candidate]:
        """Yield the first value in each direction beyond a plateau, on which all values have the same effect.

        For instance, a node that looks at the time twice a second waits equally long for all times from 0.51 to 1 s.
        """
        seed, _ = self.missed.few[refused][0]
        for ratio in ASIDE[:2]:
            for power in PLATEAU:
                other = moved(refused, ratio**power, self.mutants.mutate)
                try:
                    alike = other is not None and trials(other, seed).acts_like(trials(refused, seed))
                except RepairError:
                    break
                if other is not None and not alike:
                    yield in_place(other)
                if not alike:
                    break

    def recentred(self, refused: Candidate, trials: Trials) -> OtherValues:
        """Propose the best value near a refused one if the refused value's missions succeed but earn too little.

        Values are compared on missions that represent the refused value's test, so that small improvements are found.
        Raise BudgetSpentError.
        """
        place = (operands(refused), refused.guard)
        missions = self.missed.spread.get(refused)
        if missions is None or place in self._recentred:
            return
        self._recentred.add(place)
        before = -sum(max(one.loss, 0.0) for one in missions)
        best, most = refused, before
        for step in RATIOS:
            for ratio in (step, 1 / step):
                for _ in range(MOVES):
                    other = moved(best, ratio, self.mutants.mutate)
                    earned = self._earned(other, missions, most, trials) if other is not None else None
                    if other is None or earned is None:
                        break
                    best, most = other, earned
        if most - before >= BETTER * self.mutants.order.reference.margin * len(missions):
            self.chosen.add(in_place(best))
            yield in_place(best)

    def _earned(
        self, candidate: Candidate, missions: Sequence[Lost], most: float, trials: Trials
    ) -> float | None:
        """Return a candidate's total reward in all of `missions`, minus their designed total.

        The reward of a mission is capped at its designed reward. Return None if the difference cannot exceed `most` or
        if a mission fails.
        """
        earned = 0.0
        trials.expect((candidate, one.seed) for one in missions)
        for one in sorted(missions, key=lambda each: -each.loss):
            try:
                outcome = trials(candidate, one.seed)
            except RepairError:
                return None
            earned += min(outcome.total - one.designed, 0.0)
            if earned <= most or self.mutants.order.goal.lost(outcome):
                return None
        return earned

    def bracketed(self, candidate: Candidate) -> bool:
        """Return whether good values may lie between two close values that each lost in few missions."""
        ratios = [ratio_of(candidate, other) for other in self.missed.few]
        close = [one for one in ratios if one is not None and max(one, 1.0 / one) <= CLOSE]
        return bool(close) and min(close) < 1.0 < max(close)

    def _between(self, refused: Candidate) -> Iterator[Candidate]:
        """Yield the value halfway between two rejected values that are close to each other."""
        for other in self.missed.few:
            ratio = ratio_of(other, refused)
            if ratio is not None and 1.0 < max(ratio, 1.0 / ratio) <= CLOSE:
                middle = moved(refused, sqrt(ratio), self.mutants.mutate)
                if middle is not None:
                    yield in_place(middle)

    def _mends(self, other: Candidate, refused: Candidate, trials: Trials) -> bool:
        try:
            return self.missed.mends(other, refused, trials, self.mutants.order.goal)
        except RepairError:
            return False

    def milder(self, candidate: Candidate) -> OtherValues:
        """Bisect between the original value, which gains too little, and a candidate that does harm elsewhere."""
        known, place = self.ledger.alike(candidate), (operands(candidate), candidate.guard)
        if known is None or known.reason not in STRONG or place in self._bisected:
            return
        self._bisected.add(place)
        between = Between(candidate, self.mutants.mutate)
        for one in self.ledger.tried:
            if one.candidate.guard == candidate.guard and one.reason in WEAK:
                between.beyond(one.candidate)
        while (middle := between.middle()) is not None:
            examined = yield middle
            if not between.told(examined.reason):
                return


def ratio_of(one: Candidate, other: Candidate) -> float | None:
    """Return the ratio of two candidates' factors if both change the same constant, else None."""
    if one.guard != other.guard or operands(one) != operands(other):
        return None
    mine, its = common_factor(one), common_factor(other)
    return mine / its if mine is not None and its is not None else None
