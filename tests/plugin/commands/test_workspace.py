"""`tarl workspace`: the table of packages, the JSON output, and unreadable files."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from pytest_tarl.commands.cli import main


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    base = tmp_path / "arm_base"
    (base / "launch").mkdir(parents=True)
    (base / "package.xml").write_text("<package><name>arm_base</name><depend>catkin</depend></package>")
    (base / "launch/arm.launch").write_text("<launch/>")
    names = " ".join(f"scripts/a_long_name_{number}.py" for number in range(6))
    (base / "CMakeLists.txt").write_text(f"catkin_install_python(PROGRAMS {names} DESTINATION bin)")
    (base / "scripts").mkdir()
    for number in range(5):
        (base / f"scripts/a_long_name_{number}.py").write_text("")
    return tmp_path


def test_the_table_lists_packages_nodes_launch_files_and_problems(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["workspace", str(folder)]) == 0
    heading, row, *rest = capsys.readouterr().out.splitlines()
    assert heading.split("  ")[0] == "package"
    assert [cell.strip() for cell in row.split("  ") if cell.strip()] == [
        "arm_base", "catkin", "a_long_name_0.py, a_long_name_1.py and 4 more", "arm.launch", "1",
    ]  # fmt: skip
    assert heading.index("launch files") == row.index("arm.launch")
    assert rest == [
        "",
        "Not read:",
        (
            "  arm_base/CMakeLists.txt: a_long_name_5.py is installed, "
            "but its file scripts/a_long_name_5.py does not exist"
        ),
    ]


def test_json_contains_the_whole_workspace(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["workspace", "--format", "json", str(folder)]) == 0
    found = json.loads(capsys.readouterr().out)
    (package,) = found["packages"]
    assert (found["version"], found["root"], package["folder"]) == (1, str(folder), "arm_base")
    assert package["nodes"][0] == {
        "name": "a_long_name_0.py",
        "file": "arm_base/scripts/a_long_name_0.py",
        "entry": None,
    }
    assert package["nodes"][5]["file"] is None
    assert package["launch_files"] == ["arm_base/launch/arm.launch"]
    assert package["problems"][0]["line"] == 0


@pytest.mark.parametrize(("name", "said"), [("empty", "there is no package.xml"), ("none", "no such folder")])
def test_user_mistakes_are_reported_in_one_sentence(
    name: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty").mkdir()
    assert main(["workspace", str(tmp_path / name)]) == 2
    assert said in capsys.readouterr().err


def test_hidden_packages_are_named_with_the_cause(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = folder / "old"
    old.mkdir()
    (old / "package.xml").write_text("<package><name>arm_old</name></package>")
    (old / "COLCON_IGNORE").write_text("")
    assert main(["workspace", str(folder)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "  old/COLCON_IGNORE: hides the package arm_old"
    assert main(["workspace", "--format", "json", str(folder)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [one["name"] for one in found["packages"]] == ["arm_base"]
    assert found["hidden"] == [{"name": "arm_old", "marker": "old/COLCON_IGNORE"}]


CMAKE = """
project(arm_base)
add_executable(servo src/servo.cpp)
add_executable(servo_test src/test.cpp)
set_target_properties(servo PROPERTIES OUTPUT_NAME arm_servo)
rclcpp_components_register_node(arm PLUGIN "arm_base::Grip" EXECUTABLE grip)
if(BUILD_TESTING)
  add_executable(check test/check.cpp)
endif()
add_executable(${UNKNOWN} src/other.cpp)
add_executable(imported IMPORTED)
"""
LAUNCH = """
<launch>
  <node pkg="arm_base" type="arm_servo" name="servo"/>
  <node pkg="arm_base" type="check" name="check"/>
  <node pkg="arm_base" type="gone" name="gone"/>
  <node pkg="joy" type="joy_node" name="joy"/>
  <node pkg="joy" type="joy_node" name="$(env NAME)"/>
  <include file="$(find usb_cam)/launch/cam.launch"/>
  <include file="$(arg more)"/>
</launch>
"""


def test_nodes_that_are_not_python_have_their_place(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "arm_base/CMakeLists.txt").write_text(CMAKE)
    (folder / "arm_base/launch/arm.launch").write_text(LAUNCH)
    assert main(["workspace", str(folder)]) == 0
    heading, row, *rest = capsys.readouterr().out.splitlines()
    assert row[heading.index("C++ nodes") :].startswith(
        "arm_servo, grip, servo_test, arm_base::Grip  arm.launch"
    )
    assert rest == [
        "",
        "C++ nodes: 4 (known by interface only)",
        "Started from packages outside the workspace: joy/joy_node",
        "Included launch files of packages outside the workspace: usb_cam",
        "Known on the robot only: 1 value in launch files (tarl-lint --launch FILE lists them)",
        "",
        "Not read:",
        "  arm_base/CMakeLists.txt:10: add_executable: the value of ${UNKNOWN} is not known",
        "  arm_base/launch/arm.launch:5: the node gone: arm_base has no program gone",
        "  arm_base/launch/arm.launch:9: <include>: the argument more has no value",
    ]
    assert main(["workspace", "--format", "json", str(folder)]) == 0
    found = json.loads(capsys.readouterr().out)
    (package,) = found["packages"]
    assert package["compiled_nodes"] == ["arm_servo", "grip", "servo_test"]
    assert package["components"] == ["arm_base::Grip"]
    assert found["started_from_elsewhere"] == ["joy/joy_node"]
    assert found["included_from_elsewhere"] == ["usb_cam"]
    assert found["known_on_robot_only"] == 1
    assert [one["line"] for one in package["problems"]] == [10, 5, 9]


def test_nodelets_are_read_from_the_files_that_describe_them(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "arm_base/package.xml").write_text(
        '<package><name>arm_base</name><export><nodelet plugin="${prefix}/a.xml"/></export></package>'
    )
    (folder / "arm_base/a.xml").write_text(
        '<class_libraries><library><class name="arm/Grip" type="a::G"/></library>'
        '<library><class type="arm::Lift"/></library></class_libraries>'
    )
    assert main(["workspace", "--format", "json", str(folder)]) == 0
    assert json.loads(capsys.readouterr().out)["packages"][0]["components"] == ["arm/Grip", "arm/Lift"]


def test_packages_of_equal_names_are_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "copy").mkdir()
    (folder / "copy/package.xml").write_text("<package><name>arm_base</name></package>")
    assert main(["workspace", str(folder)]) == 0
    same = "  copy/package.xml: the package arm_base in arm_base has the same name, and is read in its place"
    assert same in capsys.readouterr().out.splitlines()
    assert main(["workspace", "--format", "json", str(folder)]) == 0
    assert json.loads(capsys.readouterr().out)["problems"][0]["file"] == "copy/package.xml"


def test_yaml_files_that_cannot_be_examined_are_reported(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "arm_base/a.yaml").write_text("a: [")
    monkeypatch.setitem(sys.modules, "yaml", None)
    assert main(["workspace", str(folder)]) == 0
    assert (
        capsys.readouterr().out.splitlines()[-1] == "  YAML files were not examined: run pip install PyYAML"
    )


def test_a_file_is_not_a_workspace(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["workspace", str(folder / "arm_base/package.xml")]) == 2
    assert "this is a file" in capsys.readouterr().err
