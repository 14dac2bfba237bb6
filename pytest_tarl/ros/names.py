"""Names of topics, services and parameters: resolution, remapping, ROS command lines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros import params_files
from pytest_tarl.ros.literals import parse_value


@dataclass(frozen=True, slots=True)
class CommandLine:
    """The parts of a ROS command line; `rest` are the program's own arguments."""

    remappings: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[str, Any] = field(default_factory=dict)
    name: str | None = None
    namespace: str | None = None
    rest: tuple[str, ...] = ()


def absolute(name: str) -> str:
    """Add the leading slash to a name and remove doubled and trailing ones, such as `odom` → `/odom`."""
    return "/" + "/".join(part for part in name.split("/") if part)


def given_name(name: object) -> str:
    """Return the absolute form of a name that a test gives. Raise RecordingError if it is not a string."""
    if not isinstance(name, str):
        raise RecordingError(f"The name of a topic or service must be a string, not {name!r}.")
    return absolute(name)


def resolve(name: str, node: str, remappings: Mapping[str, str]) -> str:
    """Resolve a name used in the node with the fully qualified name `node`, as both ROS generations do.

    `~x` is private to the node, `/x` global, `x` relative to the node's namespace. A remapping applies to resolved
    names: its left side is resolved as well.
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


def parse_ros2(arguments: Iterable[str]) -> CommandLine:
    """Read `--ros-args -r old:=new -p name:=value --params-file file …` up to `--`.

    Node-specific rules keep their `node:` prefix; parameters from files stay grouped by node name.
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
                (special if left.startswith("__") else remappings)[left] = right
            option = ""
    name = special.get("__node", special.get("__name"))
    return CommandLine(remappings, parameters, name, special.get("__ns"), tuple(rest))
