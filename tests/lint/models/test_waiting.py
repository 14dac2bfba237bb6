"""What a program waits for decides what follows: an element of a queue, an event, a condition."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, sections

HEAD = """\
import queue, threading, rospy
from collections import deque
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
waiting, always, places = queue.Queue(), queue.Queue(), deque()
event, changed = threading.Event(), threading.Condition()
def on(msg):
    always.put(1.0)
    if msg.data > 1.0:
        waiting.put(1.0)
        places.append(1.0)
        event.set()
        with changed:
            changed.notify()
rospy.Subscriber("in", Float64, on)
"""
BODIES = """\
### an element of a queue
while True:
    out.publish(1.0)  # clean
    waiting.get()
    out.publish(2.0)  # control
### a queue that gets an element with each message
while True:
    always.get()
    out.publish(2.0)  # clean
### a time-out
while True:
    try:
        waiting.get(timeout=1.0)
    except queue.Empty:
        out.publish(1.0)  # control
        continue
    out.publish(2.0)  # control
### no time to wait
try:
    waiting.get_nowait()
    out.publish(2.0)  # control
except queue.Empty:
    out.publish(1.0)  # control
### an end of a deque
try:
    places.popleft()
    out.publish(2.0)  # control
except IndexError:
    out.publish(1.0)  # control
### an event
out.publish(1.0)  # clean
event.wait()
out.publish(2.0)  # control
### a condition
with changed:
    changed.wait()
    out.publish(2.0)  # control
### a queue, in a called function
def fetch():
    item = waiting.get()
    return 3.0
def outer():
    return fetch()
while True:
    out.publish(1.0)  # clean
    outer()
    out.publish(2.0)  # control
### an event, in a constructor
class Client:
    def __init__(self):
        event.wait()
out.publish(1.0)  # clean
client = Client()
out.publish(2.0)  # control
### in a called function, if it waits at all
def fetch(wait):
    if wait:
        waiting.get()
fetch(False)
out.publish(2.0)  # clean
### in a called function, for an element that each message puts there
def fetch():
    return always.get() is not None
fetch()
out.publish(2.0)  # clean
### in the condition of a loop
def fetch():
    return waiting.get() is not None
while fetch():
    out.publish(2.0)  # control
### in a generator
def items():
    while True:
        yield waiting.get()
for item in items():
    out.publish(2.0)  # control
"""


@pytest.mark.parametrize("title", sections(BODIES))
def test_the_event_decides_whether_the_code_after_the_wait_runs(title: str) -> None:
    body = sections(BODIES)[title].replace("\n", "\n    ")
    assert not differing(
        f"{HEAD}def work():\n    {body}\nthreading.Thread(target=work).start()\nrospy.spin()\n"
    )
