"""The interfaces between the parts of the interpreter, and the value of an expression that is not constant."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from typing import Any, Protocol

from tarl_lint.workspace.python.values import Namespace, Scope, Unknown


class Evaluation(Protocol):
    """The evaluation of the expressions of one file."""

    trying: int  # number of `try` statements around the current expression

    @property
    def models(self) -> Mapping[str, Any]:
        """Return functions and values of libraries by full name."""

    def value(self, node: ast.expr, names: Scope) -> Any:
        """Return the value of an expression; `Unknown` if it is not constant."""

    def spend(self, steps: int = 1) -> None:
        """Count steps. Raises SpentError if the limit is reached."""

    def call(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call."""

    def imported(self, module: str) -> Namespace | None:
        """Return an imported module if it is interpreted, too."""

    def kept(self, container: Any, value: Any) -> Any:
        """Return the form in which a container stores a value."""

    def operated(self, kind: type[ast.operator], left: Any, right: Any) -> Any:
        """Return the result of an operator."""


class Execution(Evaluation, Protocol):
    """The interpretation of the statements of one file."""

    def body(self, statements: Iterable[ast.stmt], names: Scope) -> None:
        """Interpret statements in order."""

    def bind(self, target: ast.expr, value: Any, names: Scope) -> None:
        """Assign a value to a target."""

    def attribute(self, base: Any, name: str, node: ast.AST) -> tuple[Any] | None:
        """Return a tuple with an attribute of a value; None if the attribute is not known."""


def unknown(node: ast.AST) -> Unknown:
    """Return an `Unknown` for an expression."""
    return Unknown(getattr(node, "lineno", 0), ast.unparse(node)[:80])


def call_of(name: str, line: int) -> ast.Call:
    """Return a call without arguments, for functions that Python calls implicitly."""
    return ast.Call(ast.Name(name, ast.Load(), lineno=line, col_offset=0), [], [], lineno=line, col_offset=0)
