"""Find combinations of directions that break the guarantee, even where no single direction breaks it.

The combinations are confirmed on fresh seeds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import inf

from pytest_tarl.spaces import Point
from pytest_tarl.stressing import chains
from pytest_tarl.stressing.boundary import COARSE, bisect
from pytest_tarl.stressing.evaluating import NEAREST, SIZES, SPENT, Evaluator
from pytest_tarl.stressing.findings import (
    APART,
    Curve,
    Failure,
    MarginMap,
    confirmed,
    contains,
    failure,
    place_on,
)
from pytest_tarl.stressing.guarantee import Part, recorded_mean
from pytest_tarl.stressing.nearest import AGAIN, EXPECTED, LARGEST, ROUNDS, Nearest
from pytest_tarl.stressing.rate_tests import RateTests
from pytest_tarl.stressing.rays import Ray, distance, joined
from pytest_tarl.stressing.trimming import broken, trimmed

# pairs are tested at this share of the way to both boundaries, where neither direction alone breaks the guarantee
INSIDE = 0.9
FIRST = 0.44  # share of the budget for the first search
# the first chains of tests stop at this share of the budget, so that the model can learn from them
BEGUN = 0.7
# all chains of tests stop at this share of the budget, to keep episodes for the single directions
CONFIRMED = 0.85
LAST = 0.85  # pairs and evolution stop at this share of the budget, to keep episodes for confirmation
ALONE = 3  # rounds of the search with nominal options, before other options are searched
REFINED = 0.08  # share of the budget for the search between the first two chains of tests
TRIMMED = 0.1  # maximum share of the budget for trimming a confirmed drift
FURTHER = 6  # maximum number of searches after the planned chains; a chain follows each
EXPLORED = 0.06  # maximum share of the budget for each of these FURTHER searches
ATTEMPTS = 2  # the first search tests at most this many chains, and stops when one confirms a drift
RECORDED = 0.05  # share of the total risk for the bound on the recorded mean reward
# shares of the total risk for the first chains; each later chain gets half of what remains
SHARES = (0.4, 0.3, 0.1, 0.05)
QUICK = SIZES[0]  # number of search episodes at a drift that was confirmed to fail
# A new chain is tested before an interrupted one is continued if its near end is much nearer: if its distance is below
# this share of the distance of the interrupted chain's next drift.
AHEAD = 0.97


@dataclass
class Chain:
    """A chain of drifts, farthest first, and its tests; `left` holds the drifts still to be tested.

    All drifts are chosen before the pool's first episode, so the tests can be interrupted and continued at any time
    (fixed-sequence procedure). Each test uses the chain's full `risk`.
    """

    left: list[Point]
    evaluator: Evaluator
    pool: str
    risk: float
    part: Part
    least: float | None = None  # lower bound on the nominal mean reward; used instead of nominal episodes

    def __post_init__(self) -> None:
        """Prepare the tests of the failure rate."""
        self._rates = RateTests(self.evaluator, self.pool, self.risk)

    def confirm(self, point: Point) -> bool:
        """Return whether fresh episodes show that the guarantee fails at a point. Raise BudgetSpentError."""
        if self.part == "rate":
            return self._rates.confirm(point)
        return self.evaluator.confirm(
            point, self.pool, self.risk, NEAREST, SPENT, self.part, strict=True, least=self.least
        )


@dataclass
class Together:
    """The confirmed combinations; the probability that any of them is a false alarm is at most `risk`."""

    risk: float
    curves: Sequence[Curve]
    # confirmed failures, without those that hardly differ from a nearer one
    found: list[Failure] = field(default_factory=list)
    every: list[Failure] = field(default_factory=list)  # all confirmed failures
    tried: int = 0  # number of drifts in several directions tried by the search
    margin_map: MarginMap | None = None
    chains: int = 0  # number of chains tested so far
    tested: list[Point] = field(default_factory=list)  # drifts of the tested chains that have episodes
    interrupted: Chain | None = None  # the last chain, if the budget ran out during its tests
    # drifts that the model expects to fail, but that are not confirmed
    expected: list[Failure] = field(default_factory=list)

    @property
    def confirmed(self) -> list[Failure]:
        """Return the confirmed failing drifts along single directions and in combination."""
        return [*confirmed(self.curves), *self.every]

    def confirm(
        self, chain: Sequence[Point], evaluator: Evaluator, part: Part = "both", *, unpaired: bool = False
    ) -> bool:
        """Test drifts on fresh seeds, farthest first, until one is not confirmed; return whether any was confirmed.

        The tests examine this `part` of the guarantee; it must be chosen independently of the fresh seeds. With
        `unpaired`, they compare with a lower bound on the recorded mean reward instead of nominal episodes. This bound
        has its own share of the risk and is the same in all chains, so the choice of drifts may depend on it.

        Each test uses the chain's full risk. This is valid because a false alarm requires an error at one particular
        drift: the first one at which the guarantee holds. Each chain has new seeds, so its drifts may be chosen by the
        outcomes of earlier chains, from which the model learns. A drift is skipped if it contains a confirmed failure,
        which means that it changes the same values by at least as much. Raise BudgetSpentError.
        """
        usual, known = evaluator.space.nominal, self.confirmed
        chain = [
            point
            for point in chain
            if point != usual and not any(contains(evaluator.space, point, other.point) for other in known)
        ]
        if not chain:
            return False
        risk = self.risk * _share(self.chains)
        number, self.chains = self.chains, self.chains + 1
        least = recorded_mean(evaluator.guarantee, self.risk * RECORDED) if unpaired else None
        return self.run(Chain(chain, evaluator, f"chain {number}", risk, part, least))

    def run(self, chain: Chain) -> bool:
        """Start or continue the tests of a chain; return whether another drift was confirmed.

        If the budget runs out, keep the chain in `interrupted` and raise BudgetSpentError.
        """
        found, self.interrupted = False, chain
        try:
            while chain.left:
                point = chain.left[0]
                if point not in self.tested[-1:]:
                    self.tested.append(point)
                if not chain.confirm(point):
                    break
                found = True
                del chain.left[0]
                self._add(failure(chain.evaluator.space, point), chain.evaluator)
            self.interrupted = None
        finally:
            chain.evaluator.release(chain.pool)
            self.found = _apart(self.every, chain.evaluator)
        return found

    def _add(self, found: Failure, evaluator: Evaluator) -> None:
        if len(found.names) > 1:
            self.every.append(found)
        else:
            self._along(found, evaluator)

    def _along(self, found: Failure, evaluator: Evaluator) -> None:
        """Add a confirmed failure along a single direction to the curve of that direction."""
        for curve in self.curves:
            t = place_on(curve.ray, found)
            if t is not None:
                curve.evidence[t] = evaluator.examine(curve.ray.point(t), QUICK)
                curve.confirm(t)


def _share(number: int) -> float:
    """Return the share of the risk for chain `number`, counted from 0; with RECORDED, all shares sum to 1."""
    if number < len(SHARES):
        return SHARES[number]
    return (1.0 - RECORDED - sum(SHARES)) * 0.5 ** (number - len(SHARES) + 1)


def _apart(found: Sequence[Failure], evaluator: Evaluator) -> list[Failure]:
    """Return the failures in the same order, without those that hardly differ from a nearer one.

    A failure hardly differs from a nearer one if it contains that one and is less than APART times as far away.
    """
    kept: list[Failure] = []
    for one in sorted(found, key=lambda one: (one.distance, one.names)):
        if not any(
            one.distance < APART * near.distance and contains(evaluator.space, one.point, near.point)
            for near in kept
        ):
            kept.append(one)
    return [one for one in found if one in kept]


class Combined:
    """The search in several directions: `begin` runs before the search in single directions, `end` after it.

    With nominal options, the search may find no failing drift near nominal. Each other option is then searched
    separately.
    """

    def __init__(self, evaluator: Evaluator, together: Together) -> None:
        self.evaluator, self.together = evaluator, together
        self._trimmed: list[Point] = []  # confirmed drifts at a jump that were already trimmed
        risk = together.risk * _share(1)
        self.nearest = Nearest(evaluator, together.curves, risk=risk)
        self.options = [
            Nearest(evaluator, together.curves, self.nearest.tried, risk=risk, base=curve.ray.farthest)
            for curve in together.curves
            if not curve.ray.continuous and len(self.nearest.coordinates.spans) > 1
        ]

    def begin(self) -> None:
        """Run a few episodes on each ray, search for the nearest failing drift, and confirm it.

        Raise BudgetSpentError.
        """
        with self.evaluator.limited(FIRST):
            for curve in self.together.curves:
                for t in curve.ray.places:
                    curve.evidence[t] = self.evaluator.glance(curve.ray.point(t))
            self._approach()
        with self.evaluator.limited(BEGUN):
            if not any(self._confirm(chains.FIRST) for _ in range(ATTEMPTS)):
                self._test(chains.clear(self._leading))
        with self.evaluator.limited(CONFIRMED):
            self._trim()
            with self.evaluator.limited(self.evaluator.spent / self.evaluator.budget + REFINED):
                self._leading.refine()
            if not self._continue():
                self._approach_confirmed()
            self._search_on()

    def end(self) -> None:
        """Search for nearer failing drifts, test pairs of directions, then confirm. Raise BudgetSpentError."""
        proposed: list[Point] = []
        with self.evaluator.limited(LAST):
            self._leading.improve()
            pairs(self.evaluator, self.together, proposed)
        self._confirm(chains.NEXT)
        self._test(sorted(proposed, key=lambda one: -distance(self.evaluator.space, one)))

    def draw(self) -> None:
        """Predict the map and the nearest failures, without new episodes; skip this if a ray has no episodes."""
        if not all(curve.evidence for curve in self.together.curves):
            return
        with self.evaluator.limited(0.0):
            found = self._leading.expected(EXPECTED)
            self.together.expected = [failure(self.evaluator.space, point) for point in found]
            self.together.margin_map = self.nearest.map()

    def _approach(self) -> None:
        """Search with nominal options, and with every other option that may lead to a nearer failure.

        Raise BudgetSpentError.
        """
        if not self.options:
            self.nearest.approach()
            return
        self.nearest.approach(ALONE)
        self._explore(ROUNDS)

    def _explore(self, rounds: int) -> None:
        """Explore with nominal options, and with every other option that may lead to a nearer failure.

        Raise BudgetSpentError.
        """
        for _ in range(rounds):
            best = self._leading.best
            limit = LARGEST if best is None else self.nearest.distance(best)
            nearer = [
                one
                for one in self.options
                if one.coordinates.options < limit**2 and not self._option_fails(one)
            ]
            for one in (self.nearest, *nearer):
                one.ceiling = limit
                one.explore(1)

    def _option_fails(self, option: Nearest) -> bool:
        """Return whether a few episodes show that an option alone fails. Raise BudgetSpentError.

        The first search may have spent its budget before any episode ran on the option's own ray.
        """
        evaluator, base = self.evaluator, option.coordinates.base
        found = evaluator.known(base) if evaluator.searched(base) else evaluator.glance(base)
        return found.result == "fails"

    @property
    def _leading(self) -> Nearest:
        """Return the search that found the nearest failing drift, or the one with nominal options if none failed."""
        leading, least = self.nearest, inf
        for one in (*self.options, self.nearest):
            best = one.best
            if best is None or any(
                other is not one and other.coordinates.covers(best) for other in self.options
            ):
                # `other` searches with the options of `best`: its model decides whether `best` fails
                continue
            if one.distance(best) < least:
                leading, least = one, one.distance(best)
        return leading

    def _confirm(self, plan: chains.Plan) -> bool:
        """Test a chain that ends nearer to nominal than every confirmed drift. Raise BudgetSpentError."""
        return self._test(self._next(plan))

    def _next(self, plan: chains.Plan) -> list[Point]:
        limit = min((one.distance for one in self.together.confirmed), default=inf)
        return chains.chain(self._leading, plan, limit)

    def _continue(self) -> bool:
        """Continue the interrupted chain, or test a nearer chain; return whether a drift was confirmed.

        Continuing a chain needs fewer episodes than a new chain, because its seeds have already run at the last drift.
        The chain is dropped if the model, which has learned from these episodes, no longer expects a confirmation.
        Raise BudgetSpentError.
        """
        begun = self.together.interrupted
        if begun is None or not chains.likely(self._leading, begun.left[0]):
            return self._confirm(chains.NEXT)
        chain = self._next(chains.NEXT)
        nearer = chain and self.nearest.distance(chain[-1]) < AHEAD * self.nearest.distance(begun.left[0])
        return (bool(nearer) and self._test(chain)) or self.together.run(begun)

    def _approach_confirmed(self) -> None:
        """Test chains in small steps from the nearest confirmed drift, until a chain confirms nothing.

        The earlier chains had larger steps and may have ended far from the boundary. Raise BudgetSpentError.
        """
        while known := self.together.confirmed:
            near = min(known, key=lambda one: (one.distance, one.names)).point
            chain = chains.closer(self._leading, near)
            if not self._run(chain, chains.part_of(self._leading, chain[:1])):
                return

    def _trim(self) -> None:
        """Move single directions of the nearest confirmed drift towards nominal, if it is at a jump; test the result.

        Do nothing while a chain is interrupted: if its next drift also fails, there is no jump. Raise BudgetSpentError.
        """
        evaluator, known = self.evaluator, self.together.confirmed
        if not known or self.together.interrupted is not None:
            return
        near = min(known, key=lambda one: (one.distance, one.names)).point
        part = broken(near, evaluator, self._leading.model().shown)
        if part is None or near in self._trimmed:
            return
        self._trimmed.append(near)
        last = near
        with evaluator.limited(evaluator.spent / evaluator.budget + TRIMMED):
            for nearer in trimmed(near, evaluator, self.nearest.tried):
                last = nearer
        if last != near:
            self._run([between(near, last), last], part)

    def _search_on(self) -> None:
        """Alternate between exploring and testing further chains while episodes are left. Raise BudgetSpentError.

        The earlier chains stopped when the model expected no nearer drift to fail, but another region may contain one.
        """
        evaluator = self.evaluator
        for _ in range(FURTHER):
            spent = evaluator.spent
            self._trim()
            with evaluator.limited(evaluator.spent / evaluator.budget + EXPLORED):
                self._explore(AGAIN)
            if evaluator.spent == spent:
                return
            self._confirm(chains.NEXT)

    def _test(self, chain: Sequence[Point]) -> bool:
        """Test a chain, extended by drifts on the ray through its near end. Raise BudgetSpentError."""
        leading = self._leading
        part = chains.part_of(leading, chain)
        return self._run(chains.finer(leading, chain, part), part)

    def _run(self, chain: Sequence[Point], part: Part) -> bool:
        self.together.tried = len(self.nearest.tried)
        try:
            unpaired = part != "rate" and self._leading.unpaired
            return self.together.confirm(chain, self.evaluator, part, unpaired=unpaired)
        finally:
            for one in (self.nearest, *self.options):
                one.tested = self.together.tested


def between(one: Point, other: Point) -> Point:
    """Return the point in the middle of two points with the same options."""
    return {name: (number + other[name]) / 2 for name, number in one.items()}


def pairs(evaluator: Evaluator, together: Together, proposed: list[Point]) -> None:
    """Test pairs of directions just inside their boundaries; if a pair fails, bisect towards nominal.

    Append the nearest failing drift of each pair to `proposed`. Skip pairs farther from nominal than a confirmed
    combination. Raise BudgetSpentError.
    """
    inside = list(_inside(together.curves))
    nearest = min((one.distance for one in together.found), default=inf)
    for one, other in combinations(inside, 2):
        if one[0].names == other[0].names:
            continue
        curve = Curve(joined((one, other)))
        if curve.ray.length >= nearest:
            continue
        together.tried += 1
        curve.evidence[1.0] = evaluator.examine(curve.ray.point(1.0), COARSE)
        if curve.failing:
            bisect(curve, evaluator)
            decided = [t for t in curve.failing if curve.evidence[t].result == "fails"]
            proposed += [curve.ray.point(t) for t in decided[:1]]


def _inside(curves: Sequence[Curve]) -> Iterator[tuple[Ray, float]]:
    """Yield each ray with the largest t for a pair; skip options that break the guarantee on their own."""
    for curve in curves:
        if not curve.failing:
            yield curve.ray, 1.0
        elif curve.ray.continuous and curve.bracket and curve.bracket[0] > 0.0:
            yield curve.ray, INSIDE * curve.bracket[0]
