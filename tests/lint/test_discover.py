import os
from pathlib import Path

import pytest

from tarl_lint.errors import UsageError
from tarl_lint.read.discover import find
from tarl_lint.settings.config import Config


def paths(*where: str, config: Config = Config()) -> list[str]:  # noqa: B008 - frozen
    return [file.shown for file in find([Path(w) for w in where or (".",)], config).files]


def names(*where: str) -> dict[str, str]:
    return {file.shown: file.name for file in find([Path(w) for w in where or (".",)], Config()).files}


def test_python_files_and_python_scripts_without_extension_are_found(in_directory):
    in_directory(
        {
            "a.py": "",
            "scripts/talker": "#!/usr/bin/env python3\n",
            "scripts/run": "#!/bin/sh\n",
            "scripts/notes": "python",
            "README.md": "#!/usr/bin/env python3\n",
        }
    )
    assert paths() == ["a.py", "scripts/talker"]


def test_generated_and_installed_files_are_skipped(in_directory):
    in_directory(
        {
            "src/a.py": "",
            "build/lib/a.py": "",
            "install/a/lib/a.py": "",
            "log/latest/a.py": "",
            "devel/.catkin": "",
            "devel/lib/a.py": "",
            ".venv/b.py": "",
            "env/pyvenv.cfg": "",
            "env/lib/b.py": "",
            "src/__pycache__/c.py": "",
            "src/frozen/COLCON_IGNORE": "",
            "src/frozen/d.py": "",
        }
    )
    assert paths() == ["src/a.py"]


def test_a_package_named_like_a_colcon_directory_is_analysed(in_directory):
    in_directory({"robot/__init__.py": "", "robot/log/__init__.py": "", "robot/log/writer.py": ""})
    assert "robot/log/writer.py" in paths()


def test_ignored_files_are_linted_only_if_named(in_directory):
    root = in_directory(
        {".gitignore": "made/\n*_pb2.py\n", "made/a.py": "", "b_pb2.py": "", "c.py": "", "vendor/d.py": "",
         "sub/.gitignore": "!b_pb2.py\n", "sub/b_pb2.py": ""}
    )  # fmt: skip
    config = Config(root=root, exclude=("/vendor",))
    assert paths(config=config) == ["c.py", "sub/b_pb2.py"]
    assert paths("made", "vendor/d.py", config=config) == ["made/a.py", "vendor/d.py"]


def test_ignore_files_apply_up_to_the_repository_root(in_directory):
    root = in_directory(
        {".gitignore": "*.py\n", "repo/.gitignore": "a.py\n", "repo/src/a.py": "", "repo/src/b.py": ""}
    )
    (root / "repo/.git").mkdir()
    assert paths("repo/src") == ["repo/src/b.py"]


def test_symbolic_links_are_followed_once(in_directory):
    root = in_directory({"src/a.py": "", "src/deep/b.py": "", "elsewhere/c.py": ""})
    (root / "src/link.py").symlink_to("a.py")
    (root / "src/deep/loop").symlink_to(root / "src")
    (root / "src/other").symlink_to(root / "elsewhere")
    (root / "src/broken.py").symlink_to("missing.py")
    discovery = find([Path("src")], Config())
    assert [f.shown for f in discovery.files] == ["src/a.py", "src/deep/b.py", "src/other/c.py"]
    assert discovery.notes.duplicate_links == 2


def test_a_file_named_twice_is_analysed_once(in_directory):
    in_directory({"src/a.py": ""})
    assert paths("src", "src/a.py", "./src/../src") == ["src/a.py"]


def test_files_outside_the_working_directory_have_absolute_paths(in_directory, monkeypatch):
    root = in_directory({"a/x.py": "", "b/y.py": ""})
    monkeypatch.chdir(root / "a")
    assert paths(".", "../b") == [(root / "b/y.py").as_posix(), "x.py"]


def test_a_missing_path_is_refused_with_a_suggestion(in_directory):
    in_directory({"source/a.py": ""})
    with pytest.raises(UsageError, match=r"sorce: no such file or directory: did you mean source\?"):
        find([Path("sorce")], Config())
    with pytest.raises(UsageError, match="no such file or directory, and no directory nowhere either"):
        find([Path("nowhere/a.py")], Config())


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_a_directory_that_cannot_be_read_is_noted(in_directory):
    root = in_directory({"a.py": "", "secret/b.py": ""})
    (root / "secret").chmod(0)
    discovery = find([Path()], Config())
    (root / "secret").chmod(0o755)
    assert discovery.notes.unreadable == ("secret",)


def test_skipped_files_are_counted(in_directory):
    in_directory(
        {
            "src/driver.cpp": "int main() { ros::init(argc, argv, \"driver\"); }",
            "src/filter.cc": "class Filter : public rclcpp::Node {};",
            "src/maths.cpp": "double square(double x) { return x * x; }",
            "launch/robot.launch": '<node><remap from="a" to="b"/></node>',
            "launch/plain.launch": "<node/>",
            "launch/two.launch.py": "Node(remappings=[('a', 'b')])",
        }
    )  # fmt: skip
    discovery = find([Path()], Config())
    assert (discovery.notes.cpp_nodes, discovery.notes.remapping_launch_files) == (2, 2)
    assert [f.shown for f in discovery.files] == ["launch/two.launch.py"]


def test_modules_are_named_from_the_nearest_import_root(in_directory):
    in_directory(
        {
            "pkg/pkg/__init__.py": "",
            "pkg/pkg/node.py": "",
            "pkg/pkg/sub/__init__.py": "",
            "pkg/pkg/sub/tool.py": "",
            "catkin/src/robot/__init__.py": "",
            "catkin/src/robot/arm.py": "",
            "catkin/scripts/talker.py": "",
            "catkin/nodes/listen-er": "#!/usr/bin/python3\n",
        }
    )
    assert names() == {
        "pkg/pkg/__init__.py": "pkg",
        "pkg/pkg/node.py": "pkg.node",
        "pkg/pkg/sub/__init__.py": "pkg.sub",
        "pkg/pkg/sub/tool.py": "pkg.sub.tool",
        "catkin/src/robot/__init__.py": "robot",
        "catkin/src/robot/arm.py": "robot.arm",
        "catkin/scripts/talker.py": "talker",
        "catkin/nodes/listen-er": "listen-er",
    }


def test_only_an_init_file_is_a_package(in_directory):
    in_directory({"pkg/__init__.py": "", "pkg/a.py": ""})
    packages = [f.shown for f in find([Path()], Config()).files if f.is_package]
    assert packages == ["pkg/__init__.py"]


def test_package_dir_of_setup_files_is_respected(in_directory):
    in_directory(
        {
            "one/setup.py": "from setuptools import setup\nsetup(package_dir={'': 'src'})\n",
            "one/src/__init__.py": "",
            "one/src/robot/__init__.py": "",
            "one/src/robot/arm.py": "",
            "two/setup.py": "from catkin_pkg.python_setup import generate_distutils_setup\n"
            "from setuptools import setup\nd = generate_distutils_setup(package_dir={'eye': 'python'})\nsetup(**d)\n",
            "two/python/__init__.py": "",
            "two/python/lens.py": "",
            "three/setup.cfg": "[options]\npackage_dir =\n    ear = lib\n",
            "three/lib/__init__.py": "",
            "three/lib/drum.py": "",
        }
    )
    found = names("one/src/robot/arm.py", "two/python", "three/lib/drum.py")
    assert found == {
        "one/src/robot/arm.py": "robot.arm",
        "two/python/__init__.py": "eye",
        "two/python/lens.py": "eye.lens",
        "three/lib/drum.py": "ear.drum",
    }


@pytest.mark.parametrize(
    "text", ["setup(package_dir=", "setup(package_dir=where())", "setup(package_dir={**x})"]
)
def test_an_unreadable_setup_file_is_ignored(in_directory, text):
    in_directory({"setup.py": text, "pkg/__init__.py": "", "pkg/a.py": ""})
    assert names("pkg/a.py") == {"pkg/a.py": "pkg.a"}
