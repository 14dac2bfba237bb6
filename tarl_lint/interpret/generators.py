"""Generators advanced by `send` or `next`, which run the statements up to the next `yield`.

The body of a generator is executed once, when it is made, with all values that are ever sent. Its caller may go on at
every `yield`, and the rest of the body may never run.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import SUSPENDED
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import BOTTOM, NONE, UNKNOWN, Obj, Value, const, join

VALUE: Final = "<value>"  # field of a mailbox: the values that other roots have sent


def mailbox(ctx: Interpreter, frame: Frame) -> Obj:
    """Return the object that holds the values sent to the generators of a call context."""
    return recency.intern(ctx, "lib", ("mailbox", frame.id), "mailbox")


def send(ctx: Interpreter, generator: Obj, value: Value) -> None:
    """Send a value to a generator; a new value makes the roots of its body run again.

    A root that runs again does not see its own stores. For this reason, `ctx.posted` holds the data that each root
    sends.
    """
    box = generator.info
    if not isinstance(box, Obj):
        return
    updates.weaken(ctx, box, VALUE, value)
    sent = ctx.posted.setdefault(box, {})
    known = sent.get(ctx.store.root)
    both = ctx.use(value) | (known or NONE)
    if both != known:
        sent[ctx.store.root] = both
        ctx.pending.update(ctx.receivers.get(box, {}))


def step(ctx: Interpreter, generator: Obj) -> None:
    """Advance a generator by `next`: the program may go on at each `yield`. Nothing is sent."""
    box = generator.info
    if isinstance(box, Obj) and ctx.store.root not in (sent := ctx.posted.setdefault(box, {})):
        if not sent:
            ctx.pending.update(ctx.receivers.get(box, {}))
        sent[ctx.store.root] = NONE


def begin(ctx: Interpreter, frame: Frame) -> None:
    """Begin the body of a generator: at the first `send` or `next`, other code may have stored values."""
    box = mailbox(ctx, frame)
    ctx.store.reads.ask(ctx.sendings, box)
    if box in ctx.posted:
        ctx.ops.wait(ctx, frame)


def suspended(ctx: Interpreter, expr: ir.Yield, frame: Frame) -> Value:
    """Return the value of a `yield`; if `send` or `next` ever advances the generator, the caller continues here."""
    box, statement = mailbox(ctx, frame), frame.statement
    ctx.receivers.setdefault(box, {})[ctx.store.root] = None
    ctx.store.reads.ask(ctx.sendings, box)
    unused = isinstance(statement, ir.Evaluate) and statement.value is expr
    if statement is None or (unused and box not in ctx.posted):
        return UNKNOWN
    # add these conditions even if nothing has been sent yet, because nodes keep only the conditions that are known
    # when the nodes are created
    frame.function.may_leave(statement, SUSPENDED)
    if box not in ctx.posted:
        return UNKNOWN
    frame.returns.append((ctx.store.since(frame.depth_of_layers), const(None)))
    ctx.ops.wait(ctx, frame)
    stored = ctx.store.get((box, VALUE)) or BOTTOM
    return join(stored, Value(ctx.posted[box].get(ctx.store.root, NONE)))


def delegated(ctx: Interpreter, expr: ir.Yield, inner: Value, frame: Frame) -> Value:
    """Return the value of `yield from`: the values that inner generators return.

    Values that are sent are passed on to the inner generators.
    """
    sent, result = suspended(ctx, expr, frame), UNKNOWN
    generated: list[Obj] = []
    for obj in inner.objects:
        if obj.name == heap.GENERATOR:
            if sent is not UNKNOWN:
                send(ctx, obj, sent)
            returned = ctx.store.get((obj, heap.RESULT))
            result = join(result, heap.arrive(ctx, returned or BOTTOM, inner.deps))
            generated.append(obj)
    if sent is not UNKNOWN and frame.statement is not None:
        # what follows depends on whether the inner generators have ended
        ended = operators.chosen(ctx, frozenset(generated), frame, ("ended", expr.pos))
        ctx.graph.depend(ctx.condition(frame, frame.statement), ended)
    return result
