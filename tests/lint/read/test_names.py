"""Names of modules and packages, and the modules that imports mean."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from tarl_lint.read.declared_entry_points import Declarations
from tarl_lint.read.layout import Layout
from tarl_lint.read.module_names import Index


def written(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def test_module_is_named_from_its_outermost_package(tmp_path):
    written(
        tmp_path, dict.fromkeys(("a/__init__.py", "a/b/__init__.py", "a/b/c.py", "a/loose/d.py", "tool"), "")
    )
    layout = Layout()
    names = {
        name: layout.module(f"{tmp_path}/{name}") for name in ("a/__init__.py", "a/b/__init__.py", "a/b/c.py")
    }
    assert names == {
        "a/__init__.py": ("a", True),
        "a/b/__init__.py": ("a.b", True),
        "a/b/c.py": ("a.b.c", False),
    }
    assert layout.module(f"{tmp_path}/a/loose/d.py") == ("d", False)
    assert layout.module(f"{tmp_path}/tool") == ("tool", False)
    assert layout.module(f"{tmp_path}/a/loose/__init__.py") == ("__init__", False), (
        "no package without that file"
    )


@pytest.mark.parametrize(
    ("folders", "name"),
    [
        ("{'': 'src'}", "inner.m"),
        ("{'robot': 'src'}", "robot.inner.m"),
        ("{'robot.parts': 'src/inner'}", "robot.parts.m"),
        ("{'robot': '.'}", "inner.m"),
    ],
)
def test_declared_folders_of_packages_are_import_roots(tmp_path, folders, name):
    written(
        tmp_path,
        {
            "setup.py": f"from setuptools import setup\nsetup(package_dir={folders})\n",
            "src/inner/__init__.py": "",
            "src/inner/m.py": "",
        },
    )
    assert Layout().module(f"{tmp_path}/src/inner/m.py") == (name, False)


def test_file_belongs_to_the_package_of_the_nearest_manifest(tmp_path):
    manifest = "<package><name>{}</name></package>"
    written(
        tmp_path,
        {
            "o/package.xml": manifest.format("outer"),
            "o/i/package.xml": manifest.format("inner"),
            "o/i/s/a.py": "",
        },
    )
    layout = Layout()
    assert layout.ros_package(f"{tmp_path}/o/i/s/a.py") == "inner"
    assert layout.ros_package(f"{tmp_path}/o/b.py") == "outer"
    assert layout.ros_package(f"{tmp_path}/c.py") == ""


@dataclass
class File:
    path: str
    name: str
    is_package: bool = False
    text: str = ""
    started: tuple[str, ...] = ()


def found(name: str, importer: File, *files: File) -> str:
    module = Index(files).find(name, importer)
    return "" if module is None else module.path


def test_the_nearest_of_several_modules_is_imported():
    files = File("a/x/util.py", "util"), File("a/y/util.py", "util"), File("b/util.py", "util")
    assert found("util", File("a/x/node.py", "node"), *files) == "a/x/util.py"
    assert found("util", File("a/y/deep/node.py", "node"), *files) == "a/y/util.py"
    assert found("util", File("b/node.py", "node"), *files) == "b/util.py"
    assert found("util", File("c/node.py", "node"), *files) == "b/util.py", (
        "the last by path if none is nearer"
    )
    assert found("other", File("b/node.py", "node"), *files) == ""


def test_script_of_a_package_may_import_files_beside_it():
    files = File("p/util.py", "p.util"), File("p/q/tool.py", "p.q.tool"), File("p/time.py", "p.time")
    assert found("util", File("p/node.py", "p.node"), *files) == "p/util.py"
    assert found("util", File("p/__init__.py", "p", is_package=True), *files) == "p/util.py"
    assert found("tool", File("p/node.py", "p.node"), *files) == ""
    assert found("q.tool", File("p/node.py", "p.node"), *files) == "p/q/tool.py"
    assert found("util", File("node.py", "node"), *files) == ""
    assert found("time", File("p/node.py", "p.node"), *files) == "", "the standard library has this name"


def test_packages_of_ros_are_never_analysed_from_source_files():
    files = File("rospy/__init__.py", "rospy", is_package=True), File("rclpy/node.py", "rclpy.node")
    assert found("rospy", File("a.py", "a"), *files) == ""
    assert found("rclpy.node", File("a.py", "a"), *files) == ""
    assert list(Index(files).names) == ["rospy", "rclpy.node"]


def declared(folder: Path, path: str, module: str) -> tuple[str, ...]:
    return Declarations().of(f"{folder}/{path}", module)


def test_only_the_entry_points_of_the_nearest_package_count(tmp_path):
    written(
        tmp_path,
        {
            "package.xml": "<package/>",
            "setup.py": "entry_points = {'console_scripts': ['a = arm.node:main', 'b = arm.node:other']}",
            "inner/pyproject.toml": "[project.scripts]\nc = 'arm.node:third'\n",
            "inner/arm/node.py": "",
        },
    )
    assert declared(tmp_path, "arm/node.py", "arm.node") == ("main", "other")
    assert declared(tmp_path, "arm/node.py", "arm.tool") == ()
    assert declared(tmp_path, "inner/arm/node.py", "arm.node") == ("third",)
    assert declared(tmp_path.parent, "node.py", "arm.node") == ()


@pytest.mark.parametrize(
    ("files", "names"),
    [
        ({"setup.py": "x = 'arm.node:main'"}, ()),
        ({"setup.cfg": "[options]\nscripts = arm.node:main"}, ("main",)),
        ({"plugin.xml": "<class type='arm.node.Plugin'/>"}, ("Plugin",)),
        ({"plugin.xml": "<other type='arm.node.Plugin'/>"}, ()),
        ({"other.xml": "<class type='arm.node.Plugin'/>"}, ()),
        ({"package.xml": "<rqt_gui plugin='${prefix}/other.xml'/>", "other.xml": "<class a='arm.node.P'/>"}, ("P",)),
        ({"CMakeLists.txt": "install(FILES deep/other.xml)", "deep/other.xml": "<plugin a='arm.node.Q'/>"}, ("Q",)),
        ({"resource/plugins.xml": "<class a='arm.node.R'/>", "deep/plugins.xml": "<class a='arm.node.S'/>"}, ("R",)),
        ({"urdf/arm.urdf": "<plugin>arm.node.T</plugin>", "arm.xacro": "<plugin>arm.node.U</plugin>"}, ("T", "U")),
        ({"plugin.xml": "<class type='my/arm.node.V' a='arm.node.W/x'/>"}, ()),
        ({"plugin.xml": f"<class type='arm.node.X'/>{' ' * 500_000}"}, ()),
    ],
)  # fmt: skip
def test_functions_named_in_package_descriptions_are_entry_points(tmp_path, files, names):
    written(tmp_path, {"package.xml": "<package/>", **files})
    assert declared(tmp_path, "arm/node.py", "arm.node") == names
