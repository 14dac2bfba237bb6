"""Find the types that a C++ package may use, without analysing it.

A program can only use types that occur in its sources, or in the libraries of its workspace. Therefore all types
are among the names in the C++ files of the package, and of the packages whose headers it includes. For libraries
from elsewhere, it must be known that they use no topics on their own.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.model import Package, Workspace

LARGEST: Final = 1_000_000  # maximum size of a file (bytes)
MOST: Final = 400  # maximum number of files of a package; larger packages count as unknown
_SUFFIXES: Final = (".cpp", ".cc", ".cxx", ".c++", ".c", ".h", ".hpp", ".hh", ".hxx", ".ipp")
_INCLUDE: Final = re.compile(r"^[ \t]*#[ \t]*include[ \t]*[<\"]([^>\"\n]+)[>\"]", re.MULTILINE)
_NAME: Final = re.compile(r"\b[A-Z]\w*")
# beginnings of headers of libraries that use no topics on their own
_QUIET: Final = frozenset(
    ["ros", "rclcpp", "rclcpp_action", "rclcpp_components", "rclcpp_lifecycle", "rcutils", "rcl", "rmw",
     "rosidl_runtime_cpp", "ament_index_cpp", "roscpp", "rosconsole", "roslib", "rosbag", "rosbag2_cpp",
     "message_filters", "nodelet", "tf", "tf2", "tf2_ros", "tf2_eigen", "tf2_kdl", "tf2_geometry_msgs",
     "tf2_sensor_msgs", "tf_conversions", "eigen_conversions", "angles", "actionlib", "dynamic_reconfigure",
     "diagnostic_updater", "cv_bridge", "image_geometry", "laser_geometry", "pcl_conversions", "pcl", "urdf", "kdl",
     "kdl_parser", "kdl_conversions", "opencv", "opencv2", "eigen3", "Eigen", "boost", "yaml-cpp", "nlohmann",
     "jsoncpp", "json", "tinyxml2", "fmt", "spdlog", "glog", "gflags", "gtest", "gmock", "sys", "linux", "arpa",
     "netinet", "net", "bits", "experimental", "ext", "asio", "serial", "libusb-1.0", "GL", "X11"]
)  # fmt: skip
_MESSAGES: Final = re.compile(r"\w+_(?:msgs|srvs|interfaces|actions?|msg|srv)$")
_GENERATED: Final = ("msg", "srv", "action")
# headers that only register a library's classes with a loader
_EXPORTS: Final = (
    "pluginlib/class_list_macros",
    "class_loader/register_macro",
    "class_loader/class_loader_register",
)
_IMAGES: Final = frozenset(
    ["Image", "CompressedImage", "CameraInfo", "Theora", "Packet"]
)  # headers of image_transport


# (package folder, workspace packages) → types; many nodes share a package
_FOUND: dict[tuple[Path, int], frozenset[str] | None] = {}


def used_types(package: Package, workspace: Workspace) -> frozenset[str] | None:
    """Return a superset of the types that a package's C++ programs use, or None."""
    key = package.folder, len(workspace.packages)
    if key not in _FOUND:
        _FOUND[key] = _used(package, workspace)
    return _FOUND[key]


def _used(package: Package, workspace: Workspace) -> frozenset[str] | None:
    found: set[str] = set()
    pending, seen = [package], {package.name}
    while pending:
        one = pending.pop()
        names = _names(one.folder)
        if names is None or (one is package and not names[0]):
            return None
        found |= names[0]
        for first in sorted(names[1]):
            other = workspace.package(first)
            if first == "image_transport":
                found |= _IMAGES
            elif other is not None:
                pending += [other] if other.name not in seen else []
                seen.add(other.name)
            elif first not in _QUIET and not _MESSAGES.match(first):
                return None
    return frozenset(found)


@cache
def _names(folder: Path) -> tuple[frozenset[str], frozenset[str]] | None:
    """Return names and included packages of C++ files; None if they are too many or unreadable."""
    names: set[str] = set()
    packages: set[str] = set()
    files = sorted(path for path in folder.rglob("*") if path.suffix in _SUFFIXES and path.is_file())
    if len(files) > MOST:
        return None
    for path in files:
        try:
            text = read_text(path, LARGEST)
        except UnreadableError:
            return None
        names |= set(_NAME.findall(text))
        for header in _INCLUDE.findall(text):
            first, slash, rest = header.partition("/")
            # headers without a folder belong to the system or to this package
            if header.startswith(_EXPORTS):
                continue
            if slash and first not in ("..", ".") and not (folder / first).is_dir():
                generated = rest.partition("/")[0] in _GENERATED and rest.endswith(".hpp")
                packages |= set() if generated or (folder / "include" / header).is_file() else {first}
    names |= {
        f"{one}{part}" for one in names if one.endswith("Action") for part in ("Goal", "Result", "Feedback")
    }
    return frozenset(names), frozenset(packages)
