"""Absent fields of messages, and the services that a program calls, by syntax."""

from __future__ import annotations

import ast
from textwrap import dedent

import pytest

from tarl_lint.evidence import Outline
from tarl_lint.flows.statement_text import Texts
from tarl_lint.read.source import Module
from tarl_lint.system.called_services import called_services, part
from tarl_lint.system.unknown_fields import examined

HEAD = """\
from geometry_msgs.msg import Twist, Pose as P
from std_msgs.msg import Float64
from demo.msg import Own
"""


def absent(text: str) -> list[tuple[str, str]]:
    """Return the absent fields of a program with their message types."""
    whole = HEAD + dedent(text)
    module = Module("node.py", "node", whole, ast.parse(whole))
    found, _ = examined(module, Outline(module.tree), Texts({module.path: module}))
    return [(one.type, one.field) for one in found]


MADE = [
    ("t = Twist()\nt.linear.x = 1\nt.speed = 2", [("Twist", "speed")]),
    ("t = Twist()\nt.linear.w = 1", [("Vector3", "w")]),
    ("p = P()\nprint(p.position.x, p.orientation.w, p.x)", [("Pose", "x")]),
    ("t = Twist()\nt.linear.x.y = 1", []),
    ("t = Twist()\nt.serialize(b)\nt._type\nt.LIMIT\nt.angular", []),
    ("t = Twist()\nt = Own()\nt.speed = 1", []),
    ("t = Own()\nt.speed = 1", []),
    ("t = Float64(1.0)\nt.value = 1", [("Float64", "value")]),
    ("t = m.Twist()\nt.speed = 1", []),
    ("t, u = Twist(), 1\nt.speed = 1", [("Twist", "speed")]),
    ("for t in [Twist()]:\n    t.speed = 1", []),
    ("t = Twist()\nfor t in ts:\n    t.speed = 1", []),
    ("t = u = Twist()\nt.speed = 1", [("Twist", "speed")]),
    ("t = None\nt = Twist()\nt.speed = 1", [("Twist", "speed")]),
    ("t = Twist()\nif isinstance(t, Own):\n    t.speed = 1", []),
    ("t = Twist()\nif hasattr(t, 'speed'):\n    t.speed = 1", []),
    ("t = Twist()\ntry:\n    t.speed = 1\nexcept AttributeError:\n    pass", []),
    ("t = Twist()\nt += 1\nt.speed", []),
    ("t = Twist()\nwith a as t:\n    t.speed", []),
    ("t = Twist()\n*t, x = y\nt.speed", []),
    ("t = Twist() if a else Own()\nt.speed", []),
    ("t = copy.deepcopy(Twist())\nt.speed", [("Twist", "speed")]),
    ("t = rospy.wait_for_message('a', Twist)\nt.speed", [("Twist", "speed")]),
    # variables that are assigned many times from each other
    ("\n".join(["t = u[0]", "u = t[1]"] * 30) + "\nt.speed", []),
    ("for i, t in enumerate(Own().poses):\n    t.speed", []),
    ("ts = [t.speed for t in P().positions]", [("Pose", "positions")]),
]


@pytest.mark.parametrize(("body", "found"), MADE)
def test_unknown_field_of_a_new_message_is_absent(body, found):
    text = "def f():\n" + "\n".join(f"    {line}" for line in body.split("\n"))
    assert absent(text) == found
    assert absent(body) == found, "at the top of a module"


RECEIVED = [
    ("rospy.Subscriber('a', Twist, on)", "def on(msg):\n    print(msg.speed)", [("Twist", "speed")]),
    ("self.create_subscription(Twist, 'a', self.on, 1)",
     "def on(self, msg):\n    print(msg.speed)", [("Twist", "speed")]),
    ("rospy.Subscriber('a', Twist, on)", "def on(msg):\n    msg = msg.other()\n    print(msg.speed)", []),
    ("rospy.Subscriber('a', Own, on)", "def on(msg):\n    print(msg.speed)", []),
    ("rospy.Subscriber('a', Twist, callback=on)", "def on(msg):\n    print(msg.speed)", [("Twist", "speed")]),
    ("rospy.Subscriber('a', Twist, partial(on, 1))", "def on(x, msg):\n    print(x.speed, msg.speed)",
     [("Twist", "speed")]),
    ("rospy.Subscriber('a', Twist, lambda m: on(1, m))", "def on(x, msg):\n    print(x.speed, msg.speed)",
     [("Twist", "speed")]),
    ("rospy.Subscriber('a', Twist, lambda m: on(m.linear))", "def on(msg):\n    print(msg.speed)", []),
    ("rospy.Subscriber('a', Twist)", "def on(msg):\n    print(msg.speed)", []),
    ("rospy.Subscriber('a', Twist, on)\nrospy.Subscriber('b', Float64, on)", "def on(msg):\n    print(msg.speed)", []),
    ("rospy.Subscriber('a', Twist, on)\nrospy.Subscriber('b', Own, on)", "def on(msg):\n    print(msg.speed)", []),
    ("rospy.Subscriber('a', Twist, on)", "def on(msg, x):\n    print(x.speed)", []),
    ("rospy.Subscriber('a', Twist, on)", "def on():\n    print(msg.speed)", []),
    ("rospy.Subscriber('a', Twist, lambda m: m.speed)", "def on(msg):\n    print(msg.speed)", [("Twist", "speed")]),
    ("rospy.Subscriber('a', Twist, on)", "def on(msg):\n    print(msg.speed)\ndef on(msg):\n    print(msg.speed)", []),
]  # fmt: skip


@pytest.mark.parametrize(("register", "function", "found"), RECEIVED)
def test_unknown_field_of_a_received_message_is_absent(register, function, found):
    assert absent(f"{function}\n{register}") == found


@pytest.mark.parametrize(
    ("imported", "made"),
    [
        ("from std_msgs import msg as std", "std.ColorRGBA"),
        ("from std_msgs import msg", "msg.ColorRGBA"),
        ("import std_msgs.msg", "std_msgs.msg.ColorRGBA"),
        ("import std_msgs.msg as m", "m.ColorRGBA"),
    ],
)
def test_the_module_of_a_message_may_have_any_name(imported, made):
    text = f"{imported}\ndef f():\n    c = {made}(r=1, alpha=1)\n    c.red = 1\n"
    assert absent(text) == [("ColorRGBA", "alpha"), ("ColorRGBA", "red")]
    on = f"{imported}\ndef on(c):\n    print(c.red)\nrospy.Subscriber('a', {made}, on)\n"
    assert absent(on) == [("ColorRGBA", "red")]
    assert absent(f"{imported}\ndef f():\n    c = other.ColorRGBA(alpha=1)\n    c.red = 1\n") == []


@pytest.mark.parametrize(
    ("kinds", "function", "found"),
    [
        (["geometry_msgs/Twist"], "def on(self, msg):\n    print(msg.speed)", [("Twist", "speed")]),
        (["geometry_msgs/Twist"], "def on(self, which, msg):\n    print(msg.speed)", []),
        (["geometry_msgs/Twist", "std_msgs/Float64"], "def on(self, msg):\n    print(msg.speed)", []),
        (["demo/Own"], "def on(self, msg):\n    print(msg.speed)", []),
    ],
)
def test_the_analysis_may_show_which_messages_a_function_receives(kinds, function, found):
    module = Module("a.py", "a", function, ast.parse(function))
    outline, texts = Outline(module.tree), Texts({"a.py": module})
    heard = {"on": frozenset(kinds)}
    absent, unknown = examined(module, outline, texts, heard)
    assert [(one.type, one.field) for one in absent] == found
    assert [one.type for one in unknown] == (["demo/Own"] if kinds == ["demo/Own"] else [])


TWICE = """a = m.Synchronizer([image])
        b = m.Synchronizer([self.info])
        a.registerCallback(self.on), b.registerCallback(self.on)"""
SYNCHRONIZED = """
from sensor_msgs.msg import CameraInfo, Image
class Seam:
    def __init__(self):
        image = message_filters.Subscriber('image', Image)
        self.info = message_filters.Subscriber(self, CameraInfo, 'info')
        {}
    def on(self, image, info):
        print(image.cols, info.width, info.cols)
"""


@pytest.mark.parametrize(
    ("made", "found"),
    [
        ("self.s = TimeSynchronizer([image, self.info], 5)\n        self.s.registerCallback(self.on)", 2),
        ("m.ApproximateTimeSynchronizer((image, self.info), 5, 1).registerCallback(self.on)", 2),
        ("subs = [image, other]\n        m.TimeSynchronizer(subs, 5).registerCallback(self.on)", 1),
        ("m.TimeSynchronizer(subs, 5).registerCallback(self.on)", 0),
        ("m.Cache(image, 5).registerCallback(self.on)", 0),
        (TWICE, 0),
    ],
)  # fmt: skip
def test_synchronizer_passes_messages_in_filter_order(made, found):
    assert absent(SYNCHRONIZED.format(made)) == [("Image", "cols"), ("CameraInfo", "cols")][:found]


def test_no_field_is_absent_if_the_type_is_unknown():
    module = Module(
        "a.py", "a", "", ast.parse("from demo.msg import Twist\ndef f():\n    t = Twist()\n    t.x = 1")
    )
    assert examined(module, Outline(module.tree), Texts({"a.py": module}))[0] == ()


@pytest.mark.parametrize(
    ("call", "found"),
    [
        ("rospy.ServiceProxy('a', Add)", ("a", "Add")),
        ("rospy.ServiceProxy(name='a', service_class=srv.Add)", ("a", "Add")),
        ("self.create_client(Add, 'a')", ("a", "Add")),
        ("self.create_client(srv_name='a', srv_type=Add)", ("a", "Add")),
        ("rospy.ServiceProxy('a')", ("a", "")),
        ("rospy.ServiceProxy(name, Add)", None),
        ("rospy.ServiceProxy(1, Add)", None),
        ("rospy.ServiceProxy()", None),
        ("rospy.Service('a', Add)", None),
    ],
)
def test_service_name_of_a_client_is_read_from_a_literal(call, found):
    services = [(name, kind) for _, name, kind in called_services(Outline(ast.parse(call)))]
    assert services == ([found] if found else [])


@pytest.mark.parametrize(
    ("api", "sent", "received"),
    [
        ("rospy.ServiceProxy.__call__", " (request)", " (response)"),
        ("rclpy.create_client.call", " (request)", " (response)"),
        ("actionlib.SimpleActionClient.send_goal", " (goal)", " (result)"),
        ("rospy.Service", " (response)", " (request)"),
        ("rclpy.create_service", " (response)", " (request)"),
        ("rclpy.action.ActionServer.result", " (result)", " (goal)"),
        ("rclpy.action.ActionServer.publish_feedback", " (feedback)", " (feedback)"),
        ("actionlib.SimpleActionClient.feedback", " (feedback)", " (feedback)"),
        ("rospy.Publisher.publish", "", ""),
        ("rospy.Subscriber", "", ""),
    ],
)
def test_sent_or_received_part_of_a_service_is_named(api, sent, received):
    assert part(api, sent=True) == sent
    assert part(api, sent=False) == received
