"""The variables that hold a number where a constant is used, with their sizes in both worlds."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.repairing import variables_in_scope
from pytest_tarl.repairing.strategies import operands
from pytest_tarl.repairing.variables_in_scope import variables
from tarl_lint.api import analyse
from tarl_lint.model import Operand

NODE = """\
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

AHEAD = 1.1


class Follower:
    def __init__(self):
        self.speed = 0.0
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom)

    def on_odom(self, msg):
        self.speed = msg.twist.twist.linear.x
        side = msg.pose.pose.position.y
        twist = Twist()
        twist.angular.z = -side / AHEAD
        late = twist.angular.z * 0.5
        twist.linear.x = late + self.speed
        self.pub.publish(twist)


rospy.init_node("follower")
Follower()
rospy.spin()
"""


class Sizes:
    """Sizes of all statements: 2 in the designed world, 6 in the drifted one."""

    def __init__(self, order: Any, world: Any = None) -> None:
        self.by_site = {str(step.site): 2.0 if world is None else 6.0 for step in order.analysis.sites}


def asked(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Any, Operand]:
    """Return an order and the use of AHEAD."""
    monkeypatch.chdir(folder)
    (folder / "follower.py").write_text(NODE)
    order: Any = SimpleNamespace(
        analysis=analyse([Path("follower.py")]),
        comparison=SimpleNamespace(culprits=()),
        online=SimpleNamespace(recorded=SimpleNamespace(sample="drifted", parameters={})),
    )
    monkeypatch.setattr(variables_in_scope, "TypicalSizes", Sizes)
    (used,) = (one for one in operands(order) if one.code == "AHEAD")
    return order, used


def test_class_attributes_and_earlier_names_are_in_scope(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    order, used = asked(tmp_path, monkeypatch)
    found = {name: sizes for name, *sizes in variables(order, [used])}
    assert found == {"self.speed": [2.0, 6.0], "side": [2.0, 6.0]}


def test_the_most_suspect_statement_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    order, used = asked(tmp_path, monkeypatch)
    sites = [str(step.site) for step in order.analysis.sites if step.code.startswith(("side", "self.speed"))]
    for first in (sites, sites[::-1]):
        order.comparison.culprits = [SimpleNamespace(site=SimpleNamespace(id=site)) for site in first]
        name, *_ = next(variables(order, [used]))
        assert name in first[0]
