"""Remappings and parameters in a node's arguments."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from tarl_lint.workspace.name_resolution import resolved

# matches a name, which may contain `$(arg robot)`
_NAME: Final = re.compile(r"[~/]?[A-Za-z$][\w$() ]*(/[\w$() ]+)*/?")
_SYMBOLIC: Final = re.compile(r"\$\([^()]*\)")
Pairs = tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Given:
    """The ROS settings in a node's arguments."""

    remaps: Pairs = ()
    parameters: Pairs = ()
    files: tuple[str, ...] = ()
    name: str = ""
    namespace: str = ""


def ros1(arguments: str) -> Given:
    """Return the settings in the arguments of a ROS 1 node: `topic:=other`, `_parameter:=value`, `__ns:=`."""
    pairs = [
        (old, new) for old, assigned, new in (one.partition(":=") for one in _words(arguments)) if assigned
    ]
    return Given(
        tuple(one for one in pairs if all(map(_is_name, one))),
        tuple((f"~{old[1:]}", new) for old, new in pairs if old.startswith("_") and not old.startswith("__")),
        namespace=next((new for old, new in pairs if old == "__ns"), ""),
    )


def ros2(arguments: str) -> Given:
    """Return the settings in the arguments of a ROS 2 node, between `--ros-args` and `--`."""
    remaps: list[tuple[str, str]] = []
    parameters: list[tuple[str, str]] = []
    files: list[str] = []
    inside, option = False, ""
    for word in _words(arguments):
        if not inside or word in ("--", "--ros-args"):
            inside, option = word == "--ros-args", ""
        elif not option:
            option = word if word.startswith("-") else ""
        else:
            left, _, right = word.partition(":=")
            if option in ("-r", "--remap"):
                remaps.append((left, right))
            elif option in ("-p", "--param"):
                parameters.append((f"~{left}", right))
            elif option == "--params-file":
                files.append(word)
            option = ""
    names = [new for old, new in remaps if old in ("__node", "__name")]
    spaces = [new for old, new in remaps if old == "__ns"]
    plain = tuple(one for one in remaps if not one[0].startswith("__"))
    return Given(plain, tuple(parameters), tuple(files), "".join(names[:1]), "".join(spaces[:1]))


def first_of_each(remaps: Iterable[tuple[str, str]], namespace: str, node: str) -> Pairs:
    """Return the remappings that ROS 2 applies to a node."""
    found: dict[str, tuple[str, str]] = {}
    for old, new in remaps:
        of, colon, name = old.rpartition(":")
        if not colon or of in (node, f"{namespace.rstrip('/')}/{node}"):
            found.setdefault(resolved(name, namespace, node), (name, new))
    return tuple(found.values())


def _is_name(text: str) -> bool:
    """Return whether a string can be a topic name, unlike `debug:=false`."""
    return _NAME.fullmatch(text) is not None and text not in ("true", "false", "True", "False")


def _words(arguments: str) -> list[str]:
    whole = _SYMBOLIC.sub(lambda found: found[0].replace(" ", "\0"), arguments)
    try:
        words = shlex.split(whole)
    except ValueError:
        words = whole.split()
    return [one.replace("\0", " ") for one in words]


def plain(arguments: str, *, for_ros2: bool) -> tuple[str, ...]:
    """Return a node's arguments without those for ROS."""
    words = _words(arguments)
    if not for_ros2:
        return tuple(one for one in words if ":=" not in one)
    found, inside = [], False
    for word in words:
        if word == "--ros-args" or (inside and word == "--"):
            inside = word == "--ros-args"
        elif not inside:
            found.append(word)
    return tuple(found)
