"""Code and lines that are reported as hazards, and similar code that is correct."""

import json
from textwrap import dedent

import pytest

from tarl_lint.cli import main
from tests.lint.hazardous import inside, lines

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
        "n = len(msg.ranges)\nahead = msg.ranges[n // 2]\ncmd.linear.x = 0.3 * ahead",
    ],
)
def test_unlimited_command_from_a_sensor_is_a_hazard(body):
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
        "cmd.linear.x = 2.0 * [0.1, 0.2, 0.3][int(msg.range)]",
    ],
)
def test_a_limited_command_is_not_a_hazard(body):
    assert lines("TARL202", inside(RANGE, body, 8)) == []


def test_hazard_is_reported_at_the_computation():
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
def test_speeds_that_may_be_measurements_are_not_commands(topic, value, found, package, message, field):
    text = SPEED.format(topic=topic, value=value, package=package, message=message, field=field)
    assert len(lines("TARL202", text)) == found


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
def test_a_callback_without_effect_is_a_hazard(body, more, found):
    assert len(lines("TARL203", WATCH.format(body=body, more=more))) == found


def test_topic_name_is_not_an_attribute_use():
    text = WATCH.format(body="self.scan = msg", more="").replace("/scan", "scan")
    assert len(lines("TARL203", text)) == 1
    assert lines("TARL204", SENDER.format(more="").replace('"/a"', '"pub"')) == [6]
    looked_up = (
        "            from operator import attrgetter\n            attrgetter('pub')(self).publish(1.0)"
    )
    assert lines("TARL204", SENDER.format(more=looked_up).replace('"/a"', '"pub"')) == []


def test_overridden_callback_is_no_hazard():
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
def test_an_unused_publisher_is_a_hazard(more, found):
    assert lines("TARL204", SENDER.format(more=more)) == found


def test_other_class_publisher_does_not_hide_an_unused_one():
    more = """
    class Twin:
        def __init__(self):
            self.pub = rospy.Publisher("/c", Float64, queue_size=1)
        def send(self):
            self.pub.publish(1.0)
    Twin().send()
    """
    assert lines("TARL204", SENDER.format(more=more)) == [6]


def test_publisher_used_in_another_file_is_no_hazard():
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


def test_the_json_of_a_hazard_contains_no_flow(in_directory, capsys):
    in_directory({"node.py": dedent(SENDER.format(more=""))})
    main(["--format", "json"])
    (diagnostic,) = json.loads(capsys.readouterr().out)["diagnostics"]
    assert diagnostic["code"] == "TARL204"
    assert "flow" not in diagnostic


DECIDED = """
    import rospy
    from race.msg import {kind}
    from ackermann_msgs.msg import AckermannDriveStamped
    pub = rospy.Publisher("/drive", AckermannDriveStamped, queue_size=1)
    def on_message(msg):
        made = AckermannDriveStamped()
        made.drive.speed = 0.3 * msg.{field}
        pub.publish(made)
    rospy.Subscriber("{topic}", {kind}, on_message)
"""


@pytest.mark.parametrize(
    ("kind", "field", "topic", "found"),
    [
        ("drive_param", "velocity", "/drive_parameters", 0),
        ("drive_param", "velocity", "/sensors", 0),
        ("Float64", "data", "/velocity_msg", 0),
        ("Twist", "linear.x", "/base/vel", 0),
        ("Joy", "axes", "/joy", 0),
        ("Odometry", "pose.pose.position.x", "/target_odom", 0),
        ("Float64", "data", "/front_distance", 1),
        ("Odometry", "pose.pose.position.x", "/base/pose", 1),
        ("Range", "range", "/anything", 1),
        ("Unheard", "range", "/scan", 0),
    ],
)
def test_only_measurements_are_sensors(kind, field, topic, found):
    assert len(lines("TARL202", DECIDED.format(kind=kind, field=field, topic=topic))) == found
