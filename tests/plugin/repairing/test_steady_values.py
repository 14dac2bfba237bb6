"""At values that do not vary, templates that can have no effect are not tried."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.patching.document import document
from pytest_tarl.patching.templates import templates
from pytest_tarl.repairing import typical_sizes
from pytest_tarl.repairing.mission_pairs import Recorded, signs
from pytest_tarl.repairing.steady_values import has_effect, is_constant
from pytest_tarl.repairing.template_forms import fitting
from pytest_tarl.repairing.template_places import spots
from tarl_lint.api import analyse

NODE = """\
import rospy
from geometry_msgs.msg import Twist

LEAST = 0.1


class Mower:
    def __init__(self):
        self.pace = rospy.get_param("~pace", 0.5)
        self.slack = rospy.get_param("~slack", 0.2)
        self.at = 0.0
        self.out = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("offset", Twist, self.on_offset)

    def on_offset(self, msg):
        turn = 2.0 * msg.angular.z
        turn += self.slack
        cmd = Twist()
        if msg.angular.z < 1.0:
            cmd.linear.x = self.pace
            cmd.linear.y = max(LEAST, 0.5 * self.pace)
        cmd.angular.z = turn
        self.out.publish(cmd)


if __name__ == "__main__":
    rospy.init_node("mower")
    Mower()
    rospy.spin()
"""
STATEFUL = {"low_pass", "median", "derivative", "integral", "rate_limit"}


@pytest.fixture
def order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    (tmp_path / "mower.py").write_text(NODE)
    monkeypatch.setattr(
        typical_sizes, "_recorded", lambda order, _: dict.fromkeys(map(str, sites(order)), 1.0)
    )
    return SimpleNamespace(
        analysis=analyse([tmp_path / "mower.py"], root=tmp_path),
        root=tmp_path,
        comparison=SimpleNamespace(culprits=(), sensors=()),
        online=SimpleNamespace(recorded=SimpleNamespace(sample=None)),
        fixture=SimpleNamespace(sample=None),
    )


def sites(order: Any) -> list[Any]:
    return [step.site for step in order.analysis.sites]


def site(order: Any, text: str) -> str:
    (found,) = {str(one) for one in sites(order) if one.text.startswith(text)}
    return found


def tried(order: Any, code: str, steady: tuple[str, ...] = ()) -> set[str]:
    """Return the templates that are tried at the expression with this code."""
    found = list(spots(order, steady=steady))
    (spot,) = [one for one in found if one.source.source(one.node) == code]
    return {one.name for one in templates(order.root) if one.on != "field" and spot in fitting(one, found)}


def test_constant_gets_only_templates_beyond_another_value(order: Any) -> None:
    assert "rate_limit" in tried(order, "self.pace")  # a soft start
    assert tried(order, "self.pace") & STATEFUL == {"rate_limit"}
    assert not tried(order, "self.pace") & {"gain", "offset", "dead_band", "at_least"}
    assert tried(order, "max(LEAST, 0.5 * self.pace)").isdisjoint({"low_pass", "at_most", "limit"})


def test_constant_added_to_a_variable_gets_no_stateful_template(order: Any) -> None:
    assert not tried(order, "self.slack") & STATEFUL


def test_value_that_never_varied_gets_no_first_value_template(order: Any) -> None:
    assert tried(order, "2.0 * msg.angular.z") >= STATEFUL
    still = tried(order, "2.0 * msg.angular.z", (site(order, "turn = 2.0"),))
    assert still & STATEFUL == {"integral", "rate_limit"}
    assert {"at_most", "limit"} <= still


@pytest.mark.parametrize(
    ("code", "constant"),
    [
        ("LEAST", True),
        ("-LEAST / 2.0", True),
        ("max(LEAST, min(1.0, LEAST))", True),
        ("LEAST * gap", False),
        ("read(LEAST)", False),
        ("LEAST if gap else 2.0", False),
    ],
)
def test_an_expression_is_constant_if_all_its_parts_are(code: str, constant: bool) -> None:
    source = document("node.py", f"x = {code}\n")
    assert is_constant(source, source.tree.body[0].value, {"LEAST"}) is constant  # type: ignore[attr-defined]


def test_sensor_templates_are_always_tried() -> None:
    known = {one.name: one for one in templates(Path())}
    assert all(has_effect(known[name], True, True, True) for name in ("sign", "term", "scale", "power"))
    assert not has_effect(known["gain"], True, True, False)
    assert has_effect(known["gain"], False, True, False)


def test_steady_value_never_varies_within_a_mission(order: Any) -> None:
    places = plan(order.analysis).places
    number = {place.id: at for at, place in enumerate(places)}
    pace, turn = number[site(order, "cmd.linear.x")], number[site(order, "turn = 2.0")]

    def mission(paces: tuple[float, ...], turns: tuple[float, ...]) -> Trace:
        here = [(pace, one) for one in paces] + [(turn, one) for one in turns]
        steps, none = np.zeros(len(here), np.int32), np.full(len(here), -1, np.int32)
        at, flow = zip(*here, strict=True) if here else ((), ())
        return Trace((), np.array(at, np.int32), np.array(flow), none, steps, none[:1], np.zeros(1), {})

    def steady(*pairs: Recorded) -> set[str]:
        return {places[at].id for at in (pace, turn)} & signs(order, pairs).steady

    still, moving = mission((0.5, 0.5), (1.0, 1.0)), mission((0.6, 0.6), (1.0, 2.0))
    assert steady((still, still)) == {places[pace].id, places[turn].id}
    assert steady((still, moving)) == {places[pace].id}  # another value in the other world is still steady
    assert steady((moving, still)) == {places[pace].id}
    assert steady((mission((), (1.0,)), still)) == {
        places[turn].id
    }  # the designed mission says nothing of the pace
    assert steady((still, mission((), (1.0,)))) == {places[pace].id, places[turn].id}
