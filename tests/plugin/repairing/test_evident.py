"""Structural changes that symptoms indicate: which templates, at which expressions, and at what cost."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.errors import SettingsError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.patching.templates import Template, template, templates
from pytest_tarl.repairing import mission_pairs
from pytest_tarl.repairing.early import FROM, LATER, MOST, PARTLY, Early
from pytest_tarl.repairing.evident import CHANGES, PLACES, evident
from pytest_tarl.repairing.mission_pairs import PAIRS, Signs, signs
from pytest_tarl.repairing.structural import Structures
from pytest_tarl.repairing.template_places import spots
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tarl_lint.api import analyse

NODE = """\
import rospy
from std_msgs.msg import Float64


class Keeper:
    def __init__(self):
        self.range = 0.0
        self.near = False
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_value)

    def on_value(self, msg):
        self.range = msg.data
        self.near = self.range < 0.5
        speed = 0.4 * self.range
        if self.near:
            speed = 0.0
        self.out.publish(Float64(data=min(speed, 1.0)))


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
"""
SENSOR = Sensor("range", topic="/in", field="data", low=0, high=4, bins=8)


def order_of(folder: Path, rollout: Any = None) -> Any:
    path = folder / "keeper.py"
    path.write_text(NODE)
    none = np.zeros(0, np.int64)
    lists: Any = SimpleNamespace(lists=(), chain=SimpleNamespace(cell=none, count=none), cells=())
    return SimpleNamespace(
        analysis=analyse([path], root=folder),
        root=folder,
        rollout=rollout,
        drift="echoes",
        comparison=SimpleNamespace(culprits=(), sensors=(SENSOR,)),
        fixture=SimpleNamespace(sample=lists, lists=()),
        online=SimpleNamespace(recorded=SimpleNamespace(sample=lists)),
        goal=Goal((Pair(3, 1.0), Pair(4, 1.0), Pair(5, 0.5)), near=8.5, enough=9.0, online=1.0),
    )


def site(order: Any, text: str) -> str:
    (found,) = [str(step.site) for step in order.analysis.sites if step.site.text.startswith(text)]
    return found


def tried(order: Any, strengths: Mapping[str, Mapping[str, float]]) -> list[tuple[str, str]]:
    """Return the template and the code of the chosen changes."""
    found = evident(order, templates(order.root), list(spots(order)), Signs(strengths))
    told = [
        (form.template.name, operand.code.partition(" of ")[2].partition(", ")[0]) for operand, form in found
    ]
    return list(dict.fromkeys(told))


def test_spikes_indicate_a_median_where_the_value_is_received(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    received, used = site(order, "self.range = "), site(order, "speed = 0.4")
    spiky = {"spikes": 1.0}
    assert tried(order, {received: spiky, used: spiky})[:2] == [
        ("low_pass", "msg.data"),
        ("low_pass", "0.4 * self.range"),
    ]
    assert ("median", "msg.data") in tried(order, {received: spiky})


def test_spikes_suggest_a_confirming_template(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    told = tried(order, {site(order, "self.near = "): {"spikes": 0.9, "swing": 0.2}})
    assert told == [("confirmed", "self.range < 0.5")]


def test_jumps_are_limited_next_to_the_publish_call(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    strengths = {site(order, text): {"jumps": 0.9} for text in ("self.range = ", "speed = 0.4")}
    limited = [code for name, code in tried(order, strengths) if name == "rate_limit"]
    assert limited == ["0.4 * self.range", "msg.data"]


def test_stronger_symptoms_come_first_and_weak_symptoms_are_ignored(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    here = site(order, "speed = 0.4")
    told = [name for name, _ in tried(order, {here: {"swing": 0.6, "offset": 0.9, "runaway": 0.4}})]
    assert told[0] == "integral"
    assert "derivative" in told
    assert "sign" not in told
    assert tried(order, {}) == []


def test_the_number_of_changes_is_limited(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    everywhere = {
        str(step.site): dict.fromkeys(("jumps", "noise", "spikes", "swing", "offset"), 1.0)
        for step in order.analysis.sites
    }
    told = tried(order, everywhere)
    assert len(told) == CHANGES
    assert max([name for name, _ in told].count(name) for name, _ in told) <= PLACES


def test_a_template_with_an_unknown_symptom_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "odd.toml"
    path.write_text('summary = "x"\non = "value"\ncost = 1\nexpression = "-{x}"\nsymptoms = ["fever"]\n')
    with pytest.raises(
        SettingsError, match=r"the symptom 'fever' is unknown; known are chatter, hunting, jumps"
    ):
        template(path)


class Missions:
    """Missions in which the received value is 3, or in the drifted world an echo now and then."""

    def __init__(self) -> None:
        self.plans: list[EpisodePlan] = []
        self.order: Any = None

    def __call__(self, asked: EpisodePlan) -> EpisodeRun:
        self.plans.append(asked)
        places = plan(self.order.analysis).places
        here = next(number for number, place in enumerate(places) if place.code.startswith("self.range = "))
        steps = 30 if asked.drift is None else 20
        values = 3.0 + np.random.default_rng(asked.seed).normal(0.0, 0.01, steps)
        if asked.drift:
            values[4::7] = 0.3
        at = np.arange(steps, dtype=np.int32)
        trace = Trace(
            ((7,), (1,)),
            np.full(steps, here, np.int32),
            values,
            at,
            at,
            np.zeros(steps, np.int32),
            np.full(steps, 0.1),
            {},
        )
        return EpisodeRun(asked, trace, passed=not asked.drift)


def missions(folder: Path) -> tuple[Any, Missions]:
    rollout = Missions()
    rollout.order = order_of(folder, rollout)
    return rollout.order, rollout


def unhelpful(_: Candidate, __: int) -> Outcome:
    return Outcome(1.0, passed=False)


def test_seeds_with_a_loss_run_in_both_worlds(
    tmp_path: Path,
) -> None:
    order, rollout = missions(tmp_path)
    trials = Trials(unhelpful, 100)
    found = signs(order, mission_pairs.mission_pairs(order, trials))
    assert [(one.seed, one.drift) for one in rollout.plans] == [
        (seed, drift) for seed in (3, 4) for drift in (None, "echoes")
    ]
    assert all(one.record and one.signed for one in rollout.plans)
    assert trials.spent == 2 * PAIRS
    assert found.strength(site(order, "self.range = "), ("spikes",)) == 1.0
    assert found.strength(site(order, "self.range = "), ("offset",)) < 0.5
    assert found.strength("elsewhere", ("spikes",)) == 0.0


def test_symptoms_need_episodes_and_a_drift(tmp_path: Path) -> None:
    order, rollout = missions(tmp_path)
    assert signs(order, mission_pairs.mission_pairs(order, Trials(unhelpful, 1))) == Signs()
    order.drift = None
    rollout.plans.clear()
    assert signs(order, mission_pairs.mission_pairs(order, Trials(unhelpful, 100))) == Signs()
    assert not rollout.plans


def test_sensor_is_compared_over_common_steps(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    same = Signs(cells=((((1,), (1,)), ((1,), (1,))),))
    other = Signs(cells=((((1,), (1,)), ((1,), (2,))),))
    assert same.overlap(order, SENSOR) == 1.0
    assert other.overlap(order, SENSOR) == 0.5
    assert Signs().overlap(order, SENSOR) == 0.0
    order, _ = missions(tmp_path)[:2]
    found = signs(order, mission_pairs.mission_pairs(order, Trials(unhelpful, 100)))
    assert [len(one) for pair in found.cells for one in pair] == [20, 20, 20, 20]


def test_changes_with_symptoms_come_before_all_other_structural_changes(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    labels: list[str] = []

    def run(candidate: Candidate, _: int) -> Outcome:
        form = candidate.mutations[0].form
        assert form is not None
        labels.append(form.template.name)
        return Outcome(1.0, passed=False)

    told = Signs({site(order, "self.near = "): {"spikes": 1.0}})
    structures = Structures(order, (ALWAYS,), Trials(run, 40), signs=told)
    assert list(_quietly(structures)) == []
    assert labels[0] == "confirmed"
    assert set(labels) > {"confirmed"}


def test_changes_without_parameters_are_tried_first(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    names: list[str] = []

    def run(candidate: Candidate, _: int) -> Outcome:
        form = candidate.mutations[0].form
        assert form is not None
        names.append(form.template.name)
        return Outcome(1.0, passed=False)

    structures = Structures(order, (ALWAYS,), Trials(run, 40))
    assert list(structures.early(20)) == []
    assert sorted(names) == ["comparison", "sign", "sign"]
    names.clear()
    assert list(_quietly(structures)) == []
    assert not {"comparison", "sign"} & set(names[:8])  # their results are known


def _quietly(structures: Structures) -> list[Candidate]:
    from pytest_tarl.searching.search import BudgetSpentError

    try:
        return list(structures.candidates())
    except BudgetSpentError:
        return []


def test_early_changes_wait_while_a_constant_gains(tmp_path: Path) -> None:
    order, _ = missions(tmp_path)
    trials = Trials(unhelpful, 200)
    early = Early(order, (ALWAYS,), trials)
    for _ in range(FROM):
        trials.charge()
    partly = PARTLY * order.goal.wanted
    assert list(early.candidates(partly)) == []
    assert early.spent == 0
    for _ in range(FROM, LATER):
        trials.charge()
    list(early.candidates(partly))
    assert early.spent > 0


def test_early_changes_run_once_after_the_constants(
    tmp_path: Path,
) -> None:
    order, rollout = missions(tmp_path)
    trials = Trials(unhelpful, 200)
    early = Early(order, (ALWAYS,), trials)
    assert list(early.candidates()) == []
    assert not rollout.plans
    for _ in range(FROM):
        trials.charge()
    assert list(early.candidates()) == []
    assert len(rollout.plans) == 2 * PAIRS
    assert 2 * PAIRS < early.spent <= 2 * PAIRS + 2 * MOST
    assert trials.budget == 200
    assert trials.reserve == 0
    spent = trials.spent
    assert list(early.candidates()) == []
    assert trials.spent == spent


def flipping(cost: int, on: str = "value", symptom: str = "runaway", name: str = "flip") -> Template:
    return Template(name, "change the sign", on, cost, "-{x}", symptoms=(symptom,) if symptom else ())


def changes(order: Any, known: list[Template], strengths: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Return the names of the templates and the code of the expressions, in order."""
    return [operand.code for operand, _ in evident(order, known, list(spots(order)), Signs(strengths))]


@pytest.mark.parametrize(("strength", "expected"), [(0.5, ["flip of 0.4 * self.range"]), (0.49, [])])
def test_a_symptom_of_half_its_strength_indicates_a_change(
    tmp_path: Path, strength: float, expected: list[str]
) -> None:
    order = order_of(tmp_path)
    assert changes(order, [flipping(1)], {site(order, "speed = 0.4"): {"runaway": strength}}) == expected


@pytest.mark.parametrize(
    ("cheap", "dear", "expected"),
    [
        (0.96, 1.0, ["cheap", "dear"]),  # equal if they are rounded to a tenth
        (0.94, 1.0, ["dear", "cheap"]),
        (1.0, 0.94, ["cheap", "dear"]),
    ],
)
def test_cheaper_of_two_similar_changes_comes_first(
    tmp_path: Path, cheap: float, dear: float, expected: list[str]
) -> None:
    order = order_of(tmp_path)
    known = [flipping(2, symptom="swing", name="dear"), flipping(1, name="cheap")]
    found = changes(order, known, {site(order, "speed = 0.4"): {"runaway": cheap, "swing": dear}})
    assert [one.partition(" ")[0] for one in found] == expected


def test_templates_without_symptoms_are_not_indicated(tmp_path: Path) -> None:
    order = order_of(tmp_path)
    known = [flipping(1, symptom=""), flipping(1, on="sent by sensor")]
    assert changes(order, known, {site(order, "speed = 0.4"): {"runaway": 1.0, "": 1.0}}) == []


MANY = """\
import rospy
from std_msgs.msg import Float64


class Keeper:
    def __init__(self):
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_value)

    def on_value(self, msg):
        self.range = msg.data
        a = self.range * 2.0
        b = a * 3.0
        c = b + 4.0
        speed = c - 5.0
        self.out.publish(Float64(data=min(speed, 1.0)))


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
"""


def of_many(folder: Path) -> Any:
    order = order_of(folder)
    (folder / "keeper.py").write_text(MANY)
    order.analysis = analyse([folder / "keeper.py"], root=folder)
    return order


def measured(order: Any, symptom: str) -> dict[str, dict[str, float]]:
    """Return one symptom at all statements but the publish call, which has no value."""
    codes = ("self.range", "a = ", "b = ", "c = ", "speed = ")
    return {site(order, code): {symptom: 1.0} for code in codes}


@pytest.mark.parametrize(
    ("symptom", "expected"),
    [
        ("noise", ["msg.data", "self.range * 2.0", "a * 3.0"]),  # received: next to the subscription first
        ("jumps", ["c - 5.0", "b + 4.0", "a * 3.0"]),  # sent: next to the publish call first
    ],
)
def test_template_is_tried_at_three_expressions_on_the_wrong_side(
    tmp_path: Path, symptom: str, expected: list[str]
) -> None:
    order = of_many(tmp_path)
    found = changes(order, [flipping(1, symptom=symptom)], measured(order, symptom))
    assert [one.removeprefix("flip of ") for one in found] == expected


def test_published_argument_comes_last_with_earlier_symptoms(
    tmp_path: Path,
) -> None:
    order = of_many(tmp_path)
    known = [flipping(1, symptom="jumps")]
    assert changes(order, known, {site(order, "speed = "): {"jumps": 1.0}}) == [
        "flip of c - 5.0",
        "flip of min(speed, 1.0)",
    ]
    assert changes(order, known, {site(order, "c = "): {"jumps": 1.0}}) == ["flip of b + 4.0"]
