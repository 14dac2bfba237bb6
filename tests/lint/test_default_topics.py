"""A topic named by a default is known, and marked as a default."""

from __future__ import annotations

import pytest

from tests.lint.analysing import analysed

NODE = """\
import argparse, os, sys
import rospy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64

class Repeater(Node):
    def __init__(self):
        super().__init__("repeater")
        parser = argparse.ArgumentParser()
        parser.add_argument("--topic", default="/scan")
        parser.add_argument("-p", "--second-topic", default="/second")
        parser.add_argument("third", nargs="?", default="/third")
        args = parser.parse_args()
        some, rest = parser.parse_known_args()
        self.declare_parameter("declared", "cmd_vel")
        {before}
        self.pub = rospy.Publisher({name}, Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.heard)

    def heard(self, msg):
        self.pub.publish(msg.data)

rospy.init_node("repeater")
Repeater()
rospy.spin()
"""


def ends(directory, name, before="pass"):
    (flow,) = analysed(directory, node=NODE.format(name=name, before=before)).flows
    return flow.sink.topics, flow.sink.default_topics


@pytest.mark.parametrize(
    ("name", "topic"),
    [
        ('os.environ.get("X", "/cmd_vel")', "/cmd_vel"),
        ('os.getenv("X", default="/cmd_vel")', "/cmd_vel"),
        ('os.environ.setdefault("X", "/cmd_vel")', "/cmd_vel"),
        ('os.environ.get("X") or "/cmd_vel"', "/cmd_vel"),
        ('os.environ["X"] if "X" in os.environ else "/cmd_vel"', "/cmd_vel"),
        ('rospy.get_param("~topic", "cmd_vel")', "cmd_vel"),
        ('rospy.get_param_cached("~topic", "cmd_vel")', "cmd_vel"),
        ('rospy.get_param("~ns", "/a") + "/b"', "/a/b"),
        ('self.declare_parameter("topic", "cmd_vel").value', "cmd_vel"),
        ('self.get_parameter("declared").value', "cmd_vel"),
        ('self.get_parameter("declared").get_parameter_value().string_value', "cmd_vel"),
        ("args.topic", "/scan"),
        ("args.second_topic", "/second"),
        ("some.third", "/third"),
        ('sys.argv[1] if len(sys.argv) > 1 else "/scan"', "/scan"),
    ],
)
def test_the_default_in_the_code_names_the_topic(tmp_path, name, topic):
    assert ends(tmp_path, name) == ((topic,), (topic,))


@pytest.mark.parametrize(
    "name", ['os.environ["X"]', 'os.environ.get("X")', "sys.argv[1]", 'rospy.get_param("~t")']
)
def test_a_topic_name_without_a_default_is_unknown(tmp_path, name):
    assert ends(tmp_path, name) == ((), ())


def test_literal_topic_name_is_not_a_default(tmp_path):
    assert ends(tmp_path, '"cmd_vel"') == (("cmd_vel",), ())


def test_parameter_default_does_not_decide_a_condition(tmp_path):
    before = 'mode = os.environ.get("MODE", "a")\n        name = "x" if mode == "a" else "y"'
    assert ends(tmp_path, "name", before) == (("x", "y"), ())
