"""What starts a node, read off the syntax: without any of it a file only defines things."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from tarl_lint.trees import walk
from tarl_lint.valueflow import ir

STARTS = frozenset(["init_node", "init", "create_node", "spin", "Subscriber", "create_subscription"])
STARTING = re.compile(rf"\.\s*({'|'.join(sorted(STARTS))})\s*\(")  # without it a file starts nothing


def definitions(body: Sequence[ir.Stmt]) -> Iterator[ir.Define | ir.Class]:
    """Yield the functions and classes that a body defines itself."""
    for statement in body:
        if isinstance(statement, (ir.Define, ir.Class)):
            yield statement


def starts_node(function: ir.Function) -> bool:
    """Tell whether a function is there to be started: it is called main, or it starts a node."""
    return function.name == "main" or starts(function)


def registers(statement: ir.Class) -> bool:
    """Tell whether a method of a class registers something or starts a node."""
    return any(isinstance(s, ir.Define) and starts(s.function) for s in statement.body)


def starts(function: ir.Function) -> bool:
    """Tell whether a function calls a method that registers something or starts a node."""
    if function.starts is None:
        function.starts = any(
            isinstance(n, ast.Call) and isinstance(n.func, ast.Attribute) and n.func.attr in STARTS
            for n in walk(function.node)
        )
    return function.starts
