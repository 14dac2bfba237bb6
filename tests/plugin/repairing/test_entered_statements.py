"""Statements that only designed missions run, until a change lets a drifted mission enter them."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.repairing.entered_statements import entered
from tarl_lint.api import analyse

CLIMBER = """\
import rospy
from std_msgs.msg import Float64

FLOOR, STEP, TOP = 0.25, 0.5, 0.3


def on_pitch(msg):
    if msg.data < 0.1:
        out.publish(Float64(data=FLOOR * msg.data))
    elif msg.data < 0.4:
        out.publish(Float64(data=STEP * msg.data))
    else:
        out.publish(Float64(data=TOP * msg.data))


rospy.init_node("climber")
out = rospy.Publisher("/out", Float64, queue_size=1)
rospy.Subscriber("/pitch", Float64, on_pitch)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("designed", "drifted", "changed", "expected"),
    [
        (("FLOOR", "STEP", "TOP"), ("FLOOR",), ("FLOOR", "STEP"), ["STEP"]),
        (("FLOOR", "STEP", "TOP"), ("FLOOR",), ("FLOOR", "TOP", "STEP"), ["TOP", "STEP"]),  # in its order
        (("FLOOR", "STEP"), ("FLOOR",), ("FLOOR", "TOP"), []),  # an emergency, which no designed mission has
        (("FLOOR", "STEP"), ("FLOOR",), ("FLOOR", "FLOOR"), []),  # it only waits
        (("FLOOR", "STEP"), ("FLOOR", "STEP"), ("FLOOR", "STEP"), []),
    ],
)
def test_the_constants_of_entered_statements_are_listed(
    designed: tuple[str, ...],
    drifted: tuple[str, ...],
    changed: tuple[str, ...],
    expected: list[str],
    tmp_path: Path,
) -> None:
    (tmp_path / "climber.py").write_text(CLIMBER)
    analysis = analyse([tmp_path / "climber.py"], root=tmp_path)
    numbers = {
        name: number
        for number, place in enumerate(plan(analysis).places)
        for name in ("FLOOR", "STEP", "TOP")
        if f"{name} *" in place.id
    }

    def trace(names: tuple[str, ...]) -> Any:
        return SimpleNamespace(site=np.array([numbers[one] for one in names], np.int32))

    order: Any = SimpleNamespace(analysis=analysis)
    found = entered(order, [(trace(designed), trace(drifted))], trace(changed))
    assert [one.code for one in found] == expected
