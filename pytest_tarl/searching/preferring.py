"""Before a confirmed change is yielded, look for changes that a maintainer would prefer to it.

A maintainer prefers changes that are less unusual, milder or smaller, or with which missions proceed as designed.
Searching for one of these kinds takes only a few episodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import log
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.bisecting import bisected
from pytest_tarl.searching.calls_apart import calls_of
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.closeness import CLOSER, COMPARED, EXACT, RIVALS, rivals
from pytest_tarl.searching.exact import exactest
from pytest_tarl.searching.forward_selection import Joint
from pytest_tarl.searching.gains import Part
from pytest_tarl.searching.gentler import another_way, gentler
from pytest_tarl.searching.moderate import MODERATE, extreme, moderate
from pytest_tarl.searching.plainness import Oddness, instead_of_offset, kind, named, oddness, plainer
from pytest_tarl.searching.plateau import NEARBY
from pytest_tarl.searching.preference_search import Search
from pytest_tarl.searching.refining import ALMOST, FURTHER, PROMISING
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.smaller import (
    BESIDE,
    EARLY,
    EPISODES,
    LEAST,
    LOST,
    WORSE,
    inside,
    known_steps,
    milder,
    onward,
    outside,
    smaller,
)
from pytest_tarl.searching.units import NEAR, Unit, change_size

PLAINER_ROUNDS = 2  # maximum number of refinements of each constant whose change a maintainer would prefer
FUNCTIONS = 2  # maximum number of functions whose constants are compared by how their missions proceed
UNUSUAL = 6  # number of episodes for trying other constants if a change leads to unusual commands
PLAINER = 12  # maximum number of episodes for constants whose change a maintainer would prefer


class Preferences:
    """Look for the preferred changes of one search; some kinds are looked for only once."""

    def __init__(self, search: Search) -> None:
        self.search = search
        self._compared: set[tuple[str, str]] = set()  # functions whose constants were compared
        self._moderated = False  # whether moderate changes were already tried before an extreme one
        # whether other constants were already tried before a change that leads to unusual commands
        self._exceeded = False
        self._reduced = False  # whether smaller changes of other constants were already tried
        self._replaced: set[Unit] = set()  # units whose change was already compared with milder changes
        # confirmed changes that wait because another candidate is preferred; they follow if that candidate is refused
        self._aside: list[tuple[Unit, Candidate]] = []

    def before(
        self, found: Candidate, unit: Unit, factor: float, pair: int, holds: bool, near: bool
    ) -> Iterator[Candidate]:
        """Yield the changes preferred to `found`; `near` says whether `found` reached the goal on its first seed."""
        nearer = self._bisected(unit, factor, found.guard, pair) if holds else None
        if nearer is not None:
            unit, factor, found = nearer
        if holds:
            yield from self._moderate(found, unit, factor, pair)
            yield from self._usual(found, unit, factor, pair)
            yield from self._plainer(found, unit, pair)
            yield from self._called(found, unit, factor)
        if holds or (near and oddness(found.mutations) is Oddness.NATURE):
            yield from self._instead(found, unit, self._hardest(pair))
        if holds:
            yield from self._truer(found, unit, factor, pair)
            hardest = self._hardest(pair)
            milder = self._milder(found, unit, factor, hardest)
            if milder is None:
                yield from self._smaller(found, unit, factor, hardest)
            else:
                yield milder
        if nearer is not None:
            yield found
            self.search.refused.add((unit, found.guard))

    def _bisected(
        self, unit: Unit, factor: float, guard: Guard, pair: int
    ) -> tuple[Unit, float, Candidate] | None:
        if self.search.proposed:
            return None
        return bisected(self.search, unit, factor, guard, self._hardest(pair))

    def _moderate(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Iterator[Candidate]:
        """If a change is extreme, once try corrections of sensor readings and small steps of other constants first."""
        if self.search.proposed or self._moderated or not extreme(unit, factor):
            return
        self._moderated = True
        yield from self.search.corrections()
        begun = self.search.trials.spent
        for other, step in moderate(unit, self.search.units, self.search.gains, found.guard):
            if self.search.trials.spent - begun >= MODERATE:
                return
            yield from self.search.attempt(other, found.guard, step, pair)

    def _usual(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Iterator[Candidate]:
        """If a large change leads to unusually large commands, once try the same step on other constants first.

        A simulator may obey commands that no real motor or heater can follow.
        """
        search = self.search
        large = change_size(unit, factor) > log(NEARBY)
        if search.proposed or self._exceeded or not large or not self._exceeds(found, pair):
            return
        self._exceeded, begun = True, search.trials.spent
        for other in sorted(search.gains.moving(search.units), key=kind):
            if search.trials.spent - begun >= UNUSUAL:
                return
            taken = kind(other) >= Oddness.OFFSET or set(other.operands) & set(unit.operands)
            if taken or self._loses(other, factor, found.guard):
                continue
            candidate = search.holding(other, factor, found.guard, pair)
            if candidate is not None and not self._exceeds(candidate, pair):
                yield candidate
                search.refused.add((other, found.guard))

    def _loses(self, unit: Unit, factor: float, guard: Guard) -> bool:
        """Return whether a smaller step of a unit in the same direction clearly lost reward."""
        tried, slack = self.search.gains.of(unit, guard), self.search.gains.slack
        low, high = min(1.0, factor), max(1.0, factor)
        return any(gain < -slack for one, gain in tried.items() if low < one < high)

    def _exceeds(self, candidate: Candidate, pair: int) -> bool:
        """Return whether a candidate publishes larger commands than a designed mission; False if this is unknown."""
        try:
            return self.search.trials.exceeds(candidate, self.search.goal.pairs[pair].seed)
        except RepairError:
            return False

    def _hardest(self, pair: int) -> int:
        """Return the index of the pair on whose seed most candidates earned too little, by default `pair`.

        A rival constant that fails is then dropped after its first mission.
        """
        misses = self.search.trials.misses
        seeds = [one.seed for one in self.search.goal.pairs]
        worst = max(range(len(seeds)), key=lambda at: misses[seeds[at]])
        return worst if misses[seeds[worst]] else pair

    def after(self) -> Iterator[Candidate]:
        """Yield the confirmed changes that were set aside. The changes with the largest mean reward come first."""
        pairs = self.search.goal.pairs
        while self._aside:
            unit, candidate = max(
                self._aside, key=lambda one: fmean(self.search.trials.totals_of(one[1], pairs).values())
            )
            self._aside.remove((unit, candidate))
            yield candidate
            self.search.refused.add((unit, candidate.guard))

    def _plainer(self, found: Candidate, unit: Unit, pair: int) -> Iterator[Candidate]:
        """Spend a few episodes on changes that a maintainer would prefer to the candidate found.

        If the candidate changes a literal, named constants also get larger steps, because small steps may have no
        effect. If the candidate is an offset, the other constants of its statement are first moved by the same amount.
        """
        odd, guard, begun = oddness(found.mutations), found.guard, self.search.trials.spent
        for other, factor in instead_of_offset(found, self.search.units) if odd is Oddness.OFFSET else ():
            yield from self.search.attempt(other, guard, factor, pair)
        # If the candidate is an offset, also refine units that were refused before.
        before = set(self.search.refused if odd is Oddness.OFFSET else ())
        others = [one for one in self.search.units if one != unit]
        gains = self.search.gains.under(guard)
        for other in plainer(odd, gains, others, PROMISING * self.search.goal.wanted, unit):
            held = guard
            for factor in NEAR if other not in gains else ():
                yield from self.search.attempt(other, guard, factor, pair)
            if not self.search.gains.of(other, guard) and ALWAYS in self.search.guards:
                # the condition cannot be written at this place, for example in a helper function
                held = ALWAYS
                for factor in NEAR:
                    yield from self.search.attempt(other, held, factor, pair)
            yield from self._closer(other, held, before, pair)
            if self.search.trials.spent - begun >= PLAINER:
                return
        for factor, nearer in FURTHER if odd is Oddness.INNER else ():
            for other in self.search.gains.leading(
                nearer, guard, named(others), -self.search.gains.slack, inert=True
            ):
                if self.search.trials.spent - begun < PLAINER:
                    yield from self.search.attempt(other, guard, factor, pair)
                    yield from self._closer(other, guard, before, pair)

    def _called(self, found: Candidate, unit: Unit, factor: float) -> Iterator[Candidate]:
        """If a candidate changes a function's return value, try to change only those calls that need the change."""
        calls = calls_of(unit, self.search.units)
        if len(calls) > 1:
            joint = Joint(tuple((call, factor) for call in calls), found.guard)
            yield from self.search.joining({}).fewest(joint)

    def _instead(self, found: Candidate, unit: Unit, pair: int) -> Iterator[Candidate]:
        """If missions with the candidate do not proceed as designed, first try small steps of named constants."""
        if unit in self._replaced or not another_way(found, self.search.trials, self.search.goal):
            return
        self._replaced.add(unit)
        begun, promising = self.search.trials.spent, PROMISING * self.search.goal.wanted
        for other, steps in gentler(unit, self.search.units, self.search.gains, found.guard, promising):
            for step in steps:
                if self.search.trials.spent - begun < PLAINER:
                    yield from self.search.attempt(other, found.guard, step, pair)

    def _truer(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Iterator[Candidate]:
        """If missions with a change of another (rival) constant are much closer to the design, yield that change first.

        The rival constant is then more likely to be the cause. The parameter of a structural change has no rivals, but
        if another value of it leads to much closer missions, that value is examined first.
        """
        seeds, site = self._compared_on(pair), unit.operands[0].site
        function = (site.module, site.qualname)
        if function in self._compared or len(self._compared) >= FUNCTIONS:
            return
        deviation = self._deviation(found, seeds[:1])
        if deviation <= EXACT:
            return
        self._compared.add(function)
        step, least = exactest(unit, factor, found.guard, seeds[0], self.search.mutate, self.search.trials)
        closer = self.search.proposed and least <= CLOSER * deviation
        exact = self.search.holding(unit, step, found.guard, pair) if closer or least <= EXACT else None
        if exact is not None:
            yield exact
            return
        begun, compared = self.search.trials.spent, set[Unit]()
        for other, step in rivals(unit, factor, self.search.units, self.search.gains, found.guard):
            if self.search.trials.spent - begun >= RIVALS:
                return
            if other in compared or not self._promises(other, step, found.guard, pair):
                continue
            compared.add(other)
            candidate = self._closer_rival(found, other, step, pair)
            if candidate is None:
                continue
            if self._deviation(candidate, seeds) <= CLOSER * self._deviation(found, seeds):
                yield candidate
                self.search.refused.add((other, found.guard))
                return
            self._aside.append((other, candidate))

    def _promises(self, unit: Unit, factor: float, guard: Guard, pair: int) -> bool:
        """Return whether a factor reaches the goal on a pair's seed, or gains at least `PROMISING`."""
        if self.search.reaches(unit, factor, guard, pair):
            return True
        gain = self.search.gains.of(unit, guard).get(factor, 0.0)
        return gain >= PROMISING * self.search.goal.wanted

    def _closer_rival(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Candidate | None:
        """Return a change of a rival constant if it is confirmed to reach the goal, else None.

        The factor is chosen so that the mission on the first seed is closest to the designed mission. If this mission
        is not much closer than the mission of `found`, the rival is dropped without further episodes.
        """
        search, seed = self.search, self._compared_on(pair)[0]
        step, least = exactest(unit, factor, found.guard, seed, search.mutate, search.trials)
        if least > CLOSER * self._deviation(found, [seed]):
            return None
        tried = (search.holding(unit, one, found.guard, pair) for one in dict.fromkeys((step, factor)))
        return next((one for one in tried if one is not None), None)

    def _smaller(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Iterator[Candidate]:
        """Yield a much smaller change of another constant first, if its missions are as close to the designed ones."""
        if (
            self._reduced
            or self.search.proposed
            or change_size(unit, factor) < log(LEAST)
            or self.search.trials.spent > EARLY * self.search.trials.budget
        ):
            return
        parts = smaller(unit, factor, self.search.units, self.search.gains, found.guard)
        self._reduced = bool(parts)
        begun, seeds = self.search.trials.spent, self._compared_on(pair)
        for other, step in self._small_steps(parts, found, unit, factor, begun):
            step, candidate = self._smaller_holding(other, step, found.guard, pair)
            if candidate is None:
                continue
            step, candidate = self._off_the_edge(candidate, other, step, pair)
            if self._deviation(candidate, seeds) <= self._deviation(found, seeds) + WORSE:
                yield from self._truer(candidate, other, step, pair)
                yield candidate
                self.search.refused.add((other, found.guard))
                return
            self._aside.append((other, candidate))

    def _milder(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Candidate | None:
        """Return a candidate with the value halfway to the old one if it earns as much, else None.

        This is done only if no value in between was tried. A value a little nearer to the old one must pass, too, so
        that the value halfway lies inside the good range.
        """
        gains = self.search.gains.of(unit, found.guard)
        halfway = milder(unit, factor, gains)
        if self.search.proposed or halfway is None:
            return None
        candidate = self.search.holding(unit, halfway, found.guard, pair)
        if candidate is None:
            return None
        one, other = (
            self.search.trials.totals_of(each, self.search.goal.pairs) for each in (candidate, found)
        )
        lost = fmean(other[at] - one[at] for at in one.keys() & other.keys())
        if lost <= LOST * self.search.goal.wanted and self._holds_inside(unit, halfway, found.guard, pair):
            return candidate
        self._aside.append((unit, candidate))
        return None

    def _holds_inside(self, unit: Unit, factor: float, guard: Guard, pair: int) -> bool:
        """Return whether a factor a little nearer to 1 reaches the goal on a few seeds."""
        nearer = Candidate(unit.mutations(self.search.mutate, inside(factor)), guard)
        trials, goal = self.search.trials, self.search.goal
        try:
            return all(goal.reached(trials(nearer, seed), seed) for seed in self._compared_on(pair))
        except RepairError:
            return False

    def _small_steps(
        self, parts: Sequence[Part], found: Candidate, unit: Unit, factor: float, begun: int
    ) -> Iterator[Part]:
        """Yield the parts while episodes are left, then larger steps of the parts that gained something.

        Parts are small steps of constants. Small steps that were tried earlier count as well.
        """
        tried = known_steps(unit, self.search.units, self.search.gains, found.guard)
        for part in parts:
            if self.search.trials.spent - begun >= EPISODES:
                break
            tried.append(part)
            yield part
        for part in onward(tried, unit, factor, self.search.gains, found.guard, self.search.goal.wanted):
            if self.search.trials.spent - begun >= EPISODES:
                return
            yield part

    def _smaller_holding(
        self, unit: Unit, step: float, guard: Guard, pair: int
    ) -> tuple[float, Candidate | None]:
        """Try a small step and, if it earns nearly enough, its neighbours; return the first confirmed one."""
        if (unit, guard) in self.search.refused:
            return step, None
        candidate = self.search.holding(unit, step, guard, pair)
        gains = self.search.gains.of(unit, guard)
        if candidate is not None or gains.get(step, 0.0) < ALMOST * self.search.goal.wanted:
            return step, candidate
        steps = [round(step * by, 3) for by in BESIDE]
        tried = ((one, self.search.holding(unit, one, guard, pair)) for one in steps)
        return next(((one, candidate) for one, candidate in tried if candidate is not None), (step, None))

    def _off_the_edge(
        self, candidate: Candidate, unit: Unit, step: float, pair: int
    ) -> tuple[float, Candidate]:
        """Return a slightly larger change if one that is slightly smaller than the candidate misses the goal."""
        if self.search.reaches(unit, inside(step), candidate.guard, pair):
            return step, candidate
        larger = outside(step)
        beyond = self.search.holding(unit, larger, candidate.guard, pair)
        if beyond is None:
            return step, candidate
        self._aside.append((unit, candidate))
        return larger, beyond

    def _compared_on(self, pair: int) -> list[int]:
        """Return the seeds on which to compare how missions proceed."""
        return [
            self.search.goal.pairs[(pair + i) % len(self.search.goal.pairs)].seed for i in range(COMPARED)
        ]

    def _deviation(self, candidate: Candidate, seeds: Sequence[int]) -> float:
        """Return the deviation of a candidate's missions from the designed ones, or 0 if it is unknown."""
        try:
            return self.search.trials.deviation(candidate, seeds)
        except RepairError:
            return 0.0

    def _closer(
        self, unit: Unit, guard: Guard, closed_before: set[tuple[Unit, Guard]], pair: int
    ) -> Iterator[Candidate]:
        """Refine a unit for `PLAINER_ROUNDS` rounds while it gains at least `PROMISING` and was not refused."""
        for _ in range(PLAINER_ROUNDS):
            closed = (unit, guard) in self.search.refused - closed_before
            if self.search.gains.most((unit, guard)) >= PROMISING * self.search.goal.wanted and not closed:
                yield from self.search.between((unit, guard), pair)
