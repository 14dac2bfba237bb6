"""Log and print statements are not interpreted, unless they have another effect."""

import ast

import pytest

from tarl_lint.engine import analyse
from tarl_lint.ir.effect_free import only_tells
from tarl_lint.read.source import parse
from tarl_lint.settings.config import Config

NODE = """
import rospy
from std_msgs.msg import Float64

pub = rospy.Publisher("/out", Float64, queue_size=1)

def send(value):
    pub.publish(Float64(value))
    return value

{own}

def heard(msg):
    {statement}

rospy.Subscriber("/in", Float64, heard)
"""


def flows(statement: str, own: str = "") -> int:
    module = parse("node.py", NODE.format(statement=statement, own=own).encode(), "node")
    return len(analyse([module], Config()))


@pytest.mark.parametrize(
    "text",
    [
        "print(msg.data, len(msg.data), file=sys.stderr)",
        "rospy.loginfo('%.2f of %s' % (msg.x, str(msg.y)))",
        "rospy.logwarn_throttle(5, f'{round(a)!r}')",
        "self.get_logger().info('{}'.format(self.x))",
        "rclpy.logging.get_logger('a').error(','.join(str(a) for a in b))",
    ],
)
def test_log_messages_that_format_values_are_effect_free(text):
    assert only_tells(ast.parse(text, mode="eval").body, prints=True)


@pytest.mark.parametrize(
    "text",
    [
        "print(send(msg.data))",
        "rospy.loginfo(self.update(msg))",
        "self.get_logger().info((x := msg.data))",
        "self.logger.info(msg.data)",
        "rospy.sleep(1)",
        "self.get_logger().set_level(10)",
        "print",
    ],
)
def test_log_statements_that_call_are_not_effect_free(text):
    assert not only_tells(ast.parse(text, mode="eval").body, prints=True)


def test_publishing_call_inside_a_log_message_is_analysed():
    assert flows("print(send(msg.data))") == 1
    assert flows("rospy.loginfo(send(msg.data))") == 1


def test_data_in_a_log_message_is_not_a_flow():
    assert flows("print(msg.data)") == flows("rospy.loginfo(msg.data)") == 0


@pytest.mark.parametrize("own", ["def print(value): send(value)", "print = send"])
def test_a_redefined_print_is_an_ordinary_function(own):
    assert flows("print(msg.data)", own) == 1
