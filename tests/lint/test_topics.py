"""Topic names are folded from constant strings, and empty if unknown."""

import pytest

from tarl_lint import engine
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

NODE = """
import os
from enum import Enum
import rospy
from std_msgs.msg import Float64

NAMES = ("left", "right")
prefix = "robot"


class Topic(str, Enum):
    SCAN = "scan"


def subscribe(topic, callback):
    rospy.Subscriber(topic, Float64, callback)


def on_value(msg):
    pub.publish(msg.data)


rospy.init_node("node")
pub = rospy.Publisher("out", Float64, queue_size=1)
"""


DEFAULT = Config()


def topics(statement, config=DEFAULT):
    module = parse("node.py", (NODE + statement + "\n").encode(), "node")
    assert isinstance(module, Module)
    return [flow.source.topics for flow in engine.analyse([module], config)]


@pytest.mark.parametrize(
    ("expression", "wanted"),
    [
        ('"in"', ("in",)),
        ('prefix + "/in"', ("robot/in",)),
        ('f"/{prefix}/in"', ("/robot/in",)),
        ("Topic.SCAN.value", ("scan",)),
        ("Topic.SCAN", ("scan",)),
        ('prefix + "/" + Topic.SCAN.value', ("robot/scan",)),
        ("os.value", ()),
        ('"/%s/in" % prefix', ("/robot/in",)),
        ('"/%s/%d" % (prefix, 2)', ("/robot/2",)),
        ('"/{}/in".format(prefix)', ("/robot/in",)),
        ('"/".join([prefix, "in"])', ("robot/in",)),
        ('os.path.join(prefix, "in")', ("robot/in",)),
        ('rospy.resolve_name("in")', ("in",)),
        ('"/in".lstrip("/")', ("in",)),
        ("prefix + str(3)", ("robot3",)),
        ('rospy.get_param("~topic")', ()),
        ('prefix + "/" + rospy.get_param("~topic")', ()),
        ('rospy.get_name() + "/in"', ()),
    ],
)
def test_the_topic_of_a_subscription_is_found(expression, wanted):
    assert topics(f"rospy.Subscriber({expression}, Float64, on_value)") == [wanted]


def test_the_topic_is_found_through_a_helper():
    assert topics('subscribe(prefix + "/in", on_value)') == [("robot/in",)]


def test_a_loop_subscribes_to_each_of_its_topics():
    assert topics("for name in NAMES:\n    rospy.Subscriber(name, Float64, on_value)") == [
        ("left",),
        ("right",),
    ]


def test_remapped_topics_have_their_new_name():
    config = Config(remaps=(("/in", "/front/in"), ("other", "never")))
    assert topics('subscribe("in", on_value)', config) == [("/front/in",)]


def test_all_names_from_a_loop_are_found():
    assert topics('for side in NAMES:\n    subscribe(side + "/in", on_value)') == [
        ("left/in",),
        ("right/in",),
    ]


def test_names_in_nested_tables_are_found():
    rows = ", ".join(f"(('s{n}', 1), ('p', 2))" for n in range(6))
    code = (
        f'for (s, _), (p, _) in [{rows}]:\n    rospy.Subscriber("/{{}}/%s".format(s) % p, Float64, on_value)'
    )
    assert topics(code) == [(f"/s{n}/p",) for n in range(6)]
