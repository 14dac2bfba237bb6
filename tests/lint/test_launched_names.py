"""Topic names that only the launch of a node determines, in all the ways in which nodes compute them."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import Request, systems
from tests.lint.test_system import MANIFEST, write

ROS1 = """\
#!/usr/bin/env python3
import ast, os, sys
import rospy
from std_msgs.msg import String
rospy.init_node("n")
"""
RELAY = """
pub = rospy.Publisher(out, String, queue_size=1)
rospy.Subscriber(inp, String, lambda msg: pub.publish(msg))
rospy.spin()
"""
EACH = """
class Relay:
    def __init__(self, inp, out):
        self.pub = rospy.Publisher(out, String, queue_size=1)
        rospy.Subscriber(inp, String, self.on)

    def on(self, msg):
        self.pub.publish(msg)
"""
SPIN = "\nrospy.spin()\n"
ARGUMENTS = "import argparse\nparser = argparse.ArgumentParser()\n"
AB = {("/a", "/b")}
PAIRS = {("/a", "/b"), ("/c", "/d")}
# name, attributes of the node, elements in it, code, flows
NODES = [
    ("argparse, positional", 'args="/a /b"', "", ARGUMENTS + """
parser.add_argument("inp", help="topic")
parser.add_argument("out", type=str)
args = parser.parse_args(rospy.myargv()[1:])
inp, out = args.inp, args.out""" + RELAY, AB),
    ("argparse, options", 'args="-i /a --out=/b"', "", ARGUMENTS + """
parser.add_argument("-i", "--inp", default="/x", type=str)
parser.add_argument("--out", dest="sent", default="/y")
args = parser.parse_args(rospy.myargv(argv=sys.argv)[1:])
inp, out = args.inp, args.sent""" + RELAY, AB),
    ("argparse, defaults", "", "", ARGUMENTS + """
group = parser.add_argument_group("topics")
group.add_argument("--inp", default="/a")
group.add_argument("--out", default="/b")
args, rest = parser.parse_known_args()
inp, out = args.inp, args.out""" + RELAY, AB),
    ("argparse, a flag", 'args="--swap"', "", ARGUMENTS + """
parser.add_argument("--swap", action="store_true")
args = parser.parse_args(rospy.myargv()[1:])
inp, out = ("/a", "/b") if args.swap else ("/c", "/d")""" + RELAY, AB),
    ("optparse", 'args="--inp /a --out /b"', "", """
from optparse import OptionParser
parser = OptionParser()
parser.add_option("--inp", dest="inp", default="/x")
parser.add_option("--out", dest="out", default="/y")
(options, args) = parser.parse_args(rospy.myargv()[1:])
inp, out = options.inp, options.out""" + RELAY, AB),
    ("a mapping", "", "<rosparam>topics: {inp: /a, out: /b}</rosparam>", """
topics = rospy.get_param("~topics", {})
inp, out = topics["inp"], topics.get("out", "/z")""" + RELAY, AB),
    ("all own parameters", "", "<rosparam>{inp: /a, out: /b}</rosparam>", """
inp, out = (rospy.get_param("~")[one] for one in ("inp", "out"))
inp, out = rospy.get_param("~")["inp"], rospy.get_param("~")["out"]""" + RELAY, AB),
    ("below its own name", "", "<rosparam>{inp: /a, out: /b}</rosparam>", """
own = rospy.get_name()
inp, out = rospy.get_param(own + "/inp"), rospy.get_param(f"{own}/out")""" + RELAY, AB),
    ("text that is split", "", '<param name="pair" value="/a,/b"/>', """
inp, out = rospy.get_param("~pair").split(",")""" + RELAY, AB),
    ("text with a list", "", """<param name="topics" value="['/a', '/c']"/>""", EACH + """
kept = [Relay(one, one + "/out") for one in ast.literal_eval(rospy.get_param("~topics"))]""" + SPIN,
     {("/a", "/a/out"), ("/c", "/c/out")}),
    ("a function that reads parameters", "", "<rosparam>{camera: {image: /a}, out: /b}</rosparam>", """
def load(name, default=None):
    return rospy.get_param("~" + name, default)
inp, out = load("camera/image", "/x"), load("out")""" + RELAY, AB),
    ("a list of mappings", "", "<rosparam>pairs: [{inp: /a, out: /b}, {inp: /c, out: /d}]</rosparam>", EACH + """
kept = [Relay(one["inp"], one["out"]) for one in rospy.get_param("~pairs")]""" + SPIN, PAIRS),
    ("pairs of a mapping", "", "<rosparam>pairs: {a: /b, c: /d}</rosparam>", EACH + """
for name, out in rospy.get_param("~pairs").items():
    kept = Relay("/" + name, out)""" + SPIN, PAIRS),
    ("a table of publishers", "", "<rosparam>names: [r, s]</rosparam>", """
pubs = {}
def on(msg, name):
    pubs[name].publish(msg)
for name in rospy.get_param("~names"):
    pubs[name] = rospy.Publisher(name + "/out", String, queue_size=1)
    rospy.Subscriber(name + "/in", String, on, callback_args=name)""" + SPIN,
     {("/r/in", "/r/out"), ("/s/in", "/s/out")}),
    ("numbered robots", "", '<param name="count" value="2"/>', EACH + """
robots = []
for number in range(rospy.get_param("~count", 1)):
    robots.append(Relay("/r%d/odom" % number, "/r{}/cmd".format(number)))""" + SPIN,
     {("/r0/odom", "/r0/cmd"), ("/r1/odom", "/r1/cmd")}),
    ("callbacks by name", "", "", """
class Node:
    def __init__(self):
        self.pub = rospy.Publisher("/b", String, queue_size=1)
        for name in ["a", "c"]:
            rospy.Subscriber("/" + name, String, getattr(self, "on_" + name))

    def on_a(self, msg):
        self.pub.publish(msg)

    def on_c(self, msg):
        rospy.loginfo(msg.data)

Node()""" + SPIN, AB),
    ("synchronized topics in a list", "", "<rosparam>topics: [/a, /c]</rosparam>", """
import message_filters
pub = rospy.Publisher("/b", String, queue_size=1)
def on(*messages):
    pub.publish(" ".join(one.data for one in messages))
several = []
for topic in rospy.get_param("~topics"):
    several.append(message_filters.Subscriber(topic, String))
message_filters.TimeSynchronizer(several, 10).registerCallback(on)""" + SPIN, {("/a", "/b"), ("/c", "/b")}),
    ("a condition on what was passed", "", '<param name="second" value="false"/>', """
class Node:
    def __init__(self, use):
        self.use = bool(use)
        self.setup()

    def setup(self):
        self.pub = rospy.Publisher("/b", String, queue_size=1)
        rospy.Subscriber("/c" if self.use else "/a", String, self.on)

    def on(self, msg):
        self.pub.publish(msg)

second = rospy.get_param("~second", True)
Node(second)""" + SPIN, AB),
    ("a comprehension of publishers", "", "<rosparam>names: [r, s]</rosparam>", """
from functools import partial
names = rospy.get_param("~names")
pubs = {name: rospy.Publisher(f"/{name}/out", String, queue_size=1) for name in names}
subs = [rospy.Subscriber("/%s/in" % name, String, partial(lambda n, m: pubs[n].publish(m), name)) for name in names]
""" + SPIN, {("/r/in", "/r/out"), ("/s/in", "/s/out")}),
    ("a list of publishers", "", "<rosparam>names: [r, s]</rosparam>", """
pubs = []
def on(msg, number):
    pubs[number].publish(msg)
for number, name in enumerate(rospy.get_param("~names")):
    pubs.append(rospy.Publisher(name + "/out", String, queue_size=1))
    rospy.Subscriber(name + "/in", String, on, number)""" + SPIN, {("/r/in", "/r/out"), ("/s/in", "/s/out")}),
    ("parts of a name", 'ns="left"', '<param name="id" value="3"/>', """
side = rospy.get_namespace()[1:-1]
inp = "/%s/in" % side
out = f"/{rospy.get_namespace().split('/')[1]}/out{int(rospy.get_param('~id')):02d}\"""" + RELAY,
     {("/left/in", "/left/out03")}),
    ("a member of a list", "", "<rosparam>sensors: [lidar]</rosparam>", """
pub = rospy.Publisher("/b", String, queue_size=1)
sensors = rospy.get_param("~sensors", ["lidar", "camera"])
if "lidar" in sensors:
    rospy.Subscriber("/a", String, lambda msg: pub.publish(msg))
if "camera" in sensors:
    rospy.Subscriber("/image", String, lambda msg: pub.publish(msg))""" + SPIN, AB),
    ("the end of an action", "", "", """
import actionlib
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
client = actionlib.SimpleActionClient("go", MoveBaseAction)
pub = rospy.Publisher("/b", String, queue_size=1)
def done(state, result):
    pub.publish(str(result.reached))
client.send_goal(MoveBaseGoal(), done_cb=done)""" + SPIN, {("/go (result)", "/b")}),
    ("a table by a mode", "", '<param name="mode" value="first"/>', """
inp = {"first": "/a", "second": "/c"}[rospy.get_param("~mode")]
out = "/b" if rospy.has_param("~mode") else "/d\"""" + RELAY, AB),
]  # fmt: skip
ROS2 = """\
#!/usr/bin/env python3
import rclpy
from functools import partial
from rclpy.node import Node
from std_msgs.msg import String

class Relay(Node):
    def __init__(self):
        super().__init__("n")
        self.declare_parameter("topics", ["/x"])
        self.pubs, self.subs = {}, []
        for topic in self.get_parameter("topics")VALUE:
            self.pubs[topic] = self.create_publisher(String, f"{self.get_name()}{topic}", 10)
            self.subs.append(self.create_subscription(String, topic, CALLBACK, 10))

    def on(self, topic, msg):
        self.pubs[topic].publish(msg)

rclpy.init()
rclpy.spin(Relay())
"""


def found(folder: Path, launch: str) -> set[tuple[str, str]]:
    (system,) = systems(Request(str(folder / "arm/launch" / launch), paths=(folder,)), resolve(Options()))
    return {(hop.source, hop.sink) for hop in system.hops if hop.kind == "explicit"}


@pytest.mark.parametrize(
    ("attributes", "inside", "code", "flows"), [n[1:] for n in NODES], ids=[n[0] for n in NODES]
)
def test_topic_names_resolve_parameters_in_ros1(tmp_path, attributes, inside, code, flows):
    body = f'<launch><node pkg="arm" type="n.py" name="n" {attributes}>{inside}</node></launch>'
    write(tmp_path, {"arm/package.xml": MANIFEST.format("arm", "catkin"), "arm/launch/a.launch": body,
                     "arm/scripts/n.py": ROS1 + code})  # fmt: skip
    assert found(tmp_path, "a.launch") == flows


@pytest.mark.parametrize("value", [
    'self.get_parameter("inp").value',
    'self.get_parameter_or("inp", Parameter("inp", value="/x")).value',
    'self.get_parameter_or("other", Parameter("other", value="/a")).value',
])  # fmt: skip
def test_parameters_set_only_by_the_launch_file_are_known(tmp_path, value):
    code = f"""\
    #!/usr/bin/env python3
    import rclpy
    from rclpy.node import Node
    from rclpy.parameter import Parameter
    from std_msgs.msg import String

    class Relay(Node):
        def __init__(self):
            super().__init__("n", automatically_declare_parameters_from_overrides=True)
            self.pub = self.create_publisher(String, "/b", 10)
            self.create_subscription(String, {value}, self.pub.publish, 10)

    rclpy.init()
    rclpy.spin(Relay())
    """
    body = '<node pkg="arm" exec="n.py" name="n"><param name="inp" value="/a"/></node>'
    write(tmp_path, {"arm/package.xml": MANIFEST.format("arm", "ament_cmake"),
                     "arm/CMakeLists.txt": "install(PROGRAMS scripts/n.py DESTINATION lib/${PROJECT_NAME})",
                     "arm/launch/a.launch.xml": f"<launch>{body}</launch>",
                     "arm/scripts/n.py": dedent(code)})  # fmt: skip
    assert found(tmp_path, "a.launch.xml") == AB


@pytest.mark.parametrize("value", [".value", ".get_parameter_value().string_array_value"])
@pytest.mark.parametrize("callback", ["partial(self.on, topic)", "lambda msg, t=topic: self.on(t, msg)"])
def test_topic_names_resolve_parameters_in_ros2(tmp_path, value, callback):
    launch = """
    from launch import LaunchDescription
    from launch_ros.actions import Node

    def generate_launch_description():
        topics = {"topics": ["/a", "/c"]}
        return LaunchDescription([Node(package="arm", executable="n.py", name="m", parameters=[topics])])
    """
    write(tmp_path, {
        "arm/package.xml": MANIFEST.format("arm", "ament_cmake"),
        "arm/CMakeLists.txt": "install(PROGRAMS scripts/n.py DESTINATION lib/${PROJECT_NAME})",
        "arm/launch/a.launch.py": launch,
        "arm/scripts/n.py": ROS2.replace("VALUE", value).replace("CALLBACK", callback),
    })  # fmt: skip
    assert found(tmp_path, "a.launch.py") == {("/a", "/m/a"), ("/c", "/m/c")}
