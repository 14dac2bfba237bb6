"""Transfer function of `try`."""

from __future__ import annotations

from typing import Literal

from tarl_lint.interpret import exceptions
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.exception_types import handled_by
from tarl_lint.memory import joins
from tarl_lint.memory.frames import Attempt, Escape, Frame, Leaving
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import UNKNOWN, Value, join_all


def try_statement(ctx: Interpreter, s: ir.Try, frame: Frame) -> bool:
    """Execute a `try`. Return whether execution continues after it."""
    if not s.final:
        return _handled(ctx, s, frame)
    depth = len(ctx.store.layers)
    ctx.store.push()
    around = Attempt(depth, [], final=True)
    frame.tries.append(around)
    goes_on = _handled(ctx, s, frame)
    frame.tries.pop()
    ends: list[Delta] = []
    if goes_on and ctx.ops.block(ctx, s.final, frame):
        ends.append(ctx.store.since(depth))
    ctx.store.cut(depth)
    for leaving in _together(ctx, around.leaving):
        ctx.store.push(leaving[0].state)
        if ctx.ops.block(ctx, s.final, frame):
            states: dict[int, Delta] = {}
            for one in leaving:
                _leave(ctx, one, frame, states)
        ctx.store.cut(depth)
    if ends:
        joins.merge(ctx, ends)
    return bool(ends)


def _together(ctx: Interpreter, leaving: list[Leaving]) -> list[list[Leaving]]:
    """Group the ways to leave a `try` by kind.

    Each group has one state, in which the `finally` is executed once.
    """
    groups: dict[object, list[Leaving]] = {}
    for one in leaving:
        groups.setdefault(one.cause if isinstance(one.cause, str) else type(one.cause), []).append(one)
    for group in groups.values():
        group[0].state = joins.joined(ctx, [one.state for one in group])
    return list(groups.values())


def _leave(ctx: Interpreter, leaving: Leaving, frame: Frame, states: dict[int, Delta]) -> None:
    """After a `finally`, continue the exception, the `return` or the jump that it interrupted."""
    cause = leaving.cause
    if isinstance(cause, Escape):
        exceptions.leave(ctx, cause, frame, states)
    elif isinstance(cause, Value):
        returned(ctx, cause, frame)
    else:
        jumped(ctx, cause, frame)


def returned(ctx: Interpreter, value: Value, frame: Frame) -> None:
    """Return a value from a function after executing every enclosing `finally`."""
    around = next((t for t in reversed(frame.tries) if t.final), None)
    if around is not None:
        around.leaving.append(Leaving(ctx.store.since(around.depth), value))
    else:
        frame.returns.append((ctx.store.since(frame.depth_of_layers), value))


def jumped(ctx: Interpreter, kind: Literal["break", "continue"], frame: Frame) -> None:
    """Leave an iteration of a loop after executing every enclosing `finally` inside the loop."""
    if not frame.jumps:
        return
    depth, table = frame.jumps[-1]
    around = next((t for t in reversed(frame.tries) if t.final and t.depth >= depth), None)
    if around is not None:
        around.leaving.append(Leaving(ctx.store.since(around.depth), kind))
    else:
        table[kind].append(ctx.store.since(depth))


def _handled(ctx: Interpreter, s: ir.Try, frame: Frame) -> bool:
    """Execute a `try` without its `finally`.

    A handler can be entered before and after every statement of the body.
    """
    depth = len(ctx.store.layers)
    ctx.condition(frame, s)
    ctx.store.push()
    attempt = Attempt(depth, [{}], tuple(handled_by(types) for types, _, _ in s.handlers))
    frame.tries.append(attempt)
    goes_on = True
    for statement in s.body:
        goes_on = ctx.ops.block(ctx, [statement], frame)
        if not goes_on:
            break
        if s.handlers:
            attempt.states.append(ctx.store.since(depth))
    frame.tries.pop()
    ends: list[Delta] = []
    if goes_on and ctx.ops.block(ctx, s.orelse, frame):
        ends.append(ctx.store.since(depth))
    ctx.store.cut(depth)
    if s.handlers:
        ends += _handlers(ctx, s, attempt, frame)
    if ends:
        joins.merge(ctx, ends)
    return bool(ends)


def _handlers(ctx: Interpreter, s: ir.Try, attempt: Attempt, frame: Frame) -> list[Delta]:
    """Execute the handlers; return the states after them."""
    depth = len(ctx.store.layers)
    start = joins.joined(ctx, attempt.states)
    ends: list[Delta] = []
    for handled, (_, name, body) in zip(attempt.handlers, s.handlers, strict=True):
        ctx.store.push(start)
        caught = attempt.caught(handled, ctx.exception_types)
        if name is not None:
            raised = join_all(caught.values())
            ctx.ops.assign(ctx, name, raised if raised.deps or raised.pts else UNKNOWN, frame)
        frame.handling.append(caught)
        if ctx.ops.block(ctx, body, frame):
            ends.append(ctx.store.since(depth))
        frame.handling.pop()
        ctx.store.cut(depth)
    return ends
