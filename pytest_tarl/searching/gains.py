"""A table of the gains of single units by guard and factor, and rankings from it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from pytest_tarl.model import Guard
from pytest_tarl.searching.plainness import Oddness, kind
from pytest_tarl.searching.units import NEAR, Unit
from tarl_lint.model import SiteId

SEEN = 6  # a guard can be called idle only after this number of units were tried under the guard
IDLE = 0.25  # a guard is idle if at most this share of the units tried under it changed an episode
# two units count as acting alike if at least this many factors clearly changed the reward by the same amount for both
ALIKE = 3

Key = tuple[Unit, Guard]
Part = tuple[Unit, float]  # a unit, and the factor by which it is changed


class Gains:
    """Gains in total reward over the unmutated runs of the same seeds.

    Gains of at most `slack` are treated as noise. If `proposed` is true, a factor of 1 counts as a change. `acting`
    returns whether a unit changed what the nodes publish, and may run an episode to find out.
    """

    def __init__(
        self, slack: float, proposed: bool = False, acting: Callable[[Unit], bool] | None = None
    ) -> None:
        self._acting = acting
        self.slack = slack
        self.proposed = proposed
        self._by_key: dict[Key, dict[float, float]] = {}
        self._moved: set[tuple[Unit, float]] = set()
        self._moved_under: set[Key] = set()
        self._hollow: set[tuple[Key, float]] = set()

    def enter(
        self, key: Key, factor: float, gain: float, moved: bool | None = None, hollow: bool = False
    ) -> None:
        """Store the gain of a factor and whether it changed an episode (by default: gain not 0).

        A `hollow` gain comes from missions that only fail sooner. Such a gain may be refined, but does not count as
        progress.
        """
        (self._hollow.add if hollow else self._hollow.discard)((key, factor))
        self._by_key.setdefault(key, {} if self.proposed else {1.0: 0.0})[factor] = gain
        if gain if moved is None else moved:
            self._moved.add((key[0], factor))
            self._moved_under.add(key)

    def of(self, unit: Unit, guard: Guard) -> Mapping[float, float]:
        """Return the gains of a unit under a guard, by factor."""
        return self._by_key.get((unit, guard), {})

    def most(self, key: Key) -> float:
        """Return the largest gain of any factor of this unit and guard."""
        return max(self._by_key.get(key, {1.0: 0.0}).values())

    def items(self) -> Iterator[tuple[Key, Mapping[float, float]]]:
        """Yield each unit and guard with its gains, in the order in which they were first tried."""
        yield from self._by_key.items()

    def under(self, guard: Guard) -> dict[Unit, Mapping[float, float]]:
        """Return the gains of all units that were tried under a guard."""
        return {unit: gains for (unit, held), gains in self._by_key.items() if held == guard}

    def best(self) -> float:
        """Return the largest gain that is not hollow, at least 0."""
        real = (
            gain
            for key, gains in self._by_key.items()
            for factor, gain in gains.items()
            if (key, factor) not in self._hollow
        )
        return max(real, default=0.0)

    def anything(self, least: float | None = None) -> bool:
        """Return whether any gain exceeds `least`, by default `slack`."""
        bound = self.slack if least is None else least
        return self.best() > bound

    def always_lost(self, key: Key) -> bool:
        """Return whether a unit lost more than `slack` under a guard with each factor that was tried."""
        return all(gain < -self.slack for gain in self._by_key.get(key, {1.0: 0.0}).values())

    def idle(self, unit: Unit) -> bool:
        """Return whether a proposed change had no effect with its proposed value (factor 1)."""
        tried = any(1.0 in gains for (one, _), gains in self._by_key.items() if one == unit)
        return self.proposed and tried and (unit, 1.0) not in self._moved

    def moves(self, unit: Unit) -> bool:
        """Return whether a unit changed any episode."""
        return any(moved == unit for moved, _ in self._moved)

    def moved_by(self, unit: Unit, factor: float) -> bool:
        """Return whether a factor of a unit changed any episode."""
        return (unit, factor) in self._moved

    def idle_guard(self, guard: Guard) -> bool:
        """Return whether changes under a guard hardly have any effect, because the robot does little where it holds."""
        tried = self.under(guard)
        moved = sum((unit, guard) in self._moved_under for unit in tried)
        return bool(guard.conjuncts) and len(tried) >= SEEN and moved <= IDLE * len(tried)

    def matters(self, unit: Unit) -> bool:
        """Return whether a unit changed any episode, or at least what the nodes publish."""
        return self.moves(unit) or self._acts(unit)

    def _acts(self, unit: Unit) -> bool:
        return self._acting is not None and self._acting(unit)

    def moving(self, among: Sequence[Unit]) -> list[Unit]:
        """Return the units, except those for which neither an increase nor a decrease had any effect.

        While no unit gains, a changed command counts as an effect, because all failing missions may earn the same.
        Tries under an idle guard (see `idle_guard`) do not count.
        """
        tries: dict[Unit, int] = {}
        idle = {guard for guard in {guard for _, guard in self._by_key} if self.idle_guard(guard)}
        for (unit, guard), by_factor in self._by_key.items():
            if guard in idle:
                continue
            tries[unit] = tries.get(unit, 0) + sum(factor != 1.0 for factor in by_factor)
        moved, flat = {unit for unit, _ in self._moved}, not self.anything()
        return [
            unit
            for unit in among
            if tries.get(unit, 0) < len(NEAR) or unit in moved or (flat and self._acts(unit))
        ]

    def distinct(self, among: Sequence[Unit]) -> list[Unit]:
        """Return the units, except those that change the constant of an earlier unit with the same effect.

        For example, a constant that is passed to a function is used both in the call and in the function. Two units
        count as equal if they share a definition, at least two factors were tried on both, and the gains of all these
        factors are equal.
        """
        kept: list[Unit] = []
        for unit in among:
            if not any(self._same(unit, other) for other in kept):
                kept.append(unit)
        return kept

    def _same(self, unit: Unit, other: Unit) -> bool:
        one, two = unit.operands[0], other.operands[0]
        if one.definition is None or one.definition != two.definition or one.literal or two.literal:
            return False
        if not self.moves(unit):
            return False
        pairs = [
            (gains.get(factor), gain)
            for guard in {guard for each, guard in self._by_key if each == unit}
            for gains in (self.of(other, guard),)
            for factor, gain in self.of(unit, guard).items()
            if factor != 1.0 and factor in gains
        ]
        return len(pairs) >= len(NEAR) and all(gain == its for its, gain in pairs)

    def acting_alike(self, unit: Unit, guard: Guard, among: Sequence[Unit]) -> list[Unit]:
        """Return the other units for which at least `ALIKE` factors had the same effects under a guard."""
        mine = self.of(unit, guard)
        found = []
        for other in among if self.moves(unit) else ():
            its = self.of(other, guard)
            both = [factor for factor in mine if factor != 1.0 and factor in its]
            same = sum(mine[one] == its[one] and abs(mine[one]) > self.slack for one in both)
            # tolerance, because steps may be rounded
            apart = any(abs(mine[one] - its[one]) > self.slack for one in both)
            if other != unit and same >= ALIKE and not apart:
                found.append(other)
        return found

    def lost_both_ways(self, guard: Guard, among: Sequence[Unit], factors: Sequence[float]) -> list[Unit]:
        """Return the units that lost more than `slack` with each of these factors.

        A mission that already earns the least possible reward cannot lose more. Therefore, an episode that changed but
        earned the same also counts as a loss. For a named constant, a change of the published messages counts as well.
        """
        tried = {unit: self.of(unit, guard) for unit in among}

        def lost(unit: Unit, gains: Mapping[float, float], factor: float) -> bool:
            gain = gains.get(factor)
            return gain is not None and (
                gain < -self.slack
                or (gain == 0.0 and ((unit, factor) in self._moved or self._acts_by_name(unit)))
            )

        return [unit for unit, gains in tried.items() if all(lost(unit, gains, one) for one in factors)]

    def clearly_lost(self, guard: Guard, among: Sequence[Unit], factors: Sequence[float]) -> list[Unit]:
        """Return the units that lost more than `slack` with each of these factors, judged by the reward alone."""
        tried = {unit: self.of(unit, guard) for unit in among}
        return [
            unit for unit, known in tried.items() if all(known.get(one, 0.0) < -self.slack for one in factors)
        ]

    def _acts_by_name(self, unit: Unit) -> bool:
        return kind(unit) is Oddness.NAMED and self._acts(unit)

    def leading(
        self, before: float, guard: Guard, among: Sequence[Unit], least: float, inert: bool = False
    ) -> list[Unit]:
        """Return the units whose gain with the factor `before` is at least `least`, best first.

        Units that never changed an episode are excluded unless `inert` is true.
        """
        gains = {unit: self.of(unit, guard).get(before) for unit in (among if inert else self.moving(among))}
        kept = [(gain, unit) for unit, gain in gains.items() if gain is not None and gain >= least]
        return [unit for _, unit in sorted(kept, key=lambda one: -one[0])]

    def best_under(self, guards: Sequence[Guard]) -> list[Part]:
        """Return the units that gained under one of the guards, each with its best factor, best gain first."""
        best: dict[Unit, tuple[float, float]] = {}
        for (unit, held), gains in self._by_key.items():
            factor = max(gains, key=gains.__getitem__)
            if held in guards and gains[factor] > best.get(unit, (0.0, 1.0))[0]:
                best[unit] = gains[factor], factor
        return [(unit, best[unit][1]) for unit in sorted(best, key=lambda unit: -best[unit][0])]

    def leaders(self, guard: Guard) -> list[tuple[float, Part]]:
        """For each site, return the best unit under a guard with its gain and factor, best gain first."""
        found: dict[SiteId, tuple[float, Part]] = {}
        for unit, gains in self.under(guard).items():
            gain, factor = max((gain, factor) for factor, gain in gains.items())
            site = unit.operands[0].site
            if gain > found.get(site, (0.0,))[0]:
                found[site] = gain, (unit, factor)
        return sorted(found.values(), key=lambda one: -one[0])
