"""Models of `heapq` and `bisect` that add elements to a list, and take them out of it."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory.values import UNKNOWN, Value
from tarl_lint.models import containers, ordering, removal

TAKING: Final = frozenset(["heapq.heappushpop", "heapq.heapreplace"])


def pushed(ctx: Interpreter, it: Invocation) -> Value:
    """Add an element; in `heappushpop` and `heapreplace`, also remove the smallest element and return it."""
    given = it.arguments[0]
    if len(given) < 2:
        return Value(call_contexts.all_used(ctx, it.arguments))
    containers.insert_elements(ctx, given[0], [given[1]], it.frame, it.call)
    return popped(ctx, it) if it.name in TAKING else UNKNOWN


def popped(ctx: Interpreter, it: Invocation) -> Value:
    """Remove the smallest element and return it; the remaining elements depend on the values that are compared."""
    if not it.arguments[0]:
        return Value(call_contexts.all_used(ctx, it.arguments))
    base = it.arguments[0][0]
    result = ordering.ordered(ctx, containers.elements_of_any(ctx, base), it)
    decides = ctx.use(Value(result.deps))
    decided = removal.decision(ctx, it.frame, it.call.slot, decides, base=base.deps)
    containers.take_any(ctx, base, decided, it.frame, it.call)
    return Value(result.deps | base.deps, result.pts, result.consts)
