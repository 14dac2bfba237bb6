"""The groups of structural changes: their order, their shares of the episodes, and the budget between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import OperandEffect
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import Parameter, Template, templates
from pytest_tarl.repairing import structural
from pytest_tarl.repairing.mission_pairs import Signs
from pytest_tarl.repairing.structural import KEPT, LEAST, LEAST_EACH, Structures, _Group, _responding
from pytest_tarl.repairing.template_places import Spot, spots
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials
from tests.plugin.repairing.test_evident import SENSOR, of_many, order_of, site
from tests.plugin.searching.test_search import operand


def structures(order: Any, budget: int = 120, **more: Any) -> Structures:
    return Structures(order, (ALWAYS,), Trials(lambda *_: Outcome(1.0, passed=False), budget), **more)


SHARES = [(1, 1000), (7, 1000), (500, 1000), (5, 30), (50, 30), (0, 3), (10, 0)]


def commands(order: Any) -> list[Spot]:
    """Return the expressions of a node as if all but the first were published."""
    first, *others = spots(order)
    return [first, *(replace(spot, kind="sent", numeric=True) for spot in others)]


@pytest.mark.parametrize(("share", "left"), SHARES)
def test_command_changes_get_at_most_a_third_of_the_episodes(tmp_path: Path, share: int, left: int) -> None:
    of = structures(of_many(tmp_path))
    group = of._at_commands(templates(tmp_path), commands(of.order))
    assert len(group.operands) >= 2
    expected = min(max(share, LEAST_EACH * len(group.operands)), left // 3)
    assert group.share(share, left) == expected


@pytest.mark.parametrize(("share", "left"), SHARES)
def test_each_change_without_a_parameter_gets_one_episode(tmp_path: Path, share: int, left: int) -> None:
    of = structures(of_many(tmp_path))
    group = of._once(templates(tmp_path), list(spots(of.order)))
    count = len(group.operands)
    assert count >= 2
    assert group.share(share, left) == min(max(share, count), left)
    assert all(of._found[one].parameter == "" for one in group.operands)


def test_three_nearest_commands_are_scaled_first(tmp_path: Path) -> None:
    order = of_many(tmp_path)
    of, among = structures(order), commands(order)
    group = of._at_commands([template("any", on="number"), template("other")], among)
    nearest = sorted(among[1:], key=lambda spot: spot.away)
    assert len(nearest) > structural.COMMANDS == 3
    assert [one.site for one in group.operands] == [spot.site for spot in nearest[:3]]
    assert {of._found[one].template.name for one in group.operands} == {"any"}


def groups(of: Structures) -> list[_Group]:
    """Return the groups that the search would try, in order, without searching."""
    found: list[_Group] = []

    def searched(given: Any, brief: bool = False) -> Iterator[Candidate]:
        found.extend(given)
        return iter(())

    of._searched = searched  # type: ignore[method-assign]
    assert list(of.candidates()) == []
    return found


@pytest.mark.parametrize(("share", "left"), SHARES)
def test_changes_with_symptoms_get_half_of_the_episodes(tmp_path: Path, share: int, left: int) -> None:
    order = of_many(tmp_path)
    here = site(order, "b = ")
    of = structures(
        order,
        effects={here: [OperandEffect("3.0", 3.0, 6.0, order.goal.wanted)]},
        signs=Signs({here: {"jumps": 1.0}}),
    )
    assert of.responding == (here,)
    first, *others = groups(of)
    indicated = {of._found[one].template.name for one in first.operands}
    assert indicated
    assert all(str(one.site) == here for one in first.operands)
    assert first.share(share, left) == max(share, left // 2)
    best = [group for group in others if all(str(one.site) == here for one in group.operands)]
    assert any(group.share(share, left) == max(share, left // 2) for group in best)


@pytest.mark.parametrize(("share", "left"), SHARES)
def test_changes_by_a_telling_sensor_get_fifty_episodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, share: int, left: int
) -> None:
    order = order_of(tmp_path)
    monkeypatch.setattr(structural, "telling", lambda _: [SENSOR])
    by_sensor = template("by", on="sensor", parameters=(Parameter("k", 1.0),))
    monkeypatch.setattr(structural, "templates", lambda _: (by_sensor,))
    monkeypatch.setattr("pytest_tarl.repairing.template_forms._scales", lambda *_: {})
    first, *_ = groups(structures(order))
    assert {one.code.partition(" of ")[0] for one in first.operands} == {"by by range"}
    assert first.share(share, left) == min(max(share, LEAST), left // 3)


def test_sensor_that_differs_by_early_ends_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    order = order_of(tmp_path)
    monkeypatch.setattr(structural, "telling", lambda _: [SENSOR])
    for same, expected in ((structural.OVERLAP, [SENSOR]), (structural.OVERLAP + 0.01, [])):
        of = structures(order)
        of.signs = SimpleNamespace(overlap=lambda _, __, same=same: same)  # type: ignore[assignment]
        assert of._telling() == expected


def template(name: str, on: str = "value", cost: int = 1, parameters: tuple[Parameter, ...] = ()) -> Template:
    names = " + ".join(f"{{{one.name}}}" for one in parameters)
    return Template(name, name, on, cost, f"-{{x}} + {names}" if names else "-{x}", parameters=parameters)


def test_templates_of_equal_cost_form_two_groups(
    tmp_path: Path,
) -> None:
    order = of_many(tmp_path)
    known = [template("one"), template("two"), template("dear", cost=3)]
    of = structures(order)
    found = of._groups(known, list(spots(order)))
    names = [sorted({of._found[one].template.name for one in group.operands}) for group in found]
    assert names == [["one", "two"], ["dear"], ["one", "two"], ["dear"]]
    assert [len(group.operands) for group in found[:2]] == [2 * structural.FIRST, structural.FIRST]
    everything = [one for group in found for one in group.operands]
    assert len(everything) == len(set(everything))
    assert found[0].share(7, 100) == 7


# The budget between groups


class Sweeps:
    """Sweeps that spend given numbers of episodes and yield a candidate after each."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *spends: list[int]) -> None:
        self.spends = [*spends]
        self.budgets: list[tuple[int, int, Any]] = []
        self.given: list[dict[str, Any]] = []
        monkeypatch.setattr(structural, "Sweep", self.sweep)

    def sweep(self, operands: Any, mutate: Any, guards: Any, trials: Trials, goal: Any, **more: Any) -> Any:
        number = len(self.given)
        self.given.append({"operands": operands, **more})

        def candidates() -> Iterator[Candidate]:
            self.budgets.append((trials.budget, trials.reserve, trials.worth))
            for spend in self.spends[number]:
                if spend < 0:
                    raise BudgetSpentError
                for _ in range(spend):
                    trials.charge()
                yield Candidate((), ALWAYS)

        effects = {"all": [number], f"site {number}": [number]}
        return SimpleNamespace(candidates=candidates, effects=lambda: effects)


def made(tmp_path: Path, budget: int) -> tuple[Structures, list[_Group]]:
    """Return a search of 120 episodes, and groups of 1, 2 and 3 operands that take their equal share."""
    operands = [operand(number, f"{number}.5", number + 0.5) for number in range(1, 7)]
    parts = [operands[:1], operands[1:3], operands[3:]]
    return structures(order_of(tmp_path), budget), [_Group(part) for part in parts]


def test_group_shares_follow_their_parameters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of, three = made(tmp_path, 120)
    sweeps = Sweeps(monkeypatch, [10], [4], [6])
    found = list(of._searched(three))
    assert len(found) == 3
    goal = of.order.goal
    # 120·1/6 = 20, then of the 110 left 2/5, then all of the 106 left; half of the others' episodes are the reserve
    assert sweeps.budgets == [(20, 50, goal), (10 + 44, 33, goal), (14 + 106, 0, goal)]
    assert (of.trials.budget, of.trials.reserve) == (120, 0)
    first, second, _ = sweeps.given
    assert (first["operands"], len(second["operands"])) == (three[0].operands, 2)
    assert (first["proposed"], first["weaker"], first["given"]) == (True, of.weaker, of.given)
    assert (first["responding"], first["brief"]) == ((), False)
    assert of.effects() == {"all": [0, 1, 2], **{f"site {number}": [number] for number in range(3)}}


def test_group_ends_when_its_share_is_used_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of, three = made(tmp_path, 120)
    # the limit of the first group is 120 - 0.6·100 = 60 episodes
    assert int(KEPT * 100) == 60
    sweeps = Sweeps(monkeypatch, [20, 0, 0, 0], [1], [1])
    told: list[int] = []
    for number, _ in enumerate(of._searched(three)):
        told.append(of.trials.spent)
        assert (of.trials.budget, of.trials.reserve) == (120, 0)  # while it is examined
        if number < 4:
            for _ in range(15):
                of.trials.charge()
    # 20, 35, 50 and 65 episodes were spent; the candidate at 65 is not examined any more
    assert told == [20, 35, 50, 66, 82]
    assert len(sweeps.given) == 3


def test_confirmed_change_of_another_expression_is_never_dropped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    of, three = made(tmp_path, 120)
    first, second = (Candidate((Mutation(one, 3.0),), ALWAYS) for one in three[2].operands[:2])

    def sweep(*_: Any, **__: Any) -> Any:
        return SimpleNamespace(candidates=lambda: iter((first, second, first, second)), effects=dict)

    monkeypatch.setattr(structural, "Sweep", sweep)
    told: list[Candidate] = []
    for candidate in of._searched(three[:2]):
        told.append(candidate)
        for _ in range(115 if len(told) == 1 else 0):  # far beyond the limit of the first group
            of.trials.charge()
    # the further values come too late in the first group, and in time in the last one
    assert told == [first, second, *(first, second) * 2]


def test_after_an_examination_the_share_grows_by_its_episodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    of, three = made(tmp_path, 120)
    Sweeps(monkeypatch, [5, 0], [0], [0])
    search = of._searched(three)
    next(search)
    for _ in range(7):
        of.trials.charge()
    ahead = of._beyond_its_share
    seen: list[tuple[int, int]] = []

    def noted(candidate: Candidate, whole: int) -> Iterator[Candidate]:
        seen.append((of.trials.budget, of.trials.reserve))
        yield from ahead(candidate, whole)

    of._beyond_its_share = noted  # type: ignore[method-assign]
    next(search)
    assert seen == [(27, 50)]  # 20 and the 7 of the examination
    of.trials.budget, of.trials.reserve = 115, 50
    examined = ahead(Candidate((), ALWAYS), 120)
    next(examined)
    for _ in range(9):
        of.trials.charge()
    assert next(examined, None) is None
    assert (of.trials.budget, of.trials.reserve) == (120, 0)


def test_next_group_follows_a_group_without_episodes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of, three = made(tmp_path, 120)
    sweeps = Sweeps(monkeypatch, [-1], [3, -1], [4])
    assert len(list(of._searched(three))) == 2
    assert len(sweeps.given) == 3
    of, three = made(tmp_path, 120)
    Sweeps(monkeypatch, [1], [1], [-1])
    with pytest.raises(BudgetSpentError):
        list(of._searched(three))
    assert (of.trials.budget, of.trials.reserve) == (120, 0)


def test_early_changes_restore_the_budget(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of = structures(order_of(tmp_path), 300)
    trials = of.trials
    trials.reserve, trials.worth = 9, of.order.goal
    seen: list[Any] = []

    def searched(groups: Any, brief: bool = False) -> Iterator[Candidate]:
        seen.append((trials.budget, brief, [group.share(10, 0) for group in groups]))
        if len(seen) == 3:
            raise BudgetSpentError
        yield Candidate((), ALWAYS)
        trials.reserve = 77

    of._searched = searched  # type: ignore[method-assign]
    monkeypatch.setattr(of, "_evident", lambda *_: [operand(1, "1.5", 1.5)])
    monkeypatch.setattr(of, "_once", lambda *_: _Group([operand(2, "2.5", 2.5)]))
    for _ in range(3):
        trials.charge()
    assert len(list(of.early(20))) == 1
    assert len(list(of.early(20, once=False))) == 1
    assert list(of.early(400)) == []
    assert seen == [(3 + 40, True, [10, 5]), (43, True, [5]), (300, True, [10, 5])]
    assert (trials.budget, trials.reserve, trials.worth) == (300, 9, of.order.goal)


def test_early_change_episodes_are_counted_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of = structures(order_of(tmp_path), 300)
    trials = of.trials
    budgets: list[int] = []

    def searched(groups: Any, brief: bool = False) -> Iterator[Candidate]:
        for _ in range(2):
            budgets.append(trials.budget)
            yield Candidate((), ALWAYS)

    of._searched = searched  # type: ignore[method-assign]
    monkeypatch.setattr(of, "_evident", lambda *_: [operand(1, "1.5", 1.5)])
    monkeypatch.setattr(of, "_once", lambda *_: _Group([]))
    for _ in of.early(20):
        assert trials.budget == 300
        for _ in range(50):
            trials.charge()
    assert budgets == [40, 90]
    assert trials.budget == 300


def test_early_sensor_changes_need_a_varying_sensor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for ranged, varies, expected in ((False, False, []), (True, False, [SENSOR]), (False, True, [SENSOR])):
        of = structures(order_of(tmp_path))
        of.order.goal = replace(of.order.goal, ranged=ranged)
        told: list[Any] = []
        monkeypatch.setattr(structural, "varies", lambda _, __, varies=varies: varies)
        monkeypatch.setattr(of, "_telling", lambda: [SENSOR])
        monkeypatch.setattr(of, "_told", lambda _, __, sensors, told=told: told.append(sensors) or [])
        monkeypatch.setattr(of, "_evident", lambda *_: [])
        list(of.early(2, once=False))
        assert told == [expected]


# Mutations of parameters


def formed(of: Structures, parameter: Parameter, *more: Parameter, on: str = "value") -> Callable[..., Any]:
    """Let the structural search know a parameter; return a function that mutates it."""
    made = template("made", on, parameters=(*more, parameter))
    form = Form(made, parameter.name, tuple((one.name, one.default) for one in made.parameters))
    of._found[operand(1, "x", 2.0)] = form
    return lambda factor: of.mutate(operand(1, "x", 2.0), factor)


def test_parameter_moves_by_a_factor(
    tmp_path: Path,
) -> None:
    of = structures(order_of(tmp_path))
    moved = formed(of, Parameter("k", 2.0))
    assert [moved(factor).value for factor in (1.0, 1.5, 0.25)] == [1.0, 1.5, 0.25]
    assert moved(1.0).form.parameter == "k"
    moved = formed(of, Parameter("k", 2.0), Parameter("first", 1.0))
    assert (moved(1.0), moved(1.5).value) == (None, 1.5)


@pytest.mark.parametrize(
    ("on", "signed", "allowed"), [("value", False, False), ("value", True, True), ("sensor", False, True)]
)
def test_only_signed_parameters_change_their_sign(
    tmp_path: Path, on: str, signed: bool, allowed: bool
) -> None:
    of = structures(order_of(tmp_path))
    moved = formed(of, Parameter("k", 2.0, signed=signed), on=on)
    assert (moved(-1.0) is not None) is allowed
    assert moved(0.5) is not None


@pytest.mark.parametrize(
    ("factor", "expected"), [(1.0, 1.0), (1.2, 1.0), (1.3, 1.5), (0.5, 0.5), (0.2, None), (2.6, 2.5)]
)
def test_a_parameter_on_a_grid_takes_only_its_multiples(
    tmp_path: Path, factor: float, expected: float | None
) -> None:
    of = structures(order_of(tmp_path))
    found = formed(of, Parameter("k", 4.0, grid=2.0))(factor)
    assert (None if found is None else found.value) == expected


@pytest.mark.parametrize(("grid", "expected"), [(0.5, 0.94), (1.0, 1.0)])
def test_exponent_is_fine_tuned_but_a_count_is_not(tmp_path: Path, grid: float, expected: float) -> None:
    of = structures(order_of(tmp_path))
    moved = formed(of, Parameter("k", 1.0, grid=grid))
    assert moved(0.94).value == 1.0
    of._fine.add(operand(1, "x", 2.0))
    assert moved(0.94).value == pytest.approx(expected)


def test_a_template_without_parameters_has_one_mutation(tmp_path: Path) -> None:
    of = structures(order_of(tmp_path))
    of._found[operand(1, "x", 2.0)] = Form(template("made"))
    assert [of.mutate(operand(1, "x", 2.0), factor).value for factor in (1.0, 3.0)] == [True, True]  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("stronger", "factor", "weaker"),
    [
        ("larger", 0.5, True),
        ("larger", 2.0, False),
        ("smaller", 0.5, False),
        ("smaller", 2.0, True),
        ("larger", 1.0, False),
        ("smaller", 1.0, False),
        ("larger", -0.5, False),
        ("larger", 0.0, False),
    ],
)
def test_weaker_step_reduces_the_effect(tmp_path: Path, stronger: str, factor: float, weaker: bool) -> None:
    of = structures(order_of(tmp_path))
    formed(of, Parameter("k", 2.0, stronger=stronger))
    assert of.weaker(operand(1, "x", 2.0), factor) is weaker


def test_parameter_is_listed_with_its_fixed_parameters(tmp_path: Path) -> None:
    of = structures(order_of(tmp_path))
    free, fixed = Parameter("k", 2.0), Parameter("base", 3.0, of="designed")
    made, other = template("made", parameters=(free, fixed)), template("other", parameters=(free, fixed))
    defaults = (("k", 2.0), ("base", 3.0))
    here, there = operand(1, "x", 2.0), operand(2, "y", 2.0)
    fixed_here = replace(here, code="x, base")
    of._found = {
        here: Form(made, "k", defaults),
        fixed_here: Form(made, "base", defaults),
        replace(here, code="x of other, base"): Form(other, "base", defaults),
        replace(there, code="y, base"): Form(made, "base", defaults),
        replace(here, code="x, k again"): Form(made, "k", defaults),
    }
    assert of.given(here) == [fixed_here]


@pytest.mark.parametrize(
    ("effects", "expected"),
    [
        ({"a": [1.0], "b": [3.0], "c": [2.0]}, ("b", "c")),
        ({"a": [2.0, 9.0], "b": [3.0]}, ("a", "b")),
        ({"a": [], "b": [1.99]}, ()),
        ({"a": [-5.0]}, ()),
        ({"a": [None], "b": [2.0]}, ("b",)),
    ],
)
def test_statement_responds_if_a_constant_gains_a_fifth(
    effects: dict[str, list[float | None]], expected: tuple[str, ...]
) -> None:
    given = {
        name: [OperandEffect("x", None if gain is None else 2.0, 1.0, gain or 9.0) for gain in gains]
        for name, gains in effects.items()
    }
    assert _responding(given, 10.0) == expected
    assert _responding({"a": [OperandEffect("x", 2.0, 1.0, 0.0)]}, 0.0) == ()
