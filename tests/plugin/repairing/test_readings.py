"""Corrections of sensor readings that differ from the first message on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.repairing import early, typical_sizes
from pytest_tarl.repairing.early import SEEDS, Early
from pytest_tarl.repairing.readings import corrections
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tarl_lint.api import analyse
from tests.plugin.searching.test_search import operand

CART = """\
import rospy
from std_msgs.msg import Float64


class Cart:
    def __init__(self):
        self.heading = 0.0
        self.weight = 0.0
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/heading", Float64, self.on_heading)
        rospy.Subscriber("/weight", Float64, self.on_weight)

    def on_heading(self, msg):
        self.heading = msg.data
        turn = -2.0 * self.heading
        self.out.publish(Float64(data=turn))

    def on_weight(self, msg):
        self.weight = msg.data
        self.out.publish(Float64(data=self.weight))


rospy.init_node("cart")
Cart()
rospy.spin()
"""
HEADING, TURN, WEIGHT = "self.heading = ", "turn = ", "self.weight = "
Missions = dict[str, tuple[float, float]]


def corrected(
    folder: Path, monkeypatch: pytest.MonkeyPatch, *missions: Missions, step: int = 0
) -> list[tuple[int, str, float]]:
    """Return the line, template and value of each correction for the first values of statements, in both worlds."""
    (folder / "cart.py").write_text(CART)
    analysis = analyse([folder / "cart.py"], root=folder)
    places = plan(analysis).places
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: {place.id: 1.0 for place in places})

    def trace(values: Missions, world: int) -> Any:
        events = [
            (number, at, pair[world] if at == step else 7.0)
            for at in range(step, step + 5)
            for number, place in enumerate(places)
            for code, pair in values.items()
            if f":{code}" in place.id
        ]
        site, steps, flow = map(np.array, zip(*events, strict=True))
        return SimpleNamespace(site=site, event_step=steps, flow=flow, reward=np.zeros(step + 5))

    order: Any = SimpleNamespace(
        analysis=analysis,
        root=folder,
        comparison=SimpleNamespace(culprits=(), sensors=()),
        online=SimpleNamespace(recorded=SimpleNamespace(sample=None)),
    )
    recorded: Any = [(trace(values, 0), trace(values, 1)) for values in missions]
    return [
        (one.operand.span.line, one.form.template.name, next(iter(form_values(one).values())))
        for one in corrections(order, recorded)
        if one.form is not None
    ]


def test_sensor_offset_is_subtracted_on_receipt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bent = {HEADING: (0.3, 0.44), TURN: (-0.6, -0.88)}
    found = corrected(tmp_path, monkeypatch, bent, {HEADING: (-0.1, 0.04), TURN: (0.2, -0.08)})
    assert found[0] == (14, "offset", pytest.approx(-0.14))


def test_wrong_sensor_scale_is_corrected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = corrected(tmp_path, monkeypatch, {WEIGHT: (4.0, 5.0)}, {WEIGHT: (8.0, 10.0)})
    assert found == [(19, "gain", pytest.approx(0.8))]


@pytest.mark.parametrize(
    ("missions", "step"),
    [
        ([{WEIGHT: (4.0, 4.0)}, {WEIGHT: (8.0, 8.0)}], 0),  # the same reading
        ([{WEIGHT: (4.0, 4.0)}, {WEIGHT: (8.0, 9.0)}], 0),  # wrong in one mission only
        ([{WEIGHT: (4.0, 5.0)}, {WEIGHT: (8.0, 7.0)}], 0),  # neither an offset nor a factor
        ([{WEIGHT: (4.0, 5.0)}], 0),  # a single mission may show chance
        ([{WEIGHT: (4.0, 5.0)}, {WEIGHT: (8.0, 10.0)}], 3),  # commands may have had an effect
    ],
)
def test_initially_right_readings_are_not_corrected(
    missions: Sequence[Missions], step: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert corrected(tmp_path, monkeypatch, *missions, step=step) == []


GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(8)), near=9.0, enough=9.0, online=0.0)


def tried(monkeypatch: pytest.MonkeyPatch, total: Any, values: Sequence[float]) -> tuple[list[float], Early]:
    """Return the confirmed corrections; `total` gives the reward of a value on a seed."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        earned = total(float(candidate.mutations[0].value), seed)
        return Outcome(earned, earned > 5.0)

    mutations = [Mutation(operand(3, "x", 1.0), value) for value in values]
    monkeypatch.setattr(early, "corrections", lambda *_: mutations)
    monkeypatch.setattr(early, "mission_pairs", lambda *_: ())
    order: Any = SimpleNamespace(goal=GOAL)
    found = Early(order, (ALWAYS,), Trials(run, 50))
    yielded = [float(one.mutations[0].value) for one in found.corrected()]
    assert list(found.corrected()) == []
    return yielded, found


def test_each_correction_is_confirmed_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    yielded, found = tried(monkeypatch, lambda value, seed: 10.0 if value == 2.0 else 0.0, (3.0, 2.0))
    assert yielded == [2.0]
    assert found.spent == found.trials.spent > SEEDS
    hard = tried(monkeypatch, lambda value, seed: 8.0 if seed == 0 else 10.0, (2.0,))
    assert hard[0] == [2.0]
    assert tried(monkeypatch, lambda value, seed: 10.0 if seed < SEEDS else 0.0, (2.0,))[0] == []


def test_a_correction_that_cannot_be_written_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def total(value: float, _: int) -> float:
        if value == 3.0:
            raise RepairError("no place")
        return 10.0

    assert tried(monkeypatch, total, (3.0, 2.0))[0] == [2.0]


def test_factors_on_published_fields_are_tried_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(early, "corrections", lambda *_: ())
    monkeypatch.setattr(early, "mission_pairs", lambda *_: ())
    monkeypatch.setattr(early, "signs", lambda *_: None)
    built: list[Any] = []

    class Fields:
        def __init__(self, *_: Any, **__: Any) -> None:
            built.append(self)

        def surest(self, most: int, symptoms: bool = True) -> Any:
            assert not symptoms
            yield from [Candidate((Mutation(operand(9, "msg.data", 1.0), 2.0),), ALWAYS)]

    monkeypatch.setattr(early, "Structures", Fields)
    order: Any = SimpleNamespace(goal=GOAL)
    found = Early(order, (ALWAYS,), Trials(lambda *_: Outcome(0.0, False), 50))
    assert [one.mutations[0].operand.code for one in found.before_extreme()] == ["msg.data"]
    assert list(found.before_extreme()) == []
    assert len(built) == 1
