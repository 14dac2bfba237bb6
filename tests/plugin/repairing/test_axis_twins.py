"""What moves along two axes is changed for both of them."""

from __future__ import annotations

import ast
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.document import document
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.repairing import template_forms
from pytest_tarl.repairing.evident import evident
from pytest_tarl.repairing.mission_pairs import Signs
from pytest_tarl.repairing.template_forms import form_words, forms
from pytest_tarl.repairing.template_places import Spot, axes_of
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.sensors import Sensor
from tarl_lint.api import analyse
from tarl_lint.model import Operand

NODE = """\
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class Pallet:
    def __init__(self):
        self.pub = rospy.Publisher("/push", Twist, queue_size=1)
        rospy.Subscriber("/odom", Odometry, self.on_odom)

    def on_odom(self, msg):
        ex = 1.0 - msg.pose.pose.position.x
        ey = 1.0 - msg.pose.pose.position.y
        push = Twist()
        push.linear.x = ex
        push.linear.y = ey
        self.pub.publish(push)


rospy.init_node("pallet")
Pallet()
rospy.spin()
"""
SPEED = Sensor("speed", topic="/odom", field="twist.twist.linear.x", low=-1.0, high=1.0, bins=4)
ERRORS = ("1.0 - msg.pose.pose.position.x", "1.0 - msg.pose.pose.position.y")


def spot(text: str, code: str, kind: str = "value") -> Spot:
    source: Any = document("a.py", text)
    node = next(one for one in source.expressions.values() if ast.unparse(one) == code)
    site: Any = SimpleNamespace()
    return Spot(site, source, node, kind, 1.0, 2.0, 1, True)


@pytest.mark.parametrize(
    ("one", "other", "axes"),
    [
        ("goal.x - at.x", "goal.y - at.y", ("x", "y")),
        ("gain * error_y", "gain * error_x", ("y", "x")),
        ("mass * push(ex)", "mass * push(ey)", ("x", "y")),
        ("ahead(left_speed)", "ahead(right_speed)", ("left", "right")),
        ("goal.x - at.x", "goal.y - at.x", ("x", "y")),
        ("goal.x - at.y", "goal.y - at.x", None),
        ("gain * error_x", "drag * error_y", None),
        ("goal.x - at.x", "goal.y - at.y - 1", None),
        ("goal.x - at.x", "goal.q - at.q", None),
    ],
)
def test_twins_differ_only_in_axis_names(one: str, other: str, axes: tuple[str, str] | None) -> None:
    text = f"def f():\n    a = {one}\n    b = {other}\n"
    assert axes_of(spot(text, one), spot(text, other)) == axes


def test_expressions_in_two_functions_are_not_twins() -> None:
    source: Any = document("a.py", "def f(g):\n    a = g.x - 1\n\n\ndef h(g):\n    a = g.y - 1\n")
    nodes = [one for one in source.expressions.values() if isinstance(one, ast.BinOp)]
    site: Any = SimpleNamespace()
    first, second = (Spot(site, source, one, "value", 1.0, 1.0, 1, True) for one in nodes)
    assert axes_of(first, second) is None


class Pallet:
    """The node above, and its first expressions as places for templates."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        (folder / "pallet.py").write_text(NODE)
        self.analysis = analyse([folder / "pallet.py"], root=folder)
        monkeypatch.setattr(template_forms, "usual", lambda *_: 0.5)
        self.order: Any = SimpleNamespace(
            analysis=self.analysis, comparison=SimpleNamespace(sensors=(SPEED,))
        )
        (path,) = self.analysis.sources
        source = document(path, self.analysis.sources[path])
        self.spots = []
        for code in ERRORS:
            node = next(one for one in source.expressions.values() if ast.unparse(one) == code)
            step = next(one for one in self.analysis.sites if code in one.code)
            self.spots.append(Spot(step.site, source, node, "value", 1.0, 2.0, 1, True))

    def forms(self, name: str, *spots: Spot, before: tuple[Spot, ...] = ()) -> list[tuple[Operand, Form]]:
        found = forms(self.order, template(SHIPPED / f"{name}.toml"), spots, before)
        return [each[0] for each in found]

    def patched(self, operand: Operand, form: Form) -> str:
        mutation = Mutation(operand, 1.0, form=form)
        texts = rewrite(self.analysis, (mutation,), ALWAYS, {"/odom": "nav_msgs/msg/Odometry"})
        (text,) = texts.values()
        return text


def test_the_second_axis_changes_together_with_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pallet = Pallet(tmp_path, monkeypatch)
    (one, alone), (both, twin) = pallet.forms("derivative", *pallet.spots)
    assert (alone.partner, twin.partner) == (None, one.span)
    assert both.code == f"derivative of {ERRORS[1]} and {ERRORS[0]}, gain"
    text = pallet.patched(both, twin)
    assert "ex = ex + 2.0 * self.change_ex" in text
    assert "ey = ey + 2.0 * self.change_ey" in text
    assert "self.change_ey" not in pallet.patched(one, alone)
    assert form_words(pallet.order, Mutation(both, 1.0, form=twin)) == (
        f"add 2.0 × the change of {ERRORS[1]} and {ERRORS[0]} since the last call"
    )


def test_the_axis_may_be_named_before_the_quantity(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pallet = Pallet(tmp_path, monkeypatch)
    first, second = pallet.spots
    ((_, form),) = pallet.forms("derivative", second, before=(first,))
    assert form.partner == first.source.span(first.node)


def test_sensor_represents_the_field_of_the_other_axis(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pallet = Pallet(tmp_path, monkeypatch)
    _, (both, twin) = pallet.forms("term", *pallet.spots)
    assert dict(twin.defaults) == {"gain": -0.5 * 2.0 / 0.5}
    text = pallet.patched(both, twin)
    assert "ex = 1.0 - msg.pose.pose.position.x - 2.0 * msg.twist.twist.linear.x" in text
    assert "ey = 1.0 - msg.pose.pose.position.y - 2.0 * msg.twist.twist.linear.y" in text


def test_sensor_without_an_axis_serves_both(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pallet = Pallet(tmp_path, monkeypatch)
    load = Sensor("load", topic="/odom", field="twist.load", low=-1.0, high=1.0, bins=4)
    pallet.order.comparison.sensors = (load,)
    _, (_, form) = pallet.forms("term", *pallet.spots)
    assert (form.sensor, form.sibling, form.partner) == (load, None, None)


def test_both_axes_change_only_if_both_overshoot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pallet = Pallet(tmp_path, monkeypatch)
    known = [template(SHIPPED / "derivative.toml")]
    signs = Signs({str(one.site): {"overshoot": 1.0} for one in pallet.spots})
    found = list(evident(pallet.order, known, pallet.spots, signs))
    assert [operand.code for operand, _ in found] == [f"derivative of {ERRORS[1]} and {ERRORS[0]}, gain"]
    one_axis = Signs({str(pallet.spots[0].site): {"overshoot": 1.0}})
    alone = list(evident(pallet.order, known, pallet.spots, one_axis))
    assert [operand.code for operand, _ in alone] == [f"derivative of {ERRORS[0]}, gain"]
