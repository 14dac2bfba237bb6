"""Each kind of file of a workspace is damaged: it is named with the reason, or nothing that is read changes."""

from __future__ import annotations

import ast
import configparser
import random
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from tarl_lint.workspace.cfg_files import configurations
from tarl_lint.workspace.examination import Examined, examined
from tarl_lint.workspace.interface_syntax import mistakes
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.message_files import fields
from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.read import read
from tests.slow import SLOW, chance

DESCRIPTION = """
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([Node(package="eye", executable="look", name="look", parameters=[{"size": 3}])])
"""
FILES = {
    "arm/package.xml": "<package><name>arm</name><buildtool_depend>catkin</buildtool_depend>"
    '<export><nodelet plugin="${prefix}/nodelets.xml"/></export></package>\n',
    "arm/CMakeLists.txt": "project(arm)\ncatkin_python_setup()\nif(TRUE)\n  set(NODES scripts/drive.py)\nendif()\n"
    "add_message_files(FILES State.msg)\ngenerate_dynamic_reconfigure_options(cfg/Arm.cfg)\n"
    "add_executable(servo src/servo.cpp)\ncatkin_install_python(PROGRAMS ${NODES}\n  DESTINATION bin)\n",
    "arm/setup.py": "from distutils.core import setup\nfrom catkin_pkg.python_setup import generate_distutils_setup\n"
    "setup(**generate_distutils_setup(packages=['arm'], package_dir={'': 'src'}))\n",
    "arm/nodelets.xml": '<library path="lib/arm"><class name="arm/Grip" type="arm::Grip"/></library>\n',
    "arm/scripts/drive.py": "#!/usr/bin/env python3\nimport rospy\n\nrospy.init_node('drive')\nrospy.spin()\n",
    "arm/src/arm/__init__.py": "",
    "arm/src/arm/pid.py": "class Pid:\n    def __init__(self, gain):\n        self.gain = gain\n",
    "arm/cfg/Arm.cfg": "#!/usr/bin/env python\nfrom dynamic_reconfigure.parameter_generator_catkin import *\n"
    "gen = ParameterGenerator()\ngen.add('gain', double_t, 0, 'The gain', 1.5, 0, 10)\n"
    "exit(gen.generate('arm', 'arm', 'Arm'))\n",
    "arm/msg/State.msg": "# the state\nfloat64 angle\nuint8 OPEN=1\nstring[] names\n",
    "arm/srv/Move.srv": "float64 angle\n---\nbool done\n",
    "arm/action/Reach.action": "float64 angle\n---\nbool done\n---\nfloat64 left\n",
    "arm/config/gains.yaml": "drive:\n  gain: 1.5\n  names: [left, right]\n",
    "arm/launch/arm.launch": '<launch>\n  <node pkg="arm" type="drive.py" name="drive">\n'
    '    <rosparam file="$(find arm)/config/gains.yaml"/>\n  </node>\n</launch>\n',
    "arm/launch/part.xml": '<launch>\n  <node pkg="arm" type="drive.py" name="part"/>\n</launch>\n',
    "eye/package.xml": "<package><name>eye</name><export><build_type>ament_python</build_type></export></package>\n",
    "eye/setup.py": "from setuptools import setup\nsetup(name='eye', packages=['eye'])\n",
    "eye/setup.cfg": "[options.entry_points]\nconsole_scripts =\n    look = eye.look:main\n",
    "eye/eye/__init__.py": "",
    "eye/eye/look.py": "import rclpy\n\n\ndef main():\n    rclpy.init()\n",
    "eye/launch/a.launch.py": DESCRIPTION,
    "eye/launch/b_launch.py": DESCRIPTION,
    "eye/launch/c.launch.xml": '<launch>\n  <node pkg="eye" exec="look" name="look"/>\n</launch>\n',
    "eye/launch/d.launch.yaml": "launch:\n- node: {pkg: eye, exec: look, name: look}\n",
}
KINDS = [name for name, text in FILES.items() if text]
TYPES = ("arm/State", "arm/Move.Request", "arm/Move.Response", "arm/Reach.Goal", "arm/Reach.Result")
RUNS = 300 if SLOW else 4  # damaged texts of each file


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root: Path = tmp_path_factory.mktemp("workspace")
    for name, text in FILES.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, "utf-8")
    return root


def seen(root: Path) -> tuple[str, dict[str, list[Problem]]]:
    """Return all that is read of a workspace, and the problems of each file."""
    known = read(root)
    found = examined(known)
    packages = [replace(one, problems=()) for one in found.workspace.packages]
    launches = [
        replace(read_launch(file, known), problems=()) for one in packages for file in one.launch_files
    ]
    configured = [configurations(file)[0] for one in packages for file in one.configurations]
    modules = [
        _tree(file) for one in packages for each in one.modules for file in sorted(each.path.rglob("*.py"))
    ]
    scripts = [_tree(each.path) for one in packages for each in one.executables if each.path]
    values = [_loaded(file) for one in packages for file in one.parameter_files]
    whole = repr(
        (packages, launches, configured, modules, scripts, values, fields(TYPES, known), found.foreign)
    )
    return whole, _by_file(root, found)


def _by_file(root: Path, found: Examined) -> dict[str, list[Problem]]:
    problems: dict[str, list[Problem]] = {}
    for one in found.workspace.problems():
        problems.setdefault(one.file.relative_to(root).as_posix(), []).append(one)
    return problems


def _tree(file: Path) -> str:
    try:
        return ast.dump(ast.parse(file.read_bytes()))
    except (SyntaxError, ValueError):
        return "nothing"


def _loaded(file: Path) -> object:
    try:
        return yaml.safe_load(file.read_bytes())
    except (yaml.YAMLError, UnicodeDecodeError):
        return "nothing"


def is_valid(name: str, data: bytes) -> bool:
    """Return whether the parser that ROS uses for a file accepts it, or another one that is as strict."""
    try:
        text = data.decode("utf-8")
        if "\0" in text:
            return False
        if name.endswith((".xml", ".launch")):
            root = ElementTree.fromstring(data)
            return not name.endswith("package.xml") or bool((root.findtext("name") or "").strip())
        if name.endswith((".py", "Arm.cfg")):
            ast.parse(data)
        elif name.endswith((".yaml", ".yml")):
            yaml.safe_load(text)
        elif name.endswith("setup.cfg"):
            configparser.ConfigParser(interpolation=None).read_string(text)
        elif name.endswith("CMakeLists.txt"):
            return text.count("(") == text.count(")") and text.count("if(") == 2 * text.count("endif(")
        else:
            lines = [line.partition("#")[0].split() for line in text.splitlines()]
            dashes = sum(line == ["---"] for line in lines)
            wanted = {".msg": 0, ".srv": 1, ".action": 2}[Path(name).suffix]
            return dashes == wanted and all(len(line) != 1 or line == ["---"] for line in lines)
    except (ValueError, SyntaxError, ElementTree.ParseError, yaml.YAMLError, configparser.Error):
        return False
    return True


def _truncated(data: bytes, draw: random.Random) -> bytes:
    return data[: draw.randrange(len(data))]


def _overwritten(data: bytes, draw: random.Random) -> bytes:
    start = draw.randrange(len(data))
    noise = draw.randbytes(draw.randint(1, 8))
    return data[:start] + noise + data[start + len(noise) :]


def _badly_encoded(data: bytes, draw: random.Random) -> bytes:
    start = draw.randrange(len(data) + 1)
    return data[:start] + "ä".encode("latin-1") + data[start:]


def _noise(data: bytes, draw: random.Random) -> bytes:
    return draw.randbytes(len(data))


DAMAGES: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    _truncated,
    _overwritten,
    _badly_encoded,
    _noise,
)


def test_the_undamaged_files_are_read_without_a_problem(workspace: Path) -> None:
    whole, problems = seen(workspace)
    assert problems == {}
    assert all(word in whole for word in ("servo", "arm/Grip", "drive.py", "look", "gain", "angle"))


@pytest.mark.parametrize("name", KINDS)
def test_a_damaged_file_is_named_or_has_no_effect(name: str, workspace: Path) -> None:
    before, _ = seen(workspace)
    path, draw = workspace / name, chance(name)
    data = path.read_bytes()
    invalid = 0
    try:
        for number in range(RUNS):
            damaged = DAMAGES[number % len(DAMAGES)](data, draw)
            path.write_bytes(damaged)
            after, problems = seen(workspace)
            if not is_valid(name, damaged):
                invalid += 1
                assert problems.get(name) or after == before, damaged
            assert set(problems) <= {name} or problems.get(name) or is_valid(name, damaged), damaged
    finally:
        path.write_bytes(data)
    assert invalid


BROKEN = {
    "arm/package.xml": ("<package><name>arm</name>", r"it is not XML: "),
    "arm/CMakeLists.txt": (
        "install(PROGRAMS ${FOO} scripts/${BAR}.py DESTINATION bin)",
        r"install: the value of \$\{FOO\}",
    ),
    "arm/setup.py": (
        "from setuptools import setup\nsetup(packages=names())\n",
        r"`packages` is not constant",
    ),
    "arm/nodelets.xml": ("<library>", r"it is not XML: "),
    "arm/scripts/drive.py": ("#!/usr/bin/env python\nprint 'Hello'\n", r"it is not Python 3: "),
    "arm/src/arm/pid.py": ("def f(:\n", r"it is not Python 3: "),
    "arm/cfg/Arm.cfg": (
        FILES["arm/cfg/Arm.cfg"].replace("1.5", "os.getpid()"),
        r"the default of gain is not constant",
    ),
    "arm/msg/State.msg": ("float64\n", r"`float64` is neither a field nor a constant"),
    "arm/srv/Move.srv": ("float64 angle\n", r"it has 0 lines of dashes in place of 1"),
    "arm/action/Reach.action": ("float64 angle\n---\nbool done\n", r"it has 1 lines of dashes in place of 2"),
    "arm/config/gains.yaml": ("drive: [1, 2\n", r"it is not YAML: "),
    "arm/launch/arm.launch": ("<launch>", r"it is not XML: "),
    "arm/launch/part.xml": ("<launch", r"it is not XML: "),
    "eye/setup.cfg": ("console_scripts = a\n", r"it cannot be read: "),
    "eye/launch/a.launch.py": ("def generate_launch_description(:\n", r"it is not Python 3: "),
    "eye/launch/b_launch.py": ("def generate(:\n", r"it is not Python 3: "),
    "eye/launch/c.launch.xml": ("<launch><node></launch>", r"it is not XML: "),
    "eye/launch/d.launch.yaml": ("launch: [\n", r"it is not YAML: "),
}


@pytest.mark.parametrize(
    ("line", "valid"),
    [
        ("int32 A =", False),
        ("int32 A = x  # 1", False),
        ("float64 G=", False),
        ("uint8 N = 1.5", False),
        ("Pose P = 1", False),
        ("int32[] L = 1", False),
        ("bool B =", False),
        ("int32 A = 0x1F  # mask", True),
        ("int8 N=-1", True),
        ("int8 N=-0x1F", True),
        ("float32 G = 1e-3", True),
        ("bool B = True", True),
        ("string S = # kept", True),
        ("string<=5 S =", True),
        ("uint32 LEADING = 010", True),
    ],
)
def test_a_constant_has_a_value_of_its_type(line: str, valid: bool) -> None:
    assert [number for number, _ in mistakes(f"{line}\n", ".msg")] == ([] if valid else [1])


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_named_with_the_reason(name: str, workspace: Path) -> None:
    text, reason = BROKEN[name]
    path = workspace / name
    before = path.read_bytes()
    path.write_text(text, "utf-8")
    try:
        _, problems = seen(workspace)
    finally:
        path.write_bytes(before)
    assert any(re.match(reason, one.reason) for one in problems[name]), problems


def test_missing_file_and_folder_are_named(workspace: Path) -> None:
    for name in ("arm/msg/State.msg", "arm/cfg/Arm.cfg", "arm/scripts/drive.py"):
        path = workspace / name
        before = path.read_bytes()
        path.unlink()
        try:
            assert "arm/CMakeLists.txt" in seen(workspace)[1]
        finally:
            path.write_bytes(before)
