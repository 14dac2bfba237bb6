"""A conversion of a number cannot fail, so it decides nothing; a conversion of a text decides its handler."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, sections

HEAD = """\
import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, Int32, String
out = rospy.Publisher("out", Float64, queue_size=1)
given = {}
"""
BODIES = """\
### a field that is a number
def on(msg):
    try:
        float(msg.data)
    except ValueError:
        out.publish(1.0)  # clean
rospy.Subscriber("in", Float64, on)
### a field that is a text
def on(msg):
    try:
        float(msg.data)
    except ValueError:
        out.publish(1.0)  # control
rospy.Subscriber("in", String, on)
### a whole number as a whole number
def on(msg):
    try:
        int(msg.data)
    except ValueError:
        out.publish(1.0)  # clean
rospy.Subscriber("in", Int32, on)
### a number as a whole number, which fails for NaN
def on(msg):
    try:
        int(msg.data)
    except ValueError:
        out.publish(1.0)  # control
rospy.Subscriber("in", Float64, on)
### a part of a message
def on(msg):
    try:
        x = float(msg.linear.x)
    except Exception:
        out.publish(1.0)  # clean
        return
    out.publish(2.0)  # clean
    out.publish(x)  # data
rospy.Subscriber("in", Twist, on)
### an element of a list of numbers
def on(msg):
    try:
        x = float(msg.ranges[0])
    except ValueError:
        out.publish(1.0)  # clean
rospy.Subscriber("in", LaserScan, on)
### a text that a function returns
def on(msg):
    given["x"] = msg.data.split()[0]
    try:
        float(given["x"])
    except ValueError:
        out.publish(1.0)  # control
rospy.Subscriber("in", String, on)
### a type that is not known
from own_msgs.msg import Own
def on(msg):
    try:
        float(msg.data)
    except ValueError:
        out.publish(1.0)  # control
rospy.Subscriber("in", Own, on)
### a test of the type
def number(x, default):
    if isinstance(x, (int, float)):
        return float(x)
    return default
def on(msg):
    try:
        number(msg.value, 0.0)
    except Exception:
        out.publish(1.0)  # clean
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### a test of another variable
def on(msg):
    x, y = msg.first, msg.second
    try:
        if isinstance(y, float):
            float(x)
    except Exception:
        out.publish(1.0)  # control
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### a test of another type
def on(msg):
    x = msg.value
    try:
        if isinstance(x, (float, str)):
            float(x)
    except Exception:
        out.publish(1.0)  # control
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### the other branch
def on(msg):
    x = msg.value
    try:
        if isinstance(x, float):
            pass
        else:
            float(x)
    except Exception:
        out.publish(1.0)  # control
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### a variable that is assigned after the test
def on(msg):
    x = msg.value
    try:
        if isinstance(x, float):
            x = msg.text
            float(x)
    except Exception:
        out.publish(1.0)  # control
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### a choice
def on(msg):
    x = msg.value
    try:
        y = float(x) if isinstance(x, (int, float)) else 0.0
    except Exception:
        out.publish(1.0)  # clean
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### the rest of a condition
def on(msg):
    x = msg.value
    try:
        y = isinstance(x, (int, float)) and float(x) > 1.0
    except Exception:
        out.publish(1.0)  # clean
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### elements of a comprehension
def on(msg):
    try:
        kept = [float(x) for x in msg.values if isinstance(x, (int, float))]
    except Exception:
        out.publish(1.0)  # clean
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### a return for all other values
def number(x):
    if not isinstance(x, (int, float)) or isinstance(x, bool):
        return 0.0
    return float(x)
def on(msg):
    try:
        number(msg.value)
    except Exception:
        out.publish(1.0)  # clean
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
### a branch that goes on
def on(msg):
    x = msg.value
    try:
        if not isinstance(x, float):
            print("not a number")
        float(x)
    except Exception:
        out.publish(1.0)  # control
from own_msgs.msg import Own
rospy.Subscriber("in", Own, on)
"""


@pytest.mark.parametrize("title", sections(BODIES))
def test_only_a_conversion_that_can_fail_decides_its_handler(title: str) -> None:
    assert not differing(f"{HEAD}{sections(BODIES)[title]}\nrospy.spin()\n")
