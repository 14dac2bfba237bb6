"""Which functions and methods run although nothing in the files calls them."""

from __future__ import annotations

from textwrap import dedent

import pytest

from tests.lint.models.marked import differing

HEAD = """\
import rclpy, rospy, smach, threading
from rclpy.node import Node
from std_msgs.msg import Float64
import framework

last = 0.0
out = rospy.Publisher("out", Float64, queue_size=1)

def on(msg):
    global last
    last = msg.data

rospy.Subscriber("in", Float64, on)
"""


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(
            """
            class Work(threading.Thread):
                def run(self):
                    out.publish(last)  # data
                def other(self):
                    out.publish(last)  # clean
            Work().start()
            """,
            id="run of a thread",
        ),
        pytest.param(
            """
            class Plain:
                def run(self):
                    out.publish(last)  # clean
                def on_timer(self):
                    out.publish(last)  # clean
            Plain()
            """,
            id="no method of a plain class",
        ),
        pytest.param(
            """
            class Plugin(framework.Plugin):
                def step(self):
                    out.publish(last)  # data
                def _inner(self):
                    out.publish(last)  # clean
            Plugin()
            """,
            id="public methods of a framework's class",
        ),
        pytest.param(
            """
            class Nearby(Node):
                def __init__(self):
                    super().__init__("nearby")
                    self.create_subscription(Float64, "in", self.heard, 10)
                def heard(self, msg):
                    out.publish(msg.data)  # data
                def on_activate(self, state):
                    out.publish(last)  # data
                def unused(self):
                    out.publish(last)  # clean
            """,
            id="a node that nothing makes",
        ),
        pytest.param(
            """
            class Near(smach.State):
                def execute(self, userdata):
                    userdata.seen = last
                def on_outcome(self, value):
                    out.publish(value.seen)  # clean
            class Far(smach.State):
                def execute(self, userdata):
                    out.publish(userdata.seen)  # data
            Near(), Far()
            """,
            id="only execute gets the userdata of a state",
        ),
        pytest.param(
            """
            class Near(smach.State):
                def execute(self, userdata):
                    userdata.seen = last
            class Far(framework.State):
                def execute(self, value):
                    out.publish(value.seen)  # clean
            Near(), Far()
            """,
            id="no other class gets userdata",
        ),
        pytest.param(
            """
            def main():
                rospy.init_node("node")
                out.publish(last)  # data
            def other():
                out.publish(last)  # clean
            """,
            id="a main function that starts a node",
        ),
    ],
)
def test_functions_that_are_not_entry_points_do_not_run(text):
    assert differing(HEAD + dedent(text)) == {}
