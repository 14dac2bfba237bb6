"""Namespaces, and mappings made of unpacked ones, keep their entries apart."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback, sections

# The bodies of a callback `on(msg)`, each below its title.
PROGRAMS = """\
### a namespace of an unpacked comprehension
kept = SimpleNamespace(**{key: msg.data * 2 for key in ("a", "b")})
out.publish(kept.a)  # data
other = SimpleNamespace(**{key: 1.0 for key in ("a", "b")})
out.publish(other.b)  # clean
### a namespace of an unpacked mapping and keywords
table = {"a": 1.0, "b": msg.data}
kept = SimpleNamespace(c=2.0, **table)
out.publish(kept.a)  # clean
out.publish(kept.b)  # data
out.publish(kept.c)  # clean
kept.b = 3.0
out.publish(kept.b)  # clean
out.publish(table["b"])  # data
### a namespace with names from the data
kept = SimpleNamespace(**{name: msg.data for name in names})
out.publish(kept.speed)  # data
kept = SimpleNamespace(**{name: 1.0 for name in names})
out.publish(kept.speed)  # clean
### publishers in a namespace
outs = SimpleNamespace(**{key: rospy.Publisher(key, Float64, queue_size=1) for key in names})
outs.speed.publish(msg.data)  # data
outs.speed.publish(1.0)  # clean
### the mapping of a namespace
kept = SimpleNamespace(a=0.0, b=0.0)
vars(kept).update(a=msg.data)
out.publish(kept.a)  # data
out.publish(kept.b)  # clean
kept.__dict__.update({"b": msg.data})
out.publish(kept.b)  # data
vars(kept)["a"] = 1.0
out.publish(kept.a)  # clean
vars(kept).update(**{"a": msg.data})
out.publish(kept.a)  # data
out.publish(vars(kept)["b"])  # data
### names chosen by constants
kept = SimpleNamespace(a=0.0, b=0.0)
setattr(kept, "a", msg.data)
out.publish(getattr(kept, "a"))  # data
out.publish(getattr(kept, "b"))  # clean
### mappings of unpacked mappings
made = dict(**{key: msg.data * 2 for key in ("a", "b")})
out.publish(made["a"])  # data
made = dict({"a": 1.0}, c=2.0, **{"b": msg.data})
out.publish(made["a"])  # clean
out.publish(made["b"])  # data
out.publish(made["c"])  # clean
made = {}
made.update(**{"a": msg.data})
out.publish(made["a"])  # data
made = collections.OrderedDict(**{"a": 1.0})
out.publish(made["a"])  # clean
"""
CASES = sections(PROGRAMS)
HEAD = """\
import collections
from types import SimpleNamespace
names = rospy.get_param("~names")
"""
KEPT_ACROSS = """\
import rospy
from types import SimpleNamespace
from std_msgs.msg import Float64
TOPICS = {"fast": "speed/fast", "slow": "speed/slow"}
state = SimpleNamespace(speed=0.0, count=0, gain=1.0)
outs = SimpleNamespace(**{name: rospy.Publisher(t, Float64, queue_size=1) for name, t in TOPICS.items()})
def on(msg):
    vars(state).update(speed=msg.data)
    state.count += 1
def tick(event):
    outs.fast.publish(state.speed)  # data
    outs.slow.publish(state.gain)  # clean
rospy.Subscriber("in", Float64, on)
rospy.Timer(rospy.Duration(1), tick)
rospy.spin()
"""


@pytest.mark.parametrize("title", CASES)
def test_namespaces_and_unpacked_mappings_have_the_marked_flows(title):
    assert differing(in_callback(CASES[title], HEAD)) == {}


def test_a_namespace_keeps_its_attributes_apart_across_callbacks():
    assert differing(KEPT_ACROSS) == {}
