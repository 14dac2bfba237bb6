"""Names mean the same constant in a file, a class or a function."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.repairing.name_scopes import name_scope
from pytest_tarl.searching.units import units, whole_constants
from tarl_lint.api import analyse
from tarl_lint.model import Operand, SiteId, Span

NODE = """\
import math
import rospy
import gains
from std_msgs.msg import Float64

YAW, dt = 0.785, 0.1


class Filter:
    def __init__(self, share):
        self.share = share

    def update(self, value, dt):
        return self.share * value * dt + dt + self.share


class Turner:
    def __init__(self):
        self.share = 0.25
        self.filter = Filter(self.share)
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_in)

    def on_in(self, msg):
        turned = math.cos(YAW) * msg.data + gains.KP
        turned += YAW * self.share * gains.KP
        self.out.publish(self.filter.update(turned, dt))


if __name__ == "__main__":
    rospy.init_node("turner")
    Turner()
    rospy.spin()
"""


def test_uses_are_combined_within_one_scope(tmp_path: Path) -> None:
    (tmp_path / "turner.py").write_text(NODE)
    (tmp_path / "gains.py").write_text("KP = 1.5\n")
    analysis = analyse([tmp_path / "turner.py", tmp_path / "gains.py"], root=tmp_path)
    used = [one for step in analysis.sites for one in analysis.operands(step.site)]
    found = {
        (unit.operands[0].code, tuple(one.span.line for one in unit.operands))
        for unit in whole_constants(units(used), name_scope(analysis))
    }
    assert ("YAW", (25, 26)) in found
    assert ("gains.KP", (25, 26)) in found
    assert ("dt", (14, 14)) in found  # the argument in line 27 is another name for the same number
    assert ("dt", (27,)) in found
    assert ("self.share", (14, 14)) in found
    assert ("self.share", (26,)) in found


def scopes(text: str) -> Callable[[str, str], str]:
    """Return a function that names the scope of an operand's code in a function of a file with this text."""
    analysis: Any = SimpleNamespace(sources={"node.py": text})
    scope = name_scope(analysis)

    def of(code: str, qualname: str, path: str = "node.py") -> str:
        span = Span(path, 1, 1, 1, 2)
        return scope(Operand(SiteId("node", qualname, "x = 1"), span, code, 1.0, span))

    return of


@pytest.mark.parametrize(
    ("text", "code", "expected"),
    [
        ("GAIN = 2.0\n", "GAIN", ""),
        ("GAIN = 2.0\n", "GAIN * 2", ""),
        ("GAIN = 2.0\n", "OTHER", "Node.run"),
        ("GAIN = 2.0\n", "GAINS", "Node.run"),
        ("GAIN, BIAS = 2.0, 1.0\n", "BIAS", ""),
        ("if True:\n    GAIN = 2.0\n", "GAIN", ""),
        ("class Gains:\n    KP = 1.0\n", "KP", ""),
        ("import gains\n", "gains.KP", ""),
        ("import robot.gains\n", "robot.gains.KP", ""),
        ("import robot.gains as g\n", "g.KP", ""),
        ("import robot.gains as g\n", "robot.gains.KP", "Node.run"),
        ("from gains import KP\n", "KP", ""),
        ("from gains import KP as gain\n", "gain", ""),
        ("from gains import KP as gain\n", "KP", "Node.run"),
        # a function binds the same name
        ("GAIN = 2.0\ndef f(GAIN):\n    pass\n", "GAIN", "Node.run"),
        ("GAIN = 2.0\nasync def f(*GAIN):\n    pass\n", "GAIN", "Node.run"),
        ("GAIN = 2.0\ndef f():\n    return lambda GAIN: 1\n", "GAIN", "Node.run"),
        ("GAIN = 2.0\ndef f():\n    if True:\n        GAIN = 3.0\n", "GAIN", "Node.run"),
        ("GAIN = 2.0\ndef f():\n    import robot as GAIN\n", "GAIN", "Node.run"),
        ("GAIN = 2.0\ndef f():\n    print(GAIN)\n", "GAIN", ""),
        ("GAIN = 2.0\n", "0.5", "Node.run"),
        ("GAIN = 2.0\n", "-GAIN", "Node.run"),
        ("", "self.kp", "Node"),
        ("self = 1\n", "self.kp", "Node"),
        ("selfish = 1\n", "selfish", ""),
    ],
)
def test_scope_of_a_name_is_the_file_class_or_function(text: str, code: str, expected: str) -> None:
    assert scopes(text)(code, "Node.run") == expected


def test_scope_of_self_is_the_class() -> None:
    of = scopes("GAIN = 2.0\n")
    assert of("self.kp", "Outer.Inner.run") == "Outer.Inner"
    assert of("self.kp", "run") == ""
    assert of("kp", "run") == "run"


def test_each_file_has_names_of_its_own() -> None:
    analysis: Any = SimpleNamespace(sources={"one.py": "A = 1\n", "other.py": "B = 1\n"})
    scope = name_scope(analysis)

    def of(path: str, code: str) -> str:
        span = Span(path, 1, 1, 1, 2)
        return scope(Operand(SiteId("node", "run", "x = 1"), span, code, 1.0, span))

    assert [of(path, code) for path in ("one.py", "other.py", "none.py") for code in "AB"] == [
        "",
        "run",
        "run",
        "",
        "run",
        "run",
    ]
