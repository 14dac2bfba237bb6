"""A repair changes the definition of a constant that the test uses, else the place of use."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from pytest_tarl.ros.messages import node_workspaces
from tests.plugin.tank import ONLINE, RECORD, changed, result
from tests.slow import slow

REPAIR = (*ONLINE, "--tarl-repair", "--tarl-drift=worn", "-p", "no:cacheprovider")
pytestmark = pytest.mark.usefixtures("quick_acceptance")
TARL = (sys.executable, "-m", "pytest_tarl")
IN_CLASS = """\
import rospy
from std_msgs.msg import Float64

{before}
class Keeper:
    {attribute}

    def __init__(self):
        self.gain = {gain}
        self.level = None
        self.valve = rospy.Publisher("/valve", Float64, queue_size=1)
        rospy.Subscriber("/level", Float64, self.on_level)

    def on_level(self, msg):
        self.level = msg.data

    def step(self{argument}):
        if self.level is not None:
            missing = 1.0 - self.level
            self.valve.publish({use} * missing)


def main():
    rospy.init_node("keeper")
    keeper = Keeper()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        keeper.step()
        rate.sleep()


if __name__ == "__main__":
    main()
"""


@pytest.fixture
def worn(tank: pytest.Pytester) -> pytest.Pytester:
    """A tank whose pump is permanently worn out."""
    changed(tank, "test_tank", "from pytest_tarl import Sensor", "from pytest_tarl import Drift, Sensor")
    changed(tank, "test_tank", '{"clogged": 0.25}', '{"worn": Drift(0.2, permanent=True)}')
    return tank


def node(tank: pytest.Pytester, **parts: str) -> None:
    """Write the node with its gain defined at a given place."""
    usual = {"before": "", "attribute": "pass", "gain": "2.0", "argument": "", "use": "self.gain"}
    (tank.path / "keeper.py").write_text(IN_CLASS.format(**usual | parts))


def repaired(tank: pytest.Pytester, *flags: str) -> tuple[str, str, str]:
    """Record and repair; return the edited place, the printed report and the patch's lines."""
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    done = tank.runpytest(*REPAIR, *flags)
    told = " ".join(done.stdout.str().split())
    found = result(tank)["repair"]
    if not found["accepted"]:
        return "", told, ""
    (patch,) = tank.path.glob(".tarl/patches/*.patch")
    lines = [
        line for line in patch.read_text().splitlines() if line[:1] in "+-" and line[:3] not in ("+++", "---")
    ]
    (edit,) = found["edits"]
    return f"{edit['path']}:{edit['line']} {edit['code']}", told, "\n".join(lines)


@pytest.mark.parametrize(
    ("parts", "place"),
    [
        ({"before": "GAIN = 2.0\n", "use": "GAIN"}, "GAIN = "),
        ({"attribute": "GAIN = 2.0", "use": "self.GAIN"}, "    GAIN = "),
        ({}, "        self.gain = "),
        ({"argument": ", gain=2.0", "use": "gain"}, "    def step(self, gain="),
        ({"gain": 'rospy.get_param("~gain", 2.0)'}, '        self.gain = rospy.get_param("~gain", '),
        (
            {"gain": 'rospy.get_param("~gain", default=2)'},
            '        self.gain = rospy.get_param("~gain", default=',
        ),
        ({"before": 'TABLE = {"gain": 2.0}\n', "use": 'TABLE["gain"]'}, 'TABLE = {"gain": '),
    ],
)
def test_a_named_constant_is_changed_where_it_is_defined(
    worn: pytest.Pytester, parts: dict[str, str], place: str
) -> None:
    node(worn, **parts)
    where, _, lines = repaired(worn)
    removed, added = lines.splitlines()
    assert removed.startswith(f"-{place}2")
    assert added.startswith(f"+{place}")
    assert where


@pytest.mark.parametrize(
    ("name", "text", "load", "line"),
    [
        ("gains.yaml", "pid:\n  gain: 2.0  # per metre\n", "yaml.safe_load(file)", "+  gain: "),
        ("gains.json", '{"pid": {\n  "gain": 2.0\n}}\n', "json.load(file)", '+  "gain": '),
    ],
)
def test_loaded_constant_is_changed_in_its_file(
    worn: pytest.Pytester, name: str, text: str, load: str, line: str
) -> None:
    (worn.path / name).write_text(text)
    before = f"""\
import json
import os

import yaml

with open(os.path.join(os.path.dirname(__file__), "{name}")) as file:
    GAINS = {load}
"""
    node(worn, before=before, use='GAINS["pid"]["gain"]')
    where, _, lines = repaired(worn)
    assert where == f"{name}:2 gain"
    assert line in lines


DECLARED = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Keeper(Node):
    def __init__(self):
        super().__init__("keeper")
        {declaration}
        self.gain = self.get_parameter("gain").value
        self.valve = self.create_publisher(Float64, "/valve", 1)
        self.create_subscription(Float64, "/level", self.on_level, 1)

    def on_level(self, msg):
        self.valve.publish(Float64(data=self.gain * (1.0 - msg.data)))


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Keeper())
"""
ONE = 'self.declare_parameter("gain", 2.0)'
SEVERAL = 'self.declare_parameters("", [("rate", 4.0), ("gain", 2.0)])'


@pytest.mark.parametrize("declaration", [ONE, SEVERAL])
def test_a_parameter_default_in_rclpy_code_is_changed(worn: pytest.Pytester, declaration: str) -> None:
    (worn.path / "keeper.py").write_text(DECLARED.format(declaration=declaration))
    where, _, lines = repaired(worn)
    assert where.endswith(" gain")
    assert f"+        {declaration[:-5].removesuffix('2')}" in lines


def test_parameter_is_changed_in_the_named_file(worn: pytest.Pytester) -> None:
    (worn.path / "keeper.py").write_text(DECLARED.format(declaration=SEVERAL.replace("2.0", "0.7")))
    (worn.path / "params.yaml").write_text("keeper:\n  ros__parameters:\n    gain: 2.0\n")
    started = 'tarl.start("keeper.py", argv=["--ros-args", "--params-file", "params.yaml"])'
    changed(worn, "test_tank", 'tarl.start("keeper.py")', started)
    where, _, lines = repaired(worn)
    assert where == "params.yaml:3 gain"
    assert "+    gain: " in lines


FILES = {
    "config/params.yaml": (
        "keeper:\n  gain: 2.0  # per second\n  other_gain: 2.0\n",
        "yaml.safe_load(Path('config/params.yaml').read_text())['keeper']",
        "-  gain: 2.0  # per second",
    ),
    "config/flow.yaml": (
        "/**: {ros__parameters: {gain: 2, rate: 2}}\n",
        "yaml.safe_load(Path('config/flow.yaml').read_text())['/**']['ros__parameters']",
        "-/**: {ros__parameters: {gain: 2, rate: 2}}",
    ),
    "launch/keeper.launch": (
        '<launch>\n  <node name="keeper" pkg="tank">\n    <param name="gain" value="2.0"/>\n  </node>\n</launch>\n',
        "{p.get('name'): float(p.get('value')) for p in ElementTree.parse('launch/keeper.launch').iter('param')}",
        '-    <param name="gain" value="2.0"/>',
    ),
    "cfg/Keeper.cfg": (
        'gen = ParameterGenerator()\ngen.add("gain", double_t, 0, "per second", 2.0, 0.0, 10.0)\n',
        "{'gain': float(ast.parse(Path('cfg/Keeper.cfg').read_text()).body[1].value.args[4].value)}",
        '-gen.add("gain", double_t, 0, "per second", 2.0, 0.0, 10.0)',
    ),
}


@pytest.mark.parametrize(("name", "default"), list(zip(FILES, ["", ", 0.7"] * 2, strict=True)))
def test_parameter_is_changed_in_the_file_of_this_test(
    worn: pytest.Pytester, name: str, default: str
) -> None:
    _, loading, removed = FILES[name]
    node(worn, gain=f'rospy.get_param("~gain"{default})')
    for other, (content, *_) in FILES.items():  # all files exist, and the node reads one of them
        path = worn.path / other
        path.parent.mkdir(exist_ok=True)
        path.write_text(content)
    changed(
        worn,
        "test_tank",
        "import pytest\n",
        "import ast\nimport yaml\nfrom pathlib import Path\nfrom xml.etree import ElementTree\nimport pytest\n",
    )
    changed(worn, "test_tank", 'tarl.start("keeper.py")', f'tarl.start("keeper.py", parameters={loading})')
    before = Path(worn.path / name).read_bytes()
    where, _, lines = repaired(worn)
    assert where.startswith(f"{name}:")
    assert where.endswith(" gain")
    assert lines.splitlines()[0] == removed
    assert len(lines.splitlines()) == 2
    assert Path(worn.path / name).read_bytes() == before
    (patch,) = worn.path.glob(".tarl/patches/*.patch")
    assert worn.run(*TARL, "apply", str(patch)).ret == 0
    worn.runpytest(*RECORD, "--tarl-drift=worn").assert_outcomes(passed=1, deselected=1)


def test_parameter_from_the_test_is_never_edited(worn: pytest.Pytester) -> None:
    node(worn, gain='rospy.get_param("~gain", 0.7)')
    (worn.path / "params.yaml").write_text("gain: 2.0\n")
    changed(worn, "test_tank", 'tarl.start("keeper.py")', 'tarl.start("keeper.py", parameters={"gain": 2.0})')
    where, told, lines = repaired(worn)
    assert where.startswith("keeper.py:")
    assert "self.gain * missing" in lines
    assert "the test itself passes it (parameters=…, argv=…), and TARL never edits tests" in told


def test_launch_parameter_is_not_reported_as_passed_by_the_test(worn: pytest.Pytester) -> None:
    node(worn, gain='rospy.get_param("~gain", 0.7)')
    files = {
        "package.xml": "<package><name>water</name></package>",
        "robot.launch": '<launch><arg name="half" default="1.0"/><node pkg="water" type="keeper.py" name="keeper">'
        '<param name="gain" value="$(eval 2 * half)"/></node></launch>',
    }
    for name, text in files.items():
        (worn.path / name).write_text(text)
    (worn.path / "keeper.py").chmod(0o755)
    changed(worn, "test_tank", 'tarl.start("keeper.py")', 'tarl.launch("robot.launch")  # gains')
    where, told, lines = repaired(worn)
    assert where.startswith("keeper.py:")
    assert "self.gain * missing" in lines
    assert "the launch file of the test sets it. Change the parameter there" in told


def test_a_definition_that_other_code_depends_on_stays_unchanged(worn: pytest.Pytester) -> None:
    node(worn, before="GAIN = 2.0\n", use="GAIN")
    changed(
        worn,
        "keeper",
        "            missing =",
        "            if GAIN > 3.0:\n                return\n            missing =",
    )
    where, told, lines = repaired(worn)
    assert where == "keeper.py:23 GAIN"
    assert "* GAIN * missing" in lines
    assert (
        "`GAIN` is changed at its use, because a change of its definition at keeper.py:4 does not restore"
        in told
    )


@slow
def test_other_uses_of_a_changed_constant_are_listed_and_tested(
    worn: pytest.Pytester,
) -> None:
    node(worn, before="from settings import GAIN\n", use="GAIN")
    (worn.path / "settings.py").write_text("GAIN = 2.0\n")
    (worn.path / "tool.py").write_text("import settings\n\nprint(settings.GAIN)\n")
    test = (worn.path / "test_tank.py").read_text()
    (worn.path / "test_again.py").write_text(test.replace("test_fills", "test_fills_again"))
    changed(worn, "test_tank", 'nodes=["keeper.py"]', 'nodes=["keeper.py", "settings.py"]')
    worn.runpytest(*RECORD).assert_outcomes(passed=2, deselected=2)
    done = worn.runpytest(*REPAIR, "--tarl-budget=40")
    told = " ".join(done.stdout.str().split())
    assert "GAIN at settings.py:1 is also used by tool.py" in told
    (patch,) = worn.path.glob(".tarl/patches/test-tank-*.patch")
    assert "# other test: test_again.py::test_fills_again: " in patch.read_text()


@pytest.mark.parametrize(
    ("edit", "first"), [("use", "-            self.valve"), ("definition", "-GAIN"), ("auto", "-GAIN")]
)
def test_the_flag_edit_chooses_between_use_and_definition(
    worn: pytest.Pytester, edit: str, first: str
) -> None:
    node(worn, before="GAIN = 2.0\n", use="GAIN")
    _, _, lines = repaired(worn, f"--tarl-edit={edit}")
    assert lines.startswith(first)


def test_repair_without_a_required_definition_is_refused(worn: pytest.Pytester) -> None:
    node(worn, gain='rospy.get_param("~gain", 0.7)')
    changed(worn, "test_tank", 'tarl.start("keeper.py")', 'tarl.start("keeper.py", parameters={"gain": 2.0})')
    where, told, _ = repaired(worn, "--tarl-edit=definition", "--tarl-budget=60")
    assert not where or "missing" in told
    assert "it works only at one use of the constant" in told


def test_unknown_edit_value_is_refused_with_a_suggestion(worn: pytest.Pytester) -> None:
    done = worn.runpytest(*REPAIR, "--tarl-edit=defintion")
    done.stderr.fnmatch_lines(["*--tarl-edit does not know 'defintion'; did you mean 'definition'?*"])


LAUNCHED = """\
from launch import LaunchDescription
from launch_ros.actions import Node

base = 1.0


def pick():
    return sum([2.0, 0.0])


def generate_launch_description():
    return LaunchDescription(
        [Node(package="tank", executable="keeper.py", name="keeper", parameters=[{{"gain": {gain}}}])]
    )
"""


def launched(worn: pytest.Pytester, gain: str) -> tuple[str, str, str]:
    """Record and repair a node whose parameter a Python launch file computes."""
    (worn.path / ".git").mkdir()  # the workspace ends here
    (worn.path / "package.xml").write_text("<package><name>tank</name></package>")
    (worn.path / "keeper.py").write_text(DECLARED.format(declaration=ONE.replace("2.0", "0.7")))
    (worn.path / "keeper.launch.py").write_text(LAUNCHED.format(gain=gain))
    changed(worn, "test_tank", 'tarl.start("keeper.py")', 'tarl.launch("keeper.launch.py")')
    node_workspaces.forget()
    return repaired(worn)


def test_number_of_a_computed_launch_parameter_is_changed(worn: pytest.Pytester) -> None:
    where, _, lines = launched(worn, "2 * base")
    assert where == "keeper.launch.py:13 the 2 in 2 * base"
    removed, added = lines.splitlines()
    assert '{"gain": 2 * base}' in removed
    assert " * base}" in added


def test_note_names_a_launch_expression_without_a_number(
    worn: pytest.Pytester,
) -> None:
    where, told, _ = launched(worn, "pick()")
    assert where.startswith("keeper.py:")
    assert "keeper.launch.py:13 computes it as `pick()`, where no number alone determines it" in told
