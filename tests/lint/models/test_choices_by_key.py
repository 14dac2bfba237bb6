"""The keys that `sorted`, `min` or `max` compare decide the place of each element, but are not data of the element."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import bisect, heapq, itertools, rospy
from operator import attrgetter, itemgetter
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
class Goal:
    def __init__(self, name, x):
        self.name, self.x = name, x
goals, scores, ranges, now = [Goal("a", 1.0), Goal("b", 2.0)], {"a": 0.0, "b": 0.0}, [], {"pose": 0.0}
def pose(msg):
    now["pose"] = msg.data
def score(msg):
    scores["a"] = msg.data
def scan(msg):
    global ranges
    ranges = msg.ranges
rospy.Subscriber("pose", Float64, pose)
rospy.Subscriber("score", Float64, score)
rospy.Subscriber("scan", Float64, scan)
def away(goal):
    return abs(goal.x - now["pose"])
"""
BODIES = """\
### a key chooses one element
out.publish(min(goals, key=away).name)  # pose:control
out.publish(max(scores, key=scores.get))  # score:control
out.publish(max(scores.items(), key=itemgetter(1))[0])  # score:control
out.publish(max("a", "b", key=lambda name: scores[name]))  # score:control
out.publish(min(ranges, key=lambda r: abs(r - now["pose"])))  # scan:data pose:control
out.publish(min(goals, key=attrgetter("name")).name)  # clean
### a key orders a list
for goal in sorted(goals, key=away):
    out.publish(goal.name)  # pose:control
copied = list(goals)
copied.sort(key=away)
out.publish(copied[0].name)  # pose:control
out.publish(sorted(goals, key=attrgetter("name"))[0].name)  # clean
### tuples are compared by what they contain
out.publish(max((v, k) for k, v in scores.items())[1])  # score:control
out.publish(sorted([(now["pose"], "a"), (1.0, "b")])[0][1])  # pose:control
### numbers are their own data
out.publish(max(scores.values()))  # score:data
out.publish(max(1.0, now["pose"]))  # pose:data
out.publish(min(ranges, default=0.0))  # scan:data
### the first elements by a key
out.publish(heapq.nsmallest(2, goals, key=away)[0].name)  # pose:control
out.publish(heapq.nlargest(2, ranges)[0])  # scan:data
out.publish(len(heapq.nlargest(int(now["pose"]), goals)))  # pose:data
waiting = [(1.0, "b")]
heapq.heappush(waiting, (now["pose"], "a"))
out.publish(heapq.heappop(waiting)[1])  # pose:control
### groups by a key
for near, group in itertools.groupby(goals, key=lambda goal: goal.x < now["pose"]):
    out.publish(near)  # pose:data
    for goal in group:
        out.publish(goal.name)  # pose:control
### the order of a sorted list decides what is in a group, but not how many groups there are
found = [("a", now["pose"]), ("b", scores["a"])]
for name, group in itertools.groupby(sorted(found), key=itemgetter(0)):
    out.publish(1.0)  # clean
    for goal in group:
        out.publish(goal[1])  # pose:data score:data
for x, group in itertools.groupby(sorted(found, key=itemgetter(1)), key=itemgetter(1)):
    out.publish(1.0)  # pose:control score:control
longer = sorted(found)
longer.append((ranges[0], 0.0))
for name, group in itertools.groupby(longer, key=itemgetter(0)):
    out.publish(1.0)  # pose:control score:control scan:control
### the place of a number is computed from the numbers
out.publish(bisect.bisect([1.0, 2.0], now["pose"]))  # pose:data
out.publish(bisect.bisect([1.0, 2.0], 1.0, key=lambda x: x - now["pose"]))  # pose:data
"""


@pytest.mark.parametrize("title", sections(BODIES))
def test_table_key_decides_the_chosen_value(title: str) -> None:
    body = sections(BODIES)[title].replace("\n", "\n    ")
    assert not differing_topics(f"{HEAD}def step(event):\n    {body}\nrospy.Timer(1.0, step)\nrospy.spin()\n")
