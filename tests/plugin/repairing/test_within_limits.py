"""The expression that a clamp limits, as the place of a correction."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.document import document
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.repairing import template_forms, template_places
from pytest_tarl.repairing.template_forms import _inside, forms
from pytest_tarl.repairing.template_places import Spot, spots
from pytest_tarl.repairing.within_limits import within_limits
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.sensors import Sensor
from tarl_lint.api import Analysis, analyse
from tarl_lint.model import Operand

HELPERS = """\
def push(error):
    return max(-top, min(top, gain * error))

def always(error):
    return min(top, gain * other)

def two(error, speed):
    return min(top, gain * error)

def apart(error):
    if error > 0:
        return min(top, error)
    return max(-top, error)

def free(error):
    return gain * error

def round_about(error):
    return min(top, round_about(error))

x = """


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("max(-top, min(top, gain * error))", "gain * error"),
        ("min(max(gain * error, -1.0), 1.0)", "gain * error"),
        ("max(0.0, error)", "error"),
        ("np.clip(gain * error, -1, 1)", "gain * error"),
        ("clamp(error, -top, top)", "error"),
        ("-min(top, error)", "error"),
        ("mass * min(top, error)", "error"),
        ("min(top, error) / mass", "error"),
        ("mass * push(error)", "error"),
        ("clamp(mass * push(error + 1), -1, 1)", "error + 1"),
        ("round_about(error)", "error"),
        ("mass / min(top, error)", None),  # the limited value divides
        (
            "other * min(top, error)",
            None,
        ),  # no constant factor: the correction would vary with the other factor
        ("min(error, other)", None),  # neither is a limit
        ("min(top, 1.0)", None),  # both are
        ("clip(top, 0, error)", None),
        ("min(top, error, other)", None),
        ("clamp(error)", None),
        ("min(top, error, key=abs)", None),
        ("min(values)", None),
        ("push(top)", None),
        ("push(*error)", None),
        ("push(error, 1)", None),
        ("always(error)", None),
        ("two(error)", None),
        ("apart(error)", None),
        ("free(error)", None),
        ("unknown(error)", None),
        ("gain * error", None),
        ("error", None),
    ],
)
def test_the_limited_expression_does_not_count_as_the_limit(code: str, expected: str | None) -> None:
    source = document("a.py", HELPERS + code + "\n")
    node = source.tree.body[-1].value  # type: ignore[attr-defined]
    found = within_limits(source, node, {"top", "gain", "mass"})
    assert (None if found is None else source.source(found)) == expected


NODE = """\
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

TOP = 0.5
MASS = 240.0


def push(error):
    return max(-TOP, min(TOP, 0.45 * error))


class Pallet:
    def __init__(self):
        self.pub = rospy.Publisher("/push", Twist, queue_size=1)
        rospy.Subscriber("/odom", Odometry, self.on_odom)

    def on_odom(self, msg):
        ex = 1.0 - msg.pose.pose.position.x
        ey = 1.0 - msg.pose.pose.position.y
        out = Twist()
        out.linear.x = MASS * push(ex)
        out.linear.y = MASS * push(ey)
        self.pub.publish(out)


rospy.init_node("pallet")
Pallet()
rospy.spin()
"""
SPEED = Sensor("speed", topic="/odom", field="twist.twist.linear.x", low=-1.0, high=1.0, bins=4)


def patched(analysis: Analysis, operand: Operand, form: Form) -> str:
    mutation = Mutation(operand, 1.0, form=form)
    (text,) = rewrite(analysis, (mutation,), ALWAYS, {"/odom": "nav_msgs/msg/Odometry"}).values()
    return text


class Sizes:
    """Usual sizes: 3 for `ex`, 2 for `ey`, and 100 for whole expressions."""

    by_site: dict[str, float] = {}  # noqa: RUF012
    returned: dict[str, float] = {}  # noqa: RUF012

    def __init__(self, *_: object) -> None:
        pass

    def of(self, _site: object, _node: ast.expr) -> float:
        return 100.0

    def known(self, _site: object, node: ast.expr) -> float | None:
        return {"ex": 3.0, "ey": 2.0}.get(ast.unparse(node))


def test_sensor_term_is_added_before_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "pallet.py").write_text(NODE)
    analysis = analyse([tmp_path / "pallet.py"], root=tmp_path)
    monkeypatch.setattr(template_forms, "usual", lambda *_: 0.5)
    monkeypatch.setattr(template_places, "TypicalSizes", Sizes)
    comparison = SimpleNamespace(sensors=(SPEED,), culprits=())
    online = SimpleNamespace(recorded=SimpleNamespace(sample=None))
    order: Any = SimpleNamespace(analysis=analysis, comparison=comparison, online=online)
    sent = [spot for spot in spots(order) if "push(" in spot.source.source(spot.node)]
    assert sorted(spot.within.typical for spot in sent if spot.within is not None) == [2.0, 3.0]
    made = template(SHIPPED / "term.toml")
    (one, alone), (both, twin) = (each[0] for each in forms(order, made, sent))
    assert {alone.defaults, twin.defaults} == {(("gain", -3.0),), (("gain", -2.0),)}  # -0.5 · size / 0.5
    text = patched(analysis, both, twin)
    gain = dict(twin.defaults)["gain"]
    assert f"MASS * push(ex - {-gain} * msg.twist.twist.linear.x)" in text
    assert f"MASS * push(ey - {-gain} * msg.twist.twist.linear.y)" in text
    assert patched(analysis, one, alone).count("twist.twist") == 1
    # other templates change the whole value
    (whole, _) = next(iter(forms(order, template(SHIPPED / "scale.toml"), sent)))[0]
    assert whole.code.startswith("scale by speed of MASS * push(e")


def test_term_of_unknown_size_is_added_to_the_whole_value() -> None:
    source: Any = document("a.py", "def f(ex, ey):\n    a = min(1.0, ex)\n    b = min(1.0, ey)\n")
    first, second = (one for one in source.expressions.values() if isinstance(one, ast.Call))
    site: Any = SimpleNamespace()
    one, other = (Spot(site, source, node, "value", 1.0, 1.0, 1, True) for node in (first, second))
    inner = replace(one, node=first.args[1])
    known = replace(one, within=inner)
    assert _inside(one, None) == (one, None)
    assert _inside(known, None) == (inner, None)
    assert _inside(known, other) == (known, other)  # both axes change alike
    assert _inside(known, known) == (inner, inner)
