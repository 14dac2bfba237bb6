"""Which changes are tried before a confirmed change is yielded, with a scripted search around them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.closeness import RIVALS
from pytest_tarl.searching.forward_selection import ForwardSelection
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.preferring import FUNCTIONS, PLAINER, Preferences
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.smaller import EPISODES
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_gains import WET, constant
from tests.plugin.searching.test_search import operand

A, B, C, D = (Unit((constant(line, name),)) for line, name in ((2, "A"), (3, "B"), (4, "C"), (5, "D")))
LITERAL = Unit((operand(9, "1.5", 1.5),))
ZERO = Unit((operand(8, "0.0", 0.0),))
GRAVITY = Unit((constant(7, "G", 9.81),))
STEADY = (1.0,) * 10  # rewards of a designed mission
PAIRS = tuple(Pair(seed, 0.0, 10) for seed in range(5))
GOAL = Goal(PAIRS, near=9.0, enough=10.0, online=0.0)

Act = Callable[[Candidate, int], Outcome]


def failing(_: Candidate, __: int) -> Outcome:
    return Outcome(0.0, False, steps=10)


class Scripted:
    """A search whose tries run in a scripted world; `log` lists them in order.

    `holds` are the tries that are confirmed; all others gain what the world gives.
    """

    def __init__(
        self,
        units: Sequence[Unit],
        run: Act = failing,
        holds: Sequence[tuple[Unit, float]] = (),
        goal: Goal = GOAL,
        guards: Sequence[Guard] = (ALWAYS,),
        proposed: bool = False,
        **given: Any,
    ) -> None:
        self.units, self.guards, self.goal, self.proposed = tuple(units), guards, goal, proposed
        self.mutate = mutations
        self.trials = Trials(run, given.pop("budget", 500), **given)
        self.gains = Gains(1.0)
        self.refused: set[tuple[Unit, Guard]] = set()
        self.holds = set(holds)
        self.log: list[tuple[str, str, float | None, int]] = []
        self.guarded: list[Guard] = []
        self.joined: list[list[tuple[Unit, float]]] = []

    def _run(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
        candidate = Candidate(unit.mutations(self.mutate, factor), guard)
        try:
            gain = self.trials(candidate, self.goal.pairs[pair].seed).total
        except RepairError:
            return None
        self.gains.enter((unit, guard), factor, gain)
        return candidate if (unit, factor) in self.holds else None

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        self._note("attempt", unit, factor, pair, guard)
        if (found := self._run(unit, factor, guard, pair)) is not None:
            yield found

    def corrections(self) -> Iterator[Candidate]:
        self.log.append(("corrections", "", None, 0))
        yield from ()

    def between(self, best: tuple[Unit, Guard], pair: int) -> Iterator[Candidate]:
        self._note("between", best[0], None, pair, best[1])
        yield from ()

    def holding(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
        self._note("holding", unit, factor, pair, guard)
        return self._run(unit, factor, guard, pair)

    def reaches(self, unit: Unit, factor: float, guard: Guard, pair: int) -> bool:
        self._note("reaches", unit, factor, pair, guard)
        self._run(unit, factor, guard, pair)
        seed = self.goal.pairs[pair].seed
        outcome = self.trials(Candidate(unit.mutations(self.mutate, factor), guard), seed)
        return self.goal.reached(outcome, seed)

    def joining(self, gains: Mapping[Unit, Mapping[float, float]]) -> ForwardSelection:
        return ForwardSelection(self.units, self.mutate, self.trials, self.goal, gains, 1.0)

    def _note(self, what: str, unit: Unit, factor: float | None, pair: int, guard: Guard) -> None:
        self.log.append((what, unit.operands[0].code, factor, pair))
        self.guarded.append(guard)

    @property
    def tries(self) -> list[tuple[str, float | None]]:
        return [(code, factor) for _, code, factor, _ in self.log]

    def of(self, what: str) -> list[tuple[str, float | None]]:
        return [(code, factor) for kind, code, factor, _ in self.log if kind == what]


def change(unit: Unit, factor: float, guard: Guard = ALWAYS) -> Candidate:
    return Candidate(unit.mutations(mutations, factor), guard)


def before(
    search: Scripted, unit: Unit, factor: float, pair: int = 0, holds: bool = True, near: bool = True
) -> list[Candidate]:
    """Return what comes before a change that was found; the change itself has run on the seed of its pair."""
    found = change(unit, factor, search.guards[0])
    search.trials(found, search.goal.pairs[pair].seed)
    return list(Preferences(search).before(found, unit, factor, pair, holds, near))


# plainer changes


def test_two_named_constants_come_before_a_literal() -> None:
    search = Scripted([LITERAL, A, B, C], proposed=True)
    before(search, LITERAL, 2.2, pair=3)
    assert search.tries == [
        *(("A", 2.2), ("A", 0.4), ("B", 2.2), ("B", 0.4)),
        *(("A", 5.0), ("B", 5.0), ("A", 0.15), ("B", 0.15)),
    ]
    assert {pair for *_, pair in search.log} == {3}


def test_larger_steps_need_a_harmless_smaller_step() -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        (one,) = candidate.mutations
        return Outcome(-1.5 if one.operand.code == "A" and one.value == 2.2 else 0.0, False)

    search = Scripted([LITERAL, A, B], run, proposed=True)
    before(search, LITERAL, 2.2)
    assert search.tries[4:] == [("B", 5.0), ("A", 0.15), ("B", 0.15)]


def test_named_constant_is_not_compared_with_larger_steps() -> None:
    search = Scripted([A, B, C], proposed=True)
    assert before(search, A, 2.2) == []
    assert search.log == []


def test_offset_is_compared_with_scalable_constants() -> None:
    search = Scripted([ZERO, LITERAL, A, B, C], proposed=True)
    before(search, ZERO, 2.2)
    assert search.tries == [(one, step) for one in ("A", "B", "C", "1.5") for step in (2.2, 0.4)]


def test_known_constants_are_refined_after_a_large_gain() -> None:
    search = Scripted([ZERO, A, B, C], proposed=True)
    for unit, gain in ((A, 3.9), (B, 4.0), (C, 7.0)):
        search.gains.enter((unit, ALWAYS), 2.2, gain)
    before(search, ZERO, 2.2)
    assert search.log == [("between", "C", None, 0)] * 2 + [("between", "B", None, 0)] * 2


@pytest.mark.parametrize(("offset", "refined"), [(True, 2), (False, 0)])
def test_refused_constant_may_replace_an_offset(offset: bool, refined: int) -> None:
    found = ZERO if offset else LITERAL
    search = Scripted([found, A], proposed=True)
    search.gains.enter((A, ALWAYS), 5.0, 7.0)
    search.refused.add((A, ALWAYS))
    before(search, found, 2.2)
    assert len(search.of("between")) == refined


def test_the_search_for_plainer_changes_ends_after_twelve_episodes() -> None:
    many = [Unit((constant(line, f"N{line}"),)) for line in range(20, 40)]
    search = Scripted([ZERO, *many], proposed=True)
    before(search, ZERO, 2.2)
    assert search.trials.spent - 1 == PLAINER == len(search.log)


def test_larger_steps_take_twelve_episodes_at_most() -> None:
    many = [Unit((constant(line, f"N{line}"),)) for line in range(20, 40)]
    search = Scripted([LITERAL, *many], proposed=True)
    for unit in many:
        search.gains.enter((unit, ALWAYS), 2.2, 0.0)
    before(search, LITERAL, 2.2)
    assert search.trials.spent - 1 == PLAINER
    assert {factor for _, factor in search.tries} == {5.0}


def test_unreadable_sensor_gives_no_condition() -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        if candidate.guard == WET and candidate.mutations[0].operand.code == "A":
            raise RepairError("no sensor here")
        return Outcome(5.0 if candidate.mutations[0].operand.code == "A" else 0.0, False)

    for guards, expected in (
        ((WET, ALWAYS), [WET, WET, ALWAYS, ALWAYS, ALWAYS, ALWAYS]),
        ((WET,), [WET, WET]),
    ):
        search = Scripted([ZERO, A], run, guards=guards, proposed=True)
        before(search, ZERO, 2.2)
        assert search.guarded == expected
        assert search.tries[:2] == [("A", 2.2), ("A", 0.4)]
    assert search.of("between") == []


def test_unconfirmed_change_gets_no_alternatives() -> None:
    search = Scripted([ZERO, LITERAL, A, B])
    assert before(search, ZERO, 2.2, holds=False) == []
    assert before(search, ZERO, 2.2, holds=False, near=False) == []
    assert search.log == []


# calls of a getter


def call(line: int) -> Unit:
    made = constant(line, "self.p('x')")
    return Unit((replace(made, definition=None),))


def getter() -> Unit:
    made = operand(30, "self.get(name)", 2.0)
    site = replace(made.site, qualname="Node.p", text="return self.get(name)")
    return Unit((replace(made, site=site, value=None),))


def test_only_the_calls_that_need_the_factor_are_changed() -> None:
    one, two, other = call(3), call(4), getter()

    def run(candidate: Candidate, _: int) -> Outcome:
        needed = any(each.operand == two.operands[0] for each in candidate.mutations)
        return Outcome(10.0 if needed else 0.0, needed)

    search = Scripted([other, one, two], run, proposed=True)
    assert before(search, other, 1.5) == [change(two, 1.5)]
    alone = Scripted([other, two], run, proposed=True)
    assert before(alone, other, 1.5) == []


# gentler changes


def longer(candidate: Candidate, _: int) -> Outcome:
    return Outcome(0.0, False, steps=20)


@pytest.mark.parametrize(("holds", "near", "tries"), [(True, True, 4), (False, True, 4), (False, False, 0)])
def test_constant_of_nature_always_has_alternatives(holds: bool, near: bool, tries: int) -> None:
    search = Scripted([GRAVITY, A, B], proposed=True)
    for unit in (A, B):
        search.gains.enter((unit, ALWAYS), 1.1, 0.0)
    before(search, GRAVITY, 2.2, holds=holds, near=near)
    assert search.tries == [("A", 1.5), ("A", 0.65), ("B", 1.5), ("B", 0.65)][:tries]


def test_change_is_compared_with_gentler_ones_only_once() -> None:
    search = Scripted([A, B], longer, goal=replace(GOAL, steps=10.0), proposed=True)
    search.trials.misses.update({1: 1, 4: 2, 2: 2})
    made, found = Preferences(search), change(A, 2.2)
    search.trials(found, 0)
    for _ in range(2):
        list(made.before(found, A, 2.2, 0, True, True))
    assert search.log == [("attempt", "B", 1.5, 2), ("attempt", "B", 0.65, 2)]


def test_gentler_changes_end_after_twelve_episodes() -> None:
    many = [Unit((constant(line, f"N{line}"),)) for line in range(20, 40)]
    search = Scripted([A, *many], longer, goal=replace(GOAL, steps=10.0), proposed=True)
    before(search, A, 2.2)
    assert search.trials.spent - 1 == PLAINER


# milder values of the same constant


def window(*good: tuple[Unit, float, float], total: float = 10.0) -> Act:
    """Return a world that a factor within a window restores."""
    ranges = {unit.operands[0]: (low, high) for unit, low, high in good}

    def run(candidate: Candidate, _: int) -> Outcome:
        (one,) = candidate.mutations
        low, high = ranges.get(one.operand, (99.0, 0.0))
        won = low <= one.value <= high
        return Outcome(total if won else 0.0, won, rewards=STEADY if won else (0.0,) * 10, steps=10)

    return run


def test_halfway_value_comes_first_if_a_closer_one_succeeds() -> None:
    search = Scripted([A], window((A, 1.3, 3.0)), [(A, 1.483)])
    assert before(search, A, 2.2) == [change(A, 1.483)]
    assert search.log == [("holding", "A", 1.483, 0)]
    assert search.trials.spent == 1 + 1 + 3


def test_value_at_the_edge_is_set_aside() -> None:
    search = Scripted([A], window((A, 1.45, 3.0)), [(A, 1.483)])
    made, found = Preferences(search), change(A, 2.2)
    search.trials(found, 0)
    assert list(made.before(found, A, 2.2, 0, True, True)) == []
    assert search.refused == set()
    assert list(made.after()) == [change(A, 1.483)]
    assert search.refused == {(A, ALWAYS)}
    assert list(made.after()) == []


def test_value_is_set_aside_without_a_writable_neighbour() -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        if candidate.mutations[0].value < 1.45:
            raise RepairError("no place")
        return Outcome(10.0, True)

    search = Scripted([A], run, [(A, 1.483)])
    assert before(search, A, 2.2) == []


@pytest.mark.parametrize(("lost", "preferred"), [(0.09, True), (0.11, False)])
def test_milder_value_may_lose_one_percent(lost: float, preferred: bool) -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        return Outcome(10.0 if candidate.mutations[0].value > 2.0 else 10.0 - lost, True)

    search = Scripted([A], run, [(A, 1.483)])
    assert before(search, A, 2.2) == ([change(A, 1.483)] if preferred else [])


def test_no_milder_value_is_tried_for_a_proposed_change() -> None:
    search = Scripted([A], window((A, 1.3, 3.0)), [(A, 1.483)], proposed=True)
    assert before(search, A, 2.2) == []
    assert search.log == []


# smaller changes of other constants


def test_small_change_of_another_constant_is_refined() -> None:
    search = Scripted([A, B], window((A, 2.0, 9.0), (B, 1.1, 1.4)), [(B, 1.22)])
    search.gains.enter((A, ALWAYS), 2.2, 10.0)
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    assert before(search, A, 3.0) == [change(B, 1.22)]
    assert search.tries == [("B", 0.82), ("B", 1.22), ("B", 1.184)]
    assert search.refused == {(B, ALWAYS)}


def test_barely_successful_change_is_enlarged() -> None:
    search = Scripted([A, B], window((A, 2.0, 9.0), (B, 1.2, 1.4)), [(B, 1.22), (B, 1.264)])
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    made, found = Preferences(search), change(A, 3.0)
    search.trials(found, 0)
    assert list(made.before(found, A, 3.0, 0, True, True)) == [change(B, 1.264)]
    assert search.tries == [("B", 0.82), ("B", 1.22), ("B", 1.184), ("B", 1.264)]
    assert list(made.after()) == [change(B, 1.22)]


def test_barely_successful_change_is_kept_without_a_larger_one() -> None:
    search = Scripted([A, B], window((A, 2.0, 9.0), (B, 1.2, 1.4)), [(B, 1.22)])
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    assert before(search, A, 3.0) == [change(B, 1.22)]


@pytest.mark.parametrize(("total", "beside"), [(8.9, []), (9.0, [("B", 0.869), ("B", 0.771)])])
def test_nearly_sufficient_small_step_is_moved_a_little(
    total: float, beside: list[tuple[str, float]]
) -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        (one,) = candidate.mutations
        return Outcome(total if one.operand.code == "B" and one.value == 0.82 else 0.0, False)

    search = Scripted([A, B], run)
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    before(search, A, 3.0)
    assert search.tries[: 2 + len(beside)] == [("B", 0.82), *beside, ("B", 1.22)]


def test_unwritable_small_step_is_not_moved() -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        if candidate.mutations[0].operand.code == "B":
            raise RepairError("no place")
        return Outcome(0.0, False)

    search = Scripted([A, B], run, goal=replace(GOAL, near=0.2, enough=0.5))
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    before(search, A, 3.0)
    assert search.tries == [("B", 0.82), ("B", 1.22)]


def test_small_change_with_different_missions_is_set_aside() -> None:
    late = (0.0,) * 9 + (10.0,)

    def run(candidate: Candidate, _: int) -> Outcome:
        code = candidate.mutations[0].operand.code
        return Outcome(10.0, True, rewards=late if code == "B" else STEADY)

    search = Scripted([A, B], run, [(B, 0.82)], design=lambda _: Outcome(10.0, True, rewards=STEADY))
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    made, found = Preferences(search), change(A, 3.0)
    search.trials(found, 0)
    assert list(made.before(found, A, 3.0, 0, True, True)) == []
    assert list(made.after()) == [change(B, 0.82)]


@pytest.mark.parametrize(("spent", "tried"), [(30, True), (31, False)])
def test_smaller_changes_are_sought_early(spent: int, tried: bool) -> None:
    search = Scripted([A, B], budget=60)
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    for _ in range(spent - 1):
        search.trials.charge()
    before(search, A, 3.0)
    assert bool(search.log) is tried


def test_smaller_changes_are_sought_once() -> None:
    search = Scripted([A, B])
    for factor in (1.05, 1.5):
        search.gains.enter((A, ALWAYS), factor, 0.0)
    made = Preferences(search)
    search.trials(change(A, 1.1), 0)
    search.trials(change(A, 3.0), 0)
    assert list(made.before(change(A, 1.1), A, 1.1, 0, True, True)) == []  # no step is that small
    assert search.log == []
    for _ in range(2):
        list(made.before(change(A, 3.0), A, 3.0, 0, True, True))
    assert search.tries == [("B", 0.82), ("B", 1.22)]


def test_small_steps_skip_refused_constants() -> None:
    many = [Unit((constant(line, f"N{line}"),)) for line in range(20, 26)]

    def run(candidate: Candidate, _: int) -> Outcome:
        code = candidate.mutations[0].operand.code
        return Outcome(9.5 if code in {"N20", "N21", "N22", "N23"} else 0.0, False)

    search = Scripted([A, *many], run)
    search.refused.add((many[0], ALWAYS))
    search.gains.enter((A, ALWAYS), 3.0, 0.0)
    before(search, A, 7.0)
    assert not any(code == "N20" for code, _ in search.tries)
    assert (
        EPISODES <= search.trials.spent - 1 <= EPISODES + 2
    )  # a step that began is finished with those beside it


# moderate changes before extreme ones


def test_other_constants_get_one_try_before_an_extreme_change() -> None:
    search = Scripted([A, B], holds=[(B, 1.05)])
    search.gains.enter((B, ALWAYS), 1.22, -3.0)
    preferences, found = Preferences(search), Candidate(A.mutations(mutations, 11.5), ALWAYS)
    assert list(preferences._moderate(found, A, 11.5, 0)) == [Candidate(B.mutations(mutations, 1.05), ALWAYS)]
    assert [(kind, factor) for kind, _, factor, _ in search.log] == [
        ("corrections", None),
        *(("attempt", step) for step in (1.1, 0.91, 1.05, 0.95)),
    ]
    assert list(preferences._moderate(found, A, 11.5, 0)) == []
    assert len(search.log) == 5


@pytest.mark.parametrize(("factor", "proposed"), [(7.0, False), (11.5, True)])
def test_moderate_change_needs_no_other_constants(factor: float, proposed: bool) -> None:
    search = Scripted([A, B], proposed=proposed)
    search.gains.enter((B, ALWAYS), 1.22, -3.0)
    found = Candidate(A.mutations(mutations, factor), ALWAYS)
    assert list(Preferences(search)._moderate(found, A, factor, 0)) == []
    assert search.log == []


# constants whose missions are closer to the designed ones


def courses(levels: Mapping[str, float], totals: Mapping[str, float] | None = None) -> Act:
    """Return a world in which the changed constant decides how late a mission earns; totals are 10 by default."""

    def run(candidate: Candidate, _: int) -> Outcome:
        code = candidate.mutations[0].operand.code
        late = levels[code]
        rewards = (*[1.0 - late] * 9, 1.0 + 9 * late)
        return Outcome((totals or {}).get(code, 10.0), True, rewards=rewards, steps=10)

    return run


def design(_: int) -> Outcome:
    return Outcome(10.0, True, rewards=STEADY, steps=10)


def rivalling(
    levels: Mapping[str, float], holds: Sequence[tuple[Unit, float]], **given: Any
) -> tuple[Scripted, Preferences]:
    search = Scripted([A, B, C], courses(levels, given.pop("totals", None)), holds, design=design, **given)
    search.gains.enter((A, ALWAYS), 1.5, 0.0)  # no milder value
    made = Preferences(search)
    made._reduced = True
    search.trials(change(A, 2.0), 0)
    return search, made


def test_exactly_restored_mission_needs_no_comparison() -> None:
    search, made = rivalling({"A": 0.0, "B": 0.0, "C": 0.0}, [(B, 0.5)])
    assert list(made.before(change(A, 2.0), A, 2.0, 0, True, True)) == []
    assert search.log == []


def test_alternative_with_smaller_deviation_comes_first() -> None:
    for level, rival in ((0.29, [change(B, 0.5)]), (0.31, [])):
        search, made = rivalling({"A": 0.5, "B": level, "C": 1.0}, [(B, 0.5)])
        assert list(made.before(change(A, 2.0), A, 2.0, 0, True, True)) == rival
        assert search.refused == ({(B, ALWAYS)} if rival else set())


def test_alternative_is_tried_with_the_reciprocal_first() -> None:
    search, made = rivalling({"A": 0.5, "B": 1.0, "C": 1.0}, [], totals={"B": 0.0, "C": 0.0})
    list(made.before(change(A, 2.0), A, 2.0, 0, True, True))
    assert search.of("reaches") == [
        *(("B", 0.5), ("B", 2.0), ("C", 0.5), ("C", 2.0)),
    ]
    assert len(search.of("reaches")) < RIVALS


def test_sufficient_alternative_gets_no_other_factor() -> None:
    search, made = rivalling({"A": 0.5, "B": 1.0, "C": 1.0}, [], totals={"C": 0.0})
    list(made.before(change(A, 2.0), A, 2.0, 0, True, True))
    assert [code for code, _ in search.of("reaches")].count("B") == 1


def test_constants_of_at_most_two_functions_are_compared() -> None:
    search, made = rivalling({"A": 0.5, "B": 1.0, "C": 1.0}, [], totals={"B": 0.0, "C": 0.0})
    for _ in range(2):
        list(made.before(change(A, 2.0), A, 2.0, 0, True, True))
    assert len(search.of("reaches")) == 4
    functions = []
    for number in range(3):
        other = replace(A.operands[0], site=replace(A.operands[0].site, qualname=f"f{number}"))
        search.trials(change(Unit((other,)), 2.0), 0)
        earlier = len(search.of("reaches"))
        search.units = (B, Unit((replace(B.operands[0], site=replace(other.site, text="x")),)))
        list(made.before(change(Unit((other,)), 2.0), Unit((other,)), 2.0, 0, True, True))
        functions.append(len(search.of("reaches")) > earlier)
    assert functions == [True, False, False]
    assert FUNCTIONS == 2


def test_exact_value_is_tried_before_alternatives() -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        (one,) = candidate.mutations
        late = min(abs(one.value - 1.6246), 1.0)
        return Outcome(10.0, True, rewards=(*[1.0 - late] * 9, 1.0 + 9 * late))

    search = Scripted([A, B], run, [(A, 1.625)], design=design)
    search.gains.enter((A, ALWAYS), 1.5, 0.0)
    made = Preferences(search)
    made._reduced = True
    search.trials(change(A, 2.0), 0)
    assert list(made.before(change(A, 2.0), A, 2.0, 0, True, True)) == [change(A, 1.625)]
    assert search.log == [("holding", "A", 1.625, 0)]


def test_set_aside_changes_follow_by_mean_reward() -> None:
    search = Scripted([A, B, C], courses({"A": 0.0, "B": 0.0, "C": 0.0}, {"B": 9.2, "C": 9.6}))
    made = Preferences(search)
    for unit in (A, B, C):
        search.trials(change(unit, 2.0), 0)
        made._aside.append((unit, change(unit, 2.0)))
    assert [one.mutations[0].operand.code for one in made.after()] == ["A", "C", "B"]
    assert search.refused == {(one, ALWAYS) for one in (A, B, C)}
