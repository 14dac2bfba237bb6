"""Calls that end the program. As a statement, such a call leaves the function like `raise SystemExit`."""

from __future__ import annotations

import ast
import re
from typing import Final

# finds a file in which `exit` or `quit` may be a function other than Python's own or that of `sys`
OWN_EXIT: Final = re.compile(
    r"\b(?:def|class|as)\s+(?:exit|quit)\b|\b(?:exit|quit)\s*=(?!=)"
    r"|\bfrom\s+(?!sys\b)\S+\s+import\b[^\n]*\b(?:exit|quit)\b"
)
EXITS: Final = frozenset(["sys.exit", "os._exit", "os.abort"])
BUILTIN_EXITS: Final = frozenset(["exit", "quit"])


def ends_program(expr: ast.expr, *, builtin: bool) -> bool:
    """Return whether an expression is a call that ends the program.

    `builtin` means that `exit` and `quit` are Python's own functions in this file.
    """
    if not isinstance(expr, ast.Call):
        return False
    function = expr.func
    if isinstance(function, ast.Name):
        return builtin and function.id in BUILTIN_EXITS
    return (
        isinstance(function, ast.Attribute)
        and isinstance(function.value, ast.Name)
        and f"{function.value.id}.{function.attr}" in EXITS
    )


def exception(call: ast.Call) -> ast.Call:
    """Return the exception that a call which ends the program raises."""
    name = ast.copy_location(ast.Name("SystemExit", ast.Load()), call.func)
    return ast.copy_location(ast.Call(name, call.args, call.keywords), call)
