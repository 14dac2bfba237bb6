"""The conditions under which a program registers a callback, a timer or a thread decide whether it runs."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import library, rospy, threading
from concurrent.futures import ThreadPoolExecutor
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
pool, client = ThreadPoolExecutor(), library.client()
kept = {}
def later(*given):
    out.publish(1.0)  # MARK
"""
# how a program registers `later` in a callback or at its start; the mark at its publish call
BODIES = """\
### scan:control: a timer
def scan(msg):
    if msg.data > 1.0:
        rospy.Timer(rospy.Duration(1.0), later, oneshot=True)
### scan:control: a thread
def scan(msg):
    if msg.data > 1.0:
        threading.Thread(target=later).start()
### scan:control: another topic
def scan(msg):
    if msg.data > 1.0:
        rospy.Subscriber("pose", Float64, later)
### scan:control: the answer to a request that is not always sent
def scan(msg):
    if msg.data < 1.0:
        return
    kept["future"] = client.call_async(3.0)
    kept["future"].add_done_callback(later)
### scan:control: work in another thread
def scan(msg):
    if msg.data > 1.0:
        pool.submit(len, []).add_done_callback(later)
### scan:control: in a called function
def start():
    threading.Thread(target=later).start()
def scan(msg):
    if msg.data > 1.0:
        start()
### scan:control: a timer in a callback that is registered itself
def begin(msg):
    rospy.Timer(rospy.Duration(1.0), later, oneshot=True)
def scan(msg):
    if msg.data > 1.0:
        rospy.Subscriber("pose", Float64, begin)
### scan:control other:control: at two places
def scan(msg):
    if msg.data > 1.0:
        threading.Thread(target=later).start()
def other(msg):
    if msg.data > 1.0:
        threading.Thread(target=later).start()
rospy.Subscriber("other", Float64, other)
### scan:control: a second timer, as with a second call of the function
def scan(msg):
    if msg.data > 1.0:
        kept["timer"] = rospy.Timer(rospy.Duration(1.0), later)
kept["timer"] = rospy.Timer(rospy.Duration(1.0), later)
### clean: with each message
def scan(msg):
    if "thread" not in kept:
        kept["thread"] = threading.Thread(target=later)
        kept["thread"].start()
### clean: by a parameter
def scan(msg):
    if rospy.get_param("~later", True):
        threading.Thread(target=later).start()
"""
CASES = sections(BODIES)


@pytest.mark.parametrize("title", CASES)
def test_a_root_runs_only_if_it_is_registered(title):
    text = HEAD.replace("MARK", title.partition(": ")[0]) + CASES[title]
    assert differing_topics(f'{text}rospy.Subscriber("scan", Float64, scan)\nrospy.spin()\n') == {}
