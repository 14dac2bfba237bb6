"""Names in the patterns of `match` have the part of the subject that they capture."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback

HEAD = "import rospy\nfrom modes import Mode, P"
# The bodies of a callback `on(msg)`, each below its title.
PROGRAMS = """\
### match of a sequence
match [1.0, msg.data, 2.0]:
    case [a, b, c]:
        out.publish(a)  # clean
        out.publish(b)  # data
        out.publish(c)  # clean
match (1.0, 2.0, msg.data):
    case (first, *rest):
        out.publish(first)  # clean
        out.publish(rest[1])  # data
match [msg.data, 1.0, 2.0]:
    case [*start, end]:
        out.publish(start[0])  # data
        out.publish(end)  # clean
match [1.0, msg.data, 2.0]:
    case [_, *_]:
        out.publish(3.0)  # clean
### match of a mapping
match {"a": msg.data, "b": 1.0}:
    case {"a": x, "b": y}:
        out.publish(x)  # data
        out.publish(y)  # clean
match {"a": 1.0, "b": msg.data}:
    case {"a": x, **rest}:
        out.publish(x)  # clean
        out.publish(rest["b"])  # data
### match of an object
class P:
    __match_args__ = ("x", "y")
    def __init__(self, x, y):
        self.x = x
        self.y = y
match P(msg.data, 1.0):
    case P(x=a, y=b):
        out.publish(a)  # data
        out.publish(b)  # clean
### names for parts and alternatives
match msg.data:
    case 1.0 | 2.0 as x:
        out.publish(x)  # data
    case (3.0 as y) | (4.0 as y):
        out.publish(y)  # data
    case z:
        out.publish(z)  # data
### alternatives that always match decide nothing
match msg.data:
    case _ if rospy.get_time() > 1.0:
        out.publish(1.0)  # clean
    case 1.0 | _:
        out.publish(2.0)  # clean
### a value of a match decides
match msg.mode:
    case "a":
        out.publish(1.0)  # control
    case None:
        out.publish(2.0)  # control
    case Mode.B:
        out.publish(3.0)  # control
    case [1, 2]:
        out.publish(4.0)  # control
    case {"k": 1}:
        out.publish(5.0)  # control
    case P(x=1):
        out.publish(6.0)  # control
out.publish(7.0)  # clean
### a pattern within a pattern
match {"a": [1.0, {"b": msg.data}]}:
    case {"a": [x, {"b": y}]}:
        out.publish(x)  # clean
        out.publish(y)  # data
"""
CASES = dict(one.split("\n", 1) for one in PROGRAMS.removeprefix("### ").split("\n### "))


@pytest.mark.parametrize("title", CASES)
def test_a_match_pattern_captures_its_part_of_the_subject(title):
    assert differing(in_callback(CASES[title], HEAD)) == {}
