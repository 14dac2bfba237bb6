"""No search moves time stamps, timeouts of look-ups, lengths of queues, identities, or rates of what only logs."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.document import document
from pytest_tarl.repairing.bookkeeping import is_bookkeeping
from pytest_tarl.repairing.strategies import aside_operands, operands
from tarl_lint.api import analyse

KEEPER = """\
import rospy
import tf2_ros
from std_msgs.msg import Float64
from geometry_msgs.msg import PoseStamped


class Keeper:
    def __init__(self):
        self.buffer = tf2_ros.Buffer(rospy.Duration(10.0))
        self.out = rospy.Publisher("/out", PoseStamped, queue_size=6)
        rospy.Subscriber("/in", Float64, self.on_value, queue_size=7)
        self.log_timer = rospy.Timer(rospy.Duration(2.5), self.log)
        self.work_timer = rospy.Timer(rospy.Duration(0.2), self.work)
        self.last = rospy.Time(0)
        self.level = 0.0

    def log(self, event):
        rospy.loginfo("level %.1f", self.level)

    def work(self, event):
        self.send(self.level)

    def on_value(self, msg):
        if rospy.Time.now() - self.last < rospy.Duration(0.5):
            return
        self.last = rospy.Time.now()
        moved = self.buffer.lookup_transform("map", "base", rospy.Time(0), rospy.Duration(1.5))
        self.level = 1.25 * msg.data + moved.transform.translation.x

    def send(self, level):
        pose = PoseStamped()
        pose.header.seq = 9
        pose.pose.position.x = level
        self.out.publish(pose)


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
    rospy.spin()
"""


def test_search_gets_only_controlling_numbers(tmp_path: Path) -> None:
    node = tmp_path / "keeper.py"
    node.write_text(KEEPER)
    order: Any = SimpleNamespace(
        analysis=analyse([node], root=tmp_path),
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=()),
    )
    ranked = operands(order)
    found = {one.value for one in (*ranked, *aside_operands(order, ranked))}
    assert {1.25, 0.5, 0.2} <= found
    assert not found & {10.0, 6, 7, 2.5, 0, 1.5, 9}


def judged(line: str, code: str, more: str = "") -> bool:
    text = line + "\n" + more
    source = document("node.py", text)
    analysis: Any = SimpleNamespace(sources={"node.py": text}, sites=(), deciding=())
    at = line.index(code) + 1
    return is_bookkeeping(
        analysis,
        source,
        source.find(
            SimpleNamespace(path="node.py", line=1, column=at, end_line=1, end_column=at + len(code))
        ),
    )


@pytest.mark.parametrize(
    ("line", "code", "expected"),
    [
        ("when = rclpy.time.Time(seconds=0)", "0", True),
        ("when = Time.from_sec(2.5)", "2.5", True),
        ("wait = rospy.Duration(2.5)", "2.5", False),
        ("sync = ApproximateTimeSynchronizer(subs, slop=0.3)", "0.3", False),
        ("sync = message_filters.TimeSynchronizer(subs, 11)", "11", True),
        ("found = buffer.can_transform(a, b, stamp, timeout=Duration(seconds=3))", "3", True),
        ("found = self.buffer.lookup_transform(a, b, stamp, Duration(seconds=3))", "3", True),
        ("marker.id = 5", "5", True),
        ("marker.scale = 5", "5", False),
        ("qos = QoSProfile(depth=4)", "4", True),
        ("client.wait_for_server(rospy.Duration(7))", "7", True),
        ("speed = 3 * left", "3", False),
    ],
)
def test_each_kind_of_bookkeeping_number_is_recognised(line: str, code: str, expected: bool) -> None:
    assert judged(line, code) is expected


def test_user_function_with_a_ros_name_is_not_bookkeeping() -> None:
    assert judged("level = Buffer(12)", "12")
    assert not judged("level = Buffer(12)", "12", "class Buffer:\n    pass\n")


def test_period_of_an_unknown_timer_may_change() -> None:
    assert not judged("timer = node.create_timer(0.5, other.tick)", "0.5")
    assert judged("timer = node.create_timer(0.5, tick)", "0.5", "def tick():\n    print(1)\n")
    assert not judged("timer = node.create_timer(0.5, lambda: tick())", "0.5", "def tick():\n    print(1)\n")
