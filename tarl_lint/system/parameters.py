"""Strings of a program, among them the names of its parameters, and whether these are all that it reads."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence
from typing import Final

from tarl_lint.read.source import Module
from tarl_lint.trees import last_name

READERS: Final = frozenset(
    ["get_param", "get_param_cached", "has_param", "search_param", "declare_parameter", "declare_parameters",
     "get_parameter", "get_parameter_or", "get_parameters", "get_parameters_by_prefix", "has_parameter"]
)  # fmt: skip
OPEN: Final = re.compile(
    r"automatically_declare_parameters_from_overrides|allow_undeclared_parameters|get_parameters_by_prefix|"
    r"get_param_names|dynamic_reconfigure|rosparam|param_server|generate_parameter_library"
)


def words(modules: Sequence[Module]) -> frozenset[str]:
    """Return every string of a program, as a name without `~` and slashes around it."""
    return frozenset(
        node.value.strip("~/")
        for module in modules
        for node in ast.walk(module.tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def reads_named_parameters(modules: Sequence[Module]) -> bool:
    """Return whether a program reads parameters only by literal names, one by one."""
    if any(OPEN.search(module.text) for module in modules):
        return False
    for module in modules:
        calls = (n for n in ast.walk(module.tree) if isinstance(n, ast.Call) and last_name(n.func) in READERS)
        if any(call.args and _computed(call.args[0]) for call in calls):
            return False
    return True


def _computed(argument: ast.expr) -> bool:
    """Return whether an argument is not a literal name, or names a whole group (`~`, `/`)."""
    if isinstance(argument, ast.List | ast.Tuple):
        return any(map(_computed, argument.elts[:1]))
    if isinstance(argument, ast.Constant):
        return not isinstance(argument.value, str) or argument.value.rstrip("/") in ("", "~")
    return True
