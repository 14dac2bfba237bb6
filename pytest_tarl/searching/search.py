"""The parts that all searches share: candidates, the goal, and trials in the drifted world.

A mission is one episode of the test. A candidate passes on a seed if its mission with this seed earns about as much
reward as designed. A search yields candidates that are confirmed (see `confirming`), best first. `searching.accept`
then tests them on fresh seeds.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from statistics import fmean

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.mutate import Mutation, form_values, redefinition
from pytest_tarl.patching.templates import CONSTANT
from pytest_tarl.searching.accept import Outcome, unforeseen
from pytest_tarl.searching.course import deviation
from tarl_lint.model import Operand

Mutate = Callable[[Operand, float], Mutation | None]
Wanted = tuple["Candidate", int]  # an episode to run: its candidate and seed

# factors for a constant, in the order in which they are tried
FACTORS = (2.2, 0.4, 5.0, 0.15, 1.5, 0.65, 10.0)
FAR = 0.6  # the reserve of episodes is released when a candidate gains at least this share of the wanted gain
# a published message counts as usual if it is at most this multiple of the largest designed message
USUAL = 1.5
PAIRED = 2  # minimum number of common seeds for comparing two candidates
# a mission is compared with the designed mission of its seed if its reward is less than `near` by at most this share of
# the distance between the drifted missions and `near`
LACKS = 0.1
# a failed mission did not end in time if it is at least this many times as long as designed missions
LATE = 1.2


@dataclass(frozen=True)
class Candidate:
    """Mutations that are applied together, under one guard."""

    mutations: tuple[Mutation, ...]
    guard: Guard

    @property
    def changes(self) -> tuple[Mutation, ...]:
        """Return the mutations without their places in the source, so that candidates compare by their effect."""
        return tuple(replace(mutation, place=None) for mutation in self.mutations)


@dataclass(frozen=True, slots=True)
class Pair:
    """A drifted episode without any mutation: its seed, its total reward and, if known, its number of steps."""

    seed: int
    total: float
    steps: int | None = None


@dataclass(frozen=True)
class Goal:
    """The target of a search.

    - `pairs`: episodes of the unrepaired program that lost reward in the drifted world.
    - `near`: a candidate is worth confirming if its total reward is at least this.
    - `enough`: the minimum mean total reward that confirms a candidate.
    - `online`: the mean total reward of all drifted episodes, including those without loss.
    - `passing`: whether failed missions never count as near. This is needed if ending early can earn more than
      continuing.
    - `harder`: seed → the mean designed reward minus the designed reward of that seed, where known.
    - `tolerated`: seed → the additional loss allowed on this seed if only a few missions lose reward.
    - `controls`: drifted episodes without loss.
    - `margin`: the tolerated mean loss against the designed missions of the same seeds, if known.
    """

    pairs: tuple[Pair, ...]
    near: float
    enough: float
    online: float
    passing: bool = False
    harder: Mapping[int, float] = field(default_factory=dict)
    tolerated: Mapping[int, float] = field(default_factory=dict)
    controls: tuple[Pair, ...] = ()
    # whether the drift's size varies by episode; a mission may then fail just because the drift is large
    ranged: bool = False
    steps: float | None = None  # mean length of a designed mission, if known
    margin: float | None = None

    @property
    def wanted(self) -> float:
        """Return the gain per episode that a repair must bring on the losing episodes (`pairs`)."""
        if not self.pairs:
            return max(self.enough - self.online, 0.0)
        lost = fmean(pair.total for pair in self.pairs)
        return max(self.enough_on([pair.seed for pair in self.pairs]) - lost, 0.0)

    def reached(self, outcome: Outcome, seed: int) -> bool:
        """Return whether an episode earns about as much as the designed one of its seed."""
        return outcome.total >= self.near - self._less(seed) and not self.lost(outcome)

    def lost(self, outcome: Outcome) -> bool:
        """Return whether an episode failed its mission although missions succeed in the designed world."""
        return self.passing and not outcome.passed

    def feigned(self, outcome: Outcome) -> bool:
        """Return whether a failed mission only earns much because it does not end in time.

        A machine that stands still until the time is up may earn more than one that works.
        """
        late = None not in (self.steps, outcome.steps) and outcome.steps >= LATE * self.steps  # type: ignore[operator]
        return self.lost(outcome) and late and outcome.total >= self.enough

    def gain(self, outcome: Outcome, before: float) -> float:
        """Return a mission's gain over `before`, the unmutated reward; 0 for a feigned mission."""
        return 0.0 if self.feigned(outcome) else outcome.total - before

    def enough_on(self, seeds: Sequence[int]) -> float:
        """Return the mean total reward that confirms a candidate on these seeds."""
        return self.enough - fmean(map(self._less, seeds))

    def _less(self, seed: int) -> float:
        """Return by how much the mission of this seed may earn less than the mean designed mission."""
        return self.harder.get(seed, 0.0) + self.tolerated.get(seed, 0.0)


class BudgetSpentError(Exception):
    """Raised if the search has spent its budget of episodes."""


def lost_nothing(_: Candidate) -> bool:
    """Return False, the default before any candidate was rejected."""
    return False


def no_missions() -> Sequence[int]:
    """Return no seeds, the default before any candidate was rejected."""
    return ()


def never_late() -> None:
    """Do nothing: the default for searches without a time limit."""


@dataclass
class Trials:
    """Run candidates in the drifted world, each seed once, and keep the outcomes.

    `beside` counts the episodes that ran in the designed world, which use the same budget. `foresee` receives the
    episodes that are likely to be requested next.
    """

    run: Callable[[Candidate, int], Outcome]
    budget: int
    beside: int = 0
    foresee: Callable[[Sequence[Wanted]], None] = unforeseen
    # extra episodes, added to the budget once a candidate has gained the share `FAR` of the wanted gain
    reserve: int = 0
    # maximum number of episodes of all phases together, up to which `granting` may extend the budget
    limit: int | None = None
    worth: Goal | None = None  # `reserve` is released after a gain of FAR times the wanted gain of this goal
    # returns whether a candidate loses reward in missions in which rejected candidates lost reward
    loses: Callable[[Candidate], bool] = lost_nothing
    # returns the seeds of missions in which rejected candidates lost reward
    lost_missions: Callable[[], Sequence[int]] = no_missions
    # returns whether the constants of a candidate made the designed world worse
    harms: Callable[[Candidate], bool] = lost_nothing
    design: Callable[[int], Outcome] | None = None  # runs the unchanged program in the designed world
    unchanged: Callable[[int], Outcome] | None = None  # runs the unchanged program in the drifted world
    in_time: Callable[[], object] = never_late  # raises BudgetSpentError when the time is up
    # seed → number of candidates that earned too little on it
    misses: Counter[int] = field(default_factory=Counter)
    totals: list[float] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    _known: dict[tuple[Candidate, int], Outcome] = field(default_factory=dict)
    _designed: dict[int, Outcome] = field(default_factory=dict)  # designed missions, by seed
    # totals of candidates that fell short, by seed
    _short: list[dict[int, float]] = field(default_factory=list)

    def __call__(self, candidate: Candidate, seed: int) -> Outcome:
        """Return the outcome of one episode; run it only once. Raise BudgetSpentError and RepairError."""
        key = (candidate, seed)
        if key not in self._known:
            self._afford()
            self._known[key] = self.run(candidate, seed)
            self.totals.append(self._known[key].total)
            self.labels.append(label(candidate))
        return self._known[key]

    def know(self, other: Trials) -> None:
        """Take over the outcomes of another phase, so that its episodes do not run again."""
        self._known = {**other._known, **self._known}

    def equate(self, candidate: Candidate, other: Candidate) -> None:
        """Use the outcomes of `candidate` for `other`, which has the same effect, unless `other` has run itself."""
        for (one, seed), outcome in list(self._known.items()):
            if one == candidate:
                self._known.setdefault((other, seed), outcome)

    def expect(self, wanted: Iterable[Wanted]) -> None:
        """Announce in order the episodes that are likely to be requested next, so that workers can start them."""
        left = max(self.budget - self.spent, 0)
        self.foresee([one for one in wanted if one not in self._known][:left])

    def deviation(self, candidate: Candidate, seeds: Sequence[int]) -> float:
        """Return the mean deviation of a candidate's missions from the designed ones (see `course`), or 0 if unknown.

        Each designed mission runs and is charged to the budget only once. Raise BudgetSpentError and RepairError.
        """
        ran = [self(candidate, seed) for seed in seeds]
        design = self.design
        if design is None:
            return 0.0
        designed = [self._as_designed(seed, design) for seed in seeds]
        return fmean(deviation(one.rewards, other.rewards) for one, other in zip(ran, designed, strict=True))

    def exceeds(self, candidate: Candidate, seed: int) -> bool:
        """Return whether a candidate's largest message exceeds `USUAL` times that of the designed mission of a seed.

        Return False if this is unknown. The designed mission runs and is charged to the budget only once. Raise
        BudgetSpentError and RepairError.
        """
        found, design = self(candidate, seed).outputs, self.design
        if design is None or not found:
            return False
        usual = {topic: largest for topic, (_, _, largest) in self._as_designed(seed, design).outputs}
        return any(largest > USUAL * usual[topic] > 0.0 for topic, (_, _, largest) in found if topic in usual)

    def lost(self, candidate: Candidate, seeds: Sequence[int]) -> float | None:
        """Return how much less a candidate earns, on average, than the designed missions of the same seeds.

        Return None if no designed mission can run. Each designed mission runs and is charged to the budget only once.
        Raise BudgetSpentError and RepairError.
        """
        design = self.design
        if design is None or not seeds:
            return None
        return fmean(self._as_designed(seed, design).total - self(candidate, seed).total for seed in seeds)

    def reaches(self, candidate: Candidate, seed: int, goal: Goal) -> bool:
        """Return whether a candidate's mission earns about as much as the designed mission of its seed.

        At first, the mission is compared with the mean designed mission. If it does not fail and earns only a little
        less, the designed mission of the same seed runs, too: with this seed, the start may be so bad that no program
        earns more. Raise BudgetSpentError and RepairError.
        """
        outcome = self(candidate, seed)
        if goal.reached(outcome, seed):
            return True
        least = goal.near - LACKS * max(goal.near - goal.online, 0.0)
        if goal.margin is None or goal.harder or goal.lost(outcome) or outcome.total < least:
            return False
        lost = self.lost(candidate, [seed])
        return lost is not None and lost <= goal.margin

    def _as_designed(self, seed: int, design: Callable[[int], Outcome]) -> Outcome:
        if seed not in self._designed:
            self.charge()
            self._designed[seed] = design(seed)
        return self._designed[seed]

    def charge(self) -> None:
        """Count an episode that is about to run in the designed world. Raise BudgetSpentError."""
        self._afford()
        self.in_time()
        self.beside += 1

    def gain(self, candidate: Candidate, goal: Goal) -> float:
        """Return a candidate's mean gain over the unmutated runs, on all seeds of the goal that it ran.

        The candidate must have run on at least one seed.
        """
        known = ((self._known.get((candidate, pair.seed)), pair.total) for pair in goal.pairs)
        return fmean(goal.gain(outcome, total) for outcome, total in known if outcome is not None)

    def ran(self, candidate: Candidate, pairs: Iterable[Pair]) -> list[Outcome]:
        """Return a candidate's outcomes on the seeds of `pairs`, as far as it has run there."""
        known = (self._known.get((candidate, pair.seed)) for pair in pairs)
        return [outcome for outcome in known if outcome is not None]

    def moved(self, candidate: Candidate, pairs: Iterable[Pair]) -> bool:
        """Return whether a candidate changed the reward or the length of any episode that it ran.

        The length counts because a reward that is paid only at the end is the same for all failing missions.
        """
        known = ((self._known.get((candidate, pair.seed)), pair) for pair in pairs)
        return any(
            outcome is not None and (outcome.total != pair.total or pair.steps not in (None, outcome.steps))
            for outcome, pair in known
        )

    def fails_sooner(self, candidate: Candidate, goal: Goal) -> bool:
        """Return whether all missions of a candidate failed, and did so sooner than without the candidate.

        A mission that ends early saves the costs of its remaining steps. Such a gain is not progress.
        """
        known = [(self._known.get((candidate, pair.seed)), pair.steps) for pair in goal.pairs]
        ran = [(one, steps) for one, steps in known if one is not None]
        return bool(ran) and all(
            goal.lost(one) and one.steps is not None and steps is not None and one.steps < steps
            for one, steps in ran
        )

    def steps(self, candidate: Candidate, pairs: Iterable[Pair]) -> list[int]:
        """Return the lengths of the missions that a candidate ran, where known."""
        known = (self._known.get((candidate, pair.seed)) for pair in pairs)
        return [one.steps for one in known if one is not None and one.steps is not None]

    def same_as(self, candidate: Candidate, other: Candidate) -> int:
        """If two candidates have equal outcomes on all common seeds, return the number of these seeds, else 0."""
        mine, its = self._outcomes(candidate), self._outcomes(other)
        both = mine.keys() & its.keys()
        return len(both) if all(mine[seed] == its[seed] for seed in both) else 0

    def _outcomes(self, candidate: Candidate) -> dict[int, tuple[float, bool, int | None]]:
        """Return the known outcomes of all candidates with the same changes, at any place in the source."""
        changes, guard = candidate.changes, candidate.guard
        return {
            seed: (run.total, run.passed, run.steps)
            for (one, seed), run in self._known.items()
            if one.guard == guard and one.changes == changes
        }

    def alike(self, candidate: Candidate) -> dict[Candidate, dict[int, Outcome]]:
        """Return the outcomes, by seed, of all candidates that change the same constants under the same guard."""
        mine, found = {one.operand for one in candidate.mutations}, dict[Candidate, dict[int, Outcome]]()
        for (other, seed), outcome in self._known.items():
            if other.guard == candidate.guard and {one.operand for one in other.mutations} == mine:
                found.setdefault(other, {})[seed] = outcome
        return found

    def fell_short(self, candidate: Candidate, pairs: Iterable[Pair]) -> None:
        """Store that a candidate was near the goal on every seed but earned too little on average."""
        self._short.append(self.totals_of(candidate, pairs))

    def falls_short(self, candidate: Candidate, pairs: Sequence[Pair], enough: float) -> bool:
        """Return whether a candidate will probably earn too little, judging by earlier ones that earned too little.

        The estimate uses an earlier candidate as a control variate. It is the mean total of the earlier candidate plus
        the mean difference between both candidates on their common seeds. At least `PAIRED` common seeds are needed.
        """
        totals = self.totals_of(candidate, pairs)
        for other in self._short:
            both = totals.keys() & other.keys()
            if len(both) >= PAIRED:
                differs = fmean(totals[seed] - other[seed] for seed in sorted(both))
                if fmean(other.values()) + differs < enough:
                    return True
        return False

    def reason(self, pair: Pair) -> str:
        """Return why the unchanged program fails on a pair's seed. The reason is taken from a change without effect.

        Return "" if no such change has run, or if the mission does not fail.
        """
        for (_, seed), outcome in self._known.items():
            if seed == pair.seed and outcome.total == pair.total and outcome.steps == pair.steps:
                return outcome.failure
        return ""

    def totals_of(self, candidate: Candidate, pairs: Iterable[Pair]) -> dict[int, float]:
        """Return the total rewards of a candidate by seed, for the seeds on which it has run."""
        known = ((pair.seed, self._known.get((candidate, pair.seed))) for pair in pairs)
        return {seed: outcome.total for seed, outcome in known if outcome is not None}

    @contextmanager
    def granting(self, episodes: int) -> Iterator[None]:
        """In the `with` block, extend the budget so that `episodes` are left, but never beyond `limit`."""
        most = self.budget if self.limit is None else self.limit
        extra = max(min(self.spent + episodes, most) - self.budget, 0)
        self.budget += extra
        try:
            yield
        finally:
            self.budget -= extra

    @property
    def spent(self) -> int:
        """Return how many episodes have run."""
        return len(self.totals) + self.beside

    def _afford(self) -> None:
        if self.spent >= self.budget and self.worth is not None and self._come_far(self.worth):
            self.budget, self.reserve = self.budget + self.reserve, 0
        if self.spent >= self.budget:
            raise BudgetSpentError

    def _come_far(self, goal: Goal) -> bool:
        """Return whether any candidate that ran on several seeds gained at least the share `FAR` of the wanted gain.

        Missions in which rejected candidates lost reward have other seeds than the goal's pairs. They are therefore
        compared with the mean of the pairs.
        """
        before = {pair.seed: pair.total for pair in goal.pairs}
        usual = fmean(before.values()) if before else goal.online
        held = {pair.seed for pair in goal.controls}
        gains: dict[Candidate, list[float]] = {}
        for (candidate, seed), outcome in self._known.items() if self.reserve else ():
            if seed not in held:
                gains.setdefault(candidate, []).append(goal.gain(outcome, before.get(seed, usual)))
        return any(len(each) >= PAIRED and fmean(each) >= FAR * goal.wanted for each in gains.values())


def label(candidate: Candidate) -> str:
    """Describe a candidate's mutations for a report: `line 30: 5 → 11.0`."""
    return ", ".join(
        f"line {m.operand.span.line}: {m.operand.code} → {m.value:.4g}"
        if m.operand.literal
        else f"line {m.operand.span.line}: {m.operand.code} × {m.value:.4g}"
        for m in candidate.mutations
    )


def operand_effect(mutation: Mutation, gain: float) -> OperandEffect:
    """Return a mutation's gain and new value, or its factor if the value is known only at run time.

    If the constant follows a sensor or a variable, the value is the exponent.
    """
    constant = mutation.operand.value
    known = None if constant is None else float(constant)
    value = effective_value(mutation)
    return OperandEffect(
        mutation.operand.code, known, value, gain, factor=known is None, what=_followed(mutation)
    )


def _followed(mutation: Mutation) -> str:
    """Describe a constant that follows a sensor or a variable; return "" for all other changes."""
    form = mutation.form
    if form is None or form.template.on != CONSTANT:
        return ""
    return f"{mutation.operand.code} follows {form.sensor.name if form.sensor else form.variable}"


def effective_value(mutation: Mutation) -> float:
    """Return the mutated value of the operand, or the factor if the constant is known only at run time."""
    if mutation.place is not None:
        return float(redefinition(mutation))
    if mutation.form is not None:
        return form_values(mutation).get(mutation.form.parameter, 1.0)
    constant, value = mutation.operand.value, float(mutation.value)
    if mutation.operand.literal or constant is None or isinstance(constant, bool):
        return value
    return constant * value if constant else value
