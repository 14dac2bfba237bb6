"""Classes that an interpreted file defines: data classes, named tuples, enumerations and others."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import Any

from tarl_lint.workspace.python_values import DATA, TUPLES, Class, Function, Library, Made


def defined(
    statement: ast.ClassDef, bases: tuple[Any, ...], decorators: Iterable[Any], names: dict[str, Any]
) -> Class:
    """Return the class of a `class` statement, given the values of its bases and decorators and its `names`.

    The values of an enumeration in `names` are replaced with its members.
    """
    libraries = {one.name for one in bases if isinstance(one, Library)}
    decorated = {one.name for one in decorators if isinstance(one, Library)}
    stated = tuple(
        one.target.id
        for one in statement.body
        if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name)
    )
    fields = stated if DATA in decorated or TUPLES in libraries else None
    made = Class(statement.name, bases, names, fields, TUPLES in libraries)
    if made.is_enumeration():
        for name, value in list(names.items()):
            if not isinstance(value, Function):
                names[name] = Made(made, {"name": name, "value": value})
    return made
