"""The patterns of `match` statements."""

from __future__ import annotations

import ast
from typing import Any

from tarl_lint.workspace.expressions import Evaluator
from tarl_lint.workspace.python_values import Library, Scope, Unknown


def fits(evaluator: Evaluator, pattern: ast.pattern, subject: Any, names: Scope) -> Any:
    """Return whether a subject fits a pattern, and bind the names of the pattern; Unknown if this is not constant.

    Only patterns of constants and names, and alternatives of these, are compared.
    """
    if isinstance(pattern, ast.MatchAs):
        fit = True if pattern.pattern is None else fits(evaluator, pattern.pattern, subject, names)
        if fit is True and pattern.name is not None:
            names.store(pattern.name, subject)
        return fit
    if isinstance(pattern, ast.MatchOr):
        found = [fits(evaluator, one, subject, names) for one in pattern.patterns]
        return next((one for one in found if one is True), next((one for one in found if one), False))
    if isinstance(subject, Unknown | Library):
        return Unknown(pattern.lineno, "the subject")
    if isinstance(pattern, ast.MatchValue):
        return evaluator.compared(ast.Eq, subject, evaluator.value(pattern.value, names))
    if isinstance(pattern, ast.MatchSingleton):
        return subject is pattern.value
    return Unknown(pattern.lineno, "a pattern")
