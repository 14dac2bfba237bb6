"""The parameters that YAML in a launch file gives a node."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any, Final

from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.python.elements import bounded

DEEPEST: Final = 50  # maximum nesting of parameters; needed because a YAML mapping may contain itself
MOST: Final = 300_000  # maximum number of values of a YAML text
YAML: Final = (".yaml", ".yml")  # endings of YAML files
SECTION: Final = "ros__parameters"


class NoYamlError(Exception):
    """PyYAML is not installed, so no YAML can be read."""


def content(setting: Setting) -> Any:
    """Return the parsed YAML of a setting; None if it has no YAML.

    Raises NoYamlError without PyYAML, and UnreadableError with the reason if the text is not YAML.
    """
    if setting.yaml is None:
        return None
    try:
        import yaml  # noqa: F401
    except ModuleNotFoundError:
        raise NoYamlError from None
    return _parsed(setting.yaml)


@lru_cache(maxsize=512)
def _parsed(text: str) -> Any:
    import yaml

    try:
        found = yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError) as problem:
        raise UnreadableError(f"it is not YAML: {' '.join(str(problem).split())}") from None
    if not bounded(found, MOST):
        # nested YAML aliases can make a short text stand for billions of values
        raise UnreadableError("it has too many values")
    return found


def sections(parsed: Any, above: str = "") -> Iterator[tuple[str, dict[Any, Any]]]:
    """Yield the sections of a ROS 2 parameter file: the pattern of node names, and the parameters.

    Other files have no sections.

    Namespaces may be part of the key (`/robot/gate`), or enclosing keys.
    """
    for key, value in parsed.items() if isinstance(parsed, dict) and above.count("/") < DEEPEST else ():
        if not isinstance(value, dict):
            continue
        name = f"{above}{key}"
        if SECTION in value:
            yield name, value[SECTION] if isinstance(value[SECTION], dict) else {}
        else:
            yield from sections(value, f"{name.rstrip('/')}/")


def matches(pattern: str, node: str) -> bool:
    """Return whether a section is for the node with the absolute name `node`."""
    parts = ["(/[^/]+)*" if part == "**" else "/[^/]+" if part == "*" else "/" + re.escape(part)
             for part in pattern.strip("/").split("/")]  # fmt: skip
    return re.fullmatch("".join(parts), node) is not None


def is_wildcard(pattern: str) -> bool:
    """Return whether a section is for nodes of any name."""
    return pattern.rpartition("/")[2] in ("*", "**")


def of_node(parsed: Mapping[Any, Any], node: str) -> dict[Any, Any]:
    """Return the parameters that parsed YAML has for a node (dotted names for ROS 2); later sections win.

    A file without sections has the same parameters for every node. A node without a name gets a section only if the
    file has just one.
    """
    found = list(sections(parsed))
    if not found:
        return dict(parsed)
    chosen: dict[Any, Any] = {}
    for pattern, values in found:
        if matches(pattern, node) or (not node.rpartition("/")[2] and len(found) == 1):
            chosen.update(dotted(values))
    return chosen


def dotted(values: Mapping[Any, Any], above: str = "") -> dict[str, Any]:
    """Flatten nested ROS 2 parameters to dotted names."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        name = f"{above}{key}"
        nested = isinstance(value, dict) and name.count(".") < DEEPEST
        found.update(dotted(value, f"{name}.") if nested else {name: value})
    return found
