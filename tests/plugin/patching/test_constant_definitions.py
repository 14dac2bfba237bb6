"""Names of constants at their definitions."""

from __future__ import annotations

import ast
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.patching.constant_definitions import (
    Place,
    _entry_name,
    _name,
    computed_at,
    configured,
    defined,
    edits,
    parameter,
    users,
)
from pytest_tarl.patching.document import apply_plain_edits, document
from pytest_tarl.patching.mutate import Mutation, redefinition
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.searching.search import Candidate
from tarl_lint.api import analyse
from tarl_lint.model import Operand, SiteId, Span

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
def test_changed_entry_keeps_its_key(tmp_path: Path, use: str, name: str, value: float) -> None:
    path = tmp_path / "mast.py"
    path.write_text(NODE.format(use=use))
    analysis = analyse([path], root=tmp_path)
    (operand,) = {one for step in analysis.sites for one in analysis.operands(step.site) if one.code == use}
    (place,) = defined(analysis, operand)
    assert place is not None
    assert (place.name, place.value) == (name, value)
    assert parameter(analysis, operand) == (name if use.startswith("self.") else "")


ENTRIES = """\
import rospy
from std_msgs.msg import Float64

entries = rospy.get_param("~", {{}})
table = {{}}
value = {definition}


def on_height(msg):
    winch.publish(value * msg.data)


rospy.init_node("mast")
winch = rospy.Publisher("/winch", Float64, queue_size=1)
rospy.Subscriber("/height", Float64, on_height)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("definition", "name"),
    [
        ('entries.get("slow", 0.28)', "slow"),
        ('float(entries.get("slow", 0.28))', "slow"),
        ('rospy.get_param("~opening", {}).get("slow", 0.28)', "slow"),
        ('rospy.get_param("~opening/slow", 0.28)', "~opening/slow"),
        ("entries.get(rospy.get_name(), 0.28)", ""),
    ],
)
def test_default_of_an_entry_is_its_definition(tmp_path: Path, definition: str, name: str) -> None:
    path = tmp_path / "mast.py"
    path.write_text(ENTRIES.format(definition=definition))
    analysis = analyse([path], root=tmp_path)
    (operand,) = {one for step in analysis.sites for one in analysis.operands(step.site)}
    (place,) = defined(analysis, operand)
    assert (place.value, path.read_text()[place.start : place.end]) == (0.28, "0.28")
    assert (place.name, parameter(analysis, operand)) == (name or "value", name)


@pytest.mark.parametrize("definition", ["{}", "int({})", "round(float({}))", "rospy.get_param(int({}))"])
def test_parameter_without_default_is_known_in_a_conversion(tmp_path: Path, definition: str) -> None:
    path = tmp_path / "mast.py"
    path.write_text(ENTRIES.format(definition=definition.format('rospy.get_param("~times")')))
    analysis = analyse([path], root=tmp_path)
    (operand,) = {one for step in analysis.sites for one in analysis.operands(step.site)}
    assert parameter(analysis, operand) == ("" if "(int" in definition else "~times")


def test_changed_file_outside_the_analysis_is_read(tmp_path: Path) -> None:
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
        ("mast_launch.xml", LAUNCH),
        ("mast.launch", '<arg name="k" default="0.5"/><param name="ki" value="$(arg k)"/>'),
        ("mast.launch.xml", '<arg name="k" default="0.5"/><param name="ki" value="$(var k)"/>'),
        ("mast.launch", '<arg name="ki" default="0.5"/><param name="ki" value="$(arg ki)"/>'),
        ("mast.launch.py", "Node(parameters=[{'ki': 0.5}])"),
        ("mast_launch.py", "Node(parameters=[{'ki': 0.5}])"),
        ("Mast.cfg", "gen.add('ki', double_t, 0, 'gain', 0.5, 0, 1)"),
        ("Mast.cfg", "gen.add('ki', double_t, 0, 'gain', 0.5)"),
        ("Mast.cfg", "gen.add('ki', double_t, 0, 'gain', default=0.5, min=0)"),
        ("Mast.cfg", "gen.add(name='ki', paramtype='double', level=0, description='gain', default=0.5)"),
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
        ("mast.launch", '<arg name="k" default="0.5"/><param name="ki" value="$(arg other)"/>'),
        ("Mast.cfg", "gen.remove('ki', double_t, 0, 'gain', 0.5, 0, 1)"),
        ("Mast.cfg", "gen.add('kp', double_t, 0, 'gain', 0.5, 0, 1)"),
        ("Mast.cfg", "gen.add("),
        ("Mast.cfg", "gen.add('ki', double_t, 0, 'gain')"),
        ("Mast.cfg", "gen.add('ki', str_t, 0, 'gain', 'slow')"),
        ("Mast.cfg", "add('ki', double_t, 0, 'gain', 0.5)"),
    ],
)
def test_files_without_the_parameter_and_other_parameters_stay_unchanged(path: str, text: str) -> None:
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
def test_entry_is_named_by_namespace_and_first_element(code: str, expected: str) -> None:
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
def test_environment_number_is_changed_at_its_default(tmp_path: Path, definition: str, after: str) -> None:
    path = tmp_path / "mast.py"
    text = NODE.format(use="KP").replace("import rclpy\n", f"import os\nimport rclpy\nKP = {definition}\n", 1)
    path.write_text(text)
    analysis = analyse([path], root=tmp_path)
    (operand,) = {one for step in analysis.sites for one in analysis.operands(step.site) if one.code == "KP"}
    (place,) = defined(analysis, operand)
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
def test_environment_variable_without_a_number_has_no_definition(tmp_path: Path, definition: str) -> None:
    path = tmp_path / "mast.py"
    path.write_text(
        NODE.format(use="KP").replace("import rclpy\n", f"import os\nKP = {definition}\nimport rclpy\n", 1)
    )
    analysis = analyse([path], root=tmp_path)
    used = {one for step in analysis.sites for one in analysis.operands(step.site) if one.code == "KP"}
    assert not any(defined(analysis, one) for one in used)


HEAD = "base = 1.5\nodd = base if simulated else 2.0\n"


@pytest.mark.parametrize(
    ("expression", "changed"),
    [
        ("2 * base", ("'ki': 3 * base", "base = 2.25")),
        ("base", ("base = 2.25",)),
        ("base + 0.5", ("'ki': base + 1.5", "base = 2.5")),
        ("-base / 3", ("base = 2.25",)),
        ("1.0 - base", ("'ki': 0.75 - base", "base = 1.75")),
        ("float('0.5')", ("'ki': float('0.75')",)),
        ("ParameterValue(base, value_type=float)", ("base = 2.25",)),
        ("LaunchConfiguration('gain')", ("default_value='0.6'",)),
        ("[LaunchConfiguration('gain')]", ("default_value='0.6'",)),
        ("base * base", ()),
        ("odd", ()),
        ("2 * pick()", ()),
        ("LaunchConfiguration('other')", ()),
    ],
)
def test_computed_launch_parameter_is_changed_at_its_numbers(
    expression: str, changed: tuple[str, ...]
) -> None:
    argument = "DeclareLaunchArgument('gain', default_value='0.4'), DeclareLaunchArgument('other')"
    text = f"{HEAD}made = [{argument}, Node(parameters=[{{'ki': {expression}}}])]\n"
    use, definition = Span("n.py", 9, 1, 9, 3), Span("n.py", 2, 1, 2, 2)
    operand = Operand(SiteId("n", "", "x"), use, "ki", 3.0, definition)
    found = list(configured("ki", {"a.launch.py": text}))
    texts = []
    for place in found:
        value = redefinition(Mutation(operand, 1.5, place))
        texts.append(apply_plain_edits("a.launch.py", text, edits({place: value}, text)))
    assert len(texts) == len(changed)
    for new, part in zip(texts, changed, strict=True):
        assert part in new
        assert part not in text
    why = computed_at("ki", {"a.launch.py": text})
    assert why == ("" if changed else f"a.launch.py:3 computes it as `{expression}`")


@pytest.mark.parametrize(
    "text",
    [
        "SetParameter(name='ki', value=0.5)",
        "SetParameter('ki', 0.5)",
        "Node(parameters=[dict(ki=0.5)])",
        "Node(parameters=[{'mast': {'ki': 0.5}}])",
        "Node(parameters=[{'mast.ki': 0.5}])",
        "IncludeLaunchDescription(source, launch_arguments={'ki': '0.5'}.items())",
        "gain = 0.5\ndef generate_launch_description():\n    return Node(parameters=[{'ki': gain}])",
    ],
)
def test_python_launch_file_sets_parameters_in_several_ways(text: str) -> None:
    (place,) = configured("ki", {"a.launch.py": text})
    assert (place.value, text[place.start : place.end], place.share) == (0.5, "0.5", 1.0)


numbers = st.floats(0.1, 10).map(lambda one: round(one, 3))


@given(
    numbers, numbers, numbers, st.sampled_from(["{a} * base + {b}", "{b} - base / {a}", "({a} + base) * {b}"])
)
def test_changed_numbers_scale_the_parameter_as_wanted(a, b, factor, form):  # type: ignore[no-untyped-def]
    expression = form.format(a=a, b=b)
    text = f"base = 1.25\nNode(parameters=[{{'ki': {expression}}}])\n"
    whole = eval(expression, {"base": 1.25})
    for place in configured("ki", {"a.launch.py": text}):
        new = place.value * (1.0 + (factor - 1.0) * place.share)
        changed = text[: place.start] + repr(new) + text[place.end :]
        base = float(changed.partition("\n")[0].removeprefix("base = "))
        value = eval(changed.partition("'ki': ")[2].partition("}")[0], {"base": base})
        assert value == pytest.approx(factor * whole, abs=1e-6)


def test_number_in_a_listed_call_is_named_after_its_element() -> None:
    text = NODE.format(use="LATE[1]").replace("REACH:", 'LATE = [0.1, float("0.5")]\nREACH:')
    source = document("mast.py", text)
    literal = next(
        one for one in ast.walk(source.tree) if isinstance(one, ast.Constant) and one.value == "0.5"
    )
    assert _name(source, literal) == "LATE[1]"


def place(text: str, value: Any, old: str) -> Place:
    start = text.index(old)
    return Place("a.yaml", start, start + len(old), 1, "ki", value)


@pytest.mark.parametrize(
    ("text", "old", "value", "new", "expected"),
    [
        ("ki: 0.5", "0.5", 0.5, 0.75, "ki: 0.75"),
        ("ki: 2", "2", 2, 3.0, "ki: 3"),
        ("ki: 2", "2", 2, 2.5, "ki: 2.5"),
        ("ki: 2.0", "2.0", 2.0, 3, "ki: 3.0"),
        ("ki: 20e-1", "20e-1", 2.0, 3.0, "ki: 3.0"),
        ("ki: true", "true", True, False, "ki: false"),
        ("ki: True", "True", True, False, "ki: False"),
        ("ki: false", "false", False, True, "ki: true"),
    ],
)
def test_new_value_has_the_style_of_the_old_one(
    text: str, old: str, value: Any, new: Any, expected: str
) -> None:
    assert apply_plain_edits("a.yaml", text, edits({place(text, value, old): new}, text)) == expected


@pytest.mark.parametrize(("text", "old", "value"), [("ki: 0.6", "0.6", 0.5), ("ki: no", "no", 0.5)])
def test_a_file_that_changed_since_is_not_edited(text: str, old: str, value: float) -> None:
    with pytest.raises(RepairError, match=r"^a\.yaml:1: expected 0\.5, but the file changed: run again"):
        edits({place(text, value, old): 1.0}, text)


def test_other_uses_are_named_by_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mast.py").write_text(
        NODE.format(use="(REACH + 2.0 * self.ki + GAINS['hold'])").replace(
            "    def on_height(self, msg):\n",
            "    def on_height(self, msg):\n"
            "        far = REACH * msg.data\n"
            "        self.winch.publish(Float64(data=far))\n"
            "        fast = self.get_parameter('ki').value * msg.data\n"
            "        self.winch.publish(Float64(data=fast))\n",
        )
    )
    analysis = analyse([Path("mast.py")])
    lines = Path("mast.py").read_text().splitlines()

    def uses(code: str, text: str) -> list[Operand]:
        return [
            one
            for step in analysis.sites
            for one in analysis.operands(step.site)
            if one.code == code and text in lines[one.span.line - 1]
        ]

    def numbers(*texts: str) -> list[str]:
        return [
            f"mast.py:{at}" for at, line in enumerate(lines, start=1) if any(one in line for one in texts)
        ]

    assert users(analysis, uses("REACH", "far = ")[:1]) == numbers("(REACH")
    assert users(analysis, uses("REACH", "(REACH")[:1]) == numbers("far = ")
    assert users(analysis, [*uses("REACH", "far = ")[:1], *uses("REACH", "(REACH")[:1]]) == []
    # a parameter is used wherever it is read, whatever the code there
    assert set(numbers("fast = ")) <= set(users(analysis, uses("self.ki", "(REACH")[:1]))
