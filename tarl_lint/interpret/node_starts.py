"""Find code that starts a node by its syntax; other files only define names."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from tarl_lint import catalog
from tarl_lint.ir import nodes as ir
from tarl_lint.trees import walk

# kinds of calls that register an input
KINDS = frozenset(["subscribe", "receive", "filter", "service", "action", "behaviour"])
FACTS = {**catalog.FUNCTIONS, **catalog.METHODS}
REGISTERING = frozenset(name.rpartition(".")[2] for name, fact in FACTS.items() if fact.kind in KINDS)
STARTS = REGISTERING | {"init_node", "init", "create_node", "spin"}
HELD = REGISTERING & catalog.ENDPOINT_METHODS  # methods that are recognised without a call
MAKES = frozenset(
    name.rpartition(".")[2] for name, fact in FACTS.items() if fact.kind in ("publisher", "timer")
)  # names of calls that make a publisher or a timer
STARTING = re.compile(
    rf"\.\s*(?:{'|'.join(sorted(STARTS))})\s*\(|\b(?:{'|'.join(sorted(REGISTERING))})\s*\("
    rf"|\b(?:{'|'.join(sorted(HELD))})\b"
)  # a file that starts a node contains at least one of these words


def definitions(body: Sequence[ir.Stmt]) -> Iterator[ir.Define | ir.Class]:
    """Yield the functions and classes of a scope, including those defined in an `if`, a `try` or a `with`."""
    for statement in body:
        if isinstance(statement, (ir.Define, ir.Class)):
            yield statement
        elif isinstance(statement, ir.If):
            yield from definitions((*statement.body, *statement.orelse))
        elif isinstance(statement, ir.Try):
            handlers = (one for _, _, handler in statement.handlers for one in handler)
            yield from definitions((*statement.body, *handlers, *statement.orelse, *statement.final))
        elif isinstance(statement, ir.With):
            yield from definitions(statement.body)


def starts_node(function: ir.Function) -> bool:
    """Return whether a function is an entry point: its name is main, or it starts a node."""
    return function.name == "main" or starts(function)


def registers(statement: ir.Class) -> bool:
    """Return whether a method of a class registers something or starts a node."""
    return any(isinstance(s, ir.Define) and starts(s.function) for s in definitions(statement.body))


def publishes(function: ir.Function) -> bool:
    """Return whether a function makes a publisher or a timer."""
    return any(
        isinstance(n, (ast.Attribute, ast.Name))
        and (n.attr if isinstance(n, ast.Attribute) else n.id) in MAKES
        for n in walk(function.node)
    )


def starts(function: ir.Function) -> bool:
    """Return whether a function contains a call that registers something or starts a node, or such a method."""
    if function.starts is None:
        function.starts = any(
            _starts(n.func) if isinstance(n, ast.Call) else _holds(n) for n in walk(function.node)
        )
    return function.starts


def _holds(node: ast.AST) -> bool:
    """Return whether an expression is a registering method, or its name for `getattr`."""
    if isinstance(node, ast.Attribute):
        return node.attr in HELD
    return isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in HELD


def _starts(called: ast.expr) -> bool:
    """Return whether a callee registers something or starts a node: a method, or an imported name."""
    if isinstance(called, ast.Name):
        return called.id in REGISTERING
    return isinstance(called, ast.Attribute) and called.attr in STARTS
