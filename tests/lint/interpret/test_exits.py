"""The arguments of `__exit__`: whether the body of a `with` raised an exception, and which one."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import asyncio, rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
class Spill(Exception):
    pass
class Siren:
    def __enter__(self):
        return self
    def __exit__(self, kind, error, trace):
        out.publish(0 if kind is None else 2)  # {kind}
        if error is not None:
            out.publish(str(error))  # {error}
        out.publish(3.0)  # clean
        return {suppresses}
    __aenter__, __aexit__ = __enter__, __exit__
def pour(amount):
    if amount > 3.0:
        raise Spill("%.1f litres" % amount)
"""
BODIES = """\
### raised in the body: scan:control, scan:control, False
def scan(msg):
    with Siren():
        if msg.data > 3.0:
            raise Spill("too much")
rospy.Subscriber("scan", Float64, scan)
### raised in a called function: scan:control, scan:data, False
def scan(msg):
    with Siren():
        pour(msg.data)
rospy.Subscriber("scan", Float64, scan)
### suppressed by the manager: scan:control, scan:data, True
def scan(msg):
    with Siren():
        pour(msg.data)
rospy.Subscriber("scan", Float64, scan)
### raised in an asynchronous body: scan:control, scan:data, False
async def scan(msg):
    async with Siren():
        pour(msg.data)
rospy.Subscriber("scan", Float64, scan)
### handled around the statement: scan:control, scan:data, False
def scan(msg):
    try:
        with Siren() as siren:
            pour(msg.data)
    except Spill:
        rospy.logwarn("spilled")
rospy.Subscriber("scan", Float64, scan)
### handled inside the body: clean, clean, False
def scan(msg):
    with Siren():
        try:
            pour(msg.data)
        except Spill:
            rospy.logwarn("spilled")
rospy.Subscriber("scan", Float64, scan)
### raised before and after the body: clean, clean, False
def scan(msg):
    try:
        with Siren():
            amount = msg.data
        pour(amount)
    except Spill:
        rospy.logwarn("spilled")
rospy.Subscriber("scan", Float64, scan)
### raised by a library that a handler expects: scan:control, scan:data, False
def scan(msg):
    try:
        with Siren():
            int(msg.data)
    except ValueError:
        rospy.logwarn("no number")
rospy.Subscriber("scan", Float64, scan)
"""
CASES = sections(BODIES)


@pytest.mark.parametrize("title", CASES)
def test_exits(title: str) -> None:
    kind, error, suppresses = title.partition(": ")[2].split(", ")
    assert differing_topics(HEAD.format(kind=kind, error=error, suppresses=suppresses) + CASES[title]) == {}
