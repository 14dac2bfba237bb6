"""A repair is written at the definition of its constant if the test uses it there; the outcomes are scripted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.constant_definitions import defined
from pytest_tarl.patching.mutate import Mutation, redefinition
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.repairing.placing import MOST_NAMED, Placing
from pytest_tarl.repairing.strategies import operands
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair
from pytest_tarl.sensors import Sensor
from tarl_lint.api import analyse
from tarl_lint.model import Operand

NODE = """\
import rospy
from std_msgs.msg import Float64

GAIN = 2.0


class Keeper:
    def __init__(self):
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_in)
        rospy.Subscriber("/other", Float64, self.on_other)

    def on_in(self, msg):
        push = GAIN * msg.data
        self.out.publish(Float64(data=push))

    def on_other(self, msg):
        pull = GAIN * 0.5 * msg.data
        self.out.publish(Float64(data=pull))


rospy.init_node("keeper")
Keeper()
rospy.spin()
"""
GOAL = Goal(tuple(Pair(seed, 1.0) for seed in range(10, 16)), near=9.0, enough=9.0, online=1.0)
Script = Callable[[bool, int], float]  # whether the definition is changed, seed → total


@pytest.fixture(autouse=True)
def _in_the_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


class Scripted:
    """Trials whose totals a script gives, by whether the candidate changes a definition."""

    def __init__(self, script: Script) -> None:
        self.script = script
        self.ran: list[tuple[bool, int]] = []
        self.equated: list[tuple[Candidate, Candidate]] = []

    def __call__(self, candidate: Candidate, seed: int) -> Outcome:
        moved = any(one.place is not None for one in candidate.mutations)
        self.ran.append((moved, seed))
        return Outcome(self.script(moved, seed), passed=True)

    def reaches(self, candidate: Candidate, seed: int, goal: Goal) -> bool:
        return goal.reached(self(candidate, seed), seed)

    def equate(self, candidate: Candidate, other: Candidate) -> None:
        self.equated.append((candidate, other))


def placing(folder: Path, edit: str = "auto", text: str = NODE) -> Placing:
    (folder / "keeper.py").write_text(text)
    order: Any = SimpleNamespace(
        analysis=analyse([Path("keeper.py")]),
        root=folder,
        goal=GOAL,
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=()),
        fixture=SimpleNamespace(test="test_it.py::test_it", topics={}),
        options=SimpleNamespace(edit=edit),
    )
    return Placing(SimpleNamespace(order=order, texts={}))  # type: ignore[arg-type]


def gains(of: Placing) -> list[Any]:
    """Return the two uses of GAIN, in the order of their lines."""
    return sorted((one for one in operands(of.order) if one.code == "GAIN"), key=lambda one: one.span.line)


def tripled(of: Placing, guard: Guard = ALWAYS) -> Candidate:
    return Candidate((Mutation(gains(of)[0], 3.0),), guard)


def test_change_moves_to_the_definition_if_the_reward_is_equal(tmp_path: Path) -> None:
    of, trials = placing(tmp_path), Scripted(lambda moved, seed: 9.5)
    candidate = tripled(of)
    found: Any = of(candidate, trials)  # type: ignore[arg-type]
    place = found.mutations[0].place
    assert (place.path, place.line, place.name, place.value) == ("keeper.py", 4, "GAIN", 2.0)
    assert NODE[place.start : place.end] == "2.0"
    assert trials.equated == [(candidate, found)]
    assert {seed for _, seed in trials.ran} == {10}  # the first seed shows that the outcomes are equal


def test_change_at_the_definition_needs_three_good_seeds(
    tmp_path: Path,
) -> None:
    of, trials = placing(tmp_path), Scripted(lambda moved, seed: 9.5 if moved else 10.0)
    found: Any = of(tripled(of), trials)  # type: ignore[arg-type]
    assert found.mutations[0].place is not None
    assert [seed for moved, seed in trials.ran if moved] == [10, 10, 10, 11, 12]
    assert not trials.equated


@pytest.mark.parametrize("edit", ["auto", "definition"])
@pytest.mark.parametrize("bad", [10, 11, 12])
def test_failed_move_to_the_definition_leaves_a_note(tmp_path: Path, bad: int, edit: str) -> None:
    # on the other seeds, the change earns the same at both places
    of = placing(tmp_path, edit)
    trials = Scripted(
        lambda moved, seed: 9.5 if not moved else 5.0 if seed == bad else 9.0 + (seed == 10) / 4
    )
    candidate = tripled(of)
    found = of(candidate, trials)  # type: ignore[arg-type]
    assert found == (candidate if edit == "auto" else None)
    (note,) = of.notes(candidate)
    assert note == (
        "`GAIN` is changed at its use, because a change of its definition at keeper.py:4 does not restore the reward: "
        "other code uses the constant, too"
    )


def test_the_first_seed_decides_whether_the_outcomes_are_equal(tmp_path: Path) -> None:
    of, trials = placing(tmp_path), Scripted(lambda moved, seed: 5.0 if moved and seed == 10 else 9.5)
    candidate = tripled(of)
    assert of(candidate, trials) == candidate  # type: ignore[arg-type]
    assert not trials.equated


def test_change_at_the_definition_runs_on_three_seeds(tmp_path: Path) -> None:
    of, trials = placing(tmp_path), Scripted(lambda moved, seed: (9.5 if seed < 13 else 0.0) + (not moved))
    found: Any = of(tripled(of), trials)  # type: ignore[arg-type]
    assert found.mutations[0].place is not None
    assert max(seed for _, seed in trials.ran) == 12


@pytest.mark.parametrize("edit", ["auto", "definition"])
def test_a_definition_without_effect_is_not_changed(tmp_path: Path, edit: str) -> None:
    of, trials = placing(tmp_path, edit), Scripted(lambda moved, seed: 1.0 if moved else 9.5)
    candidate = tripled(of)
    assert of(candidate, trials) == (candidate if edit == "auto" else None)  # type: ignore[arg-type]
    assert trials.ran == [(True, 10)]
    of(candidate, trials)  # type: ignore[arg-type]
    assert trials.ran == [(True, 10)]  # the answer is kept


def test_unwritable_definition_keeps_the_change_at_its_use(tmp_path: Path) -> None:
    def script(moved: bool, seed: int) -> float:
        if moved:
            raise RepairError("no")
        return 9.5

    of, trials = placing(tmp_path), Scripted(script)
    candidate = tripled(of)
    assert of(candidate, trials) == candidate  # type: ignore[arg-type]


def test_conditional_changes_stay_at_the_use(tmp_path: Path) -> None:
    sensor = Sensor("x", topic="/x", field="data", low=0, high=1, bins=2)
    trials = Scripted(lambda moved, seed: 9.5)
    of = placing(tmp_path)
    guarded = tripled(of, Guard((Conjunct(sensor, 0.5, 1.0),)))
    assert of(guarded, trials) == guarded  # type: ignore[arg-type]
    of = placing(tmp_path, "use")
    assert of(tripled(of), trials) == tripled(of)  # type: ignore[arg-type]
    assert trials.ran == []


HELPER = """\
import rospy
from std_msgs.msg import Float64


def turn(angle, speed):
    if angle > 0.0:
        out.publish(Float64(data=speed))
    else:
        out.publish(Float64(data=-speed))


def on_goal(msg):
    turn(msg.data, {first})


def on_pose(msg):
    speed = {second}
    turn(msg.data, speed)


rospy.init_node("turner")
out = rospy.Publisher("/out", Float64, queue_size=1)
rospy.Subscriber("/goal", Float64, on_goal)
rospy.Subscriber("/pose", Float64, on_pose)
rospy.spin()
"""


def turned(folder: Path, first: str, second: str) -> tuple[Any, list[tuple[str, int, float]]]:
    """Double the speed at both uses in the helper; return the text that was edited, and each new number's line."""
    of = placing(folder, text=HELPER.format(first=first, second=second))
    uses = [one for one in operands(of.order) if one.code == "speed" and one.site.qualname.endswith("turn")]
    assert len(uses) == 2
    trials = Scripted(lambda moved, seed: 9.5)
    found: Any = of(Candidate(tuple(Mutation(one, 2.0) for one in uses), ALWAYS), trials)  # type: ignore[arg-type]
    places = {one.place: redefinition(one) for one in found.mutations if one.place is not None}
    return found, [(place.name, place.line, float(value)) for place, value in places.items()]


def test_parameter_change_moves_to_the_passed_numbers(tmp_path: Path) -> None:
    found, places = turned(tmp_path, "0.1", "0.1")
    assert places == [("speed", 13, 0.2), ("speed", 17, 0.2)]
    texts = rewrite(analyse([Path("keeper.py")]), found.mutations, ALWAYS, {}, {})
    assert texts["keeper.py"] == HELPER.format(first="0.2", second="0.2")


def test_calls_that_pass_different_numbers_are_scaled_alike(tmp_path: Path) -> None:
    assert turned(tmp_path, "0.1", "0.3")[1] == [("speed", 13, 0.2), ("speed", 17, 0.6)]


def test_a_call_that_passes_zero_stays_as_it_is(tmp_path: Path) -> None:
    assert turned(tmp_path, "0.1", "0.0")[1] == [("speed", 13, 0.2)]


ROWS = """\
import os

import rospy
from std_msgs.msg import Float64

RECIPES = {{"plum": {{"pulse": 0.2}}, "peach": {{"pulse": 0.4}}, "pear": {{"pulse": 0.6}}}}
recipe = RECIPES[rospy.get_param("~fruit", "peach")]
value = {value}


def on_goal(msg):
    out.publish(Float64(data=value * msg.data))


rospy.init_node("ejector")
out = rospy.Publisher("/out", Float64, queue_size=1)
rospy.Subscriber("/goal", Float64, on_goal)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("value", "number", "name"),
    [
        ('recipe["pulse"]', "0.4", 'RECIPES["peach"]["pulse"]'),
        ('0.25 if os.name == "nt" else 0.45', "0.45", "value"),
    ],
    ids=["row", "conditional expression"],
)
def test_only_the_alternative_that_the_test_uses_is_changed(
    tmp_path: Path, value: str, number: str, name: str
) -> None:
    text = ROWS.format(value=value)
    of = placing(tmp_path, text=text)
    (use,) = (one for one in operands(of.order) if one.code == "value")
    start = text.index(number)

    class Rows(Scripted):
        def __call__(self, candidate: Candidate, seed: int) -> Outcome:
            starts = {one.place.start if one.place else start for one in candidate.mutations}
            return Outcome(9.5 if starts == {start} else 1.0, passed=True)

    trials = Rows(lambda moved, seed: 9.5)
    found: Any = of(Candidate((Mutation(use, 2.0),), ALWAYS), trials)  # type: ignore[arg-type]
    (mutation,) = found.mutations
    assert (mutation.place.name, mutation.place.start, redefinition(mutation)) == (
        name,
        start,
        2 * float(number),
    )


def test_number_and_factor_become_one_change(tmp_path: Path) -> None:
    of = placing(tmp_path, text=HELPER.format(first="0.0", second="0.1"))
    uses = [one for one in operands(of.order) if one.code == "speed" and one.site.qualname.endswith("turn")]
    span = next(one for one in uses[0].definitions if one.line == 17)
    number = Operand(uses[0].site, span, "0.1", 0.1, span)
    changed = (Mutation(number, 0.05), *(Mutation(one, 6.0) for one in uses))
    found: Any = of(Candidate(changed, ALWAYS), Scripted(lambda moved, seed: 9.5))  # type: ignore[arg-type]
    texts = rewrite(of.order.analysis, found.mutations, ALWAYS, {}, {})
    assert texts["keeper.py"] == HELPER.format(first="0.0", second="0.3")


def test_parameter_stays_changed_if_a_call_passes_no_number(tmp_path: Path) -> None:
    of = placing(tmp_path, text=HELPER.format(first="0.1", second="rospy.get_time()"))
    uses = [one for one in operands(of.order) if one.site.qualname.endswith("turn")]
    assert not any(defined(of.order.analysis, one) for one in uses)


@pytest.mark.parametrize("edit", ["auto", "definition"])
def test_uses_with_different_values_are_not_moved(tmp_path: Path, edit: str) -> None:
    of, trials = placing(tmp_path, edit), Scripted(lambda moved, seed: 9.5)
    one, other = gains(of)
    differ = Candidate((Mutation(one, 3.0), Mutation(other, 2.0)), ALWAYS)
    assert of(differ, trials) == (differ if edit == "auto" else None)  # type: ignore[arg-type]
    same = Candidate((Mutation(one, 3.0), Mutation(other, 3.0)), ALWAYS)
    found: Any = of(same, trials)  # type: ignore[arg-type]
    assert {mutation.place.line for mutation in found.mutations} == {4}


def test_definition_only_edits_need_a_definition_of_every_constant(
    tmp_path: Path,
) -> None:
    def literal(of: Placing) -> Any:
        return next(one for one in operands(of.order) if one.literal and one.value == 0.5)

    trials = Scripted(lambda moved, seed: 9.5)
    of = placing(tmp_path, "definition")
    mixed = Candidate((Mutation(gains(of)[0], 3.0), Mutation(literal(of), 2.0)), ALWAYS)
    found: Any = of(mixed, trials)  # type: ignore[arg-type]
    assert [one.place is None for one in found.mutations] == [False, True]  # a literal is its own definition


def test_other_users_of_a_changed_definition_are_named(tmp_path: Path) -> None:
    of, trials = placing(tmp_path), Scripted(lambda moved, seed: 9.5)
    names = [f"user_{number}.py" for number in range(MOST_NAMED + 1)]
    for name in names:
        (tmp_path / name).write_text("from keeper import GAIN\n")
    (tmp_path / "stranger.py").write_text("GAIN = 7\n")  # does not name the module
    (tmp_path / "venv").mkdir()
    (tmp_path / "venv" / "hidden.py").write_text("from keeper import GAIN\n")
    (note,) = of.notes(of(tripled(of), trials))  # type: ignore[arg-type]
    shown, _, rest = note.partition(" and ")
    assert shown.startswith("GAIN at keeper.py:4 is also used by ")
    used = shown.removeprefix("GAIN at keeper.py:4 is also used by ").split(", ")
    assert len(used) == MOST_NAMED
    assert used[1:] == names[: MOST_NAMED - 1]  # after the other use in the node itself
    assert rest == "2 more; this run repeated the recorded tests that use it"
