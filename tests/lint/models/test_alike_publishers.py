"""The choice between several publishers is not a decision if all of them have the same topic and node."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, sections

HEAD = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64
class One(Node):
    def __init__(self, name="one"):
        super().__init__(name)
        self.outputs, self.pub = {}, None
        self.one, self.other = self.make("a"), self.make("b")
        self.create_subscription(Float64, "in", self.on, 1)
        self.create_timer(1.0, self.tick)
        self.start()
    def start(self):
        pass
    def make(self, topic):
        return self.create_publisher(Float64, topic, 1)
"""
BODIES = """\
### a publisher that is made when it is first used
    def output(self, topic):
        if topic not in self.outputs:
            self.outputs[topic] = self.make(topic)
        return self.outputs[topic]
    def on(self, msg):
        if msg.data > 3.0:
            self.output("c").publish(1.0)  # control
            self.output("d").publish(1.0)  # control
    def tick(self):
        self.output("c").publish(1.0)  # clean
        self.output("e").publish(1.0)  # clean
### an attribute that is set when it is first used
    def output(self):
        if self.pub is None:
            self.pub = self.make("c")
        return self.pub
    def on(self, msg):
        if msg.data > 3.0:
            self.output().publish(1.0)  # control
    def tick(self):
        self.output().publish(1.0)  # clean
### a choice between topics
    def on(self, msg):
        self.pub = self.one if msg.data > 3.0 else self.other
    def tick(self):
        if self.pub is not None:
            self.pub.publish(1.0)  # control
### whether there is a publisher
    def on(self, msg):
        if msg.data > 3.0:
            self.pub = self.make("c")
    def tick(self):
        if self.pub is not None:
            self.pub.publish(1.0)  # control
### a handler for the case that there is none
    def on(self, msg):
        if msg.data > 3.0:
            self.pub = self.make("c")
    def tick(self):
        try:
            self.pub.publish(1.0)  # control
        except AttributeError:
            pass
### a choice between a publisher and an object without one
    def start(self):
        class Quiet:
            def publish(self, msg):
                pass
        self.quiet = Quiet()
    def on(self, msg):
        self.pub = self.one if msg.data > 3.0 else self.quiet
    def tick(self):
        if self.pub is not None:
            self.pub.publish(1.0)  # control
### a choice between nodes
    def start(self):
        self.pubs = [rclpy.create_node(name).create_publisher(Float64, "c", 1) for name in ("x", "y")]
    def on(self, msg):
        self.pubs[int(msg.data)].publish(1.0)  # control
    def tick(self):
        pass
"""


@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_publisher_choice_decides_only_between_different_topics(body):
    assert differing(f"{HEAD}{body}rclpy.init()\nrclpy.spin(One())\n") == {}
