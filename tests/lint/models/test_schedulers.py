"""`sched.scheduler`, which calls functions at a later time."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, sections

HEAD = """\
import functools, rospy, sched, time
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
scheduler = sched.scheduler(time.time, time.sleep)
"""
PROGRAMS = """\
### an argument
def later(number):
    out.publish(number)  # data
rospy.Subscriber("in", Float64, lambda msg: scheduler.enter(1.0, 1, later, argument=(msg.data,)))
### arguments by position, at a known time
def later(first, second):
    out.publish(first)  # clean
    out.publish(second)  # data
rospy.Subscriber("in", Float64, lambda msg: scheduler.enterabs(1.0, 1, later, (0.0, msg.data)))
### a function without arguments
last = 0.0
def later():
    out.publish(last)  # data
def on(msg):
    global last
    last = msg.data
    scheduler.enter(1.0, 1, later)
rospy.Subscriber("in", Float64, on)
### a partial function
rospy.Subscriber("in", Float64, lambda msg: scheduler.enter(1.0, 1, functools.partial(later, msg.data)))
def later(number):
    out.publish(number)  # data
### a constant
rospy.Subscriber("in", Float64, lambda msg: scheduler.enter(1.0, 1, later, (1.0,)))
def later(number):
    out.publish(number)  # clean
### a method `enter` of a class of the file
class Door:
    def enter(self, delay, priority, action):
        out.publish(delay)  # data
door = Door()
def never():
    out.publish(1.0)  # clean
rospy.Subscriber("in", Float64, lambda msg: door.enter(msg.data, 1, never))
"""


@pytest.mark.parametrize("program", sections(PROGRAMS).values(), ids=sections(PROGRAMS))
def test_scheduled_functions_run_later(program: str) -> None:
    assert differing(HEAD + program) == {}
