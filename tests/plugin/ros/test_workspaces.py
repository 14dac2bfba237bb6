"""Nodes in a workspace: packages beside theirs, generated configurations, modules that nobody installs."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent

import pytest

from pytest_tarl.errors import NodeError, UnsupportedApiError
from pytest_tarl.ros.messages import workspace
from tests.plugin.ros.conftest import Start

CFG = """
from dynamic_reconfigure.parameter_generator_catkin import *
gen = ParameterGenerator()
gen.add("gain", double_t, 1, "gain", 0.5, 0, 2)
gen.const("Fast", int_t, 3, "fast")
limits = gen.add_group("limits")
limits.add("top", int_t, 2, "top speed", 4)
exit(gen.generate("arm_base", "arm", "Arm"))
"""


def write(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text))


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Make a workspace of two packages in which the node of the fixture `start` stands, and forget it at the end."""
    monkeypatch.setattr(workspace, "_SEARCHED", [])
    write(
        tmp_path,
        {
            ".git/HEAD": "",
            "arm_base/package.xml": "<package><name>arm_base</name><depend>catkin</depend></package>",
            "arm_base/CMakeLists.txt": "catkin_python_setup()",
            "arm_base/setup.py": """
                from distutils.core import setup
                from catkin_pkg.python_setup import generate_distutils_setup
                setup(**generate_distutils_setup(packages=["controllers", "arm_base"], package_dir={"": "src"}))
                """,
            "arm_base/src/controllers/__init__.py": "",
            "arm_base/src/controllers/pid.py": "GAIN = 0.7",
            "arm_base/src/arm_base/__init__.py": "NAME = 'arm'",
            "arm_base/msg/Reading.msg": "float64 value",
            "arm_base/cfg/Arm.cfg": CFG,
            "arm_tools/package.xml": "<package><name>arm_tools</name><depend>catkin</depend></package>",
            "arm_tools/cfg/Tool.cfg": CFG.replace("arm_base", "arm_tools").replace('"Arm"', '"Tool"'),
            "lib/smoothing.py": "WEIGHT = 0.25",
            "a/twice.py": "",
            "b/twice.py": "",
        },
    )
    workspace.search(tmp_path)
    workspace.forget()
    before = set(sys.modules)
    yield tmp_path
    for name in sys.modules.keys() - before:  # what the plugin's imports forget after each episode
        del sys.modules[name]
    workspace.forget()


def test_packages_of_the_workspace_are_importable_as_installed(packages: Path, start: Start) -> None:
    ros = start("""
        import rospy
        import arm_base
        from arm_base.msg import Reading
        from controllers.pid import GAIN
        rospy.init_node("n")
        found = (arm_base.NAME, GAIN, Reading(2.0).value)
    """)
    assert ros.namespace["found"] == ("arm", 0.7, 2.0)
    assert ros.notes == ()


def test_configurations_are_generated_with_their_defaults(packages: Path, start: Start) -> None:
    ros = start("""
        import rospy
        from dynamic_reconfigure.server import Server
        from arm_base.cfg import ArmConfig
        from arm_tools.cfg.ToolConfig import defaults
        rospy.init_node("n")
        rospy.set_param("~gain", 9.0)
        seen = []
        Server(ArmConfig, lambda config, level: seen.append((config.gain, config.top)) or config)
        found = (ArmConfig.defaults, ArmConfig.max["gain"], ArmConfig.Arm_Fast, ArmConfig.all_level, defaults["top"])
    """)
    assert ros.namespace["found"] == ({"gain": 0.5, "top": 4}, 2.0, 3, 3, 4)
    assert ros.namespace["seen"] == [(2.0, 4)]


def test_a_configuration_without_file_is_named(packages: Path, start: Start) -> None:
    with pytest.raises(
        UnsupportedApiError, match=r"No \.cfg file of arm_base generates LegConfig.*ArmConfig"
    ):
        start("import rospy\nfrom arm_base.cfg import LegConfig\n")


def test_a_module_that_nobody_installs_is_found_and_told(packages: Path, start: Start) -> None:
    ros = start("import smoothing\nfound = smoothing.WEIGHT\n")
    assert ros.namespace["found"] == 0.25
    (note,) = ros.notes
    assert note.startswith(f"smoothing was imported from {packages / 'lib/smoothing.py'}, which no package")


def test_modules_are_not_guessed(packages: Path, start: Start) -> None:
    with pytest.raises(NodeError, match="No module named 'twice'"):
        start("import twice\n")
    ros = start("""
        try:
            import smoothing
        except ImportError:
            smoothing = None
    """)
    assert ros.namespace["smoothing"] is None
