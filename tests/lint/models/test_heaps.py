"""`heapq.heappop` takes an element out of a list."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

HEAD = """\
import heapq, rospy
from std_msgs.msg import Float64, Int32
out = rospy.Publisher("out", Float64, queue_size=1)
kept, other = [(1.0, "a"), (2.0, "b"), (3.0, "c")], [1.0, 2.0]
"""
BODIES = {
    "the length follows the condition of a removal": """
def on(msg):
    if msg.data > 0.0:
        heapq.heappop(kept)
def step(event):
    out.publish(len(kept))  # control
    out.publish(len(other))  # clean
""",
    "the elements that remain follow the condition": """
def on(msg):
    if msg.data > 0.0:
        heapq.heappop(kept)
def step(event):
    out.publish(kept[0][0])  # control
    out.publish(other[0])  # clean
""",
    "the element that is returned was pushed": """
def on(msg):
    heapq.heappush(kept, (msg.data, "d"))
def step(event):
    out.publish(heapq.heappop(kept)[0])  # data
    out.publish(heapq.heappop(other))  # clean
""",
    "without an argument": """
def on(msg):
    out.publish(msg.data)  # data
    heapq.heappop()
def step(event):
    pass
""",
}
TAIL = """
rospy.Subscriber("in", Float64, on)
rospy.Timer(1.0, step)
rospy.spin()
"""


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_an_element_is_taken_out_of_a_heap(body: str) -> None:
    assert differing(HEAD + body + TAIL) == {}
