"""Entries in tables of parameters: `rospy.get_param("~pid")["gain"]`, and with a default `table.get("gain", 0.3)`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.value_flow_graph import Graph
from tarl_lint.memory.values import Nodes, Value

CONVERSIONS: Final = frozenset(["float", "int"])


def of_entry(ctx: Interpreter, expr: ir.Expr, value: Value) -> ir.Const | None:
    """Return the default in `table.get("gain", 0.3)` if the default is a number and `table` is a parameter's value."""
    default = _default(expr)
    return default if default is not None and _ask(ctx.graph, value, _of_parameters) else None


def entry(ctx: Interpreter, expr: ir.Expr, value: Value) -> ir.Pos | None:
    """Return the place of `table["gain"]` in an expression (see `entry_place`) if the table is an unknown parameter.

    Such an entry is a constant of its own: one parameter may be a table of many constants.
    """
    pos = entry_place(expr)
    return pos if pos is not None and _ask(ctx.graph, value, _of_tables) else None


def entry_place(expr: ir.Expr) -> ir.Pos | None:
    """Return the place of `table["gain"]` or `table.get("gain")`, also inside a conversion to a number, or None."""
    expr = _unconverted(expr)
    key: ir.Expr | None = None
    if isinstance(expr, ir.Item):
        key = expr.index
    elif isinstance(expr, ir.Call) and isinstance(expr.function, ir.Attribute) and len(expr.arguments) == 1:
        key = expr.arguments[0] if expr.function.name == "get" else None
    named = isinstance(key, ir.Const) and isinstance(key.value, str)
    return expr.pos if named else None


def tables(graph: Graph) -> frozenset[tuple[str, ir.Pos]]:
    """Return the places of parameters and of entries whose values are unknown: each may be a table."""
    known = (
        (node, graph.literals[node]) for node in (*graph.parameters, *graph.copies) if node in graph.literals
    )
    return frozenset((path, pos) for _, (value, pos, path) in known if value is None)


def _ask(graph: Graph, value: Value, about: Callable[[Graph, Nodes], bool]) -> bool:
    if value.pts or not value.deps:
        return False
    question = partial(about, graph)
    graph.reads.ask(question, value.deps)
    return question(value.deps)


def _unconverted(expr: ir.Expr) -> ir.Expr:
    """Return the argument of a conversion to a number, or the expression itself."""
    while isinstance(expr, ir.Call) and isinstance(expr.function, ir.Name):
        if expr.function.name not in CONVERSIONS or len(expr.arguments) != 1:
            break
        expr = expr.arguments[0]
    return expr


def _default(expr: ir.Expr) -> ir.Const | None:
    """Return the number in `table.get("gain", 0.3)` or `float(table.get("gain", 0.3))`."""
    expr = _unconverted(expr)
    if not isinstance(expr, ir.Call) or not isinstance(expr.function, ir.Attribute):
        return None
    if expr.function.name != "get" or len(expr.arguments) != 2:
        return None
    default = expr.arguments[1]
    if isinstance(default, ir.Const) and isinstance(default.value, (bool, int, float)):
        return default
    return None


def _of_tables(graph: Graph, deps: Nodes) -> bool:
    """Return whether all data of some nodes comes from parameters of unknown value, unchanged."""
    return _of_parameters(graph, deps, unknown=True)


def _of_parameters(graph: Graph, deps: Nodes, unknown: bool = False) -> bool:
    """Return whether all data of some nodes comes from parameters, unchanged; with `unknown`, from unknown values."""
    pending, seen = list(deps), set(deps)
    while pending:
        node = pending.pop()
        if node in graph.parameters and not graph.data[node]:
            if unknown and graph.literals.get(node, ("",))[0] is not None:
                return False
            continue
        if node not in graph.copies and node not in graph.carried:
            return False
        if not graph.data[node]:
            return False
        new = set(graph.data[node]) - seen
        seen |= new
        pending.extend(new)
    return True
