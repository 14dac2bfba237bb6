"""The snippets of the rules TARL3xx, which are workspaces with a launch file, are tests of these rules."""

from __future__ import annotations

import json
import re
from inspect import cleandoc
from pathlib import Path

import pytest

from tarl_lint.cli import main
from tarl_lint.explain import known_rules
from tarl_lint.system.hazards import ARCHITECTURE
from tarl_lint.system.similar_names import spelled_alike

MANIFEST = "<package><name>robot</name><depend>catkin</depend></package>"
SNIPPETS = [
    pytest.param(code, name, text, id=f"{code} {name} {number}")
    for code, rule in known_rules().items()
    if code in ARCHITECTURE
    for name in ("VALID", "INVALID")
    for number, text in enumerate(getattr(rule, name))
]


def workspace(folder: Path, snippet: str) -> Path:
    """Write the files of a snippet into a package `robot`; in the snippet, each file follows a line `--- NAME`."""
    folder = folder / "robot"
    folder.mkdir()
    (folder / "package.xml").write_text(MANIFEST)
    for part in re.split(r"^--- ", cleandoc(snippet), flags=re.MULTILINE)[1:]:
        name, _, text = part.partition("\n")
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    return next((folder / "launch").glob("robot.launch*"))


def reported(capsys: pytest.CaptureFixture[str], *arguments: str) -> list[dict[str, str]]:
    main(["--launch", *arguments, "--format", "json"])
    systems = json.loads(capsys.readouterr().out)["systems"]
    return [one for system in systems for one in system["diagnostics"]]


@pytest.mark.parametrize(("code", "name", "text"), SNIPPETS)
def test_rules_report_only_their_invalid_snippets(code, name, text, tmp_path, capsys):
    found = reported(capsys, str(workspace(tmp_path, text)))
    assert (code in {one["code"] for one in found}) == (name == "INVALID"), found


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("/cmd_vel", "/robot/cmd_vel", True), ("/cmd_vel", "/cmd_vle", True), ("/cmd_vel", "/cmd_vell", True),
        ("/obstacle", "/obstacles", True), ("/cmd_vel", "/cmd_vel", False), ("/left_1", "/left_2", False),
        ("/odom", "/oдom", False), ("/left", "/lift", False), ("/a/scan", "/b/scan", False),
        ("/a/b/scan", "/a/scan", True), ("/imu_a", "/imu_b", False), ("/a_imu", "/b_imu", False),
        ("/front/scan", "/frnot/scan", True), ("/robot1/scan", "/robot2/scan", False),
        ("/left_arm/cmd", "/lift_arm/cmd", False), ("/a/front/x", "/frnot/x", False),
        ("/odoma", "/odoxa", True), ("/arm_xy", "/arm_xz", False), ("/scan_x", "/scanx_", False),
        ("/a/obstacle", "/b/obstacles", False), ("/imu/data", "/gps/data", False),
        ("/c/image_rect/compressed", "/c/image_calib/compressed", False),
        ("/a/water/current", "/a/water_current", True), ("/auto_vel", "/automatic_velocity", True),
        ("/arm/cmd", "/arm/command", True), ("/arm/cmd", "/arm/camera", False), ("/a/cmd", "/b/command", False),
        ("/cmd_vel", "/command", False), ("/lid", "/lidar2", False), ("/ab_vel", "/abx_cel", False),
    ],
)  # fmt: skip
def test_similar_topic_names_are_recognised(one, other, alike):
    assert spelled_alike(one, other) is alike
    assert spelled_alike(other, one) is alike


def test_hazards_fail_the_run_until_they_are_disabled(tmp_path, capsys):
    snippet = next(one for one in known_rules()["TARL308"].INVALID if "cmd_val" in one)
    file = str(workspace(tmp_path, snippet))
    assert main(["--launch", file]) == 1
    assert "robot.launch:2:1 TARL308 /keeper uses no name cmd_val" in capsys.readouterr().out
    assert main(["--launch", file, "--ignore", "TARL308"]) == 0
    assert main(["--launch", file, "--select", "TARL302"]) == 0
    assert main(["--launch", file, "--exit-zero"]) == 0


def test_fingerprints_do_not_depend_on_the_namespace(tmp_path, capsys):
    file = workspace(tmp_path, known_rules()["TARL305"].INVALID[0])
    (plain,) = reported(capsys, str(file))
    file.write_text(
        file.read_text()
        .replace("<launch>", '<launch><group ns="left">')
        .replace("</launch>", "</group></launch>")
    )
    (moved,) = reported(capsys, str(file))
    assert (plain["message"] != moved["message"], plain["fingerprint"]) == (True, moved["fingerprint"])


def test_the_example_workspace_has_no_hazards(capsys, monkeypatch):
    monkeypatch.chdir(Path(__file__).parents[2] / "examples/workspace")
    assert reported(capsys, "all") == []


@pytest.mark.parametrize(
    ("code", "found"), [("TARL305", []), ("TARL306", ["TARL306"]), ("TARL309", ["TARL309"])]
)
def test_without_a_launch_file_nodes_are_not_judged_together(code, found, tmp_path, capsys, monkeypatch):
    folder = workspace(tmp_path, known_rules()[code].INVALID[0]).parents[1]
    scripts = " ".join(f"scripts/{one.name}" for one in (folder / "scripts").iterdir())
    (folder / "CMakeLists.txt").write_text(f"catkin_install_python(PROGRAMS {scripts})")
    monkeypatch.chdir(tmp_path)
    main(["--from", "/odom", "--to", "/cmd_vel", "--format", "json"])
    (system,) = json.loads(capsys.readouterr().out)["systems"]
    assert sorted({one["code"] for one in system["diagnostics"]}) == found


def test_runs_without_launch_files_keep_accepted_hazards(tmp_path, capsys, monkeypatch):
    file = str(workspace(tmp_path, known_rules()["TARL301"].INVALID[0]))
    monkeypatch.chdir(tmp_path)
    assert main(["--launch", file]) == 1
    assert main(["--launch", file, "--write-baseline"]) == 0
    assert "1 hazard" in capsys.readouterr().out
    assert main(["--launch", file]) == 0
    assert "1 accepted by the baseline." in capsys.readouterr().out
    main([".", "--write-baseline"])
    assert "TARL301" in (tmp_path / "tarl-flows.json").read_text()
    assert main(["--launch", file]) == 0


TWO_CALLBACKS = """
    --- launch/robot.launch
    <launch><node pkg="robot" type="lane.py" name="lane"/></launch>
    --- scripts/lane.py
    import rospy
    from geometry_msgs.msg import Twist
    from std_msgs.msg import Float64

    class Lane:
        def __init__(self):
            self.fastest = 0.1
            self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("fastest", Float64, self.on_fastest)
            rospy.Subscriber("center", Float64, self.on_center)

        def on_fastest(self, msg):
            self.fastest = msg.data

        def on_center(self, msg):
            cmd = Twist()
            cmd.linear.x = self.fastest
            cmd.angular.z = -msg.data
            self.pub.publish(cmd)

    rospy.init_node("lane")
    Lane()
    rospy.spin()
"""
NESTED = """
    --- launch/robot.launch
    <launch><node pkg="robot" type="lane.py" name="lane"><rosparam file="$(dirname)/lane.yaml"/></node></launch>
    --- launch/lane.yaml
    camera:
      lane:
        ros__parameters: {gain: 1.0}
    other:
      ros__parameters: {top: 1.0}
    /lane:
      ros__parameters: {detect: {white: {hue: 3}}}
    --- scripts/lane.py
    import rospy
    rospy.init_node("lane")
    print(rospy.get_param("~gain"), rospy.get_param("~detect.white.hue"))
"""


@pytest.mark.parametrize("snippet", [TWO_CALLBACKS, NESTED])
def test_code_that_earlier_versions_reported_wrongly_has_no_findings(snippet, tmp_path, capsys):
    assert reported(capsys, str(workspace(tmp_path, snippet))) == []


@pytest.mark.parametrize("condition", ['if="$(env REAL)"', 'unless="$(env REAL)"', ""])
def test_conditional_node_is_no_second_publisher(condition, tmp_path, capsys):
    text = known_rules()["TARL305"].INVALID[0].replace("<node ", f"<node {condition} ", 1)
    found = reported(capsys, str(workspace(tmp_path, text)))
    assert [one["code"] for one in found] == ([] if condition else ["TARL305"])
