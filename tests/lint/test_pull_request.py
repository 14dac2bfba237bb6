"""A baseline and the edits of a pull request: exactly the new and the vanished findings are reported."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tarl_lint.cli import main

NODE = """\
import rospy
from nav_msgs.msg import Odometry
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64


class Follower:
    def __init__(self):
        self.x = 0.0
        self.spare = rospy.Publisher("/spare", Float64, queue_size=1)
        self.pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("/odom", Odometry, self.on_odom)

    def on_odom(self, msg):
        self.x = msg.pose.pose.position.x

    def follow(self, goal):
        while not rospy.is_shutdown():
            delta = goal - self.x
            cmd = Twist()
            cmd.linear.x = 0.8 * delta
            self.pub.publish(cmd)


if __name__ == "__main__":
    Follower().follow(2.0)
"""


@pytest.fixture
def node(in_directory, capsys) -> Path:
    """A node whose flow (TARL101) and hazards (TARL202, TARL204) are accepted."""
    path = in_directory({"follower.py": NODE}) / "follower.py"
    assert main(["--write-baseline"]) == 0
    assert capsys.readouterr().out == ("tarl-flows.json: 1 flow and 2 hazards accepted (3 new, 0 removed).\n")
    return path


def linted(capsys) -> tuple[int, str]:
    return main([]), capsys.readouterr().out


def test_accepted_findings_are_not_reported_and_do_not_fail(node, capsys):
    code, out = linted(capsys)
    assert code == 0
    assert out.splitlines() == [
        "No new flow in 1 file (1 accepted in tarl-flows.json).",
        "No new hazard (2 accepted in tarl-flows.json).",
    ]


@pytest.mark.parametrize(
    "edit",
    [
        lambda text: "# a comment\n\n" + text,
        lambda text: text.replace("delta", "distance").replace("cmd =", "twist =").replace("cmd.", "twist.")
        .replace("(cmd)", "(twist)"),
        lambda text: text.replace(
            text[text.index("    def on_odom") : text.index("    def follow")], ""
        ).replace("\n\nif __name__", "\n" + text[text.index("    def on_odom") : text.index("    def follow")]
                  + "\nif __name__"),
        lambda text: text.replace("0.8 * delta", "float(0.9 * delta)"),
        lambda text: text.replace("\n", "\r\n"),
    ],
    ids=["moved lines", "renamed locals", "moved method", "another path", "Windows line ends"],
)  # fmt: skip
def test_edits_that_change_no_flow_report_nothing(node, capsys, edit):
    changed = edit(NODE)
    assert changed != NODE
    node.write_bytes(changed.encode())
    code, out = linted(capsys)
    assert (code, out.count("\n")) == (0, 2)


def test_only_the_new_flow_and_hazard_are_reported(node, capsys):
    advertised = "        self.pub = rospy.Publisher('/progress', Float64, queue_size=1)\n"
    more = advertised.replace("pub", "progress") + advertised.replace("pub", "idle").replace(
        "progress", "idle"
    )
    text = NODE.replace("        self.x = 0.0\n", f"        self.x = 0.0\n{more}")
    node.write_text(text.replace("(cmd)\n", "(cmd)\n            self.progress.publish(self.x)\n"))
    code, out = linted(capsys)
    assert code == 1
    assert "publishes /progress (Float64) in Follower.follow\n" in out
    assert "/cmd_vel" not in out
    assert "1 new flow in 1 file: 1 explicit (1 accepted in tarl-flows.json).\n" in out
    assert "1 new hazard: 1 TARL204 (2 accepted in tarl-flows.json).\n" in out


def test_vanished_findings_are_listed_until_the_baseline_is_rewritten(node, capsys):
    node.write_text(NODE.replace("0.8 * delta", "min(0.5, 0.8 * delta)").replace("rospy.Subscriber", "print"))
    code, out = linted(capsys)
    assert code == 0
    assert "Accepted but no longer found, in tarl-flows.json:\n" in out
    assert (
        "  /odom → /cmd_vel, explicit, received by Follower.on_odom, published in Follower.follow (follower)\n"
        in out
    )
    assert "  TARL202 /odom → /cmd_vel in Follower.follow (follower)\n" in out
    main(["--write-baseline"])
    assert capsys.readouterr().out == ("tarl-flows.json: 0 flows and 1 hazard accepted (0 new, 2 removed).\n")


def test_hazards_can_be_excluded_from_the_baseline(node, capsys):
    Path("tarl-flows.json").unlink()
    main(["--write-baseline", "--select", "TARL1"])
    assert capsys.readouterr().out == "tarl-flows.json: 1 flow accepted (1 new, 0 removed).\n"
    code, out = linted(capsys)
    assert code == 1
    assert "2 new hazards: 1 TARL202, 1 TARL204.\n" in out


def test_baseline_entries_of_disabled_rules_are_kept(node, capsys):
    before = Path("tarl-flows.json").read_text()
    main(["--write-baseline", "--select", "TARL1"])
    assert Path("tarl-flows.json").read_text() == before


def test_json_contains_fingerprint_and_status_of_hazards(node, capsys):
    main(["--format", "json"])
    diagnostics = json.loads(capsys.readouterr().out)["diagnostics"]
    assert {d["code"] for d in diagnostics} == {"TARL101", "TARL202", "TARL204"}
    assert {d["status"] for d in diagnostics} == {"accepted"}
    assert len({d["fingerprint"] for d in diagnostics}) == 3


def test_accepted_hazards_of_unreadable_files_are_kept(node, capsys):
    before = Path("tarl-flows.json").read_text()
    node.write_text("def f(:\n")
    main(["--write-baseline"])
    assert Path("tarl-flows.json").read_text() == before


def test_concurrent_writes_leave_an_intact_baseline(node):
    before = Path("tarl-flows.json").read_text()
    Path("tarl-flows.json").unlink()
    command = [sys.executable, "-m", "tarl_lint", "--write-baseline", "--no-cache"]
    runs = [subprocess.Popen(command, stdout=subprocess.DEVNULL) for _ in range(3)]
    assert [run.wait() for run in runs] == [0, 0, 0]
    assert Path("tarl-flows.json").read_text() == before
    assert sorted(p.name for p in Path().iterdir() if not p.name.startswith(".tarl")) == [
        "follower.py",
        "tarl-flows.json",
    ]
