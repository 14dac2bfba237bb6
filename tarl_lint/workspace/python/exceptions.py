"""Exceptions of an interpreted file, and the statements that catch them: `try` and `with`."""

from __future__ import annotations

import ast
from typing import Any

from tarl_lint.workspace.python.evaluation import Evaluation, Execution, call_of, unknown
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.jumps import Left, Raised, Returned
from tarl_lint.workspace.python.objects import Class
from tarl_lint.workspace.python.values import Scope, Suppressed, Suspended, Unknown


def raised(run: Evaluation, statement: ast.Raise, names: Scope) -> Raised:
    """Return the exception of a `raise` statement with a value."""
    line = statement.lineno
    value = run.value(statement.exc, names) if statement.exc is not None else None
    if isinstance(value, Class) or (isinstance(value, type) and issubclass(value, BaseException)):
        value = run.call(value, [], {}, call_of("an exception", line))
    known = isinstance(value, BaseException) or (isinstance(value, Made) and value.kind.error() is not None)
    return Raised(line, value if known else None)


def catches(kinds: Any, error: Any) -> bool | None:
    """Return whether a handler for some exceptions catches an exception; None if that is not known."""
    unsure = False
    for one in kinds if isinstance(kinds, tuple | list) else (kinds,):
        found = _catches_one(one, error)
        if found:
            return True
        unsure = unsure or found is None
    return None if unsure else False


def _catches_one(kind: Any, error: Any) -> bool | None:
    if error is None:
        return None
    if isinstance(error, Made):
        own = error.kind.error()
        if isinstance(kind, Class):
            return error.kind.is_a(kind)
        return own is not None and issubclass(own, kind) if isinstance(kind, type) else None
    if isinstance(kind, type):
        return isinstance(error, kind)
    # the exception is from another library, not one of Python's own
    return None if isinstance(kind, Unknown) else False


def handler(run: Evaluation, statement: ast.Try, error: Any, names: Scope) -> ast.ExceptHandler | None:
    """Return the handler of a `try` statement for an exception; if this is uncertain, the first possible handler."""
    for one in statement.handlers:
        found = True if one.type is None else catches(run.value(one.type, names), error)
        if found is not False:
            return one
    return None


def run_try(run: Execution, handled: list[Raised], statement: ast.Try, names: Scope) -> None:
    """Interpret a `try` statement; `handled` are the exceptions whose handlers are being interpreted."""
    try:
        try:
            run.trying += bool(statement.handlers)
            try:
                run.body(statement.body, names)
            finally:
                run.trying -= bool(statement.handlers)
            run.body(statement.orelse, names)
        except Raised as left:
            found = handler(run, statement, left.error, names)
            if found is None:
                raise
            if found.name is not None:
                error = Unknown(left.line, "an exception") if left.error is None else left.error
                names.store(found.name, error)
            handled.append(left)
            try:
                run.body(found.body, names)
            finally:
                handled.pop()
    finally:
        run.body(statement.finalbody, names)


def run_with(run: Execution, statement: ast.With, names: Scope) -> None:
    """Interpret a `with` statement; the exceptions of `contextlib.suppress` end its body."""
    entered: list[Made] = []
    suppressed: list[Suppressed] = []
    for index, item in enumerate(statement.items):
        value = run.value(item.context_expr, names)
        if isinstance(value, Suspended):
            rest = ast.copy_location(ast.With(statement.items[index + 1 :], statement.body), statement)
            _inside(run, value, item.optional_vars, rest, names)
            return
        suppressed += [value] if isinstance(value, Suppressed) else []
        if isinstance(value, Made) and value.has("__enter__"):
            entered.append(value)
            value = _special(run, value, "__enter__", [], statement.lineno)
        if item.optional_vars is not None:
            run.bind(item.optional_vars, value, names)
    run.trying += bool(suppressed)
    try:
        run.body(statement.body, names)
    except Raised as left:
        if not any(catches(one.kinds, left.error) is not False for one in suppressed):
            raise
    finally:
        run.trying -= bool(suppressed)
        for one in reversed(entered):
            if one.has("__exit__"):
                _special(run, one, "__exit__", [None, None, None], statement.lineno)


def _inside(
    run: Execution, manager: Suspended, target: ast.expr | None, rest: ast.With, names: Scope
) -> None:
    """Interpret a `with` block at the `yield` of its context manager, and then the rest of that function."""
    left: list[Exception] = []

    def entered(value: Any) -> None:
        if target is not None:
            run.bind(target, value, names)
        try:
            run_with(run, rest, names)
        except (Returned, Left) as jump:
            left.append(jump)

    manager.run(entered)
    if left:
        raise left[0]


def _special(run: Execution, value: Made, name: str, args: list[Any], line: int) -> Any:
    """Return the result of a special method that a statement calls."""
    call = call_of(name, line)
    method = run.attribute(value, name, call)
    return unknown(call) if method is None else run.call(method[0], args, {}, call)
