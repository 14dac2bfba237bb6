"""Parts of topic names that only the launch determines. Marks in a string stand for parameters and node names."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Literal

MARK: Final = "\0"
DEFAULT: Final = "\0default"  # the value of a parameter that is not set
# key for the program's command line (a tuple of texts) among the values of parameters
ARGUMENTS: Final = "\0argv"
LAUNCHED: Final = "\0launched"  # key for the `Launched` node itself among the values of parameters
ELSEWHERE: Final = "\0elsewhere"  # the value of a parameter that is known only on the robot
_MARKED: Final = re.compile(f"{MARK}(\\d+){MARK}")


@dataclass(frozen=True, slots=True)
class ParameterName:
    """A parameter: its name in the code and its default, which is None if the default is not a single known text.

    Besides parameters, the class represents the node's name, the last part of the node's name ("own"), the node's
    namespace, and a name after resolving and remapping.
    """

    name: str
    default: str | None = None
    kind: Literal["parameter", "node", "own", "namespace", "resolved"] = "parameter"


@dataclass(frozen=True)
class Launched:
    """A launched node: its absolute name, and the parameters that it can see, sorted by their absolute names.

    A value is a string, number, truth value, list, mapping or None, or ELSEWHERE.
    """

    name: str
    parameters: tuple[tuple[str, Any], ...]

    @property
    def namespace(self) -> str:
        """Return the namespace of the node, without a slash at its end."""
        return self.name.rpartition("/")[0]

    @cached_property
    def _values(self) -> Mapping[str, Any]:
        return dict(self.parameters)

    def value(self, name: str) -> Any:
        """Return a parameter by its name in the code: its value, a mapping of the parameters below it, or DEFAULT."""
        for place in places(name, self.name):
            if place in self._values:
                return self._values[place]
            below: dict[str, Any] = {}
            for one, value in self.parameters:
                if one.startswith(f"{place}/"):
                    _put(below, one[len(place) + 1 :].split("/"), value)
            if below:
                return below
        return DEFAULT


def _put(table: dict[str, Any], path: list[str], value: Any) -> None:
    for part in path[:-1]:
        inner = table.get(part)
        table[part] = table = inner if isinstance(inner, dict) else {}
    table[path[-1]] = value


def places(name: str, node: str) -> tuple[str, ...]:
    """Return the absolute names of a parameter in the code of a node: its name in ROS 1 and its name in ROS 2."""
    namespace = node.rpartition("/")[0]
    start = {"~": f"{node}/", "/": "/"}.get(name[:1], f"{namespace}/")
    whole = start + name.lstrip("~/")
    in_ros1 = "/" + "/".join(part for part in whole.split("/") if part)
    return (in_ros1,) if name[:1] in ("~", "/") else (in_ros1, f"{node}/{name}")


def substituted(text: str, value: Callable[[int], str | None]) -> str | None:
    """Return a string with each mark replaced by the value of its parameter; None if a parameter has no value."""
    found = {number: value(int(number)) for number in _MARKED.findall(text)}
    if None in found.values():
        return None
    return _MARKED.sub(lambda match: found[match[1]] or "", text)
