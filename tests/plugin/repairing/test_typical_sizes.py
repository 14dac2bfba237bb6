"""Start values of structural changes at expressions whose value was not recorded."""

from __future__ import annotations

import ast
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.repairing import typical_sizes
from pytest_tarl.repairing.template_places import spots
from pytest_tarl.repairing.typical_sizes import TypicalSizes
from tarl_lint.api import analyse

NODE = """\
import rospy
from std_msgs.msg import Float64

SOFT = 70.0
left = 0.0


def on_scale(msg):
    global left
    left = 500.0 - msg.data


def main():
    rospy.init_node("tap")
    rospy.Subscriber("/scale", Float64, on_scale)
    valve = rospy.Publisher("/valve", Float64, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        valve.publish(left / SOFT)
        rate.sleep()


if __name__ == "__main__":
    main()
"""


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("left / SOFT", 2.0),
        ("-left / SOFT", 2.0),
        ("SOFT * 2.0", 140.0),
        ("left - 3.0", 140.0),
        ("min(1.0, left)", 140.0),
        ("unknown / SOFT", 1.0),
        ("unknown", 1.0),
    ],
)
def test_typical_expression_size_comes_from_recorded_parts(
    text: str, size: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tap.py").write_text(NODE)
    analysis = analyse([tmp_path / "tap.py"], root=tmp_path)
    recorded = {str(step.site): 140.0 for step in analysis.sites if step.code.startswith("left =")}
    assert recorded
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: recorded)
    order: Any = SimpleNamespace(analysis=analysis)
    (site,) = (step.site for step in analysis.sites if "publish" in step.code)
    assert TypicalSizes(order).of(site, ast.parse(text, mode="eval").body) == pytest.approx(size)


@pytest.mark.parametrize(("drifted", "larger"), [(700.0, 10.0), (14.0, 2.0)])
def test_typical_size_is_the_larger_of_both_worlds(
    drifted: float, larger: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tap.py").write_text(NODE)
    analysis = analyse([tmp_path / "tap.py"], root=tmp_path)
    (left,) = (str(step.site) for step in analysis.sites if step.code.startswith("left ="))
    monkeypatch.setattr(typical_sizes, "_recorded", lambda _, world: {left: drifted if world else 140.0})
    order: Any = SimpleNamespace(
        analysis=analysis,
        comparison=SimpleNamespace(culprits=()),
        online=SimpleNamespace(recorded=SimpleNamespace(sample="drifted")),
    )
    (spot,) = (one for one in spots(order) if ast.unparse(one.node) == "left / SOFT")
    assert (spot.typical, spot.larger) == (2.0, larger)
