"""Defaults of entries in tables of parameters: the default of `rospy.get_param("~", {}).get("gain", 0.3)` is 0.3."""

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
    if default is None or value.pts or not value.deps:
        return None
    question = partial(_of_parameters, ctx.graph)
    ctx.graph.reads.ask(question, value.deps)
    return default if question(value.deps) else None


def _default(expr: ir.Expr) -> ir.Const | None:
    """Return the number in `table.get("gain", 0.3)` or `float(table.get("gain", 0.3))`."""
    while isinstance(expr, ir.Call) and isinstance(expr.function, ir.Name):
        if expr.function.name not in CONVERSIONS or len(expr.arguments) != 1:
            return None
        expr = expr.arguments[0]
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
