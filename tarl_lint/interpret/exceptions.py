"""Exceptions on their way from a `raise` in a function to the handler in a caller."""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Attempt, Escape, Frame
from tarl_lint.memory.values import BOTTOM, Nodes, join
from tarl_lint.models.ros import publications


def leave(ctx: Interpreter, escape: Escape, frame: Frame) -> None:  # noqa: ARG001 - one signature for all
    """Hand an exception to the handlers around it in the function, else out of the function."""
    attempt = next((t for t in reversed(frame.tries) if t.handled), None)
    if attempt is not None:
        attempt.raised = join(attempt.raised, escape.value)
    else:
        frame.escapes.append(escape)


def may_fail(ctx: Interpreter, deps: Nodes, raises: str, frame: Frame, *, named: bool = False) -> None:
    """Let what comes after a statement depend on whether a library can do with what it is given.

    Only where somebody takes what it raises, in the function or in one that called it; `named`: by its name.
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
    """Let what comes after a call depend on whether the called function raises, as after a `raise` of its own.

    Where nobody takes it, assertions do not count, nor calls in a loop: what comes after the loop would depend on
    how often it runs.
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
    """Tell whether a statement raises without naming what, as an assertion does."""
    return isinstance(statement, ir.Raise) and statement.value is None


def _takes(attempt: Attempt, raises: str, named: bool) -> bool:
    """Tell whether a `try` handles an exception, as far as its name tells."""
    if named or (raises and attempt.takes):
        return raises in attempt.takes
    return attempt.handled
