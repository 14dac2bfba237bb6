"""A factor on a command names the statements that compute the command."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.repairing.scaled_commands import scaled_command
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from tests.plugin.patching.repairs import HandMade

NODE = """\
class Pilot:
    def step(self, error):
        turn = max(abs(error), 0.1)
        self.cmd.angular.z = turn
        self.cmd.linear.x = 0.3
        self.pub.publish(self.cmd)
"""


def scaled(name: str, code: str, within: str, field: str = "", value: float = 1.5) -> Any:
    """Return what is found for a template at an expression."""
    made = template(Path(SHIPPED) / f"{name}.toml")
    defaults = tuple((one.name, one.default) for one in made.parameters)
    form = Form(made, defaults[0][0] if defaults else "", defaults, field=field)
    analysis: Any = HandMade({"pilot.py": NODE})
    operand = replace(analysis.operand(code, None, within, literal=False), definition=None)
    return scaled_command(analysis, Candidate((Mutation(operand, value, form=form),), ALWAYS))


@pytest.mark.parametrize(
    ("name", "code", "within", "field", "lines"),
    [
        ("field_gain", "self.cmd", "publish(self.cmd", "angular.z", [6, 4, 3]),
        ("gain", "turn", "z = turn", "", [4, 3]),
    ],
)
def test_command_factor_comes_with_the_computing_statements(
    name: str, code: str, within: str, field: str, lines: list[int]
) -> None:
    found = scaled(name, code, within, field)
    assert found.factor == 3.0  # 1.5 times the factor with which the template starts
    assert [(path, first) for path, first, _ in found.statements] == [("pilot.py", line) for line in lines]


@pytest.mark.parametrize("name", ["offset", "sign", "integral"])
def test_other_changes_do_not_scale_a_command(name: str) -> None:
    found = scaled(name, "turn", "z = turn")
    assert found is None
