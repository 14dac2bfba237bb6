"""What a user does with an interactive marker arrives at the callbacks of the server, as messages of a topic."""

from __future__ import annotations

import pytest

from tarl_lint import engine
from tarl_lint.model import Flow
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

ROS_2 = """
import rclpy
from interactive_markers import InteractiveMarkerServer, MenuHandler
from rclpy.node import Node
from std_msgs.msg import Float64
from visualization_msgs.msg import InteractiveMarker


class Arm(Node):
    def __init__(self):
        super().__init__("arm")
        self.goal = 0.0
        self.out = self.create_publisher(Float64, "out", 1)
        self.server = InteractiveMarkerServer(self, "hand")
        self.menu = MenuHandler()
        marker = InteractiveMarker()
        {registration}
        self.server.applyChanges()
        self.create_timer(0.1, self.on_timer)

    def on_feedback(self, feedback):
        self.goal = feedback.pose.position.x

    def on_timer(self):
        self.out.publish(Float64(data=self.goal))


rclpy.init()
rclpy.spin(Arm())
"""
ROS_1 = """
import rospy
from interactive_markers.interactive_marker_server import InteractiveMarkerServer
from std_msgs.msg import Float64
from visualization_msgs.msg import InteractiveMarker


def on_feedback(feedback):
    out.publish(feedback.pose.position.x)


rospy.init_node("arm")
out = rospy.Publisher("out", Float64, queue_size=1)
server = InteractiveMarkerServer("hand")
marker = InteractiveMarker()
{registration}
server.applyChanges()
rospy.spin()
"""
FEEDBACK = (("hand/feedback",), "InteractiveMarkerFeedback")


def flows(source: str) -> list[Flow]:
    module = parse("arm.py", source.encode(), "arm")
    assert isinstance(module, Module)
    return list(engine.analyse([module], Config()))


@pytest.mark.parametrize(
    ("node", "registration"),
    [
        (ROS_2, "self.server.insert(marker, feedback_callback=self.on_feedback)"),
        (ROS_2, "self.server.insert(marker); self.server.setCallback('grip', self.on_feedback)"),
        (ROS_2, "self.server.insert(marker, feedback_callback=lambda feedback: self.on_feedback(feedback))"),
        (ROS_1, "server.insert(marker, on_feedback)"),
        (ROS_1, "server.insert(marker, feedback_cb=on_feedback)"),
        (ROS_1, "server.insert(marker)\nserver.setCallback('grip', on_feedback)"),
    ],
)
def test_marker_feedback_reaches_the_messages_of_its_callback(node: str, registration: str) -> None:
    (flow,) = flows(node.replace("{registration}", registration))
    assert flow.kind == "explicit"
    assert (flow.source.topics, flow.source.type) == FEEDBACK
    assert flow.sink.topics == ("out",)


def test_feedback_on_a_menu_entry_has_no_known_topic() -> None:
    (flow,) = flows(ROS_2.replace("{registration}", "self.menu.insert('home', callback=self.on_feedback)"))
    assert (flow.source.topics, flow.source.type) == ((), "InteractiveMarkerFeedback")


@pytest.mark.parametrize("registration", ["self.server.insert(marker)", "[].insert(0, self.on_feedback)"])
def test_a_marker_without_a_callback_gives_no_flow(registration: str) -> None:
    assert flows(ROS_2.replace("{registration}", registration)) == []
