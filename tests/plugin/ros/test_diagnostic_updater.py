"""Nodes that report diagnostics. Texts and values are those of diagnostic_updater 1.11 on a real ROS 1."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.errors import UnsupportedApiError
from tests.plugin.ros.conftest import Start, heard

ROSPY = """
import rospy
from std_msgs.msg import Header
import diagnostic_updater as DIAG
rospy.init_node("driver")
updater = DIAG.Updater()
OK, WARN, ERROR = DIAG.OK, DIAG.WARN, DIAG.ERROR
number = int
def spin():
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        work()
        updater.update()
        rate.sleep()
stamp = lambda age: rospy.Time.now() - rospy.Duration(age)
"""
RCLPY = """
import rclpy
from rclpy.duration import Duration
import diagnostic_updater as DIAG
from diagnostic_msgs.msg import DiagnosticStatus
rclpy.init()
node = rclpy.create_node("driver")
updater = DIAG.Updater(node)
OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
number = lambda level: level[0]
def spin():
    node.create_timer(0.1, lambda: work())
    rclpy.spin(node)
stamp = lambda age: (node.get_clock().now() + Duration(seconds=-age)).to_msg()
"""
TASKS = """
updater.setHardwareID("arm 7")
def motor(stat):
    stat.summary(WARN, "warm")
    stat.mergeSummary(ERROR, "slow")
    stat.mergeSummary(OK, "ignored")
    stat.add("temperature", 61.5)
    return stat
class Battery(DIAG.DiagnosticTask):
    def run(self, stat):
        stat.summary(OK, "full")
        return stat
updater.add("motor", motor)
updater.add(Battery("battery"))
both = DIAG.CompositeDiagnosticTask("both")
both.addTask(DIAG.FunctionDiagnosticTask("motor", motor))
both.addTask(DIAG.Heartbeat())
updater.add(both)
work = lambda: None
"""
CHECKS = """
bounds = DIAG.FrequencyStatusParam({"min": 5, "max": 5}, 0.1, 2)
topic = DIAG.TopicDiagnostic("scan", updater, bounds, DIAG.TimeStampStatusParam(-1, 1))
work = lambda: topic.tick(stamp(-2.0))
"""


@pytest.fixture(params=[ROSPY, RCLPY], ids=["rospy", "rclpy"])
def head(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def level(status: Any) -> int:
    return int(status.level[0] if isinstance(status.level, bytes) else status.level)


def test_tasks_are_announced_and_then_published_once_a_second(head: str, start: Start) -> None:
    ros = start("")
    arrays = heard(ros, "/diagnostics")
    start(head + TASKS + "spin()", ros=ros)
    ros.step(3.5)
    assert [[one.name for one in array.status] for array in arrays[:3]] == [
        ["driver: motor"], ["driver: battery"], ["driver: both"]
    ]  # fmt: skip
    assert {array.status[0].message for array in arrays[:3]} == {"Node starting up"}
    assert len(arrays) == 6
    motor, battery, both = arrays[-1].status
    assert (level(motor), motor.message, motor.hardware_id) == (2, "warm; slow", "arm 7")
    assert [(pair.key, pair.value) for pair in motor.values] == [("temperature", "61.5")]
    assert (level(battery), battery.message) == (0, "full")
    assert level(both) == 2


def test_topic_is_checked_for_frequency_and_age(head: str, start: Start) -> None:
    ros = start("")
    arrays = heard(ros, "/diagnostics")
    start(head + CHECKS + "spin()", ros=ros)
    ros.step(4.05)
    status = arrays[-1].status[0]
    values = {pair.key: pair.value for pair in status.values}
    assert status.name == "driver: scan topic status"
    assert (level(status), status.message) == (2, "Frequency too high.; Timestamps too far in future seen.")
    assert float(values["Actual frequency (Hz)"]) == pytest.approx(10, abs=1)
    assert values["Target frequency (Hz)"] == "5.000000"
    assert values["Minimum acceptable frequency (Hz)"] == "4.500000"
    assert values["Earliest acceptable timestamp delay:"] == "-1.000000"
    assert float(values["Latest timestamp delay:"]) == pytest.approx(-2.0, abs=1e-6)


def test_a_missing_name_is_reported(start: Start) -> None:
    with pytest.raises(
        UnsupportedApiError, match=r"diagnostic_updater\.Nothing is not in the in-process ROS"
    ):
        start("import rospy\nimport diagnostic_updater\ndiagnostic_updater.Nothing").raise_failure()
