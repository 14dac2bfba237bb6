"""Recorded missions suggest changes of constants by the differences of values between both worlds."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.repairing.measured import MOST, hints
from pytest_tarl.repairing.strategies import operands
from pytest_tarl.searching.suggestions import Hint
from tarl_lint.api import Analysis, analyse

HAND = """\
import rospy
from std_msgs.msg import Float64

FLEXOR_ON = 0.42
EXTENSOR_ON = 0.36
TARGET = 50.0
TRIM = 4.0
GAIN = 3.0


class Hand:
    def __init__(self):
        self.flexor = 0.0
        self.extensor = 0.0
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/flexor", Float64, self.on_flexor)
        rospy.Subscriber("/extensor", Float64, self.on_extensor)
        rospy.Subscriber("/level", Float64, self.on_level)

    def on_flexor(self, msg):
        self.flexor = abs(msg.data)
        if self.flexor > FLEXOR_ON:
            self.out.publish(Float64(data=1.0))

    def on_extensor(self, msg):
        self.extensor = abs(msg.data)
        if self.extensor > EXTENSOR_ON:
            self.out.publish(Float64(data=-1.0))

    def on_level(self, msg):
        level = 2.0 * msg.data
        error = TARGET - level
        trimmed = level + TRIM
        push = GAIN * error
        self.out.publish(Float64(data=push + trimmed))


rospy.init_node("hand")
Hand()
rospy.spin()
"""
FLEXOR, EXTENSOR, LEVEL, PUSH = "self.flexor = ", "self.extensor = ", "level = ", "push = "


def analysed(folder: Path) -> Analysis:
    (folder / "hand.py").write_text(HAND)
    return analyse([folder / "hand.py"], root=folder)


def suggested(folder: Path, *missions: dict[str, tuple[float, float]]) -> list[dict[str, float]]:
    """Return the hints for mission pairs, given by the values of statements as designed and under the drift."""
    analysis = analysed(folder)
    places = plan(analysis).places

    def trace(values: dict[str, tuple[float, float]], world: int) -> Any:
        numbers = [
            (number, pair[world])
            for number, place in enumerate(places)
            for code, pair in values.items()
            if f":{code}" in place.id
        ]
        events = [(number, step, value) for step in range(5) for number, value in numbers]
        site, step, flow = zip(*events, strict=True)
        return SimpleNamespace(
            site=np.array(site), event_step=np.array(step), flow=np.array(flow), reward=np.zeros(5)
        )

    order: Any = SimpleNamespace(
        analysis=analysis,
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=()),
    )
    recorded: Any = [(trace(values, 0), trace(values, 1)) for values in missions]
    found: list[Hint] = hints(order, recorded, operands(order))
    return [{operand.code: factor for operand, factor in hint} for hint in found]


def test_constants_with_one_measured_factor_change_together(tmp_path: Path) -> None:
    weak = {FLEXOR: (0.8, 0.36), EXTENSOR: (0.6, 0.27)}
    found = suggested(tmp_path, weak, {FLEXOR: (0.7, 0.315), EXTENSOR: (0.5, 0.225)})
    assert found[:3] == [{"FLEXOR_ON": 0.45, "EXTENSOR_ON": 0.45}, {"FLEXOR_ON": 0.45}, {"EXTENSOR_ON": 0.45}]


def test_constant_changes_by_the_difference_of_a_like_value(tmp_path: Path) -> None:
    found = suggested(tmp_path, {LEVEL: (40.0, 54.0)}, {LEVEL: (42.0, 56.0)})
    assert {"TARGET": 1.28} in found  # 50 + 14
    assert {"TRIM": -2.5} not in found  # a changed sign is no measured step
    found = suggested(tmp_path, {LEVEL: (40.0, 37.0)}, {LEVEL: (42.0, 39.0)})
    assert {"TRIM": 1.75} in found  # what the level lost is added
    assert {"TARGET": 0.94} in found


def test_multiplier_changes_by_the_factor_of_its_result(tmp_path: Path) -> None:
    assert suggested(tmp_path, {PUSH: (2.0, 6.0)}, {PUSH: (1.0, 3.1)}) == [{"GAIN": 0.328}, {"GAIN": 3.05}]


@pytest.mark.parametrize(
    "second",
    [{FLEXOR: (0.8, 0.7)}, {FLEXOR: (0.8, 0.9)}, {EXTENSOR: (0.8, 0.36)}],
    ids=["another factor", "another direction", "no value"],
)
def test_mission_pairs_that_disagree_suggest_no_change(
    tmp_path: Path, second: dict[str, tuple[float, float]]
) -> None:
    assert suggested(tmp_path, {FLEXOR: (0.8, 0.36)}, second) == []


def test_small_and_huge_differences_suggest_no_change(tmp_path: Path) -> None:
    assert suggested(tmp_path, {FLEXOR: (0.8, 0.79)}) == []
    assert suggested(tmp_path, {PUSH: (0.001, 6.0)}) == []
    assert hints(SimpleNamespace(analysis=analysed(tmp_path)), [], ()) == []  # type: ignore[arg-type]


def test_the_number_of_suggestions_is_limited(tmp_path: Path) -> None:
    every = dict.fromkeys((FLEXOR, EXTENSOR, LEVEL, PUSH), (1.0, 1.5))
    assert len(suggested(tmp_path, every)) == MOST


def test_vanished_value_has_a_difference_but_no_factor(tmp_path: Path) -> None:
    assert suggested(tmp_path, {PUSH: (2.0, 0.0)}) == []
    assert suggested(tmp_path, {PUSH: (0.0, 2.0)}) == []
    found = suggested(tmp_path, {LEVEL: (20.0, 0.0)})
    assert found == [{"TARGET": 0.6}, {"TRIM": 6.0}]  # 50 - 20 and 4 + 20
    assert suggested(tmp_path, {LEVEL: (0.0, 0.0)}) == []


def test_small_measured_changes_suggest_no_step(tmp_path: Path) -> None:
    assert suggested(tmp_path, {PUSH: (1.0, 1.06)}) == [{"GAIN": 0.943}, {"GAIN": 1.06}]
    assert suggested(tmp_path, {PUSH: (1.0, 1.04)}) == []
    assert {"GAIN": 19.0} in suggested(tmp_path, {PUSH: (1.0, 19.0)})
    assert suggested(tmp_path, {PUSH: (1.0, 21.0)}) == []
    # 50 + 950 is 20 times as large, which is the limit, and a ratio of 96 is above it
    assert suggested(tmp_path, {LEVEL: (10.0, 960.0)}) == [{"TARGET": 20.0}]
    assert suggested(tmp_path, {LEVEL: (10.0, 961.0)}) == []


def test_pairs_agree_up_to_a_quarter_of_the_change(tmp_path: Path) -> None:
    # logarithms of the factors: 1 and 1.28 have a mean of 1.14, and 0.28 is less than a quarter of it
    e = 2.718281828
    assert suggested(tmp_path, {PUSH: (1.0, e)}, {PUSH: (1.0, e**1.28)})
    assert suggested(tmp_path, {PUSH: (1.0, e)}, {PUSH: (1.0, e**1.3)}) == []


def test_constant_changes_alone_if_its_neighbours_have_other_factors(tmp_path: Path) -> None:
    found = suggested(tmp_path, {FLEXOR: (1.0, 0.5), EXTENSOR: (1.0, 0.55)})
    assert [hint for hint in found if len(hint) > 1] == []
    assert {"FLEXOR_ON": 0.5} in found
    assert {"EXTENSOR_ON": 0.55} in found


CONTACTS = """\
import rospy
from std_msgs.msg import Bool, Float32

CHARGER = 26.5


def on_contacts(msg):
    charging.publish(Bool(data={code}))


rospy.init_node("contacts")
charging = rospy.Publisher("/charging", Bool, queue_size=1)
rospy.Subscriber("/contacts", Float32, on_contacts)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("msg.data > CHARGER", 22.0),
        ("CHARGER < abs(msg.data)", 22.0),
        ("msg.spare > CHARGER", None),  # a message of several numbers has no single value
        ("(charging.data > CHARGER) == msg.data", None),
    ],
)
def test_threshold_stays_between_its_groups(code: str, expected: float | None, tmp_path: Path) -> None:
    (tmp_path / "contacts.py").write_text(CONTACTS.format(code=code))
    analysis = analyse([tmp_path / "contacts.py"], root=tmp_path)
    (number,) = [number for number, one in enumerate(plan(analysis).places) if one.role == "receive"]

    def trace(*values: float) -> Any:
        flow = np.array([one for one in values for _ in range(5)])
        return SimpleNamespace(
            site=np.full(flow.size, number),
            event_step=np.arange(flow.size),
            flow=flow,
            reward=np.zeros(flow.size),
        )

    order: Any = SimpleNamespace(
        analysis=analysis,
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=()),
    )
    recorded: Any = [(trace(21.0, 28.0), trace(21.0, 23.0, 21.0, 23.0))] * 2
    found = [hint for hint in hints(order, recorded, operands(order)) if len(hint) == 1]
    by = [factor for ((one, factor),) in found if one.code == "CHARGER"]
    assert by == ([] if expected is None else [pytest.approx(expected / 26.5, abs=1e-3)])


TURNING = """\
import rospy
from std_msgs.msg import Float64


def on_heading(msg):
    error = 1.0 - msg.data
    if abs(error) < 0.01:
        out.publish(Float64(data=0.0))
    elif error < 3.0:
        out.publish(Float64(data=0.5 * error))


rospy.init_node("turning")
out = rospy.Publisher("/out", Float64, queue_size=1)
rospy.Subscriber("/heading", Float64, on_heading)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("ends", "expected"), [((0.005, 0.06), [{"0.01": 7.5}]), ((0.06, 0.06), []), ((0.005, 0.002), [])]
)
def test_unreached_literal_tolerance_is_widened(
    tmp_path: Path, ends: tuple[float, float], expected: list[dict[str, float]]
) -> None:
    (tmp_path / "turning.py").write_text(TURNING)
    analysis = analyse([tmp_path / "turning.py"], root=tmp_path)
    number = next(at for at, place in enumerate(plan(analysis).places) if ":error = " in place.id)

    def trace(end: float) -> Any:
        values = np.array([0.8, 0.4, 0.2, end, end])
        steps = np.arange(values.size)
        return SimpleNamespace(
            site=np.full(values.size, number), event_step=steps, flow=values, reward=np.zeros(values.size)
        )

    order: Any = SimpleNamespace(
        analysis=analysis,
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=()),
    )
    recorded: Any = [(trace(ends[0]), trace(ends[1])) for _ in range(2)]
    found = hints(order, recorded, operands(order))
    assert [{operand.code: factor for operand, factor in hint} for hint in found] == expected
