"""In place of a template with state, a factor at the same expression is tried."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.repairing.plainer_templates import FACTORS, factors
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from tests.plugin.patching.repairs import HandMade

NODE = """\
class Pilot:
    def __init__(self):
        self.cmd = Twist()

    def step(self, error):
        turn = max(-0.5, min(0.5, error))
        self.cmd.angular.z = turn
        self.pub.publish(self.cmd)
"""


def found(name: str, tmp_path: Path) -> tuple[Any, list[Candidate]]:
    made = template(Path(SHIPPED) / f"{name}.toml")
    defaults = tuple((one.name, one.default) for one in made.parameters)
    form = Form(made, defaults[0][0] if defaults else "", defaults)
    analysis: Any = HandMade({"pilot.py": NODE})
    plain = analysis.operand(
        "max(-0.5, min(0.5, error))", None, "turn = max(-0.5, min(0.5, error))", literal=False
    )
    operand = replace(plain, definition=None, code=f"{name} of {plain.code}, {form.parameter}", value=0.03)
    order: Any = SimpleNamespace(root=tmp_path)
    return analysis, list(factors(order, Candidate((Mutation(operand, 1.0, form=form),), ALWAYS)))


def test_integral_is_replaced_by_the_smallest_factor(tmp_path: Path) -> None:
    analysis, plain = found("integral", tmp_path)
    assert [form_values(one.mutations[0]) for one in plain] == [{"gain": factor} for factor in FACTORS]
    assert plain[1].mutations[0].operand.code == "gain of max(-0.5, min(0.5, error)), gain"
    (text,) = rewrite(analysis, plain[1].mutations, ALWAYS, {}).values()
    assert text == NODE.replace("max(-0.5", "3.0 * max(-0.5")


@pytest.mark.parametrize("name", ["gain", "offset", "limit", "comparison"])
def test_a_template_without_state_is_not_replaced(name: str, tmp_path: Path) -> None:
    assert found(name, tmp_path)[1] == []
