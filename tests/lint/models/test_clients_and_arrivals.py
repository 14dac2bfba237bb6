"""The settings `clients` and `arrivals`: further sources, and decisions by whether a message has arrived."""

from __future__ import annotations

import re
from textwrap import dedent

import pytest

from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing, flows

HEAD = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
# bodies of a node; each line that publishes has two marks: without the setting, and with `arrivals`
ARRIVALS = """\
### a wait in a called function, and in a loop of one
level, last = 0.0, None
def on(msg):
    global level, last
    level, last = msg.data, msg
def wait_for(ready):
    while not ready() and not rospy.is_shutdown():
        rospy.sleep(0.1)
def step(event):
    out.publish(0.0)  # clean clean
    wait_for(lambda: last is not None)
    out.publish(1.0)  # clean control
def other(event):
    for _ in range(2):
        out.publish(2.0)  # clean control
        wait_for(lambda: level > 1.0)
    out.publish(3.0)  # clean control
rospy.Subscriber("in", Float64, on)
rospy.Timer(1, step)
rospy.Timer(1, other)
### loops that only what is inside them ends
level = 0.0
def on(msg):
    global level
    level = msg.data
def step(event):
    while True:
        if level > 1.0:
            break
        rospy.sleep(0.1)
    out.publish(1.0)  # clean control
def wait():
    while True:
        if level > 1.0:
            break
        rospy.sleep(0.1)
def wait_inside():
    while True:
        for limit in (1.0, 2.0):
            if level > limit:
                return
        rospy.sleep(0.1)
def once():
    while True:
        if level > 1.0:
            rospy.loginfo("high")
        break
def other(event):
    once()
    out.publish(2.0)  # clean clean
    wait()
    out.publish(3.0)  # clean control
def third(event):
    wait_inside()
    out.publish(4.0)  # clean control
rospy.Subscriber("in", Float64, on)
rospy.Timer(1, step)
rospy.Timer(1, other)
rospy.Timer(1, third)
### the first message
last = None
def on(msg):
    global last
    last = msg
def step(event):
    if last is None:
        out.publish(0.0)  # clean control
    if not last:
        return
    out.publish(1.0)  # clean control
    out.publish(last.data)  # data data
rospy.Subscriber("in", Float64, on)
rospy.Timer(1, step)
### values computed from the first message
class Node:
    def __init__(self):
        self.me = self.heard = None
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.me = (msg.data, 1.0)
        self.heard = rospy.get_time()
    def step(self, event):
        if self.heard is None or self.me is None:
            out.publish(0.0)  # clean control
            return
        out.publish(self.me[0])  # data data
node = Node()
rospy.Timer(1, node.step)
### what a callback counts and publishes
count = 0
def on(msg):
    global count
    count += 1
    out.publish(5.0)  # clean control
def step(event):
    out.publish(count)  # clean control
    out.publish(3.0)  # clean clean
rospy.Subscriber("in", Float64, on)
rospy.Timer(1, step)
### a loop that waits
last = None
def on(msg):
    global last
    last = msg
rospy.Subscriber("in", Float64, on)
out.publish(1.0)  # clean clean
while last is None:
    rospy.sleep(0.1)
out.publish(2.0)  # clean control
### a request
def serve(request):
    out.publish(1.0)  # clean control
rospy.Service("reset", Empty, serve)
### all messages
got = {"a": None, "b": None}
def on_a(msg):
    got["a"] = msg
def on_b(msg):
    got["b"] = msg
rospy.Subscriber("a", Float64, on_a)
rospy.Subscriber("b", Float64, on_b)
def step(event):
    if all(got.values()):
        out.publish(1.0)  # clean control
    if None in got.values():
        out.publish(2.0)  # clean control
rospy.Timer(1, step)
"""
CASES = dict(part.split("\n", 1) for part in ARRIVALS.split("### ")[1:])


@pytest.mark.parametrize("arrivals", [False, True])
@pytest.mark.parametrize("title", CASES)
def test_message_arrival_is_a_decision_only_with_the_arrivals_setting(title, arrivals):
    text = HEAD + re.sub(r"# (\w+) (\w+)$", r"# \2" if arrivals else r"# \1", CASES[title], flags=re.M)
    assert differing(text, flows(text, Config(arrivals=arrivals))) == {}


CLIENTS = """
    import rclpy
    from rclpy.action import ActionClient
    node = rclpy.create_node("asking")
    out = node.create_publisher(Float64, "out", 1)
    ask = node.create_client(GetSpeed, "speed")
    go = ActionClient(node, Drive, "drive")
    async def step():
        answer = await ask.call_async(GetSpeed.Request())
        out.publish(answer.speed)  # {data}
        out.publish(1.0)  # clean
        handle = await go.send_goal_async(Drive.Goal())
        if handle.accepted:
            out.publish(2.0)  # {control}
    node.create_timer(1.0, step)
"""


def test_responses_are_sources_with_the_setting_clients():
    text = dedent(CLIENTS)
    without = text.format(data="clean", control="clean")
    assert differing(without, flows(without)) == {}
    asked = text.format(data="data", control="control")
    found = flows(asked, Config(clients=True))
    assert differing(asked, found) == {}
    assert {(f.source.topics, f.source.registered[0].line) for f in found} == {
        (("speed",), 6),
        (("drive",), 7),
    }
