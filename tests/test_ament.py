"""tarl-lint under `colcon test`, by Debian's ament packages and colcon from PyPI; skipped where they are missing."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.slow import SLOW

ROOT = Path(__file__).parent.parent
SYSTEM = Path("/usr/bin/python3")
THERE = shutil.which("cmake") is not None and all(
    Path("/usr/share", name).is_dir() for name in ("ament_cmake", "ament_cmake_test", "ament_lint_auto")
)
COLCON = ("colcon-common-extensions", "catkin_pkg", "empy==3.3.4", "lark", "setuptools<80")
NODE = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Twice(Node):
    def __init__(self):
        super().__init__("twice")
        self.out = self.create_publisher(Float64, "/out", 10)
        self.create_subscription(Float64, "/in", self.heard, 10)

    def heard(self, message):
        self.out.publish(Float64(data=2 * message.data))
"""
PYTHON_TEST = """
from ament_tarl_lint.main import main


def test_tarl_lint():
    assert main(argv=["robot_py"]) == 0, "tarl-lint found new flows or hazards"
"""
MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name><version>0.0.1</version><description>A robot.</description>
  <maintainer email="robot@example.org">A</maintainer><license>Apache-2.0</license>
  {depends}
  <export><build_type>{build}</build_type></export>
</package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.8)
project(robot_cmake NONE)
find_package(ament_cmake REQUIRED)
if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
  ament_lint_auto_find_test_dependencies()
endif()
ament_package()
"""

pytestmark = [
    pytest.mark.skipif(not THERE, reason="needs cmake and Debian's ament-cmake and ament-lint"),
    pytest.mark.skipif(not SLOW, reason="a minute: set TARL_SLOW=1"),
    pytest.mark.timeout(900),
]


def written(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@pytest.fixture(scope="module")
def colcon(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the programs of an environment of the system's Python that holds colcon and tarl."""
    folder = tmp_path_factory.mktemp("colcon") / "env"
    subprocess.run([SYSTEM, "-m", "venv", "--system-site-packages", folder], check=True)
    pip = [folder / "bin" / "pip", "install", "-q", "--disable-pip-version-check"]
    subprocess.run([*pip, *COLCON], check=True, capture_output=True)
    subprocess.run([*pip, "--no-deps", ROOT], check=True, capture_output=True)
    return folder / "bin"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("workspace")
    for name in ("ament_tarl_lint", "ament_cmake_tarl_lint"):
        shutil.copytree(ROOT / "editors" / "ros" / name, root / "src" / name)
    python = root / "src" / "robot_py"
    depends = "<test_depend>ament_tarl_lint</test_depend>"
    written(python / "package.xml", MANIFEST.format(name="robot_py", build="ament_python", depends=depends))
    written(
        python / "setup.py",
        "from setuptools import setup\n"
        "setup(name='robot_py', version='0.0.1', packages=['robot_py'], tests_require=['pytest'])\n",
    )
    written(python / "robot_py" / "__init__.py", "")
    written(python / "robot_py" / "node.py", NODE)
    written(python / "test" / "test_tarl_lint.py", PYTHON_TEST)
    cmake = root / "src" / "robot_cmake"
    depends = (
        "<buildtool_depend>ament_cmake</buildtool_depend>"
        "<test_depend>ament_lint_auto</test_depend><test_depend>ament_cmake_tarl_lint</test_depend>"
    )
    written(cmake / "package.xml", MANIFEST.format(name="robot_cmake", build="ament_cmake", depends=depends))
    written(cmake / "CMakeLists.txt", CMAKE)
    written(cmake / "scripts" / "node.py", NODE)
    return root


def run(command: str, colcon: Path, workspace: Path) -> subprocess.CompletedProcess[str]:
    clean = {
        key: text
        for key, text in os.environ.items()
        if not key.startswith(("PYTHON", "PYTEST", "COV", "VIRTUAL"))
    }
    clean["PATH"] = f"{colcon}{os.pathsep}/usr/bin{os.pathsep}/bin"
    overlay = workspace / "install" / "setup.bash"
    source = f"source {overlay} && " if overlay.exists() else ""
    return subprocess.run(
        ["bash", "-c", f"{source}{command}"],
        cwd=workspace,
        env=clean,
        capture_output=True,
        text=True,
        check=False,
    )


def results(workspace: Path) -> dict[str, int]:
    """Return the failures and errors in the result files where colcon looks for them."""
    found = {}
    for name, path in (
        ("robot_py", "pytest.xml"),
        ("robot_cmake", "test_results/robot_cmake/tarl_lint.xunit.xml"),
    ):
        suites = ElementTree.parse(workspace / "build" / name / path).getroot().iter("testsuite")
        found[name] = sum(int(one.get("failures", 0)) + int(one.get("errors", 0)) for one in suites)
    return found


def test_packages_are_built_linted_and_pass_with_a_baseline(colcon: Path, workspace: Path) -> None:
    first = "ament_tarl_lint ament_cmake_tarl_lint"
    built = run(f"colcon build --packages-select {first}", colcon, workspace)
    assert built.returncode == 0, built.stdout + built.stderr
    built = run("colcon build --packages-select robot_py robot_cmake", colcon, workspace)
    assert built.returncode == 0, built.stdout + built.stderr
    test = "colcon test --packages-select robot_py robot_cmake --return-code-on-test-failure"
    assert run(test, colcon, workspace).returncode == 1
    assert {name: wrong > 0 for name, wrong in results(workspace).items()} == {
        "robot_py": True,
        "robot_cmake": True,
    }
    for package in ("robot_py", "robot_cmake"):
        accepted = run(f"cd src/{package} && tarl-lint --write-baseline --no-cache", colcon, workspace)
        assert accepted.returncode == 0, accepted.stderr
    passed = run(test, colcon, workspace)
    assert passed.returncode == 0, passed.stdout + passed.stderr
    assert results(workspace) == {"robot_py": 0, "robot_cmake": 0}
