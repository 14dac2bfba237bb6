"""Find the node scripts in checked-out repositories, and which of them are counted separately.

Nothing is executed.
"""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

GPU = frozenset({"chainer", "chainercv", "cupy", "fairseq", "fcn", "keras", "openravepy", "tensorflow", "torch",
                 "torchvision", "pycuda", "chainer_mask_rcnn", "baselines", "hmr", "caffe"})  # fmt: skip
HARDWARE = frozenset({"RPi", "alsaaudio", "baxter_interface", "naoqi", "openhrivoice", "pyaudio", "pyrealsense2",
                      "serial", "smbus", "spidev", "bluetooth", "usb", "intera_interface", "qi", "evdev", "pygame",
                      "rangelibc", "range_libc", "speech_recognition", "pyudev", "xarm", "fetch_api", "naoqi_driver",
                      "pr2_ik", "hironx_client", "rtm", "OpenHRP", "hrpsys"})  # fmt: skip
TESTING = frozenset({"unittest", "rostest", "pytest", "rosunit", "launch_testing", "nose"})
DISPLAY = frozenset({"PyQt5", "PySide", "PySide2", "python_qt_binding", "Tkinter", "tkinter", "wx"})
DISTRIBUTED = frozenset(  # packages in `ros-noetic-desktop-full`, `ros-humble-desktop` and MoveIt
    {"actionlib", "control_msgs", "cv_bridge", "diagnostic_updater", "dynamic_reconfigure", "genpy", "image_geometry",
     "interactive_markers", "laser_assembler", "laser_geometry", "message_filters", "moveit_commander", "moveit_msgs",
     "pcl_msgs", "rclpy", "rosbag", "rosgraph", "roslib", "rosmsg", "rosnode", "rosparam", "rospy", "rosservice",
     "rostopic", "sensor_msgs_py", "smach", "smach_ros", "tf", "tf2_ros", "tf_conversions", "topic_tools",
     "urdf_parser_py", "xacro", "rcl_interfaces", "std_srvs", "nav2_msgs", "map_msgs", "octomap_msgs"}
)  # fmt: skip
MADE_BY = re.compile(r"\brospy\.init_node\s*\(|\brclpy\.(create_node|spin)\b|\(\s*(rclpy\.node\.)?Node\s*\)")
ENTRY = re.compile(r"['\"]\s*[\w.-]+\s*=\s*([\w.]+)\s*:\s*(\w+)\s*['\"]")
INSTALLED = re.compile(r"^[ \t]*[\w.-]+\s*=\s*([\w.]+)\s*:\s*(\w+)", re.MULTILINE)
SKIPPED = frozenset({"launch", "test", "tests", "build", "install", "devel", "tarl_tests"})


@dataclass(frozen=True)
class Script:
    """A node script: its file, the function of its entry point, and why it is counted separately, if it is."""

    repository: Path
    path: Path
    entry: str | None = None
    apart: str = ""

    @property
    def name(self) -> str:
        """Return the path relative to the folder of repositories."""
        return f"{self.repository.name}/{self.path.relative_to(self.repository)}"

    @property
    def package(self) -> Path:
        """Return the folder of the script's ROS package or, without one, the folder around its Python package.

        A test must be outside the script's Python package: pytest imports the `__init__.py` of the folders above a test
        before the in-process ROS is installed.
        """
        inside = [one for one in self.path.parents if one.is_relative_to(self.repository)]
        packages = [place for place, one in enumerate(inside) if (one / "__init__.py").is_file()]
        outer = next(iter(inside[packages[-1] + 1 :] if packages else inside), self.repository)
        return next((one for one in inside if (one / "package.xml").is_file()), outer)


def scripts(repository: Path) -> list[Script]:
    """Return the node scripts of a repository, sorted by path."""
    entries = dict(entry_points(repository))
    found = (script(repository, path, entries.get(path)) for path in sorted(files(repository)))
    return [one for one in found if one is not None]


def files(repository: Path) -> Iterator[Path]:
    """Yield the Python files outside the folders for launch files and tests."""
    for path in repository.rglob("*"):
        parts = path.relative_to(repository).parts
        if not path.is_file() or path.is_symlink() or not SKIPPED.isdisjoint(parts[:-1]) or ".git" in parts:
            continue
        if path.suffix == ".py" or ("." not in path.name and _first_line(path).startswith(b"#!")):
            yield path


def _first_line(path: Path) -> bytes:
    with path.open("rb") as file:
        first = file.readline(120)
    return first if b"python" in first else b""


def entry_points(repository: Path) -> Iterator[tuple[Path, str]]:
    """Yield file and function of each console script in `setup.py`, `setup.cfg` and an unpacked wheel."""
    for setup in [*repository.rglob("setup.py"), *repository.rglob("setup.cfg")]:
        for module, function in ENTRY.findall(setup.read_text("utf-8", errors="replace")):
            yield setup.parent.joinpath(*module.split(".")).with_suffix(".py"), function
    for listed in repository.rglob("*.dist-info/entry_points.txt"):
        console = listed.read_text("utf-8").partition("[console_scripts]")[2].partition("\n[")[0]
        for module, function in INSTALLED.findall(console):
            yield listed.parent.parent.joinpath(*module.split(".")).with_suffix(".py"), function


def script(repository: Path, path: Path, entry: str | None) -> Script | None:
    """Return the file as a node script, or None if it is not one."""
    text = path.read_text("utf-8", errors="replace")
    if path.name == "setup.py" or path.name.endswith(".launch.py"):
        return None
    if not MADE_BY.search(text) and (entry is None or not makes_node(path, set())):
        return None
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError) as error:
        return Script(repository, path, apart=f"Python 2 only ({error})")
    if entry is None and not MADE_BY.search(without_texts(tree)):
        return Script(repository, path, apart="mentions a node only in a string")
    if needs_arguments(tree):
        return Script(repository, path, apart="a command line tool that needs arguments")
    imported = set(imports(tree))
    if not TESTING.isdisjoint(imported):
        return Script(repository, path, apart="a test, not a node")
    runs = any(map(starts_something, tree.body))
    if entry is None and not runs:
        return Script(repository, path, apart="a module that starts nothing when it is run")
    for kind, names in (("GPU library", GPU), ("hardware SDK", HARDWARE), ("display", DISPLAY)):
        needed = sorted(names & imported)
        if needed:
            return Script(repository, path, apart=f"needs a {kind}: {needed[0]}")
    return Script(repository, path, None if runs else entry)


def without_texts(tree: ast.AST) -> str:
    """Return a file's code without string literals and comments."""
    return ast.unparse(_Blank().visit(copy.deepcopy(tree)))


class _Blank(ast.NodeTransformer):
    """Replace each string by an empty one."""

    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        return ast.Constant("") if isinstance(node.value, str) else node

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.Constant:  # noqa: ARG002
        return ast.Constant("")


def needs_arguments(tree: ast.AST) -> bool:
    """Return whether a file defines a command line with required arguments, using `argparse`."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not ast.unparse(node.func).endswith(".add_argument"):
            continue
        options = {one.arg: ast.unparse(one.value) for one in node.keywords}
        names = [one.value for one in node.args if isinstance(one, ast.Constant)]
        positional = bool(names) and not str(names[0]).startswith("-")
        if options.get("required") == "True" or (
            positional and options.get("nargs") not in ("'?'", "'*'", "argparse.REMAINDER")
        ):
            return True
    return False


def makes_node(path: Path, seen: set[Path]) -> bool:
    """Return whether a module makes a node, itself or through modules that it imports from its package."""
    if path in seen or not path.is_file():
        return False
    seen.add(path)
    text = path.read_text("utf-8", errors="replace")
    if MADE_BY.search(text):
        return True
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return False
    return any(makes_node(one, seen) for one in _siblings(tree, path))


def _siblings(tree: ast.AST, path: Path) -> Iterator[Path]:
    """Yield the files of the modules that a file imports from its own package."""
    inside = [one for one in path.parents if (one / "__init__.py").is_file()]
    root = inside[-1].parent if inside else path.parent
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            bases = [root.joinpath(*alias.name.split(".")) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = path.parents[node.level - 1] if node.level else root
            module = start.joinpath(*(node.module or "").split("."))
            bases = [module, *(module / alias.name for alias in node.names)]
        else:
            continue
        for base in bases:
            yield base.with_suffix(".py")
            yield base / "__init__.py"


def imports(tree: ast.AST) -> Iterator[str]:
    """Yield the packages that a file imports."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield (node.module or "").partition(".")[0]


def starts_something(statement: ast.stmt) -> bool:
    """Return whether a top-level statement may start a node: the `__main__` guard, or a call."""
    if isinstance(statement, ast.If):
        return re.search(r"__name_", ast.unparse(statement.test)) is not None
    text = "" if isinstance(statement, ast.FunctionDef | ast.ClassDef) else ast.unparse(statement)
    return bool(MADE_BY.search(text)) or text in ("main()", "sys.exit(main())")
