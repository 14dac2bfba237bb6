"""Topics among the arguments of a launched node, which its program takes from the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.lint.test_system import MANIFEST, flows, run, write

TOP = """\
#!/usr/bin/env python3
import sys
import rospy
from std_msgs.msg import Float64
"""
DIRECT = """
rospy.init_node("relay")
if len(sys.argv) < 3:
    sys.exit("usage: relay FROM TO")
out = rospy.Publisher(sys.argv[2], Float64, queue_size=1)
rospy.Subscriber(sys.argv[1], Float64, lambda msg: out.publish(msg.data))
rospy.spin()
"""
PAIRS = """
def relay(pair):
    out = rospy.Publisher(pair[1], Float64, queue_size=1)
    rospy.Subscriber(pair[0], Float64, lambda msg: out.publish(msg.data))

rospy.init_node("relay")
given = [one for one in sys.argv[1:] if not ":=" in one]
for pair in [(given[i], given[i + 1]) for i in range(len(given)) if i % 2 == 0]:
    relay(pair)
rospy.spin()
"""
OWN = """
rospy.init_node("relay")
names = rospy.myargv(sys.argv)
out = rospy.Publisher(names[-1], Float64, queue_size=1)
if "verbose" in names[1]:
    rospy.Subscriber("loud", Float64, lambda msg: out.publish(msg.data))
rospy.Subscriber(names[-2], Float64, lambda msg: out.publish(msg.data))
rospy.spin()
"""


@pytest.fixture
def arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return write(tmp_path, {"arm/package.xml": MANIFEST.format("arm", "catkin")})


def system(arm: Path, capsys: pytest.CaptureFixture[str], source: str, *arguments: str) -> list[str]:
    nodes = [
        f'<node pkg="arm" type="relay.py" name="n{number}" args="{given}"><remap from="/b" to="/c"/></node>'
        for number, given in enumerate(arguments)
    ]
    launch = f'<launch><arg name="to" default="/b"/>{"".join(nodes)}</launch>'
    write(arm, {"arm/scripts/relay.py": TOP + source, "arm/launch/a.launch": launch})
    return flows(run(capsys, "--launch", "a.launch")[1])


def test_each_node_has_the_topics_of_its_own_arguments(arm, capsys):
    assert system(arm, capsys, DIRECT, "/a $(arg to)", "scan 'wheels'") == [
        "/a → /n0 → /c  explicit",
        "/scan → /n1 → /wheels  explicit",
    ]


def test_an_argument_known_only_on_the_robot_stays_unknown(arm, capsys):
    source = DIRECT.replace("sys.argv[2]", '"out"')
    for given in ("$(env SCAN) /b", "it's /b"):
        assert system(arm, capsys, source, given) == ["? → /n0 → /out  explicit"]


def test_grouping_command_line_arguments_in_pairs_keeps_the_pairs(arm, capsys):
    assert system(arm, capsys, PAIRS, "/a /x /d /y") == ["/a → /n0 → /x  explicit", "/d → /n0 → /y  explicit"]


def test_arguments_for_ros_are_removed_from_the_nodes_arguments(arm, capsys):
    assert system(arm, capsys, OWN, "/a /x", "verbose /x") == [
        "/a → /n0 → /x  explicit",
        "/loud → /n1 → /x  explicit",
        "/verbose → /n1 → /x  explicit",
    ]
