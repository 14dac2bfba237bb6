"""TARL204 reports a publisher only if nothing could publish with it."""

from __future__ import annotations

from textwrap import dedent

import pytest

from tests.lint.hazardous import lines

HEAD = """\
import rospy
from std_msgs.msg import Float64
from robot import Base, helper, send
"""
FOOT = "\nif __name__ == '__main__':\n    rospy.spin()\n"
MADE = "rospy.Publisher('a', Float64, queue_size=1)"


def found(body: str, *others: str, foot: str = FOOT) -> list[int]:
    """Return the lines of unused publishers, from 1 at the begin of the body."""
    text = HEAD + dedent(body).replace("MADE", MADE) + foot
    return [line - HEAD.count("\n") for line in lines("TARL204", text, *others)]


UNUSED = {
    "a statement of its own": "MADE",
    "a name that nothing reads": "pub = MADE",
    "an annotated name": "pub: rospy.Publisher = MADE",
    "two names": "pub = other = MADE",
    "questions about subscribers": "pub = MADE\nif pub.get_num_connections() > 0:\n    print(pub.name)",
    "a truth value": "pub = MADE\nif pub:\n    pass\nwhile not pub:\n    pass\nx = 1 if pub else 2\ny = pub is None",
    "the end of the publisher": "pub = MADE\npub.unregister()",
    "a local name": "def f():\n    pub = MADE\ndef g(pub):\n    send(pub)\nf()",
    "an attribute": "class C:\n    def __init__(self):\n        self.pub = MADE\nC()",
    "a name that is stored again": "pub = MADE\npub = None",
    "destroyed by its node": "pub = MADE\nnode.destroy_publisher(pub)",
}
LINES = {"a local name": 2, "an attribute": 3}
USED = {
    "a publish call": "pub = MADE\npub.publish(1.0)",
    "a publish call in a function that nothing calls": "pub = MADE\ndef f():\n    pub.publish(1.0)",
    "an annotated name": "pub: rospy.Publisher = MADE\npub.publish(1.0)",
    "one of two names": "pub = other = MADE\nother.publish(1.0)",
    "an argument": "pub = MADE\nhelper(pub)",
    "an argument as it is made": "helper(MADE)",
    "a result": "def f():\n    return MADE\nf().publish(1.0)",
    "an element of a list": "pubs = [MADE]\npubs[0].publish(1.0)",
    "an element that is stored": "pubs = {}\npubs['a'] = MADE\npubs['a'].publish(1.0)",
    "an element of a tuple": "pub, n = MADE, 1\npub.publish(1.0)",
    "its method as a value": "pub = MADE\nsend(pub.publish)",
    "a comparison with another publisher's method": "pub = MADE\npub.other()",
    "a global name of a function": "def f():\n    global pub\n    pub = MADE\ndef g():\n    pub.publish(1.0)\nf()\ng()",
    "a name around a function": "def f():\n    pub = MADE\n    def g():\n        pub.publish(1.0)\n    g()\nf()",
    "a look-up by text": "class C:\n    def __init__(self):\n        self.pub = MADE\n    def f(self, name):\n"
    "        getattr(self, name).publish(1.0)\nC()",
    "a callback for events": "pub = node.create_publisher(Float64, 'a', 1, event_callbacks=helper)",
    "an assignment expression": "if (pub := MADE):\n    pub.publish(1.0)",
    "a with statement": "with MADE as pub:\n    pub.publish(1.0)",
}  # fmt: skip


@pytest.mark.parametrize("name", UNUSED)
def test_a_publisher_without_use_is_reported(name):
    assert found(UNUSED[name]) == [LINES.get(name, 1)]


@pytest.mark.parametrize("name", USED)
def test_a_publisher_that_may_publish_is_not_reported(name):
    assert found(USED[name]) == []


def test_unused_publisher_in_a_library_is_not_reported():
    body = "class C:\n    def __init__(self):\n        self.pub = MADE\nC()"
    assert found(body, foot="\n") == []
    assert found("MADE", foot="\n") == [1], "no other code can reach a publisher without a name"


def test_name_imported_elsewhere_may_be_used_there():
    other = "from a import pub\npub.publish(1.0)\n"
    assert found("pub = MADE", other) == []
    assert found("pub = MADE", "import b\n") == [1]


CLASSES = """\
class A({bases}):
    def __init__(self):
        self.pub = MADE
class B({others}):
    def __init__(self):
        self.pub = rospy.Publisher('b', Float64, queue_size=1)
    def send(self):
        self.pub.publish(1.0)
A()
B().send()
"""


@pytest.mark.parametrize(
    ("bases", "others", "expected"),
    [("", "", [3]), ("Base", "", [3]), ("", "A", []), ("Base, robot.B", "", [])],
)
def test_possible_subclass_shares_the_publishers_of_its_base(bases, others, expected):
    assert found(CLASSES.format(bases=bases, others=others)) == expected


def test_the_message_names_the_topics_and_types():
    from tarl_lint import engine
    from tarl_lint.read.source import Module, parse
    from tarl_lint.settings.config import Config

    module = parse("a.py", (HEAD + MADE + f"\nrospy.Publisher(helper(), Float64)\n{FOOT}").encode(), "a")
    assert isinstance(module, Module)
    assert [one.message for one in engine.lint([module], Config(select=("TARL204",)))] == [
        "a (Float64) is advertised, but nothing is ever published on it",
        "a topic (Float64) is advertised, but nothing is ever published on it",
    ]
