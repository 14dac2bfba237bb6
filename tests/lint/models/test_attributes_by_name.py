"""Attributes that a program names by texts: fields of messages and dataclasses, `__slots__`, `__dict__`, `hasattr`."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, sections

HEAD = """\
import dataclasses, rospy
from geometry_msgs.msg import Point, PoseArray, Twist
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
twists = rospy.Publisher("twists", Twist, queue_size=1)
class Plain:
    def __init__(self):
        self.x, self.y = 0.0, 0.0
@dataclasses.dataclass
class State:
    x: float = 0.0
    y: float = 0.0
"""
BODIES = """\
### the fields of a message, copied one by one
def on(msg):
    point, twist, other = Point(), Twist(), Twist()
    for name in msg.__slots__:
        setattr(point, name, getattr(msg, name))
    twist.linear.x, other.linear.x = point.x, point.w
    twists.publish(twist)  # data
    twists.publish(other)  # clean
rospy.Subscriber("in", Point, on)
### only the field that a comparison selects
def on(msg):
    twist = Twist()
    for name in msg.__slots__:
        if name == "z":
            setattr(twist.linear, name, getattr(msg, name))
        else:
            setattr(twist.linear, name, 1.0)
    out.publish(twist.linear.z)  # data
    out.publish(twist.linear.x)  # clean
rospy.Subscriber("in", Point, on)
### fields of fields, and names in a tuple
def on(msg):
    limited = Twist()
    for part in msg.__slots__:
        for axis in ("x", "y", "z"):
            setattr(getattr(limited, part), axis, min(1.0, getattr(getattr(msg, part), axis)))
    twists.publish(limited)  # data
    twists.publish(Twist())  # clean
rospy.Subscriber("in", Twist, on)
### a message whose fields are not known
from robot_msgs.msg import Status
def on(msg):
    status, kept = Status(), {}
    for name in msg.__slots__:
        setattr(status, name, getattr(msg, name))
        kept[name] = 1.0
    out.publish(status.level)  # data
    out.publish(kept["level"])  # clean
rospy.Subscriber("in", Status, on)
### fields of a part of unknown name
from robot_msgs.msg import Status
statuses = rospy.Publisher("statuses", Status, queue_size=1)
def on(msg):
    status = Status()
    for name in rospy.get_param("~fields"):
        setattr(getattr(status, name), "level", msg.data)
    statuses.publish(status)  # data
rospy.Subscriber("in", Float64, on)
### elements of a list of messages
def on(msg):
    for pose in msg.poses:
        values = {name: getattr(pose.position, name) for name in pose.position.__slots__}
        out.publish(values["x"])  # data
        out.publish(len(values))  # control
rospy.Subscriber("in", PoseArray, on)
### the fields of a class of messages
def on(msg):
    twist = Twist()
    for name in Point.__slots__:
        setattr(twist.linear, name, getattr(msg, name))
    twists.publish(twist)  # data
rospy.Subscriber("in", Point, on)
### a mapping of fields to their types
def as_dict(msg):
    found = {}
    for name, kind in msg.get_fields_and_field_types().items():
        value = getattr(msg, name)
        found[name] = as_dict(value) if hasattr(value, "get_fields_and_field_types") else value
    return found
def on(msg):
    out.publish(as_dict(msg)["linear"]["x"])  # data
rospy.Subscriber("in", Twist, on)
### a mapping of unknown fields to their types
from robot_msgs.msg import Status
def on(msg):
    for name in msg.get_fields_and_field_types():
        out.publish(name == "level")  # clean
        out.publish(getattr(msg, name))  # data
rospy.Subscriber("in", Status, on)
### private names of ROS 2
import rclpy
def on(msg):
    point = Point()
    for name in msg.__slots__:
        setattr(point, name, getattr(msg, name))
    out.publish(point.x)  # data
    for name in msg.__slots__:
        setattr(point, name[1:], 1.0)
        setattr(point, name.lstrip("_"), 1.0)
    out.publish(point.y)  # clean
rospy.Subscriber("in", Point, on)
### fields of a dataclass
def on(msg):
    state, copied = State(x=msg.data), State()
    for field in dataclasses.fields(state):
        setattr(copied, field.name, getattr(state, field.name))
    out.publish(copied.x)  # data
    out.publish(copied.y)  # clean
    out.publish(len(dataclasses.fields(State)))  # clean
    out.publish(dataclasses.fields(msg.data)[0])  # data
rospy.Subscriber("in", Float64, on)
### fields of one of several objects of a dataclass
def on(msg):
    for state in [State(x=msg.data), State(x=msg.data + 1.0)]:
        copied = State()
        for field in dataclasses.fields(state):
            setattr(copied, field.name, getattr(state, field.name))
        out.publish(copied.x)  # data
        out.publish(copied.y)  # clean
rospy.Subscriber("in", Float64, on)
### slots of an analysed class
class Slotted:
    __slots__ = ("x", "y")
    def __init__(self, x=0.0, y=0.0):
        self.x, self.y = x, y
    def copied(self):
        other = Slotted()
        for name in self.__slots__:
            setattr(other, name, getattr(self, name))
        return other
def on(msg):
    copied = Slotted(x=msg.data).copied()
    out.publish(copied.x)  # data
    out.publish(copied.y)  # clean
rospy.Subscriber("in", Float64, on)
### keyword arguments as attributes
class Options:
    def __init__(self, **options):
        for name, value in options.items():
            setattr(self, name, value)
def on(msg):
    options = Options(x=msg.data, y=1.0)
    out.publish(options.x)  # data
    out.publish(options.y)  # clean
rospy.Subscriber("in", Float64, on)
### one of two attributes
def on(msg):
    plain = Plain()
    plain.x = msg.data
    setattr(plain, "x" if rospy.get_time() > 1.0 else "y", 1.0)
    out.publish(plain.x)  # data
    out.publish(plain.y)  # clean
rospy.Subscriber("in", Float64, on)
### the attributes of an object as a mapping
def on(msg):
    plain, other, last = Plain(), Plain(), Plain()
    plain.x = msg.data
    copied = dict(plain.__dict__)
    out.publish(copied["x"])  # data
    out.publish(copied["y"])  # clean
    other.__dict__ = copied
    out.publish(other.x)  # data
    out.publish(other.y)  # clean
    last.__dict__.update(vars(plain))
    out.publish(last.x)  # data
    out.publish({**vars(plain), "x": 1.0}["y"])  # clean
rospy.Subscriber("in", Float64, on)
### whether a publisher was made
class Robot:
    def on(self, msg):
        if msg.data > 1.0:
            self.pub = rospy.Publisher("other", Float64, queue_size=1)
            self.level = msg.data
        self.last = msg.data
    def tick(self, event):
        if hasattr(self, "pub"):
            self.pub.publish(1.0)  # control
        if hasattr(self, "level"):
            out.publish(1.0)  # control
        if hasattr(self, "last"):
            out.publish(1.0)  # clean
robot = Robot()
rospy.Subscriber("in", Float64, robot.on)
rospy.Timer(rospy.Duration(1.0), robot.tick)
### a topic that data names
class Robot:
    def __init__(self):
        self.pub = self.other = None
    def on(self, msg):
        self.pub = rospy.Publisher(f"robot{msg.data}", Float64, queue_size=1)
        self.other = rospy.Publisher("other", Float64, queue_size=1)
    def tick(self, event):
        if self.pub is not None:
            self.pub.publish(1.0)  # control
            self.other.publish(1.0)  # clean
robot = Robot()
rospy.Subscriber("in", Float64, robot.on)
rospy.Timer(rospy.Duration(1.0), robot.tick)
"""


@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_attributes_by_name_have_the_marked_flows(body):
    assert differing(f"{HEAD}{body}rospy.spin()\n") == {}
