"""What every search shares: candidates, trials in the drifted world, and when one counts as confirmed.

A search yields confirmed candidates, best first; whether one is accepted is decided elsewhere, on fresh seeds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import fmean
from typing import Protocol

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.mutate import Mutation, form_values, redefinition
from pytest_tarl.searching.accept import Outcome, unforeseen
from tarl_lint.model import Operand

Mutate = Callable[[Operand, float], Mutation | None]
Wanted = tuple["Candidate", int]  # an episode: a candidate and the seed to run it with

FACTORS = (2.2, 0.4, 5.0, 0.15, 1.5, 0.65, 10.0)  # in the order they are tried
CONFIRMATIONS = 5  # further seeds that a promising candidate must hold on
FAR = 0.6  # share of the wanted gain that is worth more episodes
PAIRED = 2  # seeds on which a candidate is compared with one that fell short


@dataclass(frozen=True)
class Candidate:
    """Mutations that hold together under one guard."""

    mutations: tuple[Mutation, ...]
    guard: Guard

    @property
    def changes(self) -> tuple[Mutation, ...]:
        """Return the mutations, wherever they are written."""
        return tuple(replace(mutation, place=None) for mutation in self.mutations)


@dataclass(frozen=True, slots=True)
class Pair:
    """An on-line episode that lost: its seed, and its total reward without any mutation."""

    seed: int
    total: float


@dataclass(frozen=True)
class Goal:
    """What the search is after. `near`: a total worth confirming; `enough`: a mean that confirms.

    `online` is the mean reward of all on-line episodes, those that did not lose included. With `passing` a failed
    mission is never near: ending early can earn more than carrying on. `harder` says, per seed, how much less than
    the mean its mission earns as designed, where that is known. `controls` are on-line episodes that did not lose.
    """

    pairs: tuple[Pair, ...]
    near: float
    enough: float
    online: float
    passing: bool = False
    harder: Mapping[int, float] = field(default_factory=dict)
    controls: tuple[Pair, ...] = ()
    ranged: bool = False  # whether missions differ in size, so that one that fails may fail for its size

    @property
    def wanted(self) -> float:
        """Return the gain per episode that a repair has to bring."""
        return max(self.enough - self.online, 0.0)

    def reached(self, outcome: Outcome, seed: int) -> bool:
        """Tell whether an episode is as good as the one of its seed off-line."""
        return outcome.total >= self.near - self.harder.get(seed, 0.0) and not self.lost(outcome)

    def lost(self, outcome: Outcome) -> bool:
        """Tell whether an episode is a clear failure: its mission failed, and designed ones succeed."""
        return self.passing and not outcome.passed

    def enough_on(self, seeds: Sequence[int]) -> float:
        """Return the mean that confirms on these seeds."""
        return self.enough - fmean(self.harder.get(seed, 0.0) for seed in seeds)


class BudgetSpentError(Exception):
    """The search has used up its episodes."""


@dataclass
class Trials:
    """Runs candidates in the drifted world, each seed once, and keeps count and history.

    `beside` counts the episodes of the same budget that were run elsewhere, in the nominal world; `foresee` is told
    what will probably be asked for next.
    """

    run: Callable[[Candidate, int], Outcome]
    budget: int
    beside: int = 0
    foresee: Callable[[Sequence[Wanted]], None] = unforeseen
    reserve: int = 0  # episodes beyond the budget, for what has come far ...
    worth: Goal | None = None  # ... on the way to this goal
    totals: list[float] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    _known: dict[tuple[Candidate, int], Outcome] = field(default_factory=dict)
    _short: list[dict[int, float]] = field(default_factory=list)  # totals by seed, of each that fell short

    def __call__(self, candidate: Candidate, seed: int) -> Outcome:
        """Run one episode, or remember it. Raises BudgetSpentError, or RepairError from writing the candidate."""
        key = (candidate, seed)
        if key not in self._known:
            self._afford()
            self._known[key] = self.run(candidate, seed)
            self.totals.append(self._known[key].total)
            self.labels.append(label(candidate))
        return self._known[key]

    def expect(self, wanted: Iterable[Wanted]) -> None:
        """Tell which episodes will probably be asked for next, in this order: workers may begin them."""
        left = max(self.budget - self.spent, 0)
        self.foresee([one for one in wanted if one not in self._known][:left])

    def charge(self) -> None:
        """Count an episode that is about to be run elsewhere. Raises BudgetSpentError."""
        self._afford()
        self.beside += 1

    def gain(self, candidate: Candidate, pairs: Iterable[Pair]) -> float:
        """Return what a candidate gained over the unmutated runs of the same seeds, on average; it was run on one."""
        known = ((self._known.get((candidate, pair.seed)), pair.total) for pair in pairs)
        return fmean(outcome.total - total for outcome, total in known if outcome is not None)

    def fell_short(self, candidate: Candidate, pairs: Iterable[Pair]) -> None:
        """Remember a candidate that came near on every seed, and yet earned too little."""
        self._short.append(self._totals(candidate, pairs))

    def falls_short(self, candidate: Candidate, pairs: Sequence[Pair], enough: float) -> bool:
        """Tell whether a candidate will earn too little, as one did that it is paired with on at least two seeds.

        What the other earned in all, and by how much this one differs from it on the seeds of both (control variate).
        """
        totals = self._totals(candidate, pairs)
        for other in self._short:
            both = totals.keys() & other.keys()
            if len(both) >= PAIRED:
                differs = fmean(totals[seed] - other[seed] for seed in sorted(both))
                if fmean(other.values()) + differs < enough:
                    return True
        return False

    def _totals(self, candidate: Candidate, pairs: Iterable[Pair]) -> dict[int, float]:
        known = ((pair.seed, self._known.get((candidate, pair.seed))) for pair in pairs)
        return {seed: outcome.total for seed, outcome in known if outcome is not None}

    @property
    def spent(self) -> int:
        """Return how many episodes were run."""
        return len(self.totals) + self.beside

    def _afford(self) -> None:
        if self.spent >= self.budget and self.worth is not None and self._come_far(self.worth):
            self.budget, self.reserve = self.budget + self.reserve, 0
        if self.spent >= self.budget:
            raise BudgetSpentError

    def _come_far(self, goal: Goal) -> bool:
        """Tell whether a candidate that was run on several seeds gained most of what is wanted."""
        before = {pair.seed: pair.total for pair in goal.pairs}
        gains: dict[Candidate, list[float]] = {}
        for (candidate, seed), outcome in self._known.items() if self.reserve else ():
            if seed in before:
                gains.setdefault(candidate, []).append(outcome.total - before[seed])
        return any(len(each) >= PAIRED and fmean(each) >= FAR * goal.wanted for each in gains.values())


def label(candidate: Candidate) -> str:
    """Name a candidate's mutations for people: `line 30: 5 → 11.0`."""
    return ", ".join(
        f"line {m.operand.span.line}: {m.operand.code} → {m.value:.4g}"
        if m.operand.literal
        else f"line {m.operand.span.line}: {m.operand.code} × {m.value:.4g}"
        for m in candidate.mutations
    )


def confirmed(candidate: Candidate, trials: Trials, goal: Goal, first: int) -> bool:
    """Try further seeds, beginning after the pair `first`.

    A candidate is dropped at its first failed mission where designed ones succeed, else at its second miss, and as soon
    as it does no better than one that earned too little.
    """
    others = [goal.pairs[(first + i) % len(goal.pairs)] for i in range(1, len(goal.pairs))][:CONFIRMATIONS]
    seeds = [pair.seed for pair in others]
    outcomes: list[Outcome] = []
    trials.expect((candidate, seed) for seed in seeds)
    missed = 0
    for seed in seeds:
        outcomes.append(trials(candidate, seed))
        missed += not goal.reached(outcomes[-1], seed)
        if missed > 1 or (goal.lost(outcomes[-1]) and not goal.ranged):
            return False
        if trials.falls_short(candidate, goal.pairs, goal.enough):
            return False
    holds = not outcomes or fmean(outcome.total for outcome in outcomes) >= goal.enough_on(seeds)
    if not holds and not missed:
        trials.fell_short(candidate, goal.pairs)
    return holds


class Strategy(Protocol):
    """A search."""

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates, best first. Raises BudgetSpentError."""

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, per site id, what each of its operands was found to gain."""


def operand_effect(mutation: Mutation, gain: float) -> OperandEffect:
    """Say what a mutation's value gained; a constant known only at run time has a factor for a value."""
    constant = mutation.operand.value
    known = None if constant is None else float(constant)
    return OperandEffect(mutation.operand.code, known, effective_value(mutation), gain, factor=known is None)


def effective_value(mutation: Mutation) -> float:
    """Return the value that the use has under the mutation; of a constant known only at run time, the factor."""
    if mutation.place is not None:
        return float(redefinition(mutation))
    if mutation.form is not None:
        return form_values(mutation).get(mutation.form.parameter, 1.0)
    constant, value = mutation.operand.value, float(mutation.value)
    if mutation.operand.literal or constant is None or isinstance(constant, bool):
        return value
    return constant * value if constant else value
