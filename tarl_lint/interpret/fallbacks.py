"""Entries in tables of parameters: `rospy.get_param("~pid")["gain"]`, and with a default `table.get("gain", 0.3)`."""

from __future__ import annotations

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
    return default if default is not None and _all_of_parameters(ctx.graph, value) else None


def entry(graph: Graph, expr: ir.Expr, value: Value) -> ir.Pos | None:
    """Return the place of `table["gain"]` or `table.get("gain")` in an expression if a parameter is the table.

    Such an entry is a constant of its own: one parameter may be a table of many constants.
    """
    expr = _unconverted(expr)
    key: ir.Expr | None = None
    if isinstance(expr, ir.Item):
        key = expr.index
    elif isinstance(expr, ir.Call) and isinstance(expr.function, ir.Attribute) and len(expr.arguments) == 1:
        key = expr.arguments[0] if expr.function.name == "get" else None
    named = isinstance(key, ir.Const) and isinstance(key.value, str)
    return expr.pos if named and _all_of_parameters(graph, value) else None


def _all_of_parameters(graph: Graph, value: Value) -> bool:
    if value.pts or not value.deps:
        return False
    question = partial(_of_parameters, graph)
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


def _of_parameters(graph: Graph, deps: Nodes) -> bool:
    """Return whether all data of some nodes comes from parameters, unchanged."""
    pending, seen = list(deps), set(deps)
    while pending:
        node = pending.pop()
        if node in graph.parameters and not graph.data[node]:
            continue
        if node not in graph.copies and node not in graph.carried:
            return False
        if not graph.data[node]:
            return False
        new = set(graph.data[node]) - seen
        seen |= new
        pending.extend(new)
    return True
