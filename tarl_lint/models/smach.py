"""Models of smach's state machines: states added by calls, and states made of functions."""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency, userdata
from tarl_lint.memory.values import UNKNOWN, Value, pointer

# kinds of objects that a library can call if it gets them as arguments
LATER = frozenset(["closure", "bound", "partial"])


def add_state(ctx: Interpreter, it: Invocation) -> Value:
    """Add a state to a machine; `remapping` maps its names to shared fields."""
    plain, named = it.arguments
    states = plain[1] if len(plain) > 1 else named.get("state", UNKNOWN)
    remapping = plain[3] if len(plain) > 3 else named.get("remapping", UNKNOWN)
    ctx.look(remapping.pts)
    for table in remapping.objects:
        held = ((n, ctx.store.get((table, n))) for n in list(table.fields) if n.startswith("['"))
        pairs = [(n[2:-2], v.texts()[0]) for n, v in held if v is not None and v.texts()]
        for state in states.objects:
            userdata.rename(ctx, state, pairs)
    return UNKNOWN


def state_by_callbacks(ctx: Interpreter, it: Invocation) -> Value:
    """Create a state from functions, which get the shared userdata."""
    state = recency.allocate(ctx, "lib", it.frame, ("made", it.call.slot))
    for value in (*it.arguments[0], *it.arguments[1].values()):
        for target in value.objects:
            if target.kind in LATER:
                ctx.ops.call_later(ctx, target, [userdata.userdata(ctx, state)])
    return pointer(state)
