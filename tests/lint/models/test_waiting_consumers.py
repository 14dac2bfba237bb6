"""Programs that wait for elements of a queue, directly or in a generator that never ends."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

NODE = """\
import queue, threading
import rospy
from std_msgs.msg import Float64

class Latest:
    def __init__(self):
        self.value = 0.0

received = queue.Queue()
arrived = threading.Event()
latest, heard = Latest(), 0.0
out = rospy.Publisher("out", Float64, queue_size=1)

def on(msg):
    global heard
    heard = msg.data
    received.put(("in", msg.data))
    arrived.set()

{body}
rospy.init_node("consumer")
rospy.Subscriber("in", Float64, on)
{program}
"""
PAIRS = """\
def read():
    while True:
        topic, value = received.get()
        yield topic, value
"""
STORES = """\
def read():
    while True:
        latest.value = received.get()[1]
        yield
"""
POLLS = """\
def read():
    while not rospy.is_shutdown():
        rospy.sleep(0.1)
        yield [heard]
"""


@pytest.mark.parametrize(
    ("body", "program"),
    [
        pytest.param("", "out.publish(received.get()[1])  # data", id="one element"),
        pytest.param("", "pair = received.get()\nout.publish(pair[1])  # data", id="one element by name"),
        pytest.param("", "arrived.wait()\nout.publish(heard)  # data", id="event"),
        pytest.param(PAIRS, "for topic, value in read():\n    out.publish(value)  # data", id="pairs"),
        pytest.param(PAIRS, "for topic, value in read():\n    out.publish(topic)  # clean", id="names"),
        pytest.param(STORES, "for _ in read():\n    out.publish(latest.value)  # data", id="stores"),
        pytest.param(POLLS, "for one in read():\n    out.publish(one[0])  # data", id="polling"),
    ],
)
def test_what_a_waiting_program_publishes(body: str, program: str) -> None:
    assert differing(NODE.format(body=body, program=program)) == {}


def test_a_wait_in_a_loop_that_always_ends_decides_what_follows() -> None:
    body = "def forward():\n    while True:\n        received.get()\n        break\n    out.publish(1.0)  # control"
    text = NODE.format(body=body, program="forward()").replace(
        '    received.put(("in", msg.data))', '    if heard > 3.0:\n        received.put("high")'
    )
    assert differing(text) == {}


def test_getattr_of_unknown_arguments_is_not_an_error() -> None:
    text = NODE.format(body="", program="out.publish(getattr(*unknown(), *unknown()))  # clean")
    assert differing(text) == {}
