"""Read any launch file: ROS 1 XML, and ROS 2 Python, XML and YAML."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final
from xml.etree.ElementTree import Element

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.launch_documents import LARGEST, of_xml, of_yaml, xml_root
from tarl_lint.workspace.launch_entities import actions
from tarl_lint.workspace.launch_model import Launch
from tarl_lint.workspace.launch_py import actions_of_python
from tarl_lint.workspace.launch_run import Runner
from tarl_lint.workspace.launch_script import is_script, read_script
from tarl_lint.workspace.launch_values import Context
from tarl_lint.workspace.launch_xml import read_xml
from tarl_lint.workspace.model import Problem, Workspace, unreadable
from tarl_lint.workspace.parameter_yaml import YAML
from tarl_lint.workspace.python.values import SpentError

_OF_ROS2: Final = re.compile(
    r"<(?:node|executable)\b[^>]*\s(?:exec|cmd)\s*=|\$\((?:var|find-pkg-share|find-pkg-prefix)\s|"
    r"<(?:push[-_]ros[-_]namespace|node_container|let|set_remap|set_parameter)\b"
)
_OF_ROS1: Final = re.compile(
    r"<node\b[^>]*\stype\s*=|\$\((?:arg|find)\s|<(?:rosparam|machine|test)\b|<include\b[^>]*\sns="
)


def read_launch(path: Path, workspace: Workspace, arguments: Mapping[str, str] | None = None) -> Launch:
    """Read a launch file, with defaults for missing arguments. Nothing is executed.

    A file that nests too deeply, or contains itself, starts no node; `problems` then has the reason.
    """
    try:
        return _launch(path, workspace, dict(arguments or {}))
    except (RecursionError, SpentError):
        reason = "it nests too deeply, contains itself, or has too many parts"
        return Launch(path, problems=(unreadable(path, 0, reason),))


def _launch(path: Path, workspace: Workspace, arguments: dict[str, str]) -> Launch:
    if path.suffix not in (".py", *YAML) and not is_ros2_xml(path, workspace):
        return read_xml(path, workspace, arguments)
    if path.suffix == ".py" and is_script(_text(path)):
        return read_script(path, workspace)
    context = Context(workspace, path, dict(arguments))
    runner = Runner(_opened)
    runner.run(_opened(path, context, runner.problems), context)
    names = tuple(sorted({*runner.arguments, *context.asked}))
    problems, required = tuple(dict.fromkeys(runner.problems)), tuple(sorted(runner.required))
    return Launch(path, tuple(runner.nodes), (), problems, names, ros2=True, required=required)


def _text(path: Path) -> str:
    try:
        return read_text(path, LARGEST)
    except UnreadableError:
        return ""


def is_ros2_xml(path: Path, workspace: Workspace) -> bool:
    """Return whether an XML launch file is for ROS 2, judged by its elements or else by its package's build type."""
    text = _text(path)
    if not text:
        return False
    if _OF_ROS2.search(text):
        return True
    package = workspace.package_of(path)
    return not _OF_ROS1.search(text) and package is not None and package.kind.startswith("ament")


def _opened(path: Path, context: Context, problems: list[Problem]) -> Any:
    """Return the actions of a ROS 2 launch file."""
    if not path.is_file():
        problems.append(Problem(path, 0, "there is no such launch file", hides=True))
        return ()
    if path.suffix == ".py":
        return actions_of_python(path, context.workspace, problems)
    if path.suffix in YAML:
        return actions(of_yaml(path, problems))
    root: Element | None = xml_root(path, problems)
    return actions(of_xml(root)) if root is not None else ()
