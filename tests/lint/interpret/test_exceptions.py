"""An exception reaches the handlers that may catch it; statements that it skips depend on it."""

from __future__ import annotations

from textwrap import dedent, indent

import pytest

from tarl_lint import engine
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

NODE = """\
import socket
import rospy
from std_msgs.msg import Float64
{classes}

class Node:
    def __init__(self):
        self.x = 0
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.on_in)
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_in(self, msg):
{body}

    def tick(self, event):
{tick}

    def risky(self, v):
        if v > 1:
            raise ValueError(v)

rospy.init_node("node")
Node()
rospy.spin()
"""
CLASSES = """
class Fault(Exception):
    pass

class Worse(Fault):
    pass

class Missing(Fault, KeyError):
    pass
"""


def flows(body: str, tick: str = "pass", classes: str = CLASSES) -> list[str]:
    text = NODE.format(
        classes=classes, body=indent(dedent(body), " " * 8), tick=indent(dedent(tick), " " * 8)
    )
    module = parse("node.py", text.encode(), "node")
    assert isinstance(module, Module)
    return [f.kind for f in engine.analyse([module], Config())]


AROUND = """\
try:
    if msg.data > 1:
        raise {raised}
except {caught}:
    pass
self.pub.publish(1)
"""


@pytest.mark.parametrize(
    ("raised", "caught"),
    [
        ("ValueError", "KeyError"),
        ("KeyError", "(IndexError, OSError)"),
        ("LookupError", "KeyError"),
        ("Fault()", "Worse"),
        ("Fault()", "KeyError"),
        ("KeyboardInterrupt", "Exception"),
        ("make()", "ValueError"),  # of an unknown class
        ("ValueError", "ERRORS"),
        ("rospy.ROSException()", "rospy.ServiceException"),
        ("OSError", "socket.OSError"),  # another class of this name
    ],
)
def test_code_after_a_handler_depends_on_an_uncaught_exception(raised, caught):
    assert flows(AROUND.format(raised=raised, caught=caught)) == ["implicit"]


@pytest.mark.parametrize(
    ("raised", "caught"),
    [
        ("ValueError", "ValueError"),
        ("KeyError", "LookupError"),
        ("UnicodeError()", "(OSError, ValueError)"),
        ("OSError", "IOError"),
        ("Worse()", "Fault"),
        ("Missing()", "KeyError"),
        ("make()", "Exception"),
        ("KeyboardInterrupt", "BaseException"),
        ("rospy.ROSInterruptException()", "rospy.ROSException"),
        ("rospy.ROSException()", "Exception"),
    ],
)
def test_code_after_a_handler_ignores_a_caught_exception(raised, caught):
    assert flows(AROUND.format(raised=raised, caught=caught)) == []


def test_exception_with_two_definitions_may_be_of_either_class():
    twice = "if rospy:\n    class Fault(ValueError):\n        pass\nelse:\n    class Fault(Exception):\n        pass\n"
    assert flows(AROUND.format(raised="Fault", caught="ValueError"), classes=twice) == ["implicit"]


def test_uncaught_inner_exception_reaches_the_outer_handler():
    outer = """\
    try:
        try:
            if msg.data > 1:
                raise ValueError
        except KeyError:
            self.x = 2
        self.pub.publish(1)
    except {caught}:
        pass
    """
    assert flows(outer.format(caught="ValueError")) == ["implicit"]
    after = outer.replace("self.pub.publish(1)", "pass") + "self.pub.publish(1)"
    assert flows(after.format(caught="ValueError")) == []
    assert flows(after.format(caught="OSError")) == ["implicit"]


@pytest.mark.parametrize(("caught", "kinds"), [("ValueError", []), ("KeyError", ["implicit"])])
def test_exception_of_a_called_function_is_caught_by_class(caught, kinds):
    body = f"""\
    try:
        self.risky(msg.data)
    except {caught}:
        pass
    self.pub.publish(1)
    """
    assert flows(body) == kinds


def test_finally_passes_an_exception_on_unless_it_returns():
    body = """\
    try:
        if msg.data > 1:
            raise ValueError
    finally:
        {final}
    {after}
    """
    assert flows(body.format(final="pass", after="self.pub.publish(1)")) == ["implicit"]
    assert flows(body.format(final="self.pub.publish(1)", after="pass")) == []
    leaving = "if self.x:\n            return"
    assert flows(body.format(final=leaving, after="self.pub.publish(1)")) == ["implicit"]


@pytest.mark.parametrize("leaving", ["raise ValueError", "return", "return self.risky(0)"])
def test_stores_before_an_exception_are_kept(leaving):
    publish = "self.pub.publish(self.x)"
    assert flows(f"self.x = msg.data\n{leaving}", publish) == ["explicit"]
    final = f"try:\n    {leaving}\nfinally:\n    self.x = msg.data"
    assert flows(final, publish) == ["explicit"]
    assert flows(
        "for _ in range(2):\n    try:\n        break\n    finally:\n        self.x = msg.data", publish
    ) == ["explicit"]


def test_a_handler_sees_what_was_stored_before_the_exception():
    nested = """\
    try:
        if self.x < 9:
            self.x = msg.data
            self.risky({risk})
            self.x = 0
    except ValueError:
        self.pub.publish(self.x)
    """
    assert flows(nested.format(risk="5")) == ["explicit"]
    called = """\
    def store(v):
        self.x = v
        if self.pub:
            raise ValueError
        self.x = 0
    try:
        store(msg.data)
        {after}
    except ValueError:
        {handler}
    """
    assert flows(called.format(after="pass", handler="self.pub.publish(self.x)")) == ["explicit"]
    assert flows(called.format(after="self.pub.publish(self.x)", handler="pass")) == []


def test_next_iteration_depends_on_later_conditions():
    body = """\
    for i in (1, 2):
        if self.x:
            if msg.data > 1:
                return
        else:
            self.pub.publish(3)
        if not self.x:
            return
    """
    assert flows(body, tick="self.x = event") == ["implicit"]


@pytest.mark.parametrize(
    ("raised", "published"),
    [
        ("Worse(f'no {msg.data}')", "str(error)"),
        ("Worse(msg.data)", "error.args[0]"),
        ("ValueError(msg.data)", "error.args[0]"),
    ],
)
def test_an_exception_carries_its_arguments_through_handlers(raised, published):
    body = """\
    try:
        try:
            if msg.data > 1:
                raise {raised}
        except {inner}
            raise
    except Exception as error:
        self.pub.publish({published})
    """
    for inner in ("Fault:", "Exception:", "(Fault, ValueError) as first:"):
        assert flows(body.format(raised=raised, inner=inner, published=published)) == ["explicit"]


def test_text_of_a_failing_library_call_quotes_its_arguments():
    body = "try:\n    float({})\nexcept ValueError as error:\n    self.pub.publish(str(error))"
    assert flows(body.format("str(msg.data)")) == ["explicit"]
    assert flows(body.format("1.0")) == []


def test_handler_gets_only_data_of_caught_exceptions():
    body = """\
    try:
        if self.x:
            raise Worse("fixed")
        raise KeyError(msg.data)
    except Fault as error:
        self.pub.publish(str(error))
    except KeyError:
        pass
    """
    assert flows(body) == []


def test_handler_for_a_library_exception_catches_a_failing_call():
    body = """\
    for _ in range(2):
        try:
            self.pub.transform(msg.data)
        except {handled}:
            continue
    self.pub.publish(1)
    """
    assert flows(body.format(handled="tf2.TransformException")) == []
    assert flows(body.format(handled="(tf.LookupException, tf.ExtrapolationException)")) == []
    assert flows(body.format(handled="KeyError")) == ["implicit"]


@pytest.mark.parametrize(
    ("handled", "kinds"),
    [
        ("KeyboardInterrupt", []),
        ("(SystemExit, GeneratorExit)", []),
        ("OSError", ["implicit"]),
        ("(KeyboardInterrupt, OSError)", ["implicit"]),
    ],
)
def test_failing_call_does_not_end_the_program(handled, kinds):
    body = f"""\
    while True:
        try:
            if self.ready:
                self.library.parse(msg.data)
        except {handled}:
            break
        except Exception:
            pass
        self.pub.publish(1)
    """
    assert flows(body) == kinds
