"""The search changes constants that act through an object, ranked as the statements that use the object."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.repairing.strategies import operands
from tarl_lint.api import analyse

NODE = """\
import os
import rospy
from control_library import Pid
from std_msgs.msg import Float64

KP = 0.8
{setup}


def on_in(msg):
    value = {use}
    if value < 9.5:
        out.publish(value)


if __name__ == "__main__":
    rospy.init_node("keeper")
    out = rospy.Publisher("/out", Float64, queue_size=1)
    rospy.Subscriber("/in", Float64, on_in)
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("setup", "use", "expected"),
    [
        ("pid = Pid(KP, 0.1)", "pid.update(msg.data)", ["KP", "0.1", "9.5"]),
        ("pid = Pid(KP, 0.1)", "pid.update(msg.data) * KP", ["KP", "KP", "0.1", "9.5"]),
        ("G = [0.5, 2.0]", "sum(g * msg.data for g in G)", ["0.5", "2.0", "g", "9.5"]),
        ("G = [0.5, 2.0]", "G[0] * msg.data", ["G[0]", "9.5"]),
        ("G = float(os.environ.get('G', '1.0'))", "G * msg.data", ["G", "9.5"]),
        ("G = {'p': 0.5, 'i': 2.0}", "G['p'] * msg.data", ["G['p']", "9.5"]),
    ],
)
def test_constants_of_objects_are_searched_where_they_are_stored(
    setup: str, use: str, expected: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "keeper.py"
    path.write_text(NODE.format(setup=setup, use=use))
    analysis = analyse([path], root=tmp_path)
    places = [SimpleNamespace(site=SimpleNamespace(id=str(step.site))) for step in analysis.sites]
    order: Any = SimpleNamespace(
        analysis=analysis,
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=places),
    )
    found = [one.code for one in operands(order)]
    assert sorted(found) == sorted(expected)


WHEELS = """\
import rospy
from std_msgs.msg import Float64

LEFT = 0.16
RIGHT = 0.17


class Wheel:
    def __init__(self, radius):
        self.radius = radius

    def speed(self, turns):
        return turns * self.radius


{setup}


def on_in(msg):
    out.publish({use})


if __name__ == "__main__":
    rospy.init_node("keeper")
    out = rospy.Publisher("/out", Float64, queue_size=1)
    rospy.Subscriber("/in", Float64, on_in)
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("setup", "use", "expected"),
    [
        (
            "left = Wheel(LEFT)\nright = Wheel(RIGHT)",
            "left.speed(msg.data) + right.speed(msg.data)",
            ["LEFT", "RIGHT", "self.radius"],
        ),
        ("left = Wheel(LEFT)", "left.speed(msg.data)", ["self.radius"]),  # the use stands for one constant
        ("left = Wheel(0.16)", "left.speed(msg.data)", ["self.radius"]),
    ],
)
def test_constants_of_several_objects_are_searched_singly(
    setup: str, use: str, expected: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "keeper.py"
    path.write_text(WHEELS.format(setup=setup, use=use))
    analysis = analyse([path], root=tmp_path)
    places = [SimpleNamespace(site=SimpleNamespace(id=str(step.site))) for step in analysis.sites]
    order: Any = SimpleNamespace(
        analysis=analysis,
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=places),
    )
    found = [one.code for one in operands(order)]
    assert sorted(found) == sorted(expected)
