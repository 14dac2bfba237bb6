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
level, fixed = [0.0], [1.0]
def on(msg):
    level[0] = msg.data
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
### in a loop over elements
for one in [event, event]:
    one.wait()
out.publish(2.0)  # control
### in the loop of a called function
def fetch():
    for one in [event, threading.Event()]:
        one.wait()
fetch()
out.publish(2.0)  # control
### in an endless loop
def fetch():
    while True:
        item = waiting.get()
        if item is not None:
            return 3.0
found = fetch()
out.publish(found)  # control
### in a loop with a condition
while not rospy.is_shutdown():
    waiting.get()
out.publish(2.0)  # clean
### in the loop of a called function, with a condition
def fetch():
    while not rospy.is_shutdown():
        waiting.get()
fetch()
out.publish(2.0)  # clean
### in an argument
def fetch():
    return waiting.get()
out.publish(waiting.get())  # control
out.publish(always.get())  # control
### a predicate
def ready():
    return level[0] > 3.0
out.publish(1.0)  # clean
with changed:
    changed.wait_for(ready)
out.publish(2.0)  # control
### a predicate with a time-out
def ready():
    return level[0] > 3.0
with changed:
    if changed.wait_for(ready, timeout=1.0):
        out.publish(2.0)  # control
    out.publish(1.0)  # clean
### a predicate that is always true at the end
with changed:
    changed.wait_for(lambda: len(fixed) == 1)
out.publish(2.0)  # clean
### a wait for an object that is no condition
changed.wait_for(3.0)
out.publish(2.0)  # clean
"""


@pytest.mark.parametrize("title", sections(BODIES))
def test_event_decides_whether_code_after_the_wait_runs(title: str) -> None:
    body = sections(BODIES)[title].replace("\n", "\n    ")
    assert not differing(
        f"{HEAD}def work():\n    {body}\nthreading.Thread(target=work).start()\nrospy.spin()\n"
    )
