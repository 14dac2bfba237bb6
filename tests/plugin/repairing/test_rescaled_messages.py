"""Corrections of messages that arrive in another unit."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.patching.document import document
from pytest_tarl.patching.mutate import form_values
from pytest_tarl.repairing.rescaled_messages import reads, rescaled
from pytest_tarl.sensors import Sensor
from tarl_lint.api import analyse

BOAT = """\
import math

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Float64


class Boat:
    def __init__(self):
        self.wind = 0.0
        self.goal = None
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/wind", Float64, self.on_wind)
        rospy.Subscriber("/goal", Point, self.on_goal)

    def on_wind(self, msg):
        self.wind = math.sin(msg.data + 0.1) + math.cos(msg.data)
        self.out.publish(Float64(data=self.wind))

    def on_goal(self, msg):
        self.goal = msg
        self.out.publish(Float64(data=math.hypot(self.goal.x, self.goal.y)))


rospy.init_node("boat")
Boat()
rospy.spin()
"""
WIND, GOAL = "def on_wind", "def on_goal"
Missions = dict[str, tuple[float, float]]


def corrected(
    folder: Path, *missions: Missions, step: int = 0, code: str = BOAT, sensors: Sequence[Sensor] = ()
) -> list[list[tuple[int, str, float]]]:
    """Return the line, the code and the factor of each read that a correction changes, for sizes in both worlds.

    The messages arrive in five steps from `step` on, all with the same size.
    """
    (folder / "boat.py").write_text(code)
    analysis = analyse([folder / "boat.py"], root=folder)

    def trace(values: Missions, world: int) -> Any:
        events = [
            (number, at, pair[world])
            for at in range(step, step + 5)
            for number, place in enumerate(plan(analysis).places)
            for place_code, pair in values.items()
            if f":{place_code}" in place.id
        ]
        site, steps, flow = map(np.array, zip(*events, strict=True))
        return SimpleNamespace(site=site, event_step=steps, flow=flow, reward=np.zeros(step + 5))

    order: Any = SimpleNamespace(analysis=analysis, root=folder, comparison=SimpleNamespace(sensors=sensors))
    recorded: Any = [(trace(values, 0), trace(values, 1)) for values in missions]
    source = document("boat.py", code)
    return [
        [
            (one.operand.span.line, source.source(source.find(one.operand.span)), form_values(one)["gain"])
            for one in mutations
        ]
        for mutations in rescaled(order, recorded)
    ]


def test_unit_is_converted_at_every_read(tmp_path: Path) -> None:
    degrees = {WIND: (1.0, 180 / pi)}, {WIND: (0.3, 0.3 * 180 / pi)}
    assert corrected(tmp_path, *degrees) == [[(17, "msg.data", 0.01745)] * 2]


def test_stored_message_is_converted_when_read(tmp_path: Path) -> None:
    found = corrected(tmp_path, {GOAL: (4.0, 4000.0)}, {GOAL: (7.0, 7000.0)})
    assert found == [[(22, "self.goal.x", 0.001), (22, "self.goal.y", 0.001)]]


def test_factor_without_a_unit_ratio_is_unchanged(tmp_path: Path) -> None:
    found = corrected(tmp_path, {WIND: (4.0, 5.0)}, {WIND: (8.0, 10.0)})
    assert [by for _, _, by in found[0]] == [0.8, 0.8]


def test_usual_sizes_show_a_unit_if_messages_arrive_late(tmp_path: Path) -> None:
    late = corrected(tmp_path, {WIND: (1.0, 54.0)}, {WIND: (1.0, 60.0)}, step=4)
    assert late == [[(17, "msg.data", 0.01745)] * 2]


@pytest.mark.parametrize(
    ("missions", "step"),
    [
        ([], 0),  # nothing recorded
        ([{WIND: (4.0, 4.0)}, {WIND: (8.0, 8.0)}], 0),  # the same
        ([{WIND: (4.0, 8.0)}, {WIND: (4.0, 2.0)}], 0),  # no common factor
        ([{WIND: (4.0, 5.0)}, {WIND: (8.0, 9.0)}], 0),  # an offset
        ([{WIND: (1.0, 1e3)}], 0),  # a single mission may show chance
        ([{WIND: (1.0, 3.0)}, {WIND: (1.0, 3.5)}], 4),  # the node's own commands may explain it
        ([{WIND: (1.0, 10.0)}, {WIND: (1.0, 1e3)}], 4),  # two different units
        ([{WIND: (0.0, 10.0)}, {WIND: (0.0, 10.0)}], 4),  # no size as designed
    ],
)
def test_sizes_that_no_unit_explains_are_left_alone(
    missions: Sequence[Missions], step: int, tmp_path: Path
) -> None:
    assert corrected(tmp_path, *missions, step=step) == []


@pytest.mark.parametrize(
    ("topic", "variable", "factor", "found"),
    [
        ("/ball", "seen", 14.504, None),
        ("/ball", "seen", 180 / pi, None),
        ("/tank/pressure", "seen", 14.504, 0.06895),  # the topic says what is measured
        ("/ball", "ball_bearing", 180 / pi, 0.01745),  # the variable does
        ("/ball", "ball_bearing", 14.504, None),
        ("/ball", "seen", 1e3, 0.001),
    ],
)
def test_usual_sizes_show_only_units_of_the_quantity(
    topic: str, variable: str, factor: float, found: float | None, tmp_path: Path
) -> None:
    code = BOAT.replace("/wind", topic).replace("math.sin(msg.data + 0.1) + math.cos(msg.data)", "msg.data")
    code = code.replace("self.wind", f"self.{variable}")
    shown = corrected(tmp_path, {WIND: (1.0, factor)}, {WIND: (2.0, 2.0 * factor)}, step=4, code=code)
    assert [by for one in shown for _, _, by in one] == ([] if found is None else [found])


def test_the_unit_of_a_declared_sensor_determines_the_quantity(tmp_path: Path) -> None:
    code = BOAT.replace("math.sin(msg.data + 0.1) + math.cos(msg.data)", "msg.data")
    missions: tuple[Missions, ...] = ({WIND: (1.0, 14.5)}, {WIND: (1.0, 14.5)})
    for topic, found in (("wind", [0.06895]), ("goal", [])):
        gauge = Sensor("gauge", topic, "data", low=0.0, high=9.0, bins=3, unit="bar")
        shown = corrected(tmp_path, *missions, step=4, code=code, sensors=(gauge,))
        assert [by for one in shown for _, _, by in one] == found


READS = """\
def on(msg):
    a = msg.x
    b = msg.header.stamp
    c = msg.ranges[3] + len(msg.names)
    d = msg.ranges[1:]
    if msg.state == "on" or msg.ready:
        msg.y = 3.0
    other = msg
    return other.z + msg.compute()


spin = lambda m: print(m.data)
none = lambda: 3
"""


@pytest.mark.parametrize(
    ("line", "expected"),
    [(1, ["msg.x", "msg.ranges[3]", "other.z"]), (12, ["m.data"]), (13, []), (2, [])],
)
def test_only_reads_that_may_be_numbers_count(line: int, expected: list[str]) -> None:
    source = document("node.py", READS)
    assert sorted(map(source.source, reads(source, line))) == sorted(expected)
