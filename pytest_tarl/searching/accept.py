"""Does a repair hold? One test a candidate, on seeds that nothing was chosen by, final after its last look.

It has to show, in the drifted and in the designed world, that a mission earns on average not less than one as designed
by more than the margin δ, and that at most five points more of them fail. A mission counts as losing at most what a
designed one earns, since failures are judged apart. Each mission of a candidate is paired with the mission of the same
seed that the program as it is runs in the designed world. What the test takes from the candidate beforehand, the size
of its bets, comes from a few seeds of their own, which can end in a refusal only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import log
from statistics import fmean

from pytest_tarl.formulas.judging import Judged
from pytest_tarl.learning.betting import Bet, bet
from pytest_tarl.model import Reason
from pytest_tarl.searching.acceptance_numbers import acceptance_numbers

SCREEN = 8  # episodes before the test
EARLY = (8, 16, 32)  # episodes after which the test can end in a refusal ...
LOOKS = tuple(range(60, 201, 20))  # ... and after which it can end either way
SEEDS = SCREEN + LOOKS[-1]
PASS_RATE_LOSS = 0.05
TOO_LITTLE: tuple[Reason, ...] = ("gain too small", "fails too often", "not shown")  # in the drifted world
SHARE = 2 / 3  # of the risk for the first candidate; each one after it has a third of the one before


@dataclass(frozen=True, slots=True)
class Outcome:
    """One episode: total reward, whether the test passed, and what formulas came to."""

    total: float
    passed: bool
    judged: tuple[Judged, ...] = ()


@dataclass(frozen=True, slots=True)
class Reference:
    """The off-line world that a repair is held against; `margin` is δ, a reward per episode.

    No mission earns less than `lowest`, in either world, and none more than `highest`, where a range is declared.
    """

    totals: Sequence[float]
    pass_rate: float
    margin: float
    lowest: float
    highest: float | None = None

    @property
    def mean(self) -> float:
        """Return the off-line average total reward."""
        return fmean(self.totals)

    @property
    def tolerated(self) -> float:
        """Return the failure rate that a repair must be shown to stay below."""
        return min(1.0 - self.pass_rate + PASS_RATE_LOSS, 1.0)

    @property
    def least(self) -> float:
        """Return the least difference between a mission and the designed one of its seed that is counted.

        There is none below that of the worst mission, declared or else recorded. Where that one loses more than 20
        times the margin, which is all that a designed mission earns at a margin of 5 %, it counts as that much: a
        mission cannot do more than fail, and how many fail is shown apart. Without that limit the least loss that 200
        episodes can show would grow with what a failure costs, and repairs that are right would be refused.
        """
        best = max(self.totals) if self.highest is None else self.highest
        return max(min(self.lowest, *self.totals) - best, -self.margin / PASS_RATE_LOSS)


def unforeseen(wanted: Sequence[object]) -> None:
    """Begin nothing ahead."""


@dataclass(frozen=True, slots=True)
class World:
    """Where a program is run, by seed; `foresee` is told the seeds that will be asked for, unless the test ends."""

    run: Callable[[int], Outcome]
    foresee: Callable[[Sequence[int]], None] = unforeseen


@dataclass
class Designed:
    """The program as it is in the designed world; each seed is run once, for both worlds of a candidate."""

    world: World
    known: dict[int, Outcome] = field(default_factory=dict)

    def __call__(self, seeds: Sequence[int]) -> list[float]:
        """Return the totals of these seeds."""
        new = [seed for seed in seeds if seed not in self.known]
        self.world.foresee(new)
        self.known.update((seed, self.world.run(seed)) for seed in new)
        return [self.known[seed].total for seed in seeds]


@dataclass(frozen=True, slots=True)
class Acceptance:
    """How the test ended: `drifted` and `nominal` are its episodes, nominal empty when none were needed.

    A candidate that its first few seeds refuse is not `tested`: it takes nothing of the risk. `episodes` counts all
    that were run, those of the program as it is included. `bets` are what was bet in the two worlds, `seeds` those of
    the drifted episodes, `designed` what the program as it is earns on them in the designed world.
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


def risk_of(alpha: float, before: int) -> float:
    """Return the risk of a test that so many others came before; over all of them it adds up to α."""
    return alpha * SHARE * (1.0 - SHARE) ** before


def accept(
    drifted: World,
    nominal: World | None,
    designed: World,
    seeds: Sequence[int],
    reference: Reference,
    risk: float,
) -> Acceptance:
    """Test one candidate; `nominal` is None where the repair cannot make a difference in the designed world.

    `seeds` must be fresh, `SEEDS` of them; `risk` is the probability at most with which a candidate is accepted that
    loses more than the margin, or fails too often, in one of the worlds.
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
                return _ended(worlds, original, reason, tested, seeds)
    return _ended(worlds, original, "", tested, seeds)


def _ended(
    worlds: Sequence[_World], designed: Designed, reason: Reason, tested: bool, seeds: Sequence[int]
) -> Acceptance:
    seen = [tuple(world.seen or world.first) for world in worlds]
    begin = SCREEN if worlds[0].seen else 0
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
    """A candidate in one world, against the designed missions of the same seeds."""

    world: World
    designed: Designed
    reference: Reference
    risk: float
    worse: Reason
    first: list[Outcome] = field(default_factory=list)
    seen: list[Outcome] = field(default_factory=list)
    bet: Bet | None = None

    def screened(self, seeds: Sequence[int]) -> Reason:
        """Run the first seeds, which can only refuse; the bet is made by them."""
        self.first = self._run(seeds)
        differences = self._differences(self.first, seeds)
        self.bet = bet(self.reference.margin, self.reference.least, differences)
        return self._hopeless(self.first, differences, LOOKS[-1])

    def tested(self, seeds: Sequence[int]) -> Reason:
        """Run the test; return why it was refused, if it was."""
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
        """Tell whether a look shows both that missions succeed and that they lose nothing."""
        if number is None or self.bet is None or self._failed(self.seen) > number:
            return False
        if fmean(differences) < -self.reference.margin:
            return False
        return self.bet.wealth(differences) >= -log(self.risk)

    def _hopeless(self, outcomes: Sequence[Outcome], differences: Sequence[float], left: int) -> Reason:
        """Say why a test cannot end well any more; "" where it can."""
        if self._failed(outcomes) > self._numbers()[-1]:
            return "fails too often" if self.worse == "gain too small" else self.worse
        if self.bet is None or not self.bet.hopeless(differences, left, self.risk):
            return ""
        return self.worse if fmean(differences) < -self.reference.margin else "not shown"

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
