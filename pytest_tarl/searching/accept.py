"""Acceptance test of a repair: one group-sequential test per candidate, on seeds that the search never used.

The test must show the following in the drifted world, and again in the designed world:

- The repaired program's mean total reward is at most δ (the margin) below the mean total reward of the unrepaired
  program in the designed world.
- The repaired program's failure rate is at most five percentage points higher than the recorded failure rate.

The test caps the loss of one mission at the reward of a designed mission, because it counts failures separately. Each
mission is paired with the unrepaired program's mission of the same seed in the designed world. The means are tested by
betting (learning/betting.py). The size of the bets is chosen before the test, from episodes on other seeds. These
episodes can refuse the candidate, but they cannot accept it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import log
from statistics import fmean

from pytest_tarl.formulas.judging import Judged
from pytest_tarl.learning.betting import Bet, bet
from pytest_tarl.learning.drift import PASS_RATE_LOSS
from pytest_tarl.model import Reason
from pytest_tarl.searching.acceptance_numbers import acceptance_numbers

SCREEN = 8  # number of episodes that run before the test, to choose the bet size
EARLY = (8, 16, 32)  # early looks: numbers of episodes after which the test can only refuse
LOOKS = tuple(range(60, 201, 20))  # looks: numbers of episodes after which the test can refuse or accept
SEEDS = SCREEN + LOOKS[-1]
# Reasons to refuse a candidate in the drifted world.
TOO_LITTLE: tuple[Reason, ...] = ("gain too small", "fails too often", "not shown")
# share of the risk α that the first test spends; each later test spends a third as much as the test before it
SHARE = 2 / 3


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outcome of an episode: total reward, whether the test passed, formula verdicts, steps, rewards by step.

    `outputs` describes the messages that the nodes published: two sums and the largest message for each topic. It is
    empty if the messages are unknown. `failure` says why the test failed, without the numbers of this mission. It is
    empty if the reason is unknown.
    """

    total: float
    passed: bool
    judged: tuple[Judged, ...] = ()
    steps: int | None = None
    rewards: tuple[float, ...] = field(default=(), compare=False, repr=False)
    outputs: tuple[tuple[str, tuple[float, ...]], ...] = field(default=(), compare=False, repr=False)
    failure: str = field(default="", compare=False)

    def acts_like(self, other: Outcome) -> bool:
        """Return whether two episodes of one seed have equal outcomes and, as far as known, equal messages."""
        return self == other and self.outputs == other.outputs


@dataclass(frozen=True, slots=True)
class Reference:
    """The recorded missions of the designed world. Repairs are compared with them.

    `margin` is δ in reward per episode. `lowest` and `highest` are the declared bounds of a mission's total reward in
    both worlds.
    """

    totals: Sequence[float]
    pass_rate: float
    margin: float
    lowest: float
    highest: float | None = None

    @property
    def mean(self) -> float:
        """Return the recorded mean total reward."""
        return fmean(self.totals)

    @property
    def tolerated(self) -> float:
        """Return the failure rate that a repair must be shown to stay below."""
        return min(1.0 - self.pass_rate + PASS_RATE_LOSS, 1.0)

    @property
    def least(self) -> float:
        """Return the lower limit for the difference in reward between a mission and its designed counterpart.

        The test clips lower differences to this limit. The limit is the lowest difference that the declared bounds and
        the recorded totals allow, but at least -20 margins. With a margin of 5 % of the designed reward, 20 margins are
        the whole reward of a designed mission. Failures can be clipped because a separate test counts them. Without the
        clip, correct repairs would be refused: after one costly failure, a test of 200 episodes could no longer show
        that the loss is small.
        """
        best = max(self.totals) if self.highest is None else self.highest
        return max(min(self.lowest, *self.totals) - best, -self.margin / PASS_RATE_LOSS)


def unforeseen(wanted: Sequence[object]) -> None:
    """Do nothing: the default for worlds that start no episodes ahead of time."""


@dataclass(frozen=True, slots=True)
class World:
    """A program in a world. `run` runs the mission of one seed; `foresee` receives the seeds that are needed next."""

    run: Callable[[int], Outcome]
    foresee: Callable[[Sequence[int]], None] = unforeseen


@dataclass
class Designed:
    """The unrepaired program in the designed world. Each seed runs only once."""

    world: World
    known: dict[int, Outcome] = field(default_factory=dict)

    def __call__(self, seeds: Sequence[int]) -> list[float]:
        """Return the total rewards of these seeds."""
        new = [seed for seed in seeds if seed not in self.known]
        self.world.foresee(new)
        self.known.update((seed, self.world.run(seed)) for seed in new)
        return [self.known[seed].total for seed in seeds]


@dataclass(frozen=True, slots=True)
class Acceptance:
    """Result of a test.

    - `drifted`, `nominal`: the episodes in the drifted and in the designed world; `nominal` is empty if none were
      needed. If the candidate is refused, both include the episodes that ran before the test.
    - `tested`: False if the episodes before the test refused the candidate; then no risk is spent.
    - `episodes`: total number of episodes, including those of the unrepaired program.
    - `bets`: the sizes of the bets in the two worlds.
    - `seeds`: the seeds of the drifted episodes; `designed`: the unrepaired program's totals on them in the designed
      world.
    - `costly`: whether the candidate was refused because of its episodes in the designed world.
    """

    accepted: bool
    reason: Reason
    drifted: tuple[Outcome, ...]
    nominal: tuple[Outcome, ...]
    tested: bool = True
    episodes: int = 0
    bets: tuple[Bet, ...] = ()
    seeds: tuple[int, ...] = ()
    designed: tuple[float, ...] = ()
    costly: bool = False


def risk_of(alpha: float, before: int) -> float:
    """Return the risk of a test after `before` earlier tests; all risks sum to at most α."""
    return alpha * SHARE * (1.0 - SHARE) ** before


def accept(
    drifted: World,
    nominal: World | None,
    designed: World,
    seeds: Sequence[int],
    reference: Reference,
    risk: float,
) -> Acceptance:
    """Test one candidate in the drifted world and in the designed world (`nominal`).

    `nominal` is None if the repair changes nothing in the designed world. `seeds` are `SEEDS` fresh seeds. A candidate
    that loses more than the margin or fails too often in one of the worlds is accepted with a probability of at most
    `risk`.
    """
    original = Designed(designed)
    worlds = [_World(drifted, original, reference, risk, "gain too small")]
    if nominal is not None:
        worlds.append(_World(nominal, original, reference, risk, "nominal gets worse"))
    tested = False
    for stage in (_World.screened, _World.tested):
        for world in worlds:
            chosen = seeds[:SCREEN] if stage is _World.screened else seeds[SCREEN:]
            reason = stage(world, chosen)
            tested = tested or stage is _World.tested
            if reason:
                return replace(_ended(worlds, original, reason, tested, seeds), costly=world is not worlds[0])
    return _ended(worlds, original, "", tested, seeds)


def _ended(
    worlds: Sequence[_World], designed: Designed, reason: Reason, tested: bool, seeds: Sequence[int]
) -> Acceptance:
    # For a refused candidate, report all missions; for an accepted one, report only the missions of the test itself.
    seen = [tuple([*world.first, *world.seen] if reason else world.seen) for world in worlds]
    begin = 0 if reason else SCREEN
    used = tuple(seeds[begin : begin + len(seen[0])])
    return Acceptance(
        not reason,
        reason,
        seen[0],
        seen[1] if len(seen) > 1 else (),
        tested,
        sum(len(world.seen) + len(world.first) for world in worlds) + len(designed.known),
        tuple(world.bet for world in worlds if world.bet is not None),
        used,
        tuple(designed(used)),
    )


@dataclass
class _World:
    """A candidate in one world, paired with the designed missions of the same seeds."""

    world: World
    designed: Designed
    reference: Reference
    risk: float
    worse: Reason
    first: list[Outcome] = field(default_factory=list)
    seen: list[Outcome] = field(default_factory=list)
    bet: Bet | None = None

    def screened(self, seeds: Sequence[int]) -> Reason:
        """Run the episodes before the test and choose the bet size; return a reason to refuse, or ""."""
        self.first = self._run(seeds)
        differences = self._differences(self.first, seeds)
        self.bet = bet(self.reference.margin, self.reference.least, differences)
        if self.bet.powerless(LOOKS[-1], self.risk):
            return self._often if self._failed(self.first) else "not shown"
        return self._hopeless(self.first, differences, LOOKS[-1])

    def tested(self, seeds: Sequence[int]) -> Reason:
        """Run the test; return the reason to refuse the candidate, or "" if it is accepted."""
        numbers = dict(zip(LOOKS, self._numbers(), strict=True))
        for look in (*EARLY, *LOOKS):
            self.seen += self._run(seeds[len(self.seen) : look])
            differences = self._differences(self.seen, seeds)
            if self._shown(differences, numbers.get(look)):
                return ""
            if reason := self._hopeless(self.seen, differences, LOOKS[-1] - look):
                return reason
        return self.worse if fmean(differences) < -self.reference.margin else "not shown"

    def _shown(self, differences: Sequence[float], number: int | None) -> bool:
        """Return whether enough missions have passed so far and the test shows that they lose at most the margin."""
        if number is None or self.bet is None or self._failed(self.seen) > number:
            return False
        if fmean(differences) < -self.reference.margin:
            return False
        return self.bet.wealth(differences) >= -log(self.risk)

    def _hopeless(self, outcomes: Sequence[Outcome], differences: Sequence[float], left: int) -> Reason:
        """Return why the test can no longer accept the candidate, or "" if it still can."""
        if self._failed(outcomes) > self._numbers()[-1]:
            return self._often
        if self.bet is None or not self.bet.hopeless(differences, left, self.risk):
            return ""
        return self.worse if fmean(differences) < -self.reference.margin else "not shown"

    @property
    def _often(self) -> Reason:
        return "fails too often" if self.worse == "gain too small" else self.worse

    def _numbers(self) -> tuple[int, ...]:
        return acceptance_numbers(LOOKS, self.reference.tolerated, self.risk)

    def _run(self, seeds: Sequence[int]) -> list[Outcome]:
        self.world.foresee(seeds)
        return [self.world.run(seed) for seed in seeds]

    def _differences(self, outcomes: Sequence[Outcome], seeds: Sequence[int]) -> list[float]:
        designed = self.designed(seeds[: len(outcomes)])
        return [one.total - total for one, total in zip(outcomes, designed, strict=True)]

    @staticmethod
    def _failed(outcomes: Sequence[Outcome]) -> int:
        return sum(not outcome.passed for outcome in outcomes)
