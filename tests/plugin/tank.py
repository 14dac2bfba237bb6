"""A small project for tests of the plugin: a node that keeps a tank's level, and a simulation test of it."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pytest_tarl.learning.fixture import HEADER

RECORD = ("--tarl-record", "--tarl-episodes=16")
ONLINE = ("--tarl-online", "--tarl-episodes=12")

NODE = """\
import rospy
from std_msgs.msg import Float64

GAIN = 2.0
level = None


def on_level(msg):
    global level
    level = msg.data


def main():
    rospy.init_node("keeper")
    rospy.Subscriber("/level", Float64, on_level)
    valve = rospy.Publisher("/valve", Float64, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        if level is not None:
            missing = 1.0 - level
            flow = GAIN * missing
            valve.publish(flow)
        rate.sleep()


if __name__ == "__main__":
    main()
"""

TEST = """\
import pytest
from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")


@pytest.mark.tarl(
    nodes=["keeper.py"],
    sensors=[Sensor("level", topic="/level", field="data", low=0, high=1, bins=10)],
    drifts={"clogged": 0.25},
    episodes=30,
    min_success=0.9,
)
def test_fills(tarl, tarl_drift):
    draws = tarl.rng("world")
    level, pump = float(draws.uniform(0.0, 0.2)), 1.0 if tarl_drift is None else tarl_drift
    tarl.start("keeper.py")
    for _ in range(25):
        tarl.bus.publish("/level", Float64(data=level + float(draws.normal(0, 0.005))))
        tarl.step(0.1)
        valve = tarl.bus.latest("/valve")
        level += 0.1 * pump * (valve.data if valve else 0.0)
        tarl.reward(-abs(1.0 - level))
    assert abs(1.0 - level) < 0.1, "tank not full"


def test_ordinary():
    pass
"""


def changed(tank: pytest.Pytester, name: str, old: str, new: str) -> None:
    """Replace some of a file's text."""
    path = tank.path / f"{name}.py"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def fixture_file(tank: pytest.Pytester) -> Path:
    """Return the path of the only recording."""
    (found,) = (tank.path / ".tarl" / "utility").glob("*.npz")
    return found


def columns_of(fixture: bytes) -> dict[str, list[object]]:
    """Return the recorded columns without the header, because the header contains a digest of the test's modules."""
    with np.load(io.BytesIO(fixture), allow_pickle=False) as arrays:
        return {name: arrays[name].tolist() for name in arrays.files if name != HEADER}


def result(tank: pytest.Pytester) -> dict[str, Any]:
    """Return the only JSON result."""
    (path,) = (tank.path / ".tarl" / "results").glob("*.json")
    found: dict[str, Any] = json.loads(path.read_text())
    return found
