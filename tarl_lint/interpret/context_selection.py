"""Select a call's context: its own, or a shared one for a function with too many."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise

from tarl_lint.interpret import shared_contexts
from tarl_lint.interpret.budget import (
    MAX_CALLS,
    MAX_DELEGATIONS,
    MAX_FRAMES,
    SEPARATE_CALLS,
    SEPARATE_STATEMENTS,
)
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import generations
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Obj, Value


def make_frame(
    ctx: Interpreter, closure: Obj, arguments: Arguments, caller: Frame, call: ir.Call, owner: Obj | None
) -> Frame | None:
    """Return the frame for this call; None if a limit is reached."""
    if not isinstance(closure.info, tuple):
        return None
    function = closure.info[0]
    runs = ctx.work.activations.get(function, 0) + 1
    receiver = arguments[0][0].pts if owner is not None and arguments[0] else None
    if len(ctx.stack) > MAX_CALLS or _recurs(ctx, closure, receiver, arguments):
        return None
    if ctx.work.charged > ctx.work.limit:
        _cut(ctx)
        return None
    statement = caller.statement.id if caller.statement is not None else -1
    own = (caller.id, statement, call.slot, closure.key, receiver, *caller.turn)
    often = ctx.work.executed > SEPARATE_STATEMENTS and runs > SEPARATE_CALLS
    endless = ctx.closure_chains and own not in ctx.frames and generations.too_many_closures(ctx, caller)
    if (often or endless) and shared_contexts.may_share(arguments):
        ctx.widened.add(own)
    ctx.store.reads.ask(ctx.widened.__contains__, own)
    shares = own in ctx.widened
    key = shared_contexts.shared_key(own, ctx.store.root.key, arguments) if shares else own
    frame = ctx.frames.get(key)
    if frame is None:
        path = ctx.store.root.program
        made = ctx.work.frames_of[path] = ctx.work.frames_of.get(path, 0) + 1
        if made > MAX_FRAMES:
            _cut(ctx)
            return None
        frame = _new_frame(ctx, closure, key, caller, call, owner)
        frame.shared = shares
        frame.base = (
            shared_contexts.conditions(ctx, frame) if shares else ctx.calling(caller) | frozenset(ctx.guards)
        )
    return None if shares and frame in ctx.stack else frame


def _recurs(ctx: Interpreter, closure: Obj, receiver: frozenset[Obj] | None, arguments: Arguments) -> bool:
    """Return whether a call is a recursion that is too deep.

    A call of the same function for another object, such as a part of a composite, is no recursion. Neither is a
    call of another closure of the same code, or a call for an element of a tuple or list of the running call.
    """
    function = closure.info[0] if isinstance(closure.info, tuple) else None
    running = [f for f in ctx.stack if f.function is function]
    if len(running) <= 1 or len(running) > MAX_DELEGATIONS:
        return len(running) > 1
    keys = [frame.key for frame in running]
    same = sum(isinstance(key, tuple) and key[3:5] == (closure.key, receiver) for key in keys) > 1
    return same and not _descends(ctx, [*(frame.arguments for frame in running), arguments[0]])


def _descends(ctx: Interpreter, calls: Sequence[Sequence[Value]]) -> bool:
    """Return whether one argument of each nested call is a certain element of that of the call around it."""
    return any(
        all(_is_element(ctx, outer, inner) for outer, inner in pairwise(way))
        for way in zip(*calls, strict=False)
    )


def _is_element(ctx: Interpreter, outer: Value, inner: Value) -> bool:
    """Return whether a value is one tuple, list or text in a known place of a tuple or list."""
    if len(outer.pts) != 1 or outer.deps or inner.deps or not (len(inner.pts) == 1 or inner.fixed()):
        return False
    (holder,) = outer.pts
    if holder.kind != "sequence" or holder.many or any(o.kind != "sequence" for o in inner.pts):
        return False
    return any(
        one.pts == inner.pts and one.consts == inner.consts for one in ctx.ops.unpacked(ctx, outer) or ()
    )


def _new_frame(
    ctx: Interpreter, closure: Obj, key: Hashable, caller: Frame, call: ir.Call, owner: Obj | None
) -> Frame:
    if not isinstance(closure.info, tuple):
        raise TypeError(f"{closure!r} is not a function")
    function, outer, program, cls = closure.info
    frame = Frame(key, len(ctx.frames) + 1, function, program, ctx.module_objects[program.name])
    ctx.frames[key] = frame
    frame.caller, frame.call, frame.slot, frame.outer = caller, caller.statement, call.slot, outer
    frame.call_pos, frame.called_in = call.pos, caller.turns
    frame.owner = owner or cls
    frame.answer = caller.answer if caller.statement is None and caller.caller is None else None
    return frame


def _cut(ctx: Interpreter) -> None:
    """Note that the analysis of the program is incomplete."""
    ctx.cut[ctx.program] = None
    ctx.store.reads.whole = False
