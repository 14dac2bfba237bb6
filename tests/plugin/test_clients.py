"""Nodes whose only output is a request to a service or a goal of an action."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from pytest_tarl.instrumentation.sites import plan
from tarl_lint.api import analyse
from tests.plugin.tank import RECORD

VALVE = """\
import rospy
from std_msgs.msg import Float64
from std_srvs.srv import SetBool


def heard(message):
    valve(message.data > 3.0)


rospy.init_node("keeper")
valve = rospy.ServiceProxy("valve", SetBool)
rospy.Subscriber("level", Float64, heard)
rospy.spin()
"""
TANK = """\
import pytest
from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64, SetBool = message_type("std_msgs/Float64"), message_type("std_srvs/SetBool")


@pytest.mark.tarl(
    nodes=["valve.py"],
    sensors=[Sensor("level", topic="/level", field="data", low=0, high=8, bins=8)],
    drifts={"rain": 0.5},
    episodes=20,
)
def test_never_full(tarl, tarl_drift):
    level, drawn = 2.0, []
    tarl.bus.serve("/valve", SetBool, lambda request: drawn.append(request.data) or SetBool._response_class())
    tarl.start("valve.py")
    for _ in range(30):
        tarl.bus.publish("/level", Float64(data=level))
        tarl.step(0.1)
        level += tarl.rng("rain").uniform(0.1, 0.3) + (tarl_drift or 0.0) - (0.4 if drawn[-1] else 0.0)
        tarl.reward(-abs(level - 3.0))
        assert level < 6
"""
SENDERS = {
    "goal of ROS 1": """
        import actionlib, rospy
        from control_msgs.msg import PointHeadAction, PointHeadGoal
        from std_msgs.msg import Float64

        def heard(message):
            goal = PointHeadGoal()
            goal.target.point.x = message.data
            client.send_goal(goal)

        rospy.init_node("head")
        client = actionlib.SimpleActionClient("out", PointHeadAction)
        rospy.Subscriber("in", Float64, heard)
        rospy.spin()
    """,
    "request and goal of ROS 2": """
        import rclpy
        from nav2_msgs.action import NavigateToPose
        from rclpy.action import ActionClient
        from rclpy.node import Node
        from std_msgs.msg import Float64
        from std_srvs.srv import SetBool

        class Pilot(Node):
            def __init__(self):
                super().__init__("pilot")
                self.lamp = self.create_client(SetBool, "lamp")
                self.drive = ActionClient(self, NavigateToPose, "out")
                self.create_subscription(Float64, "in", self.heard, 1)

            def heard(self, message):
                request = SetBool.Request()
                request.data = message.data > 3.0
                self.lamp.call_async(request)
                goal = NavigateToPose.Goal()
                goal.pose.pose.position.x = message.data
                self.drive.send_goal_async(goal)

        rclpy.init()
        rclpy.spin(Pilot())
    """,
}


def test_service_client_node_is_recorded_and_compared(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(valve=VALVE, test_tank=TANK)
    result = pytester.runpytest(*RECORD)
    result.assert_outcomes(passed=1)
    result = pytester.runpytest("--tarl-online")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*valve.py:7  valve(message.data > 3.0)*"])


def test_unserved_service_is_no_output(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        valve=VALVE.replace('    valve(', '    from contextlib import suppress\n    with suppress(Exception): valve('),
        test_tank=TANK.replace("    tarl.bus.serve", "    drawn.append(False)\n    lambda: tarl.bus.serve"),
    )  # fmt: skip
    result = pytester.runpytest(*RECORD)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*The node published nothing in the whole episode*"])


@pytest.mark.parametrize("source", SENDERS.values(), ids=SENDERS)
def test_goals_and_requests_end_flows_in_the_plugin(source: str, tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text(dedent(source))
    lists = plan(analyse([tmp_path / "node.py"], root=tmp_path, with_settings=True)).lists
    assert {"in → out"} <= {one.name for one in lists} <= {"in → out", "in → lamp"}
    assert not analyse([tmp_path / "node.py"], root=tmp_path).flows  # of tarl-lint without a launch file
