"""Find where a name means the same constant, so that all of its uses can be changed together.

A name of the module, such as `LASER_YAW`, means the same constant in the whole file, and `self.kp` means the same in
the whole class. A parameter of a function, such as `dt`, means the same only in this function. If the function passes
the parameter to another function and both uses were multiplied by a factor, the factor would count twice.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable

from pytest_tarl.patching.document import document
from tarl_lint.api import Analysis
from tarl_lint.model import Operand

_NAME = re.compile(r"\w+")


def name_scope(analysis: Analysis) -> Callable[[Operand], str]:
    """Return a function that names the part of a file where an operand's name means the same constant."""
    known: dict[str, frozenset[str]] = {}

    def scope(operand: Operand) -> str:
        path, qualname = operand.span.path, operand.site.qualname
        if path not in known:
            known[path] = _module_names(path, analysis.sources.get(path, ""))
        found = _NAME.match(operand.code)
        name = found.group() if found is not None else ""
        if name == "self":
            return qualname.rpartition(".")[0]
        return "" if name in known[path] else qualname

    return scope


def _module_names(path: str, text: str) -> frozenset[str]:
    """Return the names that are bound at the top level of a file and in none of its functions."""
    tree = document(path, text).tree
    functions = [one for one in ast.walk(tree) if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)]
    arguments = {one.arg for function in functions for one in ast.walk(function) if isinstance(one, ast.arg)}
    inner = {name for function in functions for one in function.body for name in _bound(one)}
    return frozenset({name for one in tree.body for name in _bound(one)} - arguments - inner)


def _bound(statement: ast.stmt) -> set[str]:
    """Return the names that a statement binds by assignment or import, at any depth."""
    found: set[str] = set()
    for node in ast.walk(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        elif isinstance(node, ast.alias):
            found.add((node.asname or node.name).partition(".")[0])
    return found
