"""Nodes in a workspace: other packages, generated configurations, modules that no package installs."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent

import pytest

from pytest_tarl.errors import NodeError, SettingsError, UnsupportedApiError
from pytest_tarl.ros import Ros, launched, siblings, uninstalled
from pytest_tarl.ros.launch_sources import NOTHING, Given
from pytest_tarl.ros.launched import given
from pytest_tarl.ros.messages import node_workspaces
from pytest_tarl.ros.messages.node_workspaces import package_folders
from pytest_tarl.ros.packages import ResourceNotFound, RosPack
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
    """Create a workspace of two packages that contains the node of the fixture `start`; forget it at the end."""
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
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
    node_workspaces.search(tmp_path)
    node_workspaces.forget()
    before = set(sys.modules)
    yield tmp_path
    for name in sys.modules.keys() - before:  # removed after each episode by the plugin's import hook
        del sys.modules[name]
    node_workspaces.forget()


def test_workspace_packages_are_importable_as_if_installed(packages: Path, start: Start) -> None:
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


def test_test_can_use_message_types_of_its_repository(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    write(
        tmp_path,
        {
            ".git/HEAD": "",
            "somebody_msgs/msg/Level.msg": "float64 water",
            "robot/tests/test_tank.py": """
                from pytest_tarl.ros import message_type
                Level = message_type("somebody_msgs/msg/Level")
            """,
        },
    )
    found = runpy.run_path(str(tmp_path / "robot" / "tests" / "test_tank.py"))
    assert found["Level"](water=2.0).water == 2.0
    node_workspaces.forget()


@pytest.mark.parametrize("test", [".", "tests"])
def test_nearby_definitions_need_no_repository(
    test: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    node_workspaces.forget()
    write(
        tmp_path,
        {"boat/srv/Shoot.srv": "bool now\n---", "boat/nodes/boat.py": "", f"{test}/test_boat.py": ""},
    )
    ros = Ros()
    ros.use_definitions_around(tmp_path / "boat" / "nodes", tmp_path / test)
    assert node_workspaces.workspace_types("srv") == {"boat/Shoot": "bool now\n---"}
    ros.use_definitions_around(tmp_path.parent.parent, tmp_path / test)  # a node elsewhere
    assert [tmp_path] == node_workspaces._SEARCHED
    ros.close()
    node_workspaces.forget()


def test_a_folder_without_definitions_is_not_searched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    write(tmp_path, {"boat/srv/README.md": "", "boat/nodes/boat.py": ""})
    node_workspaces.search(tmp_path / "boat" / "nodes", tmp_path)
    assert node_workspaces._SEARCHED == []


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


def test_the_error_names_a_configuration_without_a_file(packages: Path, start: Start) -> None:
    with pytest.raises(
        UnsupportedApiError, match=r"No \.cfg file of arm_base generates LegConfig.*ArmConfig"
    ):
        start("import rospy\nfrom arm_base.cfg import LegConfig\n")


def test_node_in_an_ignored_package_imports_its_messages(
    packages: Path, start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node_workspaces, "_KEPT", set())
    write(packages, {"arm_base/CATKIN_IGNORE": "", "arm_tools/COLCON_IGNORE": ""})
    node_workspaces.forget()
    assert not node_workspaces.packages()
    node_workspaces.search(packages / "arm_base/src")
    assert set(node_workspaces.packages()) == {"arm_base"}
    assert start("import rospy\nfrom arm_base.msg import Reading\n").namespace["Reading"](1.0).value == 1.0


def test_uninstalled_module_is_imported_with_a_note(packages: Path, start: Start) -> None:
    ros = start("import smoothing\nfound = smoothing.WEIGHT\n")
    assert ros.namespace["found"] == 0.25
    (note,) = ros.notes
    assert note.startswith(f"smoothing was imported from {packages / 'lib/smoothing.py'}, which no package")


def test_ambiguous_and_optional_modules_are_not_imported(packages: Path, start: Start) -> None:
    with pytest.raises(NodeError, match="No module named 'twice'"):
        start("import twice\n")
    ros = start("""
        try:
            import smoothing
        except ImportError:
            smoothing = None
    """)
    assert ros.namespace["smoothing"] is None


NODE1 = """
    import rospy
    rospy.init_node("drive")
    found = {name: rospy.get_param("~" + name, None) for name in ("kp", "limits/top", "limits/low", "rate")}
    shared = rospy.get_param("/robot/mass", None)
"""
NODE2 = """
    import rclpy
    rclpy.init()
    node = rclpy.create_node("drive")
    found = {name: node.declare_parameter(name, 0.0 if name == "kp" else 0).value for name in ("kp", "limits.top")}
"""
LAUNCH1 = """
    <launch>
      <param name="robot/mass" value="12.5"/>
      <node pkg="arm_base" type="node.py" name="other_name">
        <rosparam file="$(find arm_base)/config/arm.yaml"/>
        <param name="rate" value="{rate}"/>
      </node>
    </launch>
    """
LAUNCH2 = """
    from launch import LaunchDescription
    from launch_ros.actions import Node
    from launch_ros.substitutions import FindPackageShare
    def generate_launch_description():
        return LaunchDescription([Node(package="arm_base", executable="node.py", name="drive",
            parameters=[[FindPackageShare("arm_base"), "/config/ros2.yaml"], {"limits": {"top": 4}}])])
    """


@pytest.fixture
def launches(packages: Path) -> Path:
    """Move the node of the fixture `start` into the package arm_base, with two launch files for it."""
    write(
        packages,
        {
            "package.xml": "<package><name>arm_base</name></package>",
            "config/arm.yaml": "kp: 1.5\nlimits: {top: 3, low: 1}\n",
            "config/ros2.yaml": """
                drive:
                  ros__parameters: {kp: 2.5, limits: {top: 3}}
                other:
                  ros__parameters: {kp: 9.0}
                """,
            "launch/one.launch": LAUNCH1.format(rate=5),
        },
    )
    (packages / "arm_base/package.xml").unlink()
    node_workspaces.forget()
    return packages


def started(start: Start, folder: Path, source: str, given: Given, **parameters: object) -> dict[str, object]:
    ros = Ros(parameters=parameters)
    with ros.installed():
        ros.launch(given)
        start(source, ros=ros)
        ros.close()
    return ros.namespace  # type: ignore[attr-defined,no-any-return]


def test_launch_parameters_yield_to_the_test(launches: Path, start: Start) -> None:
    found = given(launches / "node.py")
    assert found.note == "parameters of other_name come from one.launch (arm.yaml)."
    namespace = started(start, launches, NODE1, found, **{"kp": 7, "~limits/low": 0})
    assert namespace["found"] == {"kp": 7, "limits/top": 3, "limits/low": 0, "rate": 5}
    assert namespace["shared"] == 12.5


def test_parameters_of_ros2_come_from_launch_files_in_python(launches: Path, start: Start) -> None:
    write(launches, {"launch/one.launch.py": LAUNCH2})
    (launches / "launch/one.launch").unlink()
    node_workspaces.forget()
    found = given(launches / "node.py")
    assert found.note == "parameters of drive come from one.launch.py (ros2.yaml)."
    assert started(start, launches, NODE2, found)["found"] == {"kp": 2.5, "limits.top": 4}
    assert started(start, launches, NODE2, found, kp=3.0)["found"] == {"kp": 3.0, "limits.top": 4}


def test_a_node_gets_the_parameters_of_its_enclosing_namespaces(launches: Path) -> None:
    text = """
        <launch>
          <param name="everywhere" value="1"/>
          <group ns="left"><param name="side" value="l"/><node pkg="arm_base" type="node.py" name="drive"/></group>
        </launch>
        """
    write(launches, {"launch/one.launch": text})
    node_workspaces.forget()
    assert given(launches / "node.py").shared == {"/everywhere": 1, "/side": "l"}


def test_group_parameters_belong_to_their_node(launches: Path, start: Start) -> None:
    text = """
        <launch>
          <arg name="mode"/>
          <group ns="left">
            <rosparam file="$(find arm_base)/config/arm.yaml" ns="other_name"/>
            <param name="other_name/rate" value="5"/><param name="other_name/mode" value="$(arg mode)"/>
            <param name="other_name_2/rate" value="6"/>
            <node pkg="arm_base" type="node.py" name="other_name"><param name="kp" value="2.0"/></node>
          </group>
        </launch>
        """
    write(launches, {"launch/one.launch": text})
    node_workspaces.forget()
    found = given(launches / "node.py")
    assert (found.shared, found.valueless) == ({"/other_name_2/rate": 6}, ("mode",))
    namespace = started(start, launches, NODE1, found)
    assert namespace["found"] == {"kp": 2.0, "limits/top": 3, "limits/low": 1, "rate": 5}


def test_conflicting_launch_files_set_only_equal_parameters(
    launches: Path,
) -> None:
    other = LAUNCH1.format(rate=9).replace('name="rate"', 'name="limits/low" value="1.0"/><param name="rate"')
    write(launches, {"launch/two.launch": other})
    node_workspaces.forget()
    found = given(launches / "node.py")
    assert found.private == {"kp": 1.5, "limits": {"top": 3, "low": 1}}
    assert found.shared == {"/robot/mass": 12.5}
    assert found.note.startswith(
        "node.py gets different parameters in these launch files: one.launch, two.launch. In this test, it got only"
    )
    write(launches, {"launch/two.launch": LAUNCH1.format(rate=9).replace("arm.yaml", "low.yaml"),
                     "config/low.yaml": "kp: true\nlimits: {top: 3.0, low: 1}\n"})  # fmt: skip
    node_workspaces.forget()
    assert given(launches / "node.py").private == {"limits": {"low": 1}}
    assert given(launches / "node.py", launches / "launch/two.launch").private["rate"] == 9
    assert given(launches / "smoothing.py") == NOTHING
    with pytest.raises(SettingsError, match=r"one\.launch starts no node from smoothing\.py"):
        given(launches / "smoothing.py", launches / "launch/one.launch")
    with pytest.raises(SettingsError, match="there is no launch file"):
        given(launches / "node.py", launches / "launch/three.launch")


def test_later_node_gets_its_own_parameters(start: Start) -> None:
    ros = start("import rospy\nrospy.init_node('a')\nrospy.set_param('~x', 1)\n")
    ros.give({"gain": 2})
    start("import rospy\nrospy.init_node('b')\nfound = rospy.get_param('~gain')\n", ros=ros)
    assert ros.namespace["found"] == 2


def test_start_accepts_a_launch_file_or_false(launches: Path, pytester: pytest.Pytester) -> None:
    test = """
        import pytest
        from pytest_tarl import Sensor

        @pytest.mark.parametrize("launch", ["launch/two.launch", False, None])
        @pytest.mark.tarl(nodes=["node.py"], sensors=[Sensor("x", low=0, high=1, bins=2)])
        def test_it(tarl, launch):
            tarl.start("node.py", launch=launch)
        """
    node = NODE1 + "    print('RATE', found['rate'])\n"
    write(launches, {"launch/two.launch": LAUNCH1.format(rate=9), "node.py": node, "test_it.py": test})
    quiet = ("-p", "no:randomly", "-p", "no:asyncio", "-p", "no:rerunfailures")
    result = pytester.runpytest("-q", "-s", *quiet, str(launches / "test_it.py"))
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["*RATE 9*", "*RATE None*", "*RATE None*"])


def test_ros2_arguments_come_from_the_launch_file(launches: Path, pytester: pytest.Pytester) -> None:
    arguments = 'arguments=["--arm", "left", "--ros-args", "-r", "a:=b", "-p", "kp:=4.0"], '
    (launches / "launch/one.launch").unlink()
    node = "import sys\nprint('ARGV', sys.argv[1:])\n"
    test = """
        import pytest
        from pytest_tarl import Sensor

        @pytest.mark.parametrize("more", [{}, {"argv": ["right"]}, {"launch": False}])
        @pytest.mark.tarl(nodes=["node.py"], sensors=[Sensor("x", low=0, high=1, bins=2)])
        def test_it(tarl, more):
            tarl.start("node.py", **more)
        """
    text = LAUNCH2.replace('name="drive",', f'name="drive", {arguments}')
    write(launches, {"launch/one.launch.py": text, "node.py": node, "test_it.py": test})
    node_workspaces.forget()
    found = given(launches / "node.py")
    assert (found.argv, found.private["kp"]) == (("--arm", "left"), 2.5)
    assert found.note == "parameters and arguments of drive come from one.launch.py (ros2.yaml)."
    quiet = ("-p", "no:randomly", "-p", "no:asyncio", "-p", "no:rerunfailures")
    result = pytester.runpytest("-q", "-s", *quiet, str(launches / "test_it.py"))
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["*ARGV [['--arm', 'left']*", "*ARGV [['right']*", "*ARGV [[]]*"])


@pytest.mark.parametrize("layout", ["src", "."])
def test_a_python_project_is_importable_as_if_installed(packages: Path, start: Start, layout: str) -> None:
    write(
        packages,
        {
            "driver/pyproject.toml": "[project]\nname = 'driver'\n",
            f"driver/{layout}/drv/__init__.py": "from drv.drv import SPEED",
            f"driver/{layout}/drv/drv.py": "SPEED = 3.5",
            "old/drv.py": "raise SystemExit",
        },
    )
    node_workspaces.forget()
    ros = start("""
        import rospy
        import drv
        rospy.init_node("n")
        found = drv.SPEED
    """)
    assert ros.namespace["found"] == 3.5
    assert ros.notes == ()


def test_every_cache_of_workspace_facts_is_emptied(packages: Path, start: Start) -> None:
    start(
        "import rospy\nfrom arm_base.cfg import ArmConfig\nfrom arm_base.msg import Reading\nimport smoothing\n"
    )
    given(packages / "node.py")
    package_folders()
    caches = [
        (module, name, value)
        for module in (node_workspaces, launched, siblings, uninstalled)
        for name, value in vars(module).items()
        if hasattr(value, "cache_info") and value.__module__ == module.__name__
    ]
    filled = [name for _, name, value in caches if value.cache_info().currsize]
    assert {"workspaces", "packages", "given", "_of_package", "_modules"} <= set(filled)
    node_workspaces.forget()
    assert [name for _, name, value in caches if value.cache_info().currsize] == []


def test_rospack_lists_the_dependencies_of_a_package(packages: Path) -> None:
    assert RosPack().get_depends("arm_base") == ["catkin"]
    with pytest.raises(ResourceNotFound):
        RosPack().get_depends("leg_base")
