"""Models of Qt's signals: emitting a signal calls the connected functions."""

from __future__ import annotations

from tarl_lint.interpret import calls
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import BOTTOM, Value, join

CONNECTED = "<connected>"  # field of a signal that holds the connected functions


def signal(
    ctx: Interpreter, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> None:
    """Connect functions to a signal of a library object, or call them when it emits."""
    signals = [o for o in base.pts if o.kind == "lib"]
    if name == "connect":
        slots = frozenset(o for v in arguments[0][:1] for o in v.pts if o.kind in CALLABLE)
        for obj in signals if slots else ():
            before = ctx.store.get((obj, CONNECTED)) or BOTTOM
            ctx.store.put((obj, CONNECTED), join(before, Value(pts=slots)))
    elif name == "emit":
        held = [v for o in signals if (v := ctx.store.get((o, CONNECTED))) is not None]
        slots = frozenset(o for v in held for o in v.pts)
        if slots:
            calls.call_value(ctx, Value(pts=slots), arguments, frame, call)
