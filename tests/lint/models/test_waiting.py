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
"""


@pytest.mark.parametrize("title", sections(BODIES))
def test_the_event_decides_whether_the_code_after_the_wait_runs(title: str) -> None:
    body = sections(BODIES)[title].replace("\n", "\n    ")
    assert not differing(
        f"{HEAD}def work():\n    {body}\nthreading.Thread(target=work).start()\nrospy.spin()\n"
    )
