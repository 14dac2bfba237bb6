"""Exceptional control flow from a `raise` or a failing call to handlers in callers."""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Attempt, Escape, Frame
from tarl_lint.memory.values import BOTTOM, Nodes, join
from tarl_lint.models.ros import publications


def leave(ctx: Interpreter, escape: Escape, frame: Frame) -> None:  # noqa: ARG001 - shared signature
    """Pass an exception to the innermost handler in the function, or else out of the function."""
    attempt = next((t for t in reversed(frame.tries) if t.handled), None)
    if attempt is not None:
        attempt.raised = join(attempt.raised, escape.value)
    else:
        frame.escapes.append(escape)


def may_fail(ctx: Interpreter, deps: Nodes, raises: str, frame: Frame, *, named: bool = False) -> None:
    """Make later statements depend on whether a library call raises for its arguments `deps`.

    Applies only if the function or a caller handles the exception; with `named`, only if it does so by name.
    """
    statement = frame.statement
    if not deps or statement is None or frame.cls is not None:
        return
    here = any(_takes(t, raises, named) for t in frame.tries)
    if not here and not any(_takes(t, raises, named) for f in ctx.stack for t in f.tries):
        return
    known = frame.function.raising.setdefault(statement.id, {})
    if raises not in known:
        known[raises] = None
        frame.function.control = None
    decision = ctx.condition(frame, statement)
    ctx.graph.depend(decision, deps)
    if not here and not any(e.decision == decision for e in frame.escapes):
        frame.escapes.append(Escape(frame, statement, raises, BOTTOM, decision))


def escaped(ctx: Interpreter, frame: Frame, caller: Frame) -> None:
    """Make statements after a call depend on whether the called function raises, as after a `raise`.

    Where no handler is found, assertions and calls in a loop are ignored: the statements after the loop would
    otherwise depend on the number of its iterations.
    """
    statement = caller.statement
    if statement is None:
        return
    handled = any(t.handled for f in ctx.stack for t in f.tries)
    for escape in frame.escapes:
        if not handled and (caller.jumps or _bare(escape.statement)):
            continue
        known = caller.function.raising.setdefault(statement.id, {})
        if escape.name not in known and caller.cls is None:
            known[escape.name] = None
            caller.function.control = None
        decision = ctx.condition(caller, statement)
        publications.under(ctx, escape.frame, escape.statement, decision)
        if escape.decision is not None:
            ctx.graph.depend(decision, (escape.decision,))
        leave(ctx, Escape(caller, statement, escape.name, escape.value, decision), caller)


def _bare(statement: ir.Stmt) -> bool:
    """Return whether a statement raises without naming an exception: an assertion or a bare `raise`."""
    return isinstance(statement, ir.Raise) and statement.value is None


def _takes(attempt: Attempt, raises: str, named: bool) -> bool:
    """Return whether a `try` handles an exception, judged by its name."""
    if named or (raises and attempt.takes):
        return raises in attempt.takes
    return attempt.handled
