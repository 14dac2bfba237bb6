"""Conversions that cannot fail: of numeric fields of messages, and of variables that a test has shown to be numbers."""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import message_types


def certain(ctx: Interpreter, name: str, arguments: Arguments, call: ir.Call) -> bool:
    """Return whether `float` or `int` converts a number; `int` fails for NaN, so it needs a whole number."""
    if name not in ("float", "int") or len(arguments[0]) != 1 or arguments[1]:
        return False
    return call.certain or message_types.is_number(ctx, arguments[0][0], whole=name == "int")
