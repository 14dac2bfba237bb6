"""Exceptional control flow from a `raise` or a failing call to the handlers in the callers."""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import BLOCKED
from tarl_lint.ir.exception_types import UNKNOWN
from tarl_lint.memory.frames import Attempt, Escape, Frame, Leaving
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import BOTTOM, Nodes, Value, join
from tarl_lint.models.ros import publications


def leave(ctx: Interpreter, escape: Escape, frame: Frame, states: dict[int, Delta] | None = None) -> None:
    """Pass an exception to the handlers that may catch it, and to the caller unless one certainly does.

    A `finally` on the way is executed first (`try_statements.py`). `states` holds the states that earlier exceptions
    passed on at the same point; exceptions share these states. Its keys are the numbers of layers below.
    """
    states = {} if states is None else states
    for attempt in reversed(frame.tries):
        if attempt.final:
            attempt.leaving.append(Leaving(_state(ctx, attempt.depth, states), escape))
            return
        caught = attempt.catches(escape.name, ctx.exception_types)
        if caught is not False:
            attempt.raised[escape.name] = join(attempt.raised.get(escape.name, BOTTOM), escape.value)
            attempt.states.append(_state(ctx, attempt.depth, states))
        if caught:
            return
        attempt.passed.append(escape)
    escape.state = _state(ctx, frame.depth_of_layers, states)
    frame.escapes.append(escape)


def _state(ctx: Interpreter, depth: int, states: dict[int, Delta]) -> Delta:
    """Return an exception's state, without the new object if it leaves an `__init__`.

    Nothing refers to this object, unless its `__init__` has stored it elsewhere before.
    """
    known = states.get(depth)
    if known is not None:
        return known
    state = ctx.store.since(depth)
    for obj, height in ctx.building:
        if len(ctx.stack) <= height and not any(obj in v.pts for k, v in state.items() if k[0] is not obj):
            state = {k: v for k, v in state.items() if k[0] is not obj}
    states[depth] = state
    return state


def given_to_exit(ctx: Interpreter, body: Attempt, frame: Frame, pos: ir.Pos) -> list[Value]:
    """Return the arguments of `__exit__`, which say whether the body of a `with` raised, and what."""
    node = ctx.node(frame, ("exit", pos), "condition")
    error = BOTTOM
    for escape in body.passed:
        error = join(error, escape.value)
        publications.under(ctx, frame, escape.statement, node)
        if escape.decision is not None:
            ctx.graph.depend(node, (escape.decision,))
    raised = ctx.kept(node)
    return [Value(raised), Value(raised | error.deps, error.pts), Value()]


def may_fail(ctx: Interpreter, deps: Nodes, raises: str, frame: Frame, *, named: bool = False) -> None:
    """Make later statements depend on whether a library call raises for its arguments `deps`.

    Applies only if the function or a caller handles the exception; with `named`, only if the handler names the
    exception.
    """
    statement = frame.statement
    if not deps or statement is None or frame.cls is not None:
        return
    here = [t for t in frame.tries if _takes(ctx, t, raises, named)]
    if not here and not any(_takes(ctx, t, raises, named) for f in ctx.stack for t in f.tries):
        return
    raises = raises or _expected(ctx, frame)
    frame.function.may_leave(statement, raises)
    decision = ctx.condition(frame, statement)
    ctx.graph.depend(decision, deps)
    if not any(e.decision == decision and e.name == raises for e in frame.escapes):
        # the text of the exception quotes the arguments
        leave(ctx, Escape(frame, statement, raises, Value(deps), decision), frame)


def may_wait(ctx: Interpreter, decides: Nodes, frame: Frame) -> None:
    """Make the rest of a function, or of a `while` iteration, depend on the event of a waiting call.

    The rest of the callers depends on the event, too. If the call is in a `while` with a condition, statements after
    this loop do not, just as they do not depend on the condition.
    """
    statement = frame.statement
    if not decides or statement is None or frame.cls is not None:
        return
    frame.function.may_leave(statement, BLOCKED)
    decision = ctx.condition(frame, statement)
    ctx.graph.depend(decision, decides)
    if statement.id not in ctx.control(frame).kept_inside or frame.function.generator:
        frame.blocked[decision] = None


def _expected(ctx: Interpreter, frame: Frame) -> str:
    """Return the exception that the innermost `try` expects from a library call, such as of tf2.

    Return UNKNOWN if its handlers name no class of a library.
    """
    for attempt in (t for f in (frame, *reversed(ctx.stack)) for t in reversed(f.tries)):
        if _takes(ctx, attempt, UNKNOWN, named=False):
            named = [
                name for handled in attempt.handlers for name in ctx.exception_types.of_libraries(handled)
            ]
            return named[0] if named else UNKNOWN
    return UNKNOWN


def escaped(ctx: Interpreter, frame: Frame, caller: Frame) -> None:
    """Make statements after a call depend on whether the called function raises, as after a `raise`.

    Without a handler, assertions and calls in a loop are ignored. Otherwise, the statements after the loop would
    depend on the number of its iterations.
    """
    statement = caller.statement
    if statement is None:
        return
    ctx.store.push(frame.thrown)
    by_name: dict[str, Escape] = {}  # several calls may raise the same exception; it leaves the caller once
    for escape in frame.escapes:
        if (caller.jumps or _bare(escape.statement)) and not _handled(ctx, escape.name):
            continue
        if caller.cls is None:
            caller.function.may_leave(statement, escape.name)
        decision = ctx.condition(caller, statement)
        publications.under(ctx, escape.frame, escape.statement, decision)
        if escape.decision is not None:
            ctx.graph.depend(decision, (escape.decision,))
        same = by_name.setdefault(escape.name, Escape(caller, statement, escape.name, escape.value, decision))
        same.value = join(same.value, escape.value)
    states: dict[int, Delta] = {}
    for escape in by_name.values():
        leave(ctx, escape, caller, states)
    ctx.store.pop()


def _handled(ctx: Interpreter, name: str) -> bool:
    """Return whether the running functions may handle an exception."""
    return any(t.catches(name, ctx.exception_types) is not False for f in ctx.stack for t in f.tries)


def _bare(statement: ir.Stmt) -> bool:
    """Return whether a statement raises without naming an exception: an assertion or a bare `raise`."""
    return isinstance(statement, ir.Raise) and statement.value is None


def _takes(ctx: Interpreter, attempt: Attempt, raises: str, named: bool) -> bool:
    """Return whether a `try` may handle an exception; with `named`, by its name."""
    if named:
        return attempt.names(raises, ctx.exception_types)
    return attempt.catches(raises, ctx.exception_types) is not False
