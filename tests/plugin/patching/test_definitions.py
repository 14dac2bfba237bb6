"""Names of constants at their definitions."""

from __future__ import annotations

import ast
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Guard
from pytest_tarl.patching.definitions import _entry_name, configured, defined, parameter
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.searching.search import Candidate
from tarl_lint.api import analyse

NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

GAINS = {{"hold": 0.45, "pull": {{"near": 0.3, "far": 0.7}}}}
STEPS = [0.1, 0.2, (0.4, 0.8)]
REACH: float = 2.5


class Mast(Node):
    def __init__(self):
        super().__init__("mast")
        self.declare_parameters("arm", [("rate", 5.0), ("kp", 1.25)])
        self.declare_parameters(namespace="", parameters=[("ki", 0.75)])
        self.kp = self.get_parameter("arm.kp").value
        self.ki = self.get_parameter("ki").value
        self.winch = self.create_publisher(Float64, "/winch", 1)
        self.create_subscription(Float64, "/height", self.on_height, 1)

    def on_height(self, msg):
        self.winch.publish(Float64(data={use} * msg.data))


def main():
    rclpy.init()
    rclpy.spin(Mast())


if __name__ == "__main__":
    main()
"""


@pytest.mark.parametrize(
    ("use", "name", "value"),
    [
        ('GAINS["hold"]', 'GAINS["hold"]', 0.45),
        ('GAINS["pull"]["far"]', 'GAINS["pull"]["far"]', 0.7),
        ("STEPS[1]", "STEPS[1]", 0.2),
        ("STEPS[2][0]", "STEPS[2][0]", 0.4),
        ("REACH", "REACH", 2.5),
        ("self.kp", "arm.kp", 1.25),
        ("self.ki", "ki", 0.75),
    ],
)
def test_an_entry_keeps_its_key_and_a_parameter_its_name(
    tmp_path: Path, use: str, name: str, value: float
) -> None:
    path = tmp_path / "mast.py"
    path.write_text(NODE.format(use=use))
    analysis = analyse([path], root=tmp_path)
    (operand,) = {one for step in analysis.sites for one in analysis.operands(step.site) if one.code == use}
    place = defined(analysis, operand)
    assert place is not None
    assert (place.name, place.value) == (name, value)
    assert parameter(analysis, operand) == (name if use.startswith("self.") else "")


def test_a_file_outside_the_analysis_is_read_when_it_is_changed(tmp_path: Path) -> None:
    path, file = tmp_path / "mast.py", tmp_path / "mast.yaml"
    path.write_text(NODE.format(use="self.ki"))
    file.write_text("mast:\n  ki: 0.5  # per second\n")
    analysis = analyse([path], root=tmp_path)
    (operand,) = {o for step in analysis.sites for o in analysis.operands(step.site) if o.code == "self.ki"}
    (place,) = configured("ki", {"mast.yaml": file.read_text()})
    order: Any = SimpleNamespace(
        analysis=analysis, root=tmp_path, rollout=None, fixture=SimpleNamespace(topics={})
    )
    written = Mutants(order).source(Candidate((Mutation(operand, 2.0, place),), Guard()))
    assert written == {file: "mast:\n  ki: 1.0  # per second\n"}


LAUNCH = '<launch><node pkg="a" type="b"><param name="~ki" value="0.5"/></node></launch>'


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("mast.yaml", "mast: {ki: 0.5}"),
        ("mast.yml", "ki: 0.5"),
        ("mast.json", '{"ki": 0.5}'),
        ("mast.toml", "ki = 0.5"),
        ("mast.launch", LAUNCH),
        ("mast.launch.xml", LAUNCH),
        ("mast.launch.py", "Node(parameters=[{'ki': 0.5}])"),
        ("mast_launch.py", "Node(parameters=[{'ki': 0.5}])"),
        ("Mast.cfg", "gen.add('ki', double_t, 0, 'gain', 0.5, 0, 1)"),
    ],
)
def test_a_parameter_is_found_in_each_kind_of_file(path: str, text: str) -> None:
    (place,) = configured("/arm/ki", {path: text})
    assert (place.path, place.value, text[place.start : place.end]) == (path, 0.5, "0.5")


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("mast.xml", LAUNCH),
        ("mast.yaml", "other_ki: 0.5"),
        ("mast.yaml", "ki: 0.5 m"),
        ("mast.launch", LAUNCH.replace("~ki", "~other_ki")),
        ("Mast.cfg", "gen.remove('ki', double_t, 0, 'gain', 0.5, 0, 1)"),
        ("Mast.cfg", "gen.add('kp', double_t, 0, 'gain', 0.5, 0, 1)"),
        ("Mast.cfg", "gen.add("),
    ],
)
def test_other_files_and_other_parameters_stay_as_they_are(path: str, text: str) -> None:
    assert list(configured("ki", {path: text})) == []


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("declare_parameters('arm', [('ki', 'fast', d)])", "arm.ki"),
        ("declare_parameters('', [('ki', 0.5)])", "ki"),
        ("declare_parameters(namespace='arm', parameters=[('ki', 0.5)])", "arm.ki"),
        ("declare_parameters(name, [('ki', 0.5)])", ""),
        ("declare_parameters('arm', [(name, 'fast')])", ""),
        ("declare_parameters('arm', [entry])", ""),
    ],
)
def test_an_entry_is_named_by_its_namespace_and_its_first_element(code: str, expected: str) -> None:
    call = ast.parse(code, mode="eval").body
    assert isinstance(call, ast.Call)
    entries = next(one for one in ast.walk(call) if isinstance(one, ast.List))
    assert _entry_name(call, entries.elts[0]) == expected


@pytest.mark.parametrize(
    ("definition", "after"),
    [
        ('float(os.environ.get("KP", "2.5"))', 'float(os.environ.get("KP", "5.0"))'),
        ("float(os.getenv('KP', default='2.5'))", "float(os.getenv('KP', default='5.0'))"),
        ('float(os.getenv("KP", 2.5))', 'float(os.getenv("KP", 5.0))'),
        ('int(os.environ.get("KP", "3"))', 'int(os.environ.get("KP", "6"))'),
        ('float(os.environ.get("KP", "-1e-3"))', 'float(os.environ.get("KP", "-0.002"))'),
    ],
)
def test_a_number_from_the_environment_is_changed_at_its_default(
    tmp_path: Path, definition: str, after: str
) -> None:
    path = tmp_path / "mast.py"
    text = NODE.format(use="KP").replace("import rclpy\n", f"import os\nimport rclpy\nKP = {definition}\n", 1)
    path.write_text(text)
    analysis = analyse([path], root=tmp_path)
    (operand,) = {one for step in analysis.sites for one in analysis.operands(step.site) if one.code == "KP"}
    place = defined(analysis, operand)
    assert place is not None
    assert place.name == "KP"
    order: Any = SimpleNamespace(
        analysis=analysis, root=tmp_path, rollout=None, fixture=SimpleNamespace(topics={})
    )
    written = Mutants(order).source(Candidate((Mutation(operand, 2.0, place),), Guard()))
    assert written == {path: text.replace(definition, after)}


@pytest.mark.parametrize(
    "definition", ['os.environ.get("KP")', 'float(os.environ["KP"])', 'os.getenv("KP", "fast")']
)
def test_an_environment_variable_without_a_number_as_default_has_no_definition(
    tmp_path: Path, definition: str
) -> None:
    path = tmp_path / "mast.py"
    path.write_text(
        NODE.format(use="KP").replace("import rclpy\n", f"import os\nKP = {definition}\nimport rclpy\n", 1)
    )
    analysis = analyse([path], root=tmp_path)
    used = {one for step in analysis.sites for one in analysis.operands(step.site) if one.code == "KP"}
    assert all(defined(analysis, one) is None for one in used)
