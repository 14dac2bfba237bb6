"""The elements of heaps and priority queues: their data, and what a comparison of them decides."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import heapq, itertools, queue, rospy
from dataclasses import dataclass, field
from geometry_msgs.msg import Point
from std_msgs.msg import Empty, Float64, String
out = rospy.Publisher("out", Float64, queue_size=1)
text = rospy.Publisher("text", String, queue_size=1)
"""
BODIES = """\
### tuples
kept = []
def scan(msg):
    heapq.heappush(kept, (msg.data, 1.0))
def pose(msg):
    heapq.heappush(kept, (1.0, msg.data))
def tick(event):
    cost, value = heapq.heappop(kept)
    out.publish(value)  # pose:data scan:control
rospy.Subscriber("scan", Float64, scan)
rospy.Subscriber("pose", Float64, pose)
rospy.Timer(rospy.Duration(1.0), tick)
### dataclasses
@dataclass(order=True)
class Task:
    priority: float
    value: float = field(compare=False)
kept = []
def scan(msg):
    heapq.heappush(kept, Task(msg.data, 1.0))
def pose(msg):
    heapq.heappush(kept, Task(2.0, msg.data))
def tick(event):
    if kept:
        task = heapq.heappop(kept)
        out.publish(task.value)  # pose:data scan:control
rospy.Subscriber("scan", Float64, scan)
rospy.Subscriber("pose", Float64, pose)
rospy.Timer(rospy.Duration(1.0), tick)
### the count decides only if it does
kept, some = [], []
def scan(msg):
    heapq.heappush(kept, (1.0, msg.data))
    if msg.data > 3.0:
        heapq.heappush(some, (1.0, 2.0))
def tick(event):
    if kept:
        heapq.heappop(kept)
        out.publish(1.0)  # clean
    if some:
        heapq.heappop(some)
        out.publish(2.0)  # scan:control
rospy.Subscriber("scan", Float64, scan)
rospy.Timer(rospy.Duration(1.0), tick)
### priority queue of tuples
jobs = queue.PriorityQueue()
def scan(msg):
    jobs.put((1, msg.data))
def pose(msg):
    jobs.put((msg.data, 2.0))
rospy.Subscriber("scan", Float64, scan)
rospy.Subscriber("pose", Float64, pose)
while not rospy.is_shutdown():
    priority, value = jobs.get()
    out.publish(value)  # scan:data pose:control
### priority queue, constants only
jobs = queue.PriorityQueue()
def scan(msg):
    jobs.put((1, 3.0))
def pose(msg):
    if msg.data > 3.0:
        jobs.put((0, 2.0))
rospy.Subscriber("scan", Float64, scan)
rospy.Subscriber("pose", Float64, pose)
while not rospy.is_shutdown():
    priority, value = jobs.get()
    out.publish(value)  # pose:control
### priority queue of dataclasses with a counter
@dataclass(order=True)
class Job:
    priority: int
    number: int
    payload: object = field(compare=False, default=None)
class Robot:
    def __init__(self):
        self.numbers = itertools.count()
        self.jobs = queue.PriorityQueue(maxsize=10)
        rospy.Subscriber("goal", Point, self.goal)
        rospy.Subscriber("stop", Empty, self.stop)
    def goal(self, msg):
        self.jobs.put(Job(5, next(self.numbers), msg))
    def stop(self, msg):
        self.jobs.put(Job(0, next(self.numbers)))
    def run(self):
        while not rospy.is_shutdown():
            job = self.jobs.get()
            if job.payload is None:
                text.publish("stop")  # clean
            else:
                out.publish(job.payload.x)  # goal:data
            self.jobs.task_done()
Robot().run()
### heapify, heappushpop, nsmallest, heapreplace
kept = [(1.0, 0.0)]
def scan(msg):
    heapq.heapify(kept)
    best = heapq.heappushpop(kept, (msg.data, 3.0))
    out.publish(best[1])  # scan:control
    for cost, value in heapq.nsmallest(2, kept):
        out.publish(value)  # scan:control
    old = heapq.heapreplace(kept, (msg.data, 3.0))
    out.publish(old[0])  # scan:data
rospy.Subscriber("scan", Float64, scan)
### an instance behind a priority
class Node:
    def __init__(self, value): self.value = value
kept = []
def scan(msg):
    heapq.heappush(kept, (1.0, 2, Node(msg.data)))
def pose(msg):
    heapq.heappush(kept, (msg.data, 2, Node(1.0)))
def tick(event):
    cost, number, node = heapq.heappop(kept)
    out.publish(node.value)  # scan:data pose:control
rospy.Subscriber("scan", Float64, scan)
rospy.Subscriber("pose", Float64, pose)
rospy.Timer(rospy.Duration(1.0), tick)
### an own comparison
class Node:
    def __init__(self, cost, value): self.cost, self.value = cost, value
    def __lt__(self, other): return self.cost < other.cost
kept = []
def scan(msg):
    heapq.heappush(kept, Node(1.0, msg.data))
def pose(msg):
    heapq.heappush(kept, Node(2.0, 1.0))
def tick(event):
    node = heapq.heappop(kept)
    out.publish(node.cost)  # clean
    out.publish(node.value)  # scan:data
rospy.Subscriber("scan", Float64, scan)
rospy.Subscriber("pose", Float64, pose)
rospy.Timer(rospy.Duration(1.0), tick)
### an own comparison of data
class Node:
    def __init__(self, cost, value): self.cost, self.value = cost, value
    def __lt__(self, other): return self.cost < other.cost
kept = queue.PriorityQueue()
def scan(msg):
    kept.put(Node(1.0, msg.data))
def pose(msg):
    kept.put(Node(msg.data, 1.0))
def tick(event):
    node = kept.get()
    out.publish(node.value)  # scan:data pose:control
rospy.Subscriber("scan", Float64, scan)
rospy.Subscriber("pose", Float64, pose)
rospy.Timer(rospy.Duration(1.0), tick)
"""


@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_the_smallest_element_has_the_marked_flows(body):
    assert differing_topics(f"{HEAD}{body}rospy.spin()\n") == {}
