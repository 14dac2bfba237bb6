"""The parameters that a launch file gives a node."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.parameter_yaml import content, of_node

ON_ROBOT: Final = object()  # stands for a value that is known only on the robot


@dataclass(frozen=True, slots=True)
class Stated:
    """A parameter with its value, or ON_ROBOT; `name` is absolute or begins with `~`."""

    name: str
    value: Any
    file: Path


def stated(settings: Iterable[Setting], node: str) -> Iterator[Stated]:
    """Yield the parameters of a node with the absolute name `node`, in the order of setting, with YAML parsed.

    Raises NoYamlError and UnreadableError for YAML that cannot be read.
    """
    for setting in settings:
        for name, value in _values(setting, node):
            symbolic = setting.unknown or "$(" in str(value)
            yield Stated(name, ON_ROBOT if symbolic else value, setting.file)


def _values(setting: Setting, node: str) -> Iterator[tuple[str, Any]]:
    if setting.yaml is None:
        yield setting.name, setting.value
        return
    parsed = content(setting)
    if not isinstance(parsed, dict):
        yield setting.name, parsed
        return
    above = setting.name.rstrip("/")
    between = "" if above == "~" else "/"
    for name, value in of_node(parsed, node).items():
        yield f"{above}{between}{name}", value


def leaves(values: Mapping[str, Any], above: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Yield the values of nested mappings by names with slashes."""
    for name, value in values.items():
        if isinstance(value, dict) and value and depth < 50:
            yield from leaves(value, f"{above}{name}/", depth + 1)
        else:
            yield f"{above}{name}", value
