"""Topic names from parameters are followed through a program and known for each launched node."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.lint.test_system import MANIFEST, flows, run, write

TOP = """\
#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64
"""
DIRECT = """
rospy.init_node("relay")
out = rospy.Publisher(rospy.get_param("~out_topic", "out"), Float64, queue_size=1)
rospy.Subscriber(rospy.get_param("~in_topic"), Float64, lambda msg: out.publish(2.0 * msg.data))
rospy.spin()
"""
IN_A_CLASS = """
class Relay:
    def __init__(self):
        self.prefix = rospy.get_param("~prefix", "/front")
        names = {"in": rospy.get_param("~in_topic", "scan")}
        self.out = rospy.Publisher(self.named(rospy.get_param("/robot/out_topic", "out")), Float64, queue_size=1)
        self.sub = rospy.Subscriber("{}/{}".format(self.prefix.rstrip("/"), names["in"]), Float64, self.on_in)

    def named(self, name):
        return "%s_%s" % (name, "final")

    def on_in(self, msg):
        self.out.publish(msg.data)

if __name__ == "__main__":
    rospy.init_node("relay")
    Relay()
    rospy.spin()
"""
ROS2 = """
class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.declare_parameter("topics.scan", "scan")
        self.declare_parameters("", [("gain", 2.0), ("topics.out", "out")])
        scan = self.get_parameter("topics.scan").get_parameter_value().string_value
        self.out = self.create_publisher(Float64, self.get_parameter("topics.out").value, 10)
        self.create_subscription(Float64, f"{scan}_filtered", self.on_in, 10)

    def on_in(self, msg):
        self.out.publish(Float64(data=msg.data))

def main():
    rclpy.init()
    rclpy.spin(Relay())

if __name__ == "__main__":
    main()
"""


MODES = """
class Driver:
    def __init__(self):
        self.fast = rospy.get_param("~fast", False)
        mode = rospy.get_param("~mode", "raw")
        rospy.Subscriber("scan/" + ("compressed" if mode == "compressed" else "raw"), Float64, self.on_scan)
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        if rospy.get_param("/debug", False):
            self.debug = rospy.Publisher("debug", Float64, queue_size=1)
        else:
            self.debug = None

    def on_scan(self, msg):
        if self.fast:
            rospy.Publisher("boost", Float64, queue_size=1).publish(msg.data)
        self.out.publish(msg.data)
        if self.debug:
            self.debug.publish(msg.data)

rospy.init_node("driver")
Driver()
rospy.spin()
"""


@pytest.fixture
def arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return write(tmp_path, {"arm/package.xml": MANIFEST.format("arm", "catkin")})


def system(arm: Path, capsys: pytest.CaptureFixture[str], source: str, body: str, *more: str) -> list[str]:
    files = {"arm/scripts/relay.py": source, "arm/launch/a.launch": f"<launch>{body}</launch>"}
    write(arm, files)
    return flows(run(capsys, "--launch", "a.launch", *more)[1])


def node(name: str, *inside: str) -> str:
    return f'<node pkg="arm" type="relay.py" name="{name}">{"".join(inside)}</node>'


def param(name: str, value: str) -> str:
    return f'<param name="{name}" value="{value}"/>'


def test_each_node_has_the_topics_of_its_own_parameters(arm, capsys):
    body = node(
        "first", param("in_topic", "/scan"), param("out_topic", "middle"), '<remap from="middle" to="/m"/>'
    )
    body += node("second", param("in_topic", "m"))
    assert system(arm, capsys, TOP + DIRECT, body) == ["/scan → /first → /m → /second → /out  explicit"]


def test_a_parameter_without_a_value_or_default_stays_unknown(arm, capsys):
    assert system(arm, capsys, TOP + DIRECT, node("first")) == ["? → /first → /out  explicit"]
    unset = node("first", '<param name="in_topic" value="$(env SCAN)"/>', param("out_topic", "/a"))
    assert system(arm, capsys, TOP + DIRECT, unset) == ["? → /first → /a  explicit"]
    known = node("first", '<param name="in_topic" value="5.5" type="double"/>')
    assert system(arm, capsys, TOP + DIRECT, known) == ["/5.5 → /first → /out  explicit"]


def test_names_pass_through_attributes_tables_functions_and_string_operations(arm, capsys):
    body = param("/robot/out_topic", "wheels") + node("first", param("in_topic", "lidar"))
    body += (
        f'<group ns="left">{node("other", "<rosparam>{prefix: /rear/, in_topic: sonar}</rosparam>")}</group>'
    )
    assert system(arm, capsys, TOP + IN_A_CLASS, body) == [
        "/front/lidar → /first → /wheels_final  explicit",
        "/rear/sonar → /left/other → /left/wheels_final  explicit",
    ]


def test_topic_names_use_declared_ros2_parameters(arm, capsys):
    source = "import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import Float64\n" + ROS2
    write(arm, {"arm/package.xml": MANIFEST.format("arm", "ament_python"), "arm/relay.py": source,
                "arm/config/p.yaml": "/r1/relay:\n  ros__parameters: {topics: {out: /end}}\n",
                "arm/launch/b.launch.xml": """
                    <launch><push-ros-namespace namespace="r1"/>
                    <node pkg="arm" exec="relay.py">
                    <param name="topics.scan" value="/front/scan"/>
                    <param from="$(find-pkg-share arm)/config/p.yaml"/></node></launch>"""})  # fmt: skip
    out = run(capsys, "--launch", "b.launch.xml")[1]
    assert flows(out) == ["/front/scan_filtered → /r1/relay → /end  explicit"]


def test_unknown_parameter_has_both_branches_analysed(arm, capsys):
    source = TOP + """
rospy.init_node("relay")
name = rospy.get_param("~out_topic", "out")
speeds = {"out": 1.0}
out = rospy.Publisher(name, Float64, queue_size=1)
def on_in(msg):
    if name == "out":
        out.publish(msg.data)
    elif "fast" in name:
        out.publish(2.0 * msg.data * speeds[name])
rospy.Subscriber("in", Float64, on_in)
rospy.spin()
"""  # fmt: skip
    unset = '<param name="out_topic" value="$(env OUT)"/>'
    write(
        arm,
        {"arm/scripts/relay.py": source, "arm/launch/a.launch": f"<launch>{node('first', unset)}</launch>"},
    )
    document = json.loads(run(capsys, "--launch", "a.launch", "--format", "json")[1])
    (hop,) = document["systems"][0]["hops"]
    assert (hop["from"], hop["to"], len(hop["flows"])) == ("/in", "?", 2)
    assert document["systems"][0]["nodes"][0]["publishes"] == []


def test_json_states_the_name_as_written_in_the_code(arm, capsys):
    write(
        arm,
        {"arm/scripts/relay.py": TOP + DIRECT, "arm/launch/a.launch": f"<launch>{node('first')}</launch>"},
    )
    document = json.loads(run(capsys, "--launch", "a.launch", "--format", "json")[1])
    (end,) = document["systems"][0]["nodes"][0]["publishes"]
    assert (end["name"], end["in_code"]) == ("/out", ["$(param ~out_topic)"])


@pytest.mark.parametrize(
    ("source", "inside"),
    [(DIRECT, [param("in_topic", "/scan")]), (MODES, [param("fast", "true"), param("debug", "1")])],
)
def test_launch_file_keeps_the_fingerprints(arm, capsys, source, inside):
    write(arm, {"arm/scripts/relay.py": TOP + source})
    write(arm, {"arm/launch/a.launch": f"<launch>{node('first', *inside)}</launch>"})
    document = json.loads(run(capsys, "--launch", "a.launch", "--format", "json")[1])
    launched = {one["fingerprint"] for hop in document["systems"][0]["hops"] for one in hop["flows"]}
    linted = json.loads(run(capsys, "arm", "--format", "json")[1])
    assert launched <= {one["fingerprint"] for one in linted["diagnostics"] if one["code"] == "TARL101"}


TWO_ARMS = """
import rostopic

class Arm:
    def __init__(self, side):
        self.last = None
        self.out = rospy.Publisher("{}/{}_target".format(rospy.get_name(), side), Float64, queue_size=1)
        self.state = rospy.Publisher(rospy.resolve_name("state") + "/" + side, Float64, queue_size=1)
        rospy.Subscriber("/" + side + "/joy", Float64, self.on_joy)

    def on_joy(self, msg):
        self.last = msg.data
        self.out.publish(msg.data)

    def tick(self):
        self.state.publish(self.last)

class Both:
    def __init__(self):
        self.arms = [Arm("left"), Arm("right")]

    def run(self):
        while not rospy.is_shutdown():
            for arm in self.arms:
                arm.tick()
            rospy.sleep(0.1)

rospy.init_node("relay")
kind, topic, read = rostopic.get_topic_class(rospy.resolve_name("~any"), blocking=True)
copies = rospy.Publisher(rospy.get_namespace() + "copies", Float64, queue_size=1)
rospy.Subscriber(topic, kind, lambda msg: copies.publish(msg.data))
Both().run()
"""


def test_two_objects_of_one_class_have_separate_topics(arm, capsys):
    remap = '<remap from="state" to="/arms"/>'
    body = f'<group ns="robot">{node("both", remap)}</group>'
    assert system(arm, capsys, TOP + TWO_ARMS, body) == [
        "/left/joy → /robot/both → /arms/left  explicit",
        "/left/joy → /robot/both → /robot/both/left_target  explicit",
        "/right/joy → /robot/both → /arms/right  explicit",
        "/right/joy → /robot/both → /robot/both/right_target  explicit",
        "/robot/both/any → /robot/both → /robot/copies  explicit",
    ]


@pytest.mark.parametrize(
    ("around", "inside", "expected"),
    [
        ("", "", {"/scan/raw → /n → /out"}),
        ("", param("fast", "true"), {"/scan/raw → /n → /out", "/scan/raw → /n → /boost"}),
        ("", param("mode", "compressed"), {"/scan/compressed → /n → /out"}),
        (param("/debug", "true"), "", {"/scan/raw → /n → /out", "/scan/raw → /n → /debug"}),
        (
            "",
            '<param name="fast" value="$(env FAST)"/>',
            {"/scan/raw → /n → /out", "/scan/raw → /n → /boost"},
        ),
    ],
)
def test_conditions_on_parameters_are_decided_for_each_node(arm, capsys, around, inside, expected):
    found = system(arm, capsys, TOP + MODES, around + node("n", inside))
    assert {one.partition("  ")[0] for one in found} == expected


LISTS = """
class Tiles:
    def __init__(self):
        self.topics = rospy.get_param("~topics", [])
        self.images = {}
        self.out = rospy.Publisher("tiles", Float64, queue_size=1)
        self.subs = [rospy.Subscriber(one, Float64, self.kept(one)) for one in self.topics]
        rospy.Timer(rospy.Duration(0.1), self.on_timer)

    def kept(self, topic):
        def keep(msg):
            self.images[topic] = msg.data
        return keep

    def on_timer(self, event):
        self.out.publish(sum(self.images[one] for one in self.topics))

rospy.init_node("tiles")
Tiles()
rospy.spin()
"""
PAIRS = """
def relay(*messages):
    for out, message in zip(outs, messages):
        out.publish(message)

a, b, c = (message_filters.Subscriber("/a", Float64), message_filters.Subscriber("/b", Float64),
           message_filters.Subscriber("/c", Float64))
outs = [rospy.Publisher("/x", Float64), rospy.Publisher("/y", Float64), rospy.Publisher("/z", Float64)]
rospy.init_node("relay")
message_filters.TimeSynchronizer([a, b, c], 10).registerCallback(relay)
rospy.spin()
"""


def test_a_launch_file_gives_a_list_of_topics(arm, capsys):
    body = node("first", "<rosparam>{topics: [/a, b, /a]}</rosparam>")
    assert system(arm, capsys, TOP + LISTS, body) == [
        "/a → /first → /tiles  explicit",
        "/b → /first → /tiles  explicit",
    ]


def test_each_known_iteration_has_its_own_publish_call(arm, capsys):
    assert system(arm, capsys, TOP + "import message_filters\n" + PAIRS, node("n")) == [
        f"/{one} → /n → /{other}  explicit" for one, other in zip("abc", "xyz", strict=True)
    ]
