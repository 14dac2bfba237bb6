"""The types that C++ programs of the workspace may use, by the names in their files."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.system.cpp_types import used_types
from tarl_lint.workspace.read import read

NODE = """
#include <vector>
#include <ros/ros.h>
#include "node.h"
#include <std_msgs/Float64.h>
{}
int main() {{ pub = n.advertise<std_msgs::Float64>(name, 1); }}
"""


def types(root: Path, *lines: str, **files: str) -> frozenset[str] | None:
    """Return the types of a package `arm`, whose program contains lines; `files` are those of a package `base`."""
    contents = {
        "arm/src/node.cpp": NODE.format("\n".join(lines)),
        "arm/include/arm/limits.h": "using geometry_msgs::Wrench;",
    }
    contents |= {f"base/{name}.h": text for name, text in files.items()}
    for name, text in contents.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    for package in ("arm", "base"):
        (root / package).mkdir(exist_ok=True)
        (root / package / "package.xml").write_text(f"<package><name>{package}</name></package>")
    workspace = read(root)
    package = workspace.package("arm")
    assert package is not None
    return used_types(package, workspace)


@pytest.mark.parametrize(
    ("line", "more"),
    [
        ("", set()),
        ("#include <arm/limits.h>", set()),
        ("#include <pluginlib/class_list_macros.h>", set()),
        ("#include <geometry_msgs/msg/twist.hpp>\nusing geometry_msgs::msg::Twist;", {"Twist"}),
        ("#include <demo/srv/add.hpp>\ndemo::srv::Add a;", {"Add"}),
        ("#include <image_transport/image_transport.h>", {"Image", "CameraInfo"}),
        ("actionlib::SimpleActionServer<demo_msgs::GoAction> s;", {"GoAction", "GoActionGoal"}),
        ("#include <base/base.h>", {"Odometry"}),
        ("#include \"base/base.h\"", {"Odometry"}),
    ],
)  # fmt: skip
def test_a_program_uses_only_types_that_its_files_name(tmp_path, line, more):
    found = types(tmp_path, line, base="#include <tf/tf.h>\nnav_msgs::Odometry odom;")
    assert found is not None
    assert {"Float64", "Wrench"} | more <= found
    assert ("Odometry" in found) == ("Odometry" in more)
    assert "Imu" not in found


@pytest.mark.parametrize(
    "line",
    [
        "#include <costmap_2d/costmap_2d_ros.h>",
        "#include <pluginlib/class_loader.h>",
        "#include <base/base.h>",
    ],
)
def test_types_are_unknown_if_a_library_may_use_topics(tmp_path, line):
    assert types(tmp_path, line, base="#include <gazebo/gazebo.hh>") is None


def test_the_types_are_unknown_without_files(tmp_path):
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm/package.xml").write_text("<package><name>arm</name></package>")
    workspace = read(tmp_path)
    assert used_types(workspace.packages[0], workspace) is None
