"""Names of topics, services and parameters: resolution, remapping, ROS command lines."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros import params_files
from pytest_tarl.ros.command_line_values import parse_value
from pytest_tarl.ros_names import namespace_problem, node_problem, objection

_PART = r"(?:[A-Za-z_]|\\[1-9])(?:[A-Za-z0-9_]|\\[1-9])*"
_NEW_NAME = re.compile(rf"(?:~/|/)?{_PART}(?:/{_PART})*")  # `\1` stands for what a wildcard matched


@dataclass(frozen=True, slots=True)
class CommandLine:
    """The parts of a ROS command line; `rest` has the program's own arguments."""

    remappings: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[str, Any] = field(default_factory=dict)
    name: str | None = None
    namespace: str | None = None
    rest: tuple[str, ...] = ()


def absolute(name: str) -> str:
    """Return a name with a leading slash and without doubled or trailing ones: `odom` becomes `/odom`."""
    return "/" + "/".join(part for part in name.split("/") if part)


def given_name(name: object) -> str:
    """Return the absolute form of a name from a test. Raise RecordingError if no node can use it."""
    if wrong := objection(name):
        raise RecordingError(f"The name of a topic or service {wrong}.")
    return absolute(str(name))


def require_remapping(old: str, new: str) -> None:
    """Raise RecordingError if a test remaps to a name that no node can use; private names are allowed."""
    if wrong := objection(new.removeprefix("~") if isinstance(new, str) else new):
        raise RecordingError(f"The remapping of {old!r} to {new!r} is invalid: the new name {wrong}.")


def resolve(name: str, node: str, remappings: Mapping[str, str]) -> str:
    """Resolve a name used in the node `node`.

    `~x` is private to the node, `/x` is global, and `x` is relative to the node's namespace. A remapping applies if its
    left side, once resolved, equals the resolved name.
    """
    resolved = expand(name, node)
    for old, new in remappings.items():
        if expand(old.removeprefix("rostopic://").removeprefix("rosservice://"), node) == resolved:
            return expand(new, node)
    return resolved


def expand(name: str, node: str) -> str:
    """Expand `~`, `{node}`, `{ns}` and relative names, without remapping."""
    namespace, _, base = node.rpartition("/")
    name = name.replace("{node}", base).replace("{namespace}", namespace).replace("{ns}", namespace)
    if name.startswith("~"):
        return absolute(f"{node}/{name[1:]}")
    if name.startswith("/"):
        return absolute(name)
    return absolute(f"{namespace}/{name}")


def parse_ros1(arguments: Iterable[str]) -> CommandLine:
    """Read `topic:=other`, `_parameter:=value`, `__name:=` and `__ns:=`."""
    remappings: dict[str, str] = {}
    parameters: dict[str, Any] = {}
    special: dict[str, str] = {}
    rest = []
    for argument in arguments:
        left, assigned, right = argument.partition(":=")
        if not assigned:
            rest.append(argument)
        elif left.startswith("__"):
            special[left] = right
        elif left.startswith("_"):
            parameters["~" + left[1:]] = parse_value(right)
        else:
            remappings[left] = right
    return CommandLine(remappings, parameters, special.get("__name"), special.get("__ns"), tuple(rest))


def _require_remapping(option: str, rule: str) -> None:
    """Raise RuntimeError, as rcl does, if a rule's new name is not valid."""
    left, mark, right = rule.partition(":=")
    if left in ("__node", "__name"):
        wrong = node_problem(right) is not None
    elif left == "__ns":
        wrong = namespace_problem(right) is not None
    else:
        wrong = _NEW_NAME.fullmatch(right) is None
    if wrong or not mark:
        raise RuntimeError(f"failed to initialize: Couldn't parse remap rule: '{option} {rule}'.")


def parse_ros2(arguments: Iterable[str]) -> CommandLine:
    """Read `--ros-args -r old:=new -p name:=value --params-file file …` up to `--`.

    Rules for one node keep their `node:` prefix; parameters from files stay grouped by node name.
    """
    remappings: dict[str, str] = {}
    parameters: dict[str, Any] = {}
    special: dict[str, str] = {}
    rest: list[str] = []
    inside, option = False, ""
    for argument in arguments:
        if argument == "--ros-args":
            inside = True
        elif inside and argument == "--":
            inside = False
        elif not inside:
            rest.append(argument)
        elif not option and argument.startswith("-"):
            option = argument
        else:
            left, _, right = argument.partition(":=")
            if option in ("-p", "--param"):
                parameters[left] = parse_value(right)
            elif option == "--params-file":
                parameters |= params_files.read(argument)
            elif option in ("-r", "--remap"):
                _require_remapping(option, argument)
                (special if left.startswith("__") else remappings)[left] = right
            option = ""
    name = special.get("__node", special.get("__name"))
    return CommandLine(remappings, parameters, name, special.get("__ns"), tuple(rest))
