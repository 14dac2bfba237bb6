"""A constant of a table of settings is searched where a statement reads it by its key."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.patching.constant_definitions import defined
from pytest_tarl.repairing.table_entries import entry_uses
from pytest_tarl.searching.plainness import Oddness, writing
from tarl_lint.api import Analysis, analyse
from tarl_lint.model import Operand

NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Keeper(Node):
    def __init__(self):
        super().__init__("keeper")
        defaults = {{"gain": 0.4, "bias": -1.5, "idle": 7.0{more}}}
        for name, value in defaults.items():
            self.declare_parameter(name, value)
        self.p = {{name: self.get_parameter(name).value for name in defaults}}
        self.pub = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, "level", self.on_level, 1)

    def on_level(self, msg):
        {line}
        self.pub.publish(Float64(data=out))
"""


def analysed(folder: Path, line: str, more: str = "") -> Analysis:
    (folder / "keeper.py").write_text(NODE.format(line=line, more=more))
    return analyse([folder / "keeper.py"], root=folder)


def uses(analysis: Analysis) -> list[Operand]:
    literals = [one for site in analysis.configuring for one in analysis.operands(site)]
    assert literals
    return [use for found in entry_uses(analysis, literals).values() for use in found]


@pytest.mark.parametrize(
    ("line", "code", "value"),
    [
        ('out = self.p["gain"] * msg.data', 'self.p["gain"]', 0.4),
        ('out = self.p.get("gain", 1.0) * msg.data', 'self.p.get("gain", 1.0)', 0.4),
        ('out = msg.data + self.p["bias"]', 'self.p["bias"]', -1.5),
    ],
)
def test_an_entry_is_used_where_its_key_is_read(tmp_path: Path, line: str, code: str, value: float) -> None:
    analysis = analysed(tmp_path, line)
    (use,) = uses(analysis)
    assert (use.code, use.value, use.span.line) == (code, value, 17)
    assert use.site in {step.site for step in analysis.sites}
    assert writing(use) is Oddness.NAMED
    (place,) = defined(analysis, use)
    assert (place.line, place.value) == (9, value)


@pytest.mark.parametrize(
    ("line", "more"),
    [
        ("out = msg.data * self.p[msg.name]", ""),  # the key is known at run time only
        ('out = self.p["gain"] * msg.data; {"gain": 2}', ""),  # two tables have the key
        ('out = self.p["speed"] * msg.data', ', "speed": "fast"'),  # no number
    ],
)
def test_reads_of_other_keys_do_not_use_the_entry(tmp_path: Path, line: str, more: str) -> None:
    assert uses(analysed(tmp_path, line, more)) == []
