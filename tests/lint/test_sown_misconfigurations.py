"""The linter finds each misconfiguration injected into the example workspace; the kinds are those of ROSDiscover.

ROSDiscover (Timperley et al., ICSA 2022) detects ends that are not connected: names that are wrong in the code or the
launch file, remappings that have no effect, nodes in the wrong namespace, and connections that ROS refuses. The other
rules of architecture get a defect each.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tarl_lint.cli import main
from tarl_lint.system.hazards import ARCHITECTURE

EXAMPLE = Path(__file__).parents[2] / "examples/workspace"
BRINGUP = "scout_navigation/launch/bringup.launch.py"
PERCEPTION = "scout_perception/launch/perception.launch.xml"
DETECTOR = "scout_perception/scout_perception/detector.py"
PLANNER = "scout_navigation/scout_navigation/planner.py"
GATE = "scout_navigation/scout_navigation/gate.py"
Edit = tuple[str, str, str]  # file, old text, new text

INCLUDE = """\
            IncludeLaunchDescription(
                AnyLaunchDescriptionSource(perception), launch_arguments={"laser": "rear"}.items()
            ),
"""
PLANNED = """\
            Node(
                package="scout_navigation",
                executable="planner",
"""
SECOND = """\
                name="second",
                remappings=[("cmd_vel", "cmd_vel_raw")],
            ),
"""
SAME = """\
                remappings=[("cmd_vel", "cmd_vel_raw")],
            ),
"""
SERVICE = '        self.create_service(Trigger, "~/release", lambda _, answer: answer)\n'

SOWN: dict[str, tuple[str, str, list[Edit]]] = {
    "a remapping leads to a name that is spelled wrong": (
        "TARL301", "/scout/gate subscribes to /scout/cmd_vel_raw",
        [(BRINGUP, '("cmd_vel", "cmd_vel_raw")', '("cmd_vel", "cmd_vel_rwa")')],
    ),
    "the code has an absolute name, the robot a namespace": (
        "TARL301", "/scout/planner subscribes to /scout/obstacles",
        [(DETECTOR, '"obstacles"', '"/obstacles"')],
    ),
    "a topic is spelled differently in two nodes": (
        "TARL301", "/scout/planner subscribes to /scout/obstacle ",
        [(PLANNER, '"obstacles"', '"obstacle"')],
    ),
    "one part is launched outside the namespace": (
        "TARL301", "/scout/planner subscribes to /scout/obstacles",
        [(BRINGUP, INCLUDE, ""),
         (BRINGUP, "Description([Declare", "Description([IncludeLaunchDescription(perception), Declare")],
    ),
    "a remapping names what the node does not use": (
        "TARL308", "/scout/planner uses no name twist",
        [(BRINGUP, '[("cmd_vel", "cmd_vel_raw")]', '[("cmd_vel", "cmd_vel_raw"), ("twist", "cmd_vel_raw")]')],
    ),
    "two ends have different types": (
        "TARL302", "/scout/planner subscribes to /scout/obstacles as Point,",
        [(PLANNER, "import PointStamped, Twist", "import Point, PointStamped, Twist"),
         (PLANNER, "obstacle.point", "obstacle"),
         (PLANNER, "create_subscription(PointStamped", "create_subscription(Point")],
    ),
    "a subscription is reliable, its publisher is not": (
        "TARL303", "/scout/planner asks for RELIABLE on /scout/obstacles",
        [(DETECTOR, '"obstacles", 10', '"obstacles", qos_profile_sensor_data')],
    ),
    "a subscription waits for a message that is not kept": (
        "TARL303", "/scout/gate asks for TRANSIENT_LOCAL on /scout/cmd_vel_raw",
        [(GATE, "import Node\n", "import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n"),
         (GATE, "self.on_command, 10", "self.on_command, KEPT"),
         (GATE, "class Gate", "KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n\nclass Gate")],
    ),
    "a private service is called by a public name": (
        "TARL304", "/scout/planner calls /scout/release",
        [(GATE, "import Bool\n", "import Bool\nfrom std_srvs.srv import Trigger\n"),
         (GATE, "        self.stopped = False\n",
          "        self.stopped = False\n" + SERVICE),
         (PLANNER, "import Node\n", "import Node\nfrom std_srvs.srv import Trigger\n"),
         (PLANNER, "        self.obstacle = None\n",
          '        self.obstacle = None\n        self.release = self.create_client(Trigger, "release")\n')],
    ),
    "two planners drive": (
        "TARL305", "/scout/planner and /scout/second both publish commands on /scout/cmd_vel_raw",
        [(BRINGUP, PLANNED, PLANNED + SECOND + PLANNED)],
    ),
    "a planner drives on when it hears nothing": (
        "TARL306", "/scout/planner continues to publish /scout/cmd_vel_raw (Twist) after /scout/obstacles stops",
        [(PLANNER, "        self.heard = self.get_clock().now()\n", ""),
         (PLANNER, "        age = (self.get_clock().now() - self.heard).nanoseconds / 1e9\n", ""),
         (PLANNER, " and age < 0.5", "")],
    ),
    "a parameter is spelled wrong": (
        "TARL307", "/scout/detector has no parameter farhtest",
        [(PERCEPTION, '<param name="farthest"', '<param name="farhtest"')],
    ),
    "a node is started twice": (
        "TARL310", "/scout/planner is started twice",
        [(BRINGUP, PLANNED, PLANNED + SAME + PLANNED)],
    ),
    "a field is that of another type": (
        "TARL309", "LaserScan has no field angle_start",
        [(DETECTOR, "scan.angle_min", "scan.angle_start")],
    ),
}  # fmt: skip


def found(folder: Path, capsys: pytest.CaptureFixture[str]) -> list[dict[str, str]]:
    main(["--launch", str(folder / BRINGUP), str(folder), "--format", "json"])
    (system,) = json.loads(capsys.readouterr().out)["systems"]
    return list(system["diagnostics"])


@pytest.mark.parametrize("kind", SOWN)
def test_only_the_injected_misconfiguration_is_reported(kind, tmp_path, capsys):
    code, message, edits = SOWN[kind]
    folder = Path(shutil.copytree(EXAMPLE, tmp_path / "src"))
    for name, old, new in edits:
        text = (folder / name).read_text()
        assert old in text
        (folder / name).write_text(text.replace(old, new))
    diagnostics = found(folder, capsys)
    assert {one["code"] for one in diagnostics} == {code}, diagnostics
    assert any(one["message"].startswith(message) for one in diagnostics), diagnostics


def test_correct_launch_files_have_no_findings(capsys):
    assert found(EXAMPLE, capsys) == []


def test_every_rule_has_an_injected_misconfiguration():
    assert {code for code, _, _ in SOWN.values()} == set(ARCHITECTURE)
