"""Hazards: what is reported, at which line, and what looks alike but is right."""

import json
from textwrap import dedent

import pytest

from tarl_lint import engine
from tarl_lint.cli import main
from tarl_lint.config import Config
from tarl_lint.source import Module, parse

RANGE = """
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Range
    from robot import controller
    LIMIT = 0.5
    pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
    def clamped(value):
        if value > LIMIT:
            return LIMIT
        return value
    def on_range(msg):
        cmd = Twist()
{body}
        pub.publish(cmd)
    rospy.Subscriber("/range", Range, on_range)
"""

ROSPY = """
    import threading
    import rospy
    from std_msgs.msg import Float64
    class Node:
        def __init__(self):
            self.lock = threading.Lock()
            self.changed = threading.Condition(self.lock)
            self.value = 0.0
            self.pub = rospy.Publisher("/out", Float64, queue_size=1)
            rospy.Subscriber("/in", Float64, self.on_value)
            rospy.Timer(rospy.Duration(0.1), self.on_timer)
        def on_value(self, msg):
            with self.lock:
                self.value = msg.data
        def on_timer(self, event):
{body}
        def send(self):
            self.pub.publish(self.value)
    Node()
    rospy.spin()
"""

RCLPY = """
    import threading
    import rclpy
    from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
    from rclpy.executors import {executor}
    from rclpy.node import Node
    from std_msgs.msg import Float64
    class Relay(Node):
        def __init__(self):
            super().__init__("relay")
            self.lock = threading.Lock()
            self.group = {group}()
            self.value = 0.0
            self.pub = self.create_publisher(Float64, "out", 1)
            self.create_subscription(Float64, "in", self.on_value, 1)
            self.create_timer(0.1, self.on_timer, callback_group={given})
        def on_value(self, msg):
            with self.lock:
                self.value = msg.data
        def on_timer(self):
            self.pub.publish(Float64(data=self.value))
    rclpy.init()
    executor = {executor}()
    executor.add_node(Relay())
    executor.spin()
"""


def lines(code: str, *texts: str) -> list[int]:
    """Return the lines of the hazards of one rule in files a.py, b.py, ..."""
    modules = []
    for name, text in zip("abc", texts, strict=False):
        module = parse(f"{name}.py", dedent(text).strip("\n").encode(), name)
        assert isinstance(module, Module)
        modules.append(module)
    return [f.span.line for f in engine.lint(modules, Config(select=(code,))) if f.code == code]


def inside(text: str, body: str, depth: int) -> str:
    """Put a body into a text, indented."""
    return text.format(body="\n".join(" " * depth + line for line in dedent(body).strip().split("\n")))


@pytest.mark.parametrize(
    "body",
    [
        "cmd.linear.x = 0.3 * msg.range",
        "speed = 0.3 * msg.range\ncmd.linear.x = speed",
        "cmd.linear.x = float(abs(2.0 - msg.range) / 3)",
        "if msg.range > 0.2:\n    cmd.linear.x = 0.3 * msg.range",
        "if msg.range < 0.2:\n    return\ncmd.linear.x = 0.3 * msg.range",
        "if 0.2 < msg.range:\n    cmd.linear.x = 0.3 * msg.range",
        "if msg.field_of_view < 0.1:\n    cmd.linear.x = 0.1\nelse:\n    cmd.linear.x = 0.3 * msg.range",
        "cmd.angular.z = min(0.5, msg.range)\ncmd.linear.x = 0.3 * msg.range",
    ],
)
def test_a_command_computed_from_a_sensor_without_limit_is_a_hazard(body):
    assert len(lines("TARL202", inside(RANGE, body, 8))) == 1


@pytest.mark.parametrize(
    "body",
    [
        "cmd.linear.x = min(0.5, 0.3 * msg.range)",
        "speed = 0.3 * msg.range\nif speed > LIMIT:\n    speed = LIMIT\ncmd.linear.x = speed",
        "cmd.linear.x = 0.3 * msg.range\nif cmd.linear.x > LIMIT:\n    cmd.linear.x = LIMIT",
        "speed = 0.3 * msg.range\ncmd.linear.x = speed if speed < LIMIT else LIMIT",
        "if msg.range < 0.5:\n    cmd.linear.x = 0.3 * msg.range",
        "if msg.range > 0.5:\n    return\ncmd.linear.x = 0.3 * msg.range",
        "if not msg.range > 0.5:\n    cmd.linear.x = 0.3 * msg.range",
        "if 0.1 < msg.range < 0.5:\n    cmd.linear.x = 0.3 * msg.range",
        "cmd.linear.x = clamped(0.3 * msg.range)",
        "cmd.linear.x = controller.step(0.3 * msg.range)",
        "cmd.linear.x = 0.3 if msg.range > 1.0 else 0.1",
        "cmd.linear.x = 1.0 * (msg.range > 1.0)",
    ],
)
def test_a_command_that_something_limits_is_none(body):
    assert lines("TARL202", inside(RANGE, body, 8)) == []


def test_the_line_that_computes_the_value_is_named_not_the_publish_call():
    body = "speed = 0.3 * msg.range\ncmd.linear.x = speed"
    assert lines("TARL202", inside(RANGE, body, 8)) == [13]


SPEED = """
    import rospy
    from nav_msgs.msg import Odometry
    from {package}.msg import {message}
    pub = rospy.Publisher("{topic}", {message}, queue_size=1)
    last = [0.0, 0.0]
    def on_odom(msg):
        x = msg.pose.pose.position.x
        now = msg.header.stamp.to_sec()
        made = {message}()
        made.{field} = {value}
        pub.publish(made)
        last[:] = [x, now]
    rospy.Subscriber("/odom", Odometry, on_odom)
"""


@pytest.mark.parametrize(
    ("topic", "value", "found"),
    [
        ("/cmd_vel", "2.0 * (1.0 - x)", 1),
        ("/wheel_velocity", "2.0 * (1.0 - x)", 1),
        ("/speed", "3.6 * msg.twist.twist.linear.x", 0),
        ("/speed", "(x - last[0]) / (now - last[1])", 0),
        ("/actual_speed", "2.0 * (1.0 - x)", 0),
        ("/distance", "2.0 * (1.0 - x)", 0),
    ],
)
@pytest.mark.parametrize(
    ("package", "message", "field"), [("std_msgs", "Float64", "data"), ("geometry_msgs", "Twist", "linear.x")]
)
def test_speeds_that_may_be_measurements_are_no_commands(topic, value, found, package, message, field):
    text = SPEED.format(topic=topic, value=value, package=package, message=message, field=field)
    assert len(lines("TARL202", text)) == found


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("self.pub.publish(self.value)", 1),
        ("self.value += 1.0", 1),
        ("self.send()", 1),
        ("with self.lock:\n    self.send()", 0),
        ("with self.changed:\n    self.pub.publish(self.value)", 0),
        ("self.lock.acquire()\ntry:\n    self.send()\nfinally:\n    self.lock.release()", 0),
        ("self.lock.acquire()\nself.lock.release()\nself.send()", 1),
        ("if self.value is None:\n    return", 0),
        ("pass", 0),
    ],
)
def test_state_of_a_callback_used_in_a_timer_needs_its_lock(body, found):
    assert len(lines("TARL201", inside(ROSPY, body, 12))) == found


@pytest.mark.parametrize(
    ("executor", "group", "given", "found"),
    [
        ("MultiThreadedExecutor", "ReentrantCallbackGroup", "self.group", 1),
        ("MultiThreadedExecutor", "MutuallyExclusiveCallbackGroup", "self.group", 1),
        ("MultiThreadedExecutor", "ReentrantCallbackGroup", "None", 0),
        ("SingleThreadedExecutor", "ReentrantCallbackGroup", "self.group", 0),
    ],
)
def test_callbacks_of_rclpy_overlap_only_where_they_are_told_to(executor, group, given, found):
    text = RCLPY.format(executor=executor, group=group, given=given)
    if given == "None":
        text = text.replace(", callback_group=None", "")
    assert len(lines("TARL201", text)) == found


def test_what_a_thread_of_ones_own_reads_needs_the_lock_in_rclpy_too():
    text = RCLPY.format(executor="SingleThreadedExecutor", group="ReentrantCallbackGroup", given="self.group")
    text = text.replace(
        "self.create_timer(0.1, self.on_timer, callback_group=self.group)",
        "threading.Thread(target=self.on_timer).start()",
    )
    assert len(lines("TARL201", text)) == 1


def test_flags_and_state_without_any_lock_are_not_reported():
    flag = inside(ROSPY, "self.pub.publish(self.value)", 12).replace(
        "self.value = msg.data", "self.value = True"
    )
    assert lines("TARL201", flag) == []
    bare = inside(ROSPY, "self.pub.publish(self.value)", 12).replace("with self.lock:", "if msg.data:")
    assert lines("TARL201", bare) == []


WATCH = """
    import rospy
    from sensor_msgs.msg import LaserScan
    nearest = None
    class Watch:
        def __init__(self):
            self.scan = None
            rospy.Subscriber("/scan", LaserScan, self.on_scan)
        def on_scan(self, msg):
            {body}
{more}
    rospy.init_node("watch")
    Watch()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("body", "more", "found"),
    [
        ("pass", "", 1),
        ("nearest = min(msg.ranges)", "", 1),
        ("self.scan = msg", "", 1),
        ("self.scan = msg", "        def look(self):\n            return self.scan", 0),
        ("self.scan = msg", "        def look(self, name):\n            return getattr(self, name)", 0),
        ("self.scan = msg", "        @property\n        def scan(self): ...", 0),
        ("global nearest; nearest = msg", "", 1),
        ("global nearest; nearest = msg", "    def look():\n        return nearest", 0),
        ("rospy.loginfo(msg)", "", 0),
        ("raise NotImplementedError", "", 0),
        ("return msg.ranges", "", 0),
    ],
)  # fmt: skip
def test_a_callback_that_does_nothing_that_matters_is_a_hazard(body, more, found):
    assert len(lines("TARL203", WATCH.format(body=body, more=more))) == found


def test_the_name_of_a_topic_is_no_use_of_an_attribute_of_that_name():
    text = WATCH.format(body="self.scan = msg", more="").replace("/scan", "scan")
    assert len(lines("TARL203", text)) == 1
    assert lines("TARL204", SENDER.format(more="").replace('"/a"', '"pub"')) == [6]
    looked_up = (
        "            from operator import attrgetter\n            attrgetter('pub')(self).publish(1.0)"
    )
    assert lines("TARL204", SENDER.format(more=looked_up).replace('"/a"', '"pub"')) == []


def test_a_callback_that_an_heir_replaces_is_none():
    base = WATCH.format(body="pass", more="").replace("Watch()", "Near()").replace(
        'rospy.init_node("watch")',
        'class Near(Watch):\n        def on_scan(self, msg):\n            print(msg)\n    rospy.init_node("watch")',
    )  # fmt: skip
    assert lines("TARL203", base) == []


SENDER = """
    import rospy
    from std_msgs.msg import Float64
    from helper import Helper
    class Sender:
        def __init__(self):
            self.pub = rospy.Publisher("/a", Float64, queue_size=1)
            self.other = rospy.Publisher("/b", Float64, queue_size=1)
        def run(self):
            self.other.publish(1.0)
{more}
    if __name__ == "__main__":
        Sender().run()
"""


@pytest.mark.parametrize(
    ("more", "found"),
    [
        ("", [6]),
        ("            print(self.pub.get_num_connections())", [6]),
        ("            self.pub.publish(1.0)", []),
        ("        def never_called(self):\n            self.pub.publish(1.0)", []),
        ("            Helper(self.pub)", []),
        ("            getattr(self, 'pub').publish(1.0)", []),
        ("            pub = self.pub", []),
        ("    class Else:\n        def send(self):\n            self.pub.publish(1.0)", []),
    ],
)
def test_a_publisher_that_nobody_could_publish_with_is_a_hazard(more, found):
    assert lines("TARL204", SENDER.format(more=more)) == found


def test_a_publisher_of_the_same_name_in_another_class_does_not_hide_one():
    more = """
    class Twin:
        def __init__(self):
            self.pub = rospy.Publisher("/c", Float64, queue_size=1)
        def send(self):
            self.pub.publish(1.0)
    Twin().send()
    """
    assert lines("TARL204", SENDER.format(more=more)) == [6]


def test_a_publisher_used_from_another_file_is_none():
    user = """
    from a import Sender
    Sender().pub.publish(1.0)
    """
    assert lines("TARL204", SENDER.format(more=""), user) == []


def test_hazards_fail_the_run_unless_ignored_or_silenced(in_directory, capsys):
    text = dedent(SENDER.format(more=""))
    in_directory({"node.py": text})
    assert main(["--fail-on", "hazard"]) == 1
    assert "TARL204 /a (Float64) is advertised" in capsys.readouterr().out
    assert main(["--ignore", "TARL2"]) == 0
    marked = text.replace(
        '"/a", Float64, queue_size=1)', '"/a", Float64, queue_size=1)  # tarl: ignore[TARL204]'
    )
    in_directory({"node.py": marked})
    assert main([]) == 0


def test_a_hazard_has_no_flow_in_json(in_directory, capsys):
    in_directory({"node.py": dedent(SENDER.format(more=""))})
    main(["--format", "json"])
    (diagnostic,) = json.loads(capsys.readouterr().out)["diagnostics"]
    assert diagnostic["code"] == "TARL204"
    assert "flow" not in diagnostic
