"""Which constants are combined, tried under another change, or changed at one use; the search is scripted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching import combining
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.combining import Combining
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import Unit, everywhere
from pytest_tarl.searching.unmasking import FINER, longer, unmasked
from pytest_tarl.searching.uses import Uses
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import WET, constant
from tests.plugin.searching.test_search import operand

A, B, C, D = (Unit((constant(line, name),)) for line, name in ((2, "A"), (3, "B"), (4, "C"), (5, "D")))
GOAL = Goal(tuple(Pair(seed, 0.0, 10) for seed in range(4)), near=9.0, enough=10.0, online=0.0)

World = Callable[[Mapping[Operand, float]], Outcome]


def nothing(_: Mapping[Operand, float]) -> Outcome:
    return Outcome(0.0, False, steps=10)


class Joined:
    """A selection that notes what it combines."""

    def __init__(self, gains: Any, among: Any) -> None:
        self.gains, self.among = gains, among
        self.calls: list[tuple[Any, ...]] = []

    def candidates(self, base: Joint) -> Iterator[Candidate]:
        self.calls.append(("candidates", base))
        yield from ()

    def unions(
        self, parts: Sequence[tuple[Unit, float]], guard: Guard, hidden: Sequence[Unit]
    ) -> Iterator[Candidate]:
        self.calls.append(("unions", list(parts), guard, list(hidden)))
        yield from ()

    def sharpened(self, unit: Unit, factor: float, guard: Guard) -> Iterator[Candidate]:
        self.calls.append(("sharpened", unit, factor, guard))
        yield from ()


class Fake:
    """A search with the parts that are combined; `joins` lists the selections that it made."""

    def __init__(self, units: Sequence[Unit], *tries: tuple[Unit, float, float], **given: Any) -> None:
        self.units, self.late, self.scope = tuple(units), (), everywhere
        self.goal, self.slack, self.proposed = GOAL, 1.0, False
        self.generator: np.random.Generator | None = None
        self.trials: Any = None
        self.refused: set[tuple[Unit, Guard]] = set()
        self.gains = Gains(1.0)
        for unit, factor, gain in tries:
            self.gains.enter((unit, ALWAYS), factor, gain)
        self.joins: list[Joined] = []
        self.__dict__ |= given

    def joining(self, gains: Any, among: Any = None) -> Any:
        self.joins.append(Joined(gains, among))
        return self.joins[-1]

    @property
    def calls(self) -> list[tuple[Any, ...]]:
        return [call for one in self.joins for call in one.calls]


def searching(units: Sequence[Unit], *tries: tuple[Unit, float, float], **given: Any) -> Any:
    return Fake(units, *tries, **given)


# the best operand with others


def test_best_change_is_combined_under_its_condition() -> None:
    search = searching([A, B], (A, 2.2, 3.0), (A, 0.4, -1.0), (B, 2.2, 4.0), (B, 5.0, 2.0))
    search.gains.enter((A, WET), 1.5, 3.9)
    assert list(Combining(search).best_with_others()) == []
    assert search.calls == [("candidates", Joint(((B, 2.2),), ALWAYS))]
    assert search.joins[0].gains == search.gains.under(ALWAYS)
    assert search.joins[0].among == [A, B]


@pytest.mark.parametrize(("gain", "combined"), [(1.0, False), (1.01, True)])
def test_a_gain_that_may_be_noise_is_not_combined(gain: float, combined: bool) -> None:
    search = searching([A], (A, 2.2, gain))
    list(Combining(search).best_with_others())
    assert bool(search.calls) is combined


def test_nothing_is_combined_without_a_tried_change() -> None:
    assert list(Combining(searching([A])).best_with_others()) == []
    search = searching([A], (A, 2.2, 9.0), refused={(A, ALWAYS)})
    list(Combining(search).best_with_others())
    assert search.calls == []


def test_proposal_is_combined_with_its_own_parameters() -> None:
    same = Unit((replace(B.operands[0], span=A.operands[0].span),))
    search = searching([A, C, same], (A, 2.2, 3.0), proposed=True)
    list(Combining(search).best_with_others())
    assert search.joins[0].among == [A, same]


# the leaders


def test_best_changes_are_combined_with_ineffective_constants() -> None:
    search = searching([A, B, C], (A, 2.2, 3.0), (B, 0.4, 4.0), (C, 2.2, 0.0))
    list(Combining(search).leaders(ALWAYS))
    assert search.calls == [("unions", [(B, 0.4), (A, 2.2)], ALWAYS, [C])]


@pytest.mark.parametrize(("gain", "united"), [(1.0, False), (1.1, True), (8.9, True), (9.0, False)])
def test_best_changes_are_combined_if_the_gain_exceeds_the_noise(gain: float, united: bool) -> None:
    search = searching([A, B], (A, 2.2, gain))
    list(Combining(search).leaders(ALWAYS))
    assert bool(search.calls) is united


def test_change_refused_under_a_condition_is_retried_only_there() -> None:
    search = searching([A, B], (A, 2.2, 3.0), refused={(A, ALWAYS), (A, WET), (B, WET)})
    list(Combining(search).leaders(ALWAYS))
    assert search.refused == {(A, WET), (B, WET)}


def test_proposals_and_worlds_without_any_gain_have_no_leaders() -> None:
    for search in (searching([A], (A, 2.2, 3.0), proposed=True), searching([A], (A, 2.2, -3.0))):
        assert list(Combining(search).leaders(ALWAYS)) == []
        assert search.calls == []


def test_the_best_constant_under_each_condition_is_refined() -> None:
    search = searching([A, B], (A, 2.2, 3.0), (B, 0.4, 4.0))
    search.gains.enter((A, WET), 1.5, 2.0)
    list(Combining(search).sharpened([WET, ALWAYS]))
    assert search.calls == [("sharpened", A, 1.5, WET), ("sharpened", B, 0.4, ALWAYS)]
    proposed = searching([A, B], (A, 2.2, 3.0), proposed=True)
    list(Combining(proposed).sharpened([ALWAYS]))
    assert proposed.calls == []


# the joint search


class Together:
    """Stand-in for the joint search: notes its arguments."""

    made: ClassVar[list[tuple[Any, ...]]] = []

    def __init__(
        self, units: Any, selection: Any, trials: Any, goal: Any, generator: Any, hidden: int
    ) -> None:
        self.units, self.hidden = units, hidden

    def candidates(self, starts: Sequence[Joint], guard: Guard) -> Iterator[Candidate]:
        Together.made.append((self.units, self.hidden, list(starts), guard))
        yield from ()


@pytest.fixture
def together(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    monkeypatch.setattr(combining, "Jointly", Together)
    Together.made = []
    return Together.made


def test_joint_search_starts_at_the_three_best_points(
    together: list[tuple[Any, ...]],
) -> None:
    tries = [(A, 2.2, 3.0), (B, 2.2, 4.0), (C, 2.2, 2.0), (D, 2.2, 1.5)]
    search = searching([A, B, C, D], *tries, generator=np.random.default_rng(0))
    search.gains.enter((A, WET), 1.5, 3.5)
    list(Combining(search).jointly([WET, ALWAYS]))
    ((units, hidden, starts, guard),) = together
    assert guard == ALWAYS
    assert hidden == 0
    assert set(units) == {A, B, C, D}
    assert starts == [Joint(((one, 2.2),), ALWAYS) for one in (B, A, C)]


def test_joint_search_starts_at_no_negative_factor(together: list[tuple[Any, ...]]) -> None:
    search = searching([A, B], (A, -1.0, 3.0), (B, 2.2, 2.0), generator=np.random.default_rng(0))
    list(Combining(search).jointly([ALWAYS]))
    assert together[0][2] == [Joint(((B, 2.2),), ALWAYS)]


def test_constants_in_no_data_flow_are_also_searched_jointly(together: list[tuple[Any, ...]]) -> None:
    search = searching([A], (A, 2.2, 3.0), (B, 2.2, 2.0), generator=np.random.default_rng(0), late=(B,))
    list(Combining(search).jointly([ALWAYS]))
    assert set(together[0][0]) == {A, B}


@pytest.mark.parametrize(
    "given", [{"proposed": True}, {"generator": None}, {"alone": True}], ids=["proposed", "unseeded", "alone"]
)
def test_joint_search_needs_several_constants_and_a_generator(
    given: dict[str, Any], together: list[tuple[Any, ...]]
) -> None:
    units = [A] if given.get("alone") else [A, B]
    search = searching(units, (A, 2.2, 3.0), (B, 2.2, 2.0), **{"generator": np.random.default_rng(0)} | given)
    list(Combining(search).jointly([ALWAYS]))
    assert together == []


@pytest.mark.parametrize(("gain", "searched"), [(3.9, True), (4.0, False)])
def test_joint_search_needs_constants_that_can_move_jointly(
    gain: float, searched: bool, together: list[tuple[Any, ...]]
) -> None:
    several = Unit(
        (constant(7, "SEVERAL", None),)
    )  # stands for several constants, which are not moved jointly
    tries = [(A, 2.2, 3.0), (B, 2.2, 2.0), (several, 0.4, gain)]
    search = searching([A, B, several], *tries, generator=np.random.default_rng(0))
    list(Combining(search).jointly([ALWAYS]))
    assert bool(together) is searched


# unmasking


def selection(world: World, units: Sequence[Unit] = (A, B, C, D)) -> tuple[ForwardSelection, list[str]]:
    """Return a selection in a world, and the list that receives what runs on the first seed."""
    seen: list[str] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        changes = {one.operand: one.value for one in candidate.mutations}
        if seed == 0:
            seen.append(" ".join(f"{one.code}{value:.4g}" for one, value in changes.items()))
        return world(changes)

    return ForwardSelection(units, mutations, Trials(run, 500), GOAL, {}, 1.0), seen


BASE = Joint(((A, 2.2),), ALWAYS)


def test_ineffective_constants_get_larger_and_smaller_values() -> None:
    joining, seen = selection(nothing)
    assert list(unmasked(BASE, [B, C], joining)) == []
    assert seen == ["A2.2", "A2.2 B2.2", "A2.2 C2.2", "A2.2 B0.4", "A2.2 C0.4"]


def test_effective_constant_gets_finer_factors_immediately() -> None:
    def world(changes: Mapping[Operand, float]) -> Outcome:
        return Outcome(2.0 if B.operands[0] in changes else 0.0, False)

    joining, seen = selection(world)
    list(unmasked(BASE, [B, C], joining))
    assert seen[:5] == ["A2.2", "A2.2 B2.2", *(f"A2.2 B{one:g}" for one in FINER), seen[4]]
    assert "A2.2 B0.4" not in seen
    assert seen[-2:] == ["A2.2 C2.2", "A2.2 C0.4"]


def test_losing_constant_is_not_refined() -> None:
    def world(changes: Mapping[Operand, float]) -> Outcome:
        return Outcome(-2.0 if B.operands[0] in changes else 0.0, False)

    joining, seen = selection(world)
    list(unmasked(BASE, [B], joining))
    assert seen == ["A2.2", "A2.2 B2.2", "A2.2 B1.5", "A2.2 B0.65"]


def test_unwritable_change_leads_to_no_retry() -> None:
    def world(changes: Mapping[Operand, float]) -> Outcome:
        raise RepairError("no place")

    joining, seen = selection(world)
    assert list(unmasked(BASE, [B], joining)) == []
    assert seen == ["A2.2"]


@pytest.mark.parametrize(("steps", "expected"), [(11, False), (12, True)])
def test_longer_missions_have_a_fifth_more_steps(steps: int, expected: bool) -> None:
    joining, _ = selection(lambda _: Outcome(0.0, False, steps=steps))
    assert not longer(BASE, joining)  # it has not run
    list(joining.gain(BASE))
    assert longer(BASE, joining) is expected


class FakeWorld(Fake):
    """A search whose selections run in a world."""

    def __init__(self, world: World, *tries: tuple[Unit, float, float], **given: Any) -> None:
        super().__init__([A, B, C, D], *tries, **given)
        self.real, self.seen = selection(world, self.units)

    def joining(self, gains: Any, among: Any = None) -> Any:
        return self.real


def lasting(changes: Mapping[Operand, float]) -> Outcome:
    return Outcome(0.0, False, steps=20)


def unmasking(world: World, *tries: tuple[Unit, float, float], **given: Any) -> Any:
    return FakeWorld(world, *tries, **given)


@pytest.mark.parametrize(("gain", "tried"), [(2.9, 0), (3.0, 5)])
def test_ineffective_constants_are_retried_under_a_good_change(gain: float, tried: int) -> None:
    search = unmasking(lasting, (A, 2.2, gain), (B, 2.2, -1.0))
    list(search.real.gain(BASE))
    made = Combining(search)
    for _ in range(2):
        list(made.unmasked(ALWAYS))
    assert search.seen[1:] == ["A2.2 C2.2", "A2.2 D2.2", "A2.2 C0.4", "A2.2 D0.4"][: max(tried - 1, 0)]


def test_change_without_longer_missions_starts_no_retry() -> None:
    search = unmasking(nothing, (A, 2.2, 5.0))
    list(search.real.gain(BASE))
    list(Combining(search).unmasked(ALWAYS))
    assert search.seen == ["A2.2"]


def test_nothing_is_retried_without_a_gain() -> None:
    for search in (unmasking(lasting, (A, 2.2, 5.0), proposed=True), unmasking(lasting)):
        assert list(Combining(search).unmasked(ALWAYS)) == []
        assert search.seen == []


# uses of one constant


class Using:
    """A search that notes which uses it tries."""

    def __init__(self, budget: int = 100) -> None:
        self.trials = Trials(lambda _, __: Outcome(0.0, False), budget)
        self.tried: list[tuple[str, Unit, float, int, bool]] = []

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        self.tried.append(("attempt", unit, factor, pair, True))
        yield from ()

    def reaches(self, unit: Unit, factor: float, guard: Guard, pair: int, confirmable: bool = True) -> bool:
        self.tried.append(("reaches", unit, factor, pair, confirmable))
        return True


WHOLE = Unit((*A.operands, *B.operands, *C.operands))
MANY = Unit((*A.operands, *B.operands, *C.operands, *D.operands))
PARTS = {WHOLE: (A, B, C), MANY: (A, B, C, D)}


def test_each_use_of_a_confirmed_constant_is_changed_alone() -> None:
    search = Using()
    Uses(search, PARTS).learn(WHOLE, ALWAYS, 2.2, 3)
    assert search.tried == [("reaches", one, 2.2, 3, False) for one in (A, B, C)]


@pytest.mark.parametrize(("budget", "learned"), [(3, 0), (4, 3)])
def test_uses_change_alone_if_an_episode_is_left(budget: int, learned: int) -> None:
    search = Using(budget)
    Uses(search, PARTS).learn(WHOLE, ALWAYS, 2.2, 0)
    assert len(search.tried) == learned


def test_each_use_alone_is_attempted_once_under_each_condition() -> None:
    search = Using()
    uses = Uses(search, PARTS)
    for guard in (ALWAYS, ALWAYS, WET):
        list(uses.alone(WHOLE, guard, 2.2, 1))
    assert search.tried == [("attempt", one, 2.2, 1, True) for one in (A, B, C)] * 2


def test_more_than_three_uses_are_not_changed_alone() -> None:
    search = Using()
    uses = Uses(search, PARTS)
    uses.learn(MANY, ALWAYS, 2.2, 0)
    list(uses.alone(MANY, ALWAYS, 2.2, 0))
    assert search.tried == []
    assert uses.of(MANY) == (A, B, C, D)
    assert uses.of(A) == ()


# combinations


def test_literal_is_combined_under_the_first_condition() -> None:
    literal = Unit((operand(9, "1.5", 1.5),))
    wider = Joint(((A, 2.2),), WET).with_part(literal, 0.4)
    assert wider.guard == WET
    assert wider.parts == ((A, 2.2), (literal, 0.4))
    assert wider.without(A).parts == ((literal, 0.4),)
    assert [one.value for one in wider.candidate(mutations).mutations] == [2.2, pytest.approx(0.6)]
