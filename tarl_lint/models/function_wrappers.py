"""Models of `functools.wraps` and `functools.update_wrapper`: a wrapper has the attributes of its function."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import expressions
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency, updates
from tarl_lint.memory.function_attributes import WRAPPED
from tarl_lint.memory.values import UNKNOWN, Value, pointer

WRAPS: Final = "functools.wraps"
UPDATES: Final = "functools.update_wrapper"


def wraps(ctx: Interpreter, it: Invocation) -> Value:
    """Return the decorator `wraps(function)`, which is `partial(update_wrapper, wrapped=function)`."""
    given = it.argument((0, "wrapped"))
    obj = recency.intern(ctx, "partial", (it.frame.id, it.statement, it.call.slot, *it.frame.turn), it.name)
    obj.describe((expressions.external(ctx, UPDATES), [], {"wrapped": given}))
    return pointer(obj)


def update_wrapper(ctx: Interpreter, it: Invocation) -> Value:
    """Return the wrapper; attributes that it does not set itself are those of the wrapped function."""
    wrapper, wrapped = it.argument((0, "wrapper")), it.argument((1, "wrapped"))
    functions = frozenset(o for o in wrapped.pts if o.kind in ("closure", "bound"))
    if functions and any(o.kind == "closure" for o in wrapper.pts):
        updates.write_field(ctx, wrapper, WRAPPED, Value(pts=functions))
    return wrapper if wrapper.pts else UNKNOWN
