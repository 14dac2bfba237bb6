"""Interfaces of programs are kept between runs until a file that they depend on changes."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.system import command
from tests.lint.test_parameter_names import DIRECT, TOP, TWO_ARMS, arm, node, param  # noqa: F401 - a fixture
from tests.lint.test_services_in_chains import CLIENT, SERVER
from tests.lint.test_system import run, write

QOS = """\
#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Joy

class Pad(Node):
    def __init__(self):
        super().__init__("pad")
        self.joy = self.create_publisher(Joy, "joy", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))

    def __del__(self):
        self.joy.publish(Joy(butons=[]))
"""
PROGRAMS = {"relay": TOP + DIRECT, "arms": TOP + TWO_ARMS, "client": CLIENT, "server": SERVER, "pad": QOS,
            "broken": "def f(:\n"}  # fmt: skip
UNKNOWN = (
    "relay",
)  # a name that only the launch gives: the node is analysed again with all of its parameters


@pytest.fixture
def analysed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the programs that were analysed, not found in the cache."""
    seen: list[str] = []
    interface = command.interface

    def noted(script, *rest):
        seen.append(Path(script.path).stem)
        return interface(script, *rest)

    monkeypatch.setattr(command, "interface", noted)
    return seen


def launched(arm: Path) -> None:  # noqa: F811
    nodes = (f'<node pkg="arm" type="{name}.py" name="{name}"/>' for name in PROGRAMS)
    write(arm, {f"arm/scripts/{name}.py": text for name, text in PROGRAMS.items()})
    write(arm, {"arm/launch/a.launch": f"<launch>{''.join(nodes)}</launch>"})


def test_second_run_uses_kept_interfaces(arm, capsys, analysed):  # noqa: F811
    launched(arm)
    first = run(capsys, "--launch", "a.launch", "--format", "json")
    assert sorted(analysed) == sorted([*PROGRAMS, *UNKNOWN])
    assert run(capsys, "--launch", "a.launch", "--format", "json") == first
    assert len(analysed) == len([*PROGRAMS, *UNKNOWN])
    assert run(capsys, "--launch", "a.launch", "--format", "json", "--no-cache") == first
    assert len(analysed) == 2 * len([*PROGRAMS, *UNKNOWN])


def test_an_edited_program_or_import_is_analysed_again(arm, capsys, analysed):  # noqa: F811
    helper = "from names import OUT\n" + TOP + DIRECT.replace('"out")', "OUT)")
    write(arm, {"arm/scripts/relay.py": helper, "arm/scripts/names.py": "OUT = 'left'\n",
                "arm/launch/a.launch": f"<launch>{node('n', param('in_topic', '/in'))}</launch>"})  # fmt: skip
    assert "/in → /n → /left  explicit" in run(capsys, "--launch", "a.launch")[1]
    write(arm, {"arm/scripts/names.py": "OUT = 'right'\n"})
    assert "/in → /n → /right  explicit" in run(capsys, "--launch", "a.launch")[1]
    write(arm, {"arm/scripts/other.py": "OUT = 'unused'\n"})
    assert "/in → /n → /right  explicit" in run(capsys, "--launch", "a.launch")[1]
    assert analysed == ["relay", "relay"]


def test_another_launch_file_does_not_evict_kept_interfaces(arm, capsys, analysed):  # noqa: F811
    launched(arm)
    write(arm, {"arm/launch/one.launch": '<launch><node pkg="arm" type="pad.py" name="pad"/></launch>'})
    for name in ("a.launch", "one.launch", "a.launch"):
        run(capsys, "--launch", name)
    assert len(analysed) == len([*PROGRAMS, *UNKNOWN])


def test_a_damaged_file_of_kept_interfaces_is_not_used(arm, capsys):  # noqa: F811
    launched(arm)
    first = run(capsys, "--launch", "a.launch")
    (file,) = Path(".tarl/cache/lint").glob("system-*.json")
    file.write_text(file.read_text().replace("/left", "/lift"))
    assert run(capsys, "--launch", "a.launch") == first
