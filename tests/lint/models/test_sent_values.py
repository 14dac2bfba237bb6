"""A value that is sent to a generator is the value of its `yield`, and decides what the generator does next."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
now = {"pose": 0.0, "phase": 0.0}
def pose(msg):
    now["pose"] = msg.data
rospy.Subscriber("pose", Float64, pose)
"""
BODIES = """\
### a sum of what is sent
def summed():
    total = 0.0
    while True:
        value = yield total
        total += value
totals = summed()
next(totals)
def scan(msg):
    out.publish(totals.send(msg.data))  # scan:data
### a value that decides what is yielded
def limited():
    value = yield 0.0
    while True:
        value = yield (1.0 if value > 3.0 else 0.0)
limits = limited()
next(limits)
def scan(msg):
    out.publish(limits.send(msg.data))  # scan:control
### the fields of an object are told apart
class Sample:
    def __init__(self, x, y):
        self.x, self.y = x, y
def steps():
    sample = yield 0.0
    while sample.x < 3.0:
        sample = yield 2.0 * sample.y
all_steps = steps()
next(all_steps)
def scan(msg):
    out.publish(all_steps.send(Sample(msg.data, now["pose"])))  # pose:data scan:control
### a phase that ends at a yield whose value is not used
def phases():
    now["phase"] = 1.0
    yield
    now["phase"] = 2.0
    while True:
        value = yield
        if value > 3.0:
            now["phase"] = 3.0
            yield
            now["phase"] = 4.0
running = phases()
next(running)
def scan(msg):
    running.send(msg.data)
    out.publish(now["phase"])  # scan:control
### how often something was sent decides nothing, but a value that ends a loop does
def phases():
    value = yield
    now["phase"] = 1.0
    while value < 3.0:
        value = yield
    now["phase"] = 2.0
    while True:
        value = yield
        out.publish(3.0)  # scan:control
running = phases()
next(running)
def scan(msg):
    running.send(msg.data)
    out.publish(now["phase"])  # scan:control
### nothing but the number of steps decides
def phases():
    for _ in range(3):
        value = yield 0.0
    now["phase"] = 2.0
    value = yield 1.0
running = phases()
next(running)
def scan(msg):
    out.publish(running.send(msg.data))  # clean
    out.publish(now["phase"])  # clean
### the end of a generator
def few():
    value = yield 0.0
    while value < 3.0:
        value = yield 1.0
running = few()
next(running)
def scan(msg):
    try:
        running.send(msg.data)
    except StopIteration:
        out.publish(1.0)  # scan:control
### one program makes the generator and sends
def doubled():
    value = yield 0.0
    while True:
        value = yield 2.0 * value
def scan(msg):
    pass
double = doubled()
next(double)
while not rospy.is_shutdown():
    rospy.sleep(0.1)
    out.publish(double.send(now["pose"]))  # pose:data
### a generator that passes on what it gets to another one
def summed():
    total = 0.0
    while total < 9.0:
        value = yield total
        total += value
    return value
def passing():
    last = yield from summed()
    out.publish(last)  # scan:data
totals = passing()
next(totals)
def scan(msg):
    out.publish(totals.send(msg.data))  # scan:data
### what a generator returns
def asked():
    yield 1.0
    return now["pose"]
def passing():
    answer = yield from asked()
    out.publish(answer)  # pose:data
def scan(msg):
    for number in passing():
        out.publish(number)  # clean
### a generator to which nothing is sent
def numbers():
    yield 1.0
    yield now["pose"]
def scan(msg):
    for number in numbers():
        out.publish(number)  # pose:data
"""


@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_a_yield_returns_the_sent_value(body):
    text = f"{HEAD}{body}"
    assert differing_topics(text + 'rospy.Subscriber("scan", Float64, scan)\nrospy.spin()\n') == {}
