"""`tarl workspace`: the table of packages, the JSON output, and unreadable files."""

from __future__ import annotations

import json
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


def test_hidden_packages_are_named_with_the_file_that_hides_them(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
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
