"""The types of messages, services and actions that a module imports."""

from __future__ import annotations

import ast
from typing import Final

from tarl_lint.message_fields import PACKAGES
from tarl_lint.trees import walk

_KINDS: Final = ("msg", "srv", "action")
# parts of services and actions: in ROS 2, they are classes inside the type; in ROS 1, names with this ending
PARTS: Final = ("Request", "Response", "Goal", "Result", "Feedback")


def path(node: ast.expr) -> tuple[str, tuple[str, ...]]:
    """Return the variable of an attribute and the names after it; "" for others."""
    parts: list[str] = []
    expr = node
    while isinstance(expr, ast.Attribute):
        parts.append(expr.attr)
        expr = expr.value
    return (expr.id if isinstance(expr, ast.Name) else ""), tuple(reversed(parts))


def short(whole: str) -> str:
    """Return the name of a type, without its package if its fields are known."""
    package, _, name = whole.partition("/")
    return name if name in PACKAGES.get(package, ()) else whole


class ImportedTypes:
    """The types that a module imports.

    Messages are `Name` if the fields are known, else `package/Name`. Parts of services and actions are
    `package/Name.Part`; services and actions themselves are `package/Name`.
    """

    def __init__(self, tree: ast.Module) -> None:
        self._classes: dict[str, str] = {}  # local name → type
        self._modules: dict[str, tuple[str, str]] = {}  # dotted name in the code → package, and its part
        self.ros: str = ""  # "1" or "2", by the client library that the module imports
        found: set[str] = set()
        for node in walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                package, _, rest = node.module.partition(".")
                found.add(package)
                for alias in node.names:
                    local = alias.asname or alias.name
                    kind = rest.partition(".")[0]
                    if kind in _KINDS:
                        self._import(local, _typed(package, kind, alias.name))
                    elif not rest and alias.name in _KINDS:
                        self._modules[local] = package, alias.name
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    package, _, rest = alias.name.partition(".")
                    found.add(package)
                    if rest in _KINDS:
                        self._modules[alias.asname or alias.name] = package, rest
        if len(found & {"rospy", "rclpy"}) == 1:
            self.ros = "1" if "rospy" in found else "2"

    def _import(self, local: str, kind: str) -> None:
        """Store the type of a name; it becomes unknown if there are several."""
        self._classes[local] = kind if self._classes.get(local, kind) == kind else ""

    @property
    def used(self) -> bool:
        """Return whether the module imports any of these types."""
        return bool(self._classes or self._modules)

    def of(self, expr: ast.expr) -> str:
        """Return the type that a name in the code stands for; "" if it stands for none."""
        first, parts = path(expr)
        for length in range(len(parts) + 1):
            name, rest = ".".join((first, *parts[:length])), parts[length:]
            if name in self._classes:
                return _part(self._classes[name], rest)
            if name in self._modules and rest:
                package, kind = self._modules[name]
                return _part(_typed(package, kind, rest[0]), rest[1:])
        return ""


def _typed(package: str, kind: str, name: str) -> str:
    if kind == "msg":
        return short(f"{package}/{name}")
    ending = next((one for one in PARTS if kind == "srv" and name.endswith(one) and name != one), "")
    return short(f"{package}/{name.removesuffix(ending)}.{ending}") if ending else f"{package}/{name}"


def _part(kind: str, rest: tuple[str, ...]) -> str:
    if not rest or not kind:
        return kind
    return short(f"{kind}.{rest[0]}") if len(rest) == 1 and rest[0] in PARTS and "/" in kind else ""
