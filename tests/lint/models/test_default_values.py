"""Lists and mappings as defaults of parameters: the topics and keys in them, and what data decide about them."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, flows, sections

HEAD = """\
import functools, rclpy, rospy
from rclpy.node import Node
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
PROGRAMS = """\
### a list of topics
def on(msg, topic):
    kept[topic] = msg.data
    out.publish(msg.data)  # a:data b:data
    out.publish(kept["/a"])  # a:data
kept = {}
for topic in rospy.get_param("~topics", ["/a", "/b"]):
    rospy.Subscriber(topic, Float64, on, callback_args=topic)
### a list of topics that is a constant of the module
TOPICS = ["a", "b"]
def on(msg):
    out.publish(msg.data)  # a/cmd:data b/cmd:data
topics = rospy.get_param("~topics", TOPICS)
for topic in topics:
    rospy.Subscriber(topic + "/cmd", Float64, on)
for topic in TOPICS:
    out.publish(topic)  # clean
### a list of rows
def on(msg, scale):
    out.publish(scale * msg.data)  # a:data b:data
for row in rospy.get_param("~rows", [["a", 1.0], ["b", 2.0]]):
    rospy.Subscriber(row[0], Float64, functools.partial(on, scale=row[1]))
### a list of mappings
def on(msg):
    out.publish(msg.data)  # a:data b:data
for row in rospy.get_param("~rows", [{"topic": "a"}, {"topic": "b"}]):
    rospy.Subscriber(row["topic"], Float64, on)
### a mapping of topics
def on(msg, side):
    kept[side] = msg.data
    out.publish(kept["left"])  # a:data
kept = {}
for side, topic in rospy.get_param("~topics", {"left": "a", "right": "b"}).items():
    rospy.Subscriber(topic, Float64, on, callback_args=side)
### a declared list of topics
class Hub(Node):
    def __init__(self):
        super().__init__("hub")
        self.pub = self.create_publisher(Float64, "out", 1)
        for topic in self.declare_parameter("topics", ["a", "b"]).value:
            self.create_subscription(Float64, topic, self.on, 1)
    def on(self, msg):
        self.pub.publish(msg)  # a:data b:data
rclpy.spin(Hub())
### a declared list that is read later
class Hub(Node):
    def __init__(self):
        super().__init__("hub")
        self.kept = {}
        self.pub = self.create_publisher(Float64, "out", 1)
        self.declare_parameters("", [("gain", 1.0), ("topics", ["a", "b"])])
        topics = self.get_parameter("topics").get_parameter_value().string_array_value
        self.subs = [self.create_subscription(Float64, t, lambda m, t=t: self.on(m, t), 1) for t in topics]
    def on(self, msg, topic):
        self.kept[topic] = msg
        self.pub.publish(self.kept["b"])  # b:data
rclpy.spin(Hub())
### a single text as a key
kept = {}
topic = rospy.get_param("~topic", "a")
def on(msg):
    kept[topic] = msg.data
    out.publish(kept[topic])  # a:data
    out.publish(kept["other"])  # clean
rospy.Subscriber(topic, Float64, on)
### publishers under the topics of a list
pubs, kept = {}, {}
def on(msg, topic):
    kept[topic] = msg.data
topics = rospy.get_param("~topics", ["a", "b"])
for topic in topics:
    rospy.Subscriber(topic, Float64, on, callback_args=topic)
    pubs[topic] = rospy.Publisher(topic + "/out", Float64, queue_size=1)
def step(event):
    pubs["a"].publish(kept["a"])  # a:data
    for topic in topics:
        pubs[topic].publish(kept[topic])  # a:data b:data
rospy.Timer(1.0, step)
### a class that a parameter chooses
class Same:
    def change(self, number):
        return number
class Still:
    def change(self, number):
        return 0.0
class Twice:
    def change(self, number):
        return 2 * number
change = {"still": Still, "same": Same, "twice": Twice}[rospy.get_param("~way", "still")]()
rospy.Subscriber("a", Float64, lambda msg: out.publish(change.change(msg.data)))  # a:data
### waypoints that are taken out of the list
points = rospy.get_param("~points", [[0.0, 1.0], [2.0, 3.0]])
def on(msg):
    if msg.data < 0.1:
        points.pop(0)
    out.publish(points[0][0])  # a:control
rospy.Subscriber("a", Float64, on)
### waypoints that are read only
points = rospy.get_param("~points", [[0.0, 1.0], [2.0, 3.0]])
def on(msg):
    if points[0][0] > 1.0:
        out.publish(points[1][0])  # clean
    out.publish(msg.data - points[0][0])  # a:data
rospy.Subscriber("a", Float64, on)
### a number of the default may be another one on the robot
limits = rospy.get_param("~limits", [0.0, 1.0])
def on(msg):
    if limits[0] > 0.5:
        out.publish(msg.data)  # a:data
rospy.Subscriber("a", Float64, on)
### a text of the default may be another one on the robot
modes = rospy.get_param("~modes", ["slow", "fast"])
def on(msg):
    if modes[0] == "fast":
        out.publish(msg.data)  # a:data
rospy.Subscriber("a", Float64, on)
### an empty list may have entries on the robot
def on(msg):
    out.publish(msg.data)  # ?:data
for topic in rospy.get_param("~topics", []):
    rospy.Subscriber(topic, Float64, on)
"""


@pytest.mark.parametrize("program", sections(PROGRAMS).values(), ids=sections(PROGRAMS))
def test_entries_of_default_dictionaries_are_found(program: str) -> None:
    assert differing_topics(HEAD + program) == {}


def test_topic_name_from_a_default_is_shown_as_default() -> None:
    (first, second) = flows(HEAD + sections(PROGRAMS)["a list of rows"])
    assert {first.source.default_topics, second.source.default_topics} == {("a",), ("b",)}
