"""Calls that need what other code provides: an element of a queue, or an event that is set.

The code after a call that waits depends on the conditions under which the other code runs. If the call raises an
exception instead of waiting, these conditions decide whether the handler runs.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import operators
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import BOTTOM, NONE, Nodes, Obj, Value, const
from tarl_lint.models import removal

FLAG: Final = "<flag>"  # field of an event: whether it is set
# method that takes an element out of a container → the exception that the method raises if there is no element; ""
# if unknown
RAISED: Final = {"get_nowait": "", "pop": "IndexError", "popleft": "IndexError"}


def note_filling(ctx: Interpreter, base: Value, frame: Frame, call: ir.Call) -> None:
    """Record that the current statement fills containers or sets events, for code that waits for them."""
    for obj in base.pts if frame.statement is not None else ():
        if obj.kind in ("sequence", "lib"):
            ctx.filled.setdefault(obj.site, set()).add(ctx.node(frame, ("stored", call.slot, 0), "call"))


def wait_for_element(ctx: Interpreter, it: Invocation) -> None:
    """Wait until another thread puts an element into a queue; meanwhile, other code stores values."""
    ctx.ops.wait(ctx, it.frame)
    if not ctx.always_filled(it.base.objects):
        ctx.ops.may_wait(ctx, _got(ctx, it.base.pts, it), it.frame)


def may_be_empty(ctx: Interpreter, it: Invocation, raises: str) -> None:
    """Let a handler run if nothing has been put into a container."""
    if (it.frame.tries or len(ctx.stack) > 1) and not ctx.always_filled(it.base.objects):
        ours = frozenset(o for o in it.base.pts if o.kind in removal.CONTAINERS)
        ctx.ops.may_fail(ctx, _got(ctx, ours, it), raises, it.frame, named=raises != "")


def wait_for_flag(ctx: Interpreter, it: Invocation) -> None:
    """Wait until another thread sets an event, or notifies a condition; meanwhile, other code stores values."""
    ctx.ops.wait(ctx, it.frame)
    flags = [v for o in it.base.objects if (v := ctx.store.get((o, FLAG))) is not None]
    if flags and not ctx.always_filled(it.base.objects):
        node = ctx.node(it.frame, ("awaited", it.call.slot), "condition")
        ctx.graph.choice(NONE.union(*(v.deps for v in flags)), node)
        ctx.ops.may_wait(ctx, ctx.kept(node), it.frame)


def wait_for_condition(ctx: Interpreter, it: Invocation) -> Value | None:
    """Wait until a predicate holds, as in `condition.wait_for(lambda: self.ready)`; None for another method.

    The result of the predicate decides what follows. With a time-out, the call returns this result.
    """
    plain, named = it.arguments
    predicate = plain[0] if plain else named.get("predicate", BOTTOM)
    if not any(o.kind in CALLABLE for o in predicate.pts) or not any(o.kind == "lib" for o in it.base.pts):
        return None
    ctx.ops.wait(ctx, it.frame)
    found = ctx.ops.call_value(ctx, predicate, ([], {}), it.frame, it.call.inner_bare())
    decides = operators.truth(ctx, found, it.frame, ("awaited", it.call.slot))
    if len(plain) < 2 and "timeout" not in named:
        ctx.ops.may_wait(ctx, decides, it.frame)
        return const(value=True)
    return Value(decides)


def _got(ctx: Interpreter, containers: frozenset[Obj], it: Invocation) -> Nodes:
    """Return the node that decides whether a call gets an element; empty if no data decides this."""
    return operators.chosen(ctx, containers, it.frame, ("got", it.call.slot))
