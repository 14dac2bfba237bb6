"""Flows written by hand, for tests of the stages after the analysis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tarl_lint.model import Dependence, Finding, Flow, Kind, Role, Sink, SiteId, Source, Span, Step

NODE = """\
#!/usr/bin/env python3
import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

pos = 0.0


def callback(data):
    global pos
    pos = data.pose.pose.position.x


def travel(goal, pub):
    while not rospy.is_shutdown():
        delta = goal - pos
        vel = 5 * delta
        pub.publish(vel)


if __name__ == "__main__":
    rospy.Subscriber("odom", Odometry, callback)
    travel(10.0, rospy.Publisher("progress", Float64, queue_size=1))
"""


@dataclass
class Example:
    """A node's text and its flow; a test can replace each part."""

    text: str = NODE
    path: str = "node.py"
    lines: list[str] = field(init=False)

    def __post_init__(self) -> None:
        self.lines = self.text.split("\n")

    def span(self, fragment: str) -> Span:
        number = next(i for i, line in enumerate(self.lines, 1) if fragment in line)
        column = self.lines[number - 1].index(fragment) + 1
        return Span(self.path, number, column, number, column + len(fragment))

    def step(
        self, fragment: str, role: Role = "assign", dependence: Dependence = "data", qualname: str = ""
    ) -> Step:
        return Step(SiteId("node", qualname, fragment), self.span(fragment), fragment, role, dependence)

    def source(self, topic: str = "odom", callback: str = "callback") -> Source:
        span = self.span('rospy.Subscriber("odom", Odometry, callback)')
        identity = f"node:{topic}:{callback}"
        return Source(
            identity, span, (topic,), "Odometry", callback, "rospy.Subscriber", (span,), (), "node", ""
        )

    def sink(self) -> Sink:
        span = self.span("pub.publish(vel)")
        return Sink(
            "node:travel:publish", span, ("progress",), "Float64", "rospy.Publisher.publish", "node", "travel"
        )

    def flow(self, kind: Kind = "explicit", topic: str = "odom", callback: str = "callback") -> Flow:
        steps = (
            self.step('rospy.Subscriber("odom", Odometry, callback)', "register", "context"),
            self.step("def callback(data):", "receive", "data", "callback"),
            self.step("pos = data.pose.pose.position.x", qualname="callback"),
            self.step("while not rospy.is_shutdown():", "condition", "control", "travel"),
            self.step("delta = goal - pos", qualname="travel"),
            self.step("vel = 5 * delta", qualname="travel"),
            self.step("pub.publish(vel)", "publish", "data", "travel"),
        )
        return Flow(kind, self.source(topic, callback), self.sink(), steps)

    def finding(self, kind: Kind = "explicit", topic: str = "odom", callback: str = "callback") -> Finding:
        flow = self.flow(kind, topic, callback)
        code = "TARL101" if kind == "explicit" else "TARL102"
        return Finding(code, flow.sink.span, f"{topic} reaches progress", flow, fingerprint=f"{topic}-{kind}")


@pytest.fixture
def example() -> Example:
    return Example()


@pytest.fixture
def in_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[dict[str, str]], Path]:
    """Write files below a new working directory and return it."""

    def write(files: dict[str, str]) -> Path:
        for name, text in files.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path

    monkeypatch.chdir(tmp_path)
    return write
