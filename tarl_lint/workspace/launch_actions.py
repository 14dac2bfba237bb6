"""Actions of ROS 2 launch files, whether they come from Python, XML or YAML. None of them is executed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from tarl_lint.workspace.launch_values import performed, truth
from tarl_lint.workspace.python.evaluator import Unknown


@dataclass(frozen=True)
class Action:
    """A node, group, declaration or include; `line` is the line of its call or element."""

    kind: str
    line: int
    values: dict[str, Any] = field(default_factory=dict)
    readable: frozenset[str] = frozenset({"add_action", "add_entity", "entities"})

    def add_action(self, action: Any) -> None:
        """Add to a launch description or group."""
        self.entities.append(action)

    add_entity = add_action

    @property
    def entities(self) -> Any:
        """Return the actions of a launch description or group."""
        return self.values.setdefault("actions", [])


@dataclass(frozen=True)
class Condition:
    """`IfCondition` and `UnlessCondition`; with `name`, a comparison of a launch configuration."""

    value: Any
    wanted: bool = True
    name: Any = None
    readable: ClassVar = frozenset({"evaluate"})

    def evaluate(self, context: Any) -> Any:
        """Return whether the condition holds, for the function of an OpaqueFunction; Unknown if that is unknown."""
        holds = truth(performed(self.value, context)) if self.name is None else None
        return Unknown(0, "a condition") if holds is None else holds is self.wanted


@dataclass(frozen=True)
class Quoted:
    """A parameter value with its type: `str` keeps a string unchanged, other types parse it as YAML."""

    value: Any
    kind: str = ""


def gz_bridge(line: int, values: Mapping[Any, Any]) -> Action:
    """Return the node that `RosGzBridge`, `<ros_gz_bridge>` and the launch file of ros_gz_bridge start."""
    return Action(
        "node",
        line,
        {
            "package": "ros_gz_bridge",
            "executable": "bridge_node",
            "name": values.get("bridge_name"),
            "namespace": values.get("namespace"),
            "parameters": [{"config_file": values.get("config_file")}],
        },
    )
