"""`getattr` with a name that is computed, and queries whether an object has an attribute."""

from __future__ import annotations

from textwrap import dedent

import pytest

from tarl_lint import engine
from tarl_lint.read.source import parse
from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import rospy, sys
from std_msgs.msg import Float64, String
class Node:
    def __init__(self):
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        self.names = {"a": "on_a", "b": "on_b"}
        self.setup()
        rospy.Subscriber("scan", Float64, self.scan)
        rospy.Subscriber("pose", String, self.pose)
        rospy.Timer(rospy.Duration(1.0), self.tick)
    def setup(self): pass
    def scan(self, msg): pass
    def tick(self, event): pass
    def on_a(self, data):
        self.out.publish(data)  # A
    def on_b(self, data):
        self.out.publish(1.0)  # B
    def b_on(self, data):
        self.out.publish(2.0)  # REST
"""
# title: what reaches the publish calls of `on_a`, `on_b` and `b_on`
CALLED = """\
### a table of names
    def pose(self, msg):
        getattr(self, self.names[msg.kind])(msg.data)
### a beginning
    def pose(self, msg):
        getattr(self, "on_" + msg.kind)(msg.data)
### a beginning of a formatted text
    def pose(self, msg):
        handler = getattr(self, f"on_{msg.kind}", None)
        if handler is not None:
            handler(msg.data)
### format
    def pose(self, msg):
        getattr(self, "on_{}".format(msg.kind))(msg.data)
### percent
    def pose(self, msg):
        getattr(self, "on_%s" % msg.kind)(msg.data)
### a beginning in a variable
    def pose(self, msg):
        name = "on_" + msg.kind.lower()
        if hasattr(self, name):
            getattr(self, name)(msg.data)
### a beginning in a variable that is used for a variable
    def pose(self, msg):
        kind = msg.kind
        name = f"on_{kind}"
        method = name
        getattr(self, method, self.scan)(msg.data)
### a beginning in a parameter
    def dispatch(self, name, data):
        name = "on_" + name
        getattr(self, name)(data)
    def pose(self, msg):
        self.dispatch(msg.kind, msg.data)
### a beginning in a constant
    def pose(self, msg):
        getattr(self, PREFIX + msg.kind)(msg.data)
### a beginning in an argument
    def dispatch(self, group, kind, data):
        getattr(self, group + "_" + kind)(data)
    def pose(self, msg):
        self.dispatch("on", msg.kind, msg.data)
### a method of the class
    def pose(self, msg):
        getattr(Node, "on_" + msg.kind)(self, msg.data)
### a method of the type
    def pose(self, msg):
        getattr(type(self), "on_" + msg.kind)(self, msg.data)
"""
OTHERS = """\
### an end
    def pose(self, msg):
        getattr(self, msg.kind + "_command")(msg.data)
    def a_command(self, data):
        self.out.publish(data)  # pose:data
    def b_command(self, data):
        self.out.publish(3.0)  # pose:control
    def command_c(self, data):
        self.out.publish(4.0)  # clean
### a beginning and an end
    def pose(self, msg):
        getattr(self, f"do_{msg.kind}_now")(msg.data)
    def do_a_now(self, data):
        self.out.publish(data)  # pose:data
    def do_b_now(self, data):
        self.out.publish(3.0)  # pose:control
    def do_b_later(self, data):
        self.out.publish(4.0)  # clean
### publishers and numbers
    def setup(self):
        self.pub_left = rospy.Publisher("left", Float64)
        self.pub_right = rospy.Publisher("right", Float64)
        self.gain_left, self.gain_right, self.kept = 1.0, 2.0, 0.0
        self.last_left, self.last_right = 1.0, 2.0
    def scan(self, msg):
        self.kept = msg.data
        self.last_left = msg.data
    def pose(self, msg):
        getattr(self, "pub_" + msg.kind).publish(1.0)  # pose:control
        self.out.publish(getattr(self, "gain_" + msg.kind))  # pose:data
        self.out.publish(getattr(self, "last_" + msg.kind))  # pose:data scan:data
### a state
    def setup(self):
        self.state = "idle"
    def scan(self, msg):
        self.state = "moving" if msg.data > 1.0 else "idle"
    def tick(self, event):
        getattr(self, "run_" + self.state)()
    def run_idle(self):
        self.out.publish(0.0)  # scan:control
    def run_moving(self):
        self.out.publish(1.0)  # scan:control
    def run_other(self):
        self.out.publish(2.0)  # clean
### a stored attribute
    def pose(self, msg):
        if msg.data > 1.0:
            self.extra = rospy.Publisher("extra", Float64)
            self.last = msg.data
    def tick(self, event):
        if "extra" in self.__dict__:
            self.out.publish(1.0)  # pose:control
        if "extra" not in vars(self):
            self.out.publish(2.0)  # pose:control
        if hasattr(self, "extra"):
            self.out.publish(3.0)  # pose:control
        if getattr(self, "extra", None) is not None:
            self.out.publish(4.0)  # pose:control
        if "names" in self.__dict__ and "other" not in self.__dict__:
            self.out.publish(5.0)  # clean
        self.out.publish(self.__dict__["last"])  # pose:data
### an object with elements
    def setup(self):
        self.box = Box()
    def pose(self, msg):
        if msg.data > 1.0:
            self.box.held.append("extra")
            self.box.extra = 1.0
    def scan(self, msg):
        self.box.held.append(msg.data)
    def tick(self, event):
        if "extra" in self.box:
            self.out.publish(1.0)  # pose:control scan:control
class Box:
    def __init__(self):
        self.held = []
    def __iter__(self):
        return iter(self.held)
### an attribute that is always stored
    def pose(self, msg):
        self.last = msg.data
    def tick(self, event):
        if "last" in self.__dict__ and hasattr(self, "last"):
            self.out.publish(1.0)  # clean
"""
CASES = sections(CALLED)
MORE = sections(OTHERS)
END = 'PREFIX = "on_"\nNode()\nrospy.spin()\n'


@pytest.mark.parametrize("title", CASES)
def test_methods_with_the_known_parts_of_a_name_may_be_called(title):
    head = HEAD.replace("# A", "# pose:data").replace("# B", "# pose:control").replace("# REST", "# clean")
    assert differing_topics(f"{head}{CASES[title]}{END}") == {}


@pytest.mark.parametrize("title", MORE)
def test_attributes_by_name(title):
    head = HEAD.replace("# A", "# clean").replace("# B", "# clean").replace("# REST", "# clean")
    assert differing_topics(f"{head}{MORE[title]}{END}") == {}


def test_functions_of_a_module_by_name():
    handlers = """
        def do_a(node, data):
            node.out.publish(data)  # data
        def do_b(node, data):
            node.out.publish(1.0)  # control
        def no_b(node, data):
            node.out.publish(2.0)  # clean
    """
    dispatch = '    def pose(self, msg):\n        getattr(handlers, "do_" + msg.kind)(self, msg.data)\n'
    texts = {"node": f"import handlers\n{HEAD}{dispatch}{END}", "handlers": dedent(handlers)}
    found = engine.analyse(
        [parse(f"{name}.py", text.encode(), name) for name, text in texts.items()], Config()
    )
    kinds = {flow.sink.span.line: flow.kind for flow in found}
    assert kinds == {3: "explicit", 5: "implicit"}
