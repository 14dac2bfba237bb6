"""A test with four kinds of sensors, two nodes and two taint lists, from recording to verdict and region."""

from __future__ import annotations

import math

import pytest

from pytest_tarl.learning.fixture import load
from tests.plugin.tank import fixture_file, result

PLANNER = """
import rospy
from std_msgs.msg import Float64, String

rospy.init_node("planner")
wanted = rospy.Publisher("/wanted", Float64, queue_size=1)

def on_level(msg):
    missing = 1.0 - msg.data
    wanted.publish(2.0 * missing)

rospy.Subscriber("/level", Float64, on_level)
rospy.spin()
"""
MOTOR = """
import rospy
from std_msgs.msg import Float64

rospy.init_node("motor")
valve = rospy.Publisher("/valve", Float64, queue_size=1)

def on_wanted(msg):
    turned = 0.5 * msg.data
    valve.publish(turned)

rospy.Subscriber("/wanted", Float64, on_wanted)
rospy.spin()
"""
TEST = """
import pytest
from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64, String = message_type("std_msgs/msg/Float64"), message_type("std_msgs/msg/String")
Vector = message_type("geometry_msgs/msg/Vector3")


@pytest.mark.tarl(
    nodes=["planner.py", "motor.py"],
    sensors=[
        Sensor("level", topic="/level", field="data", bins=4),
        Sensor("weather", topic="/weather", field="data", categories=("dry", "wet")),
        Sensor("heading", topic="/wind", field="x", bins=8, angle=True),
        Sensor("strong", topic="/wind", field=lambda wind: wind.y > 0.5),
    ],
    drifts={"leak": 0.6},
    episodes=20,
)
def test_fills(tarl, tarl_drift):
    draws = tarl.rng("world")
    level, weather = float(draws.uniform(0.0, 0.2)), "dry"
    tarl.start("planner.py")
    tarl.start("motor.py")
    for step in range(30):
        weather = "wet" if step >= 18 else "dry"
        tarl.bus.publish("/weather", String(data=weather))
        tarl.bus.publish("/wind", Vector(x=float(draws.uniform(-9.0, 9.0)), y=float(draws.uniform(0.0, 1.0)), z=0.0))
        tarl.bus.publish("/level", Float64(data=level))
        tarl.step(0.1)
        level += 0.3 * tarl.bus.latest("/valve").data
        if tarl_drift is not None and weather == "wet":
            level -= tarl_drift * 0.3
        tarl.reward(-abs(1.0 - level))
"""


@pytest.fixture
def project(tank: pytest.Pytester) -> pytest.Pytester:
    for file in tank.path.glob("*.py"):
        file.unlink()
    tank.makefile(".py", planner=PLANNER, motor=MOTOR, test_several=TEST)
    return tank


def test_test_with_four_sensors_is_recorded_and_compared(
    project: pytest.Pytester,
) -> None:
    project.runpytest("--tarl-record").assert_outcomes(passed=1)
    fixture = load(fixture_file(project))
    assert [one.name for one in fixture.lists] == ["/level → /wanted", "/wanted → /valve"]
    assert all(one.visits.count.size for one in fixture.sample.lists)
    level, weather, heading, strong = fixture.sensors
    assert len(level.edges) == 5
    assert (heading.low, heading.high) == (-math.pi, math.pi)
    assert (strong.field, strong.guardable, weather.guardable) == ("<lambda>()", False, True)
    possible = (4 + 2) * 2 * 8 * 2
    assert 16 < len(fixture.sample.cells) < possible  # only visited cells are stored, not all combinations

    told = project.runpytest("--tarl-online", "--tarl-episodes=20")
    told.assert_outcomes(failed=1)
    found = result(project)
    assert found["verdict"]["result"] == "degraded"
    assert found["region"]
    assert all(box["weather"] == ["wet", "wet"] for box in (*found["region"], *found["novel"]))
    told.stdout.fnmatch_lines(["*where*weather wet*"])
    assert {site["path"] for site in found["sites"]} == {"planner.py", "motor.py"}


def test_workers_agree_with_sensors_of_every_kind(project: pytest.Pytester) -> None:
    project.runpytest("--tarl-record", "--tarl-episodes=6").assert_outcomes(passed=1)
    here = fixture_file(project).read_bytes()
    project.runpytest("--tarl-record", "--tarl-episodes=6", "--tarl-workers=2").assert_outcomes(passed=1)
    assert fixture_file(project).read_bytes() == here
