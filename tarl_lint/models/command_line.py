"""The command line of a launched node: `sys.argv`, and the lists that a program makes from it.

The command-line arguments are constants, so topic names among them are known. In lists that the program makes
by selecting or grouping arguments, each element is tracked separately.
"""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency
from tarl_lint.memory.heap import LENGTH, item_field
from tarl_lint.memory.values import NONE, UNKNOWN, Value, const, pointer
from tarl_lint.models import sizes


def arguments(ctx: Interpreter) -> Value:
    """Return `sys.argv`."""
    return _listed(ctx, "argv", ctx.command_line)


def own_arguments(ctx: Interpreter, it: Invocation) -> Value:
    """Return the arguments without those for ROS, as `rospy.myargv` does."""
    if not ctx.command_line:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    return _listed(ctx, "own argv", [one for one in ctx.command_line if ":=" not in one])


def counted(ctx: Interpreter, it: Invocation) -> Value:
    """Return `range(...)`.

    Its numbers are listed one by one if they are few, and if they are known to matter or the run is for a launch
    file.
    """
    each = ctx.launching or sizes.counts(ctx, it.frame)
    found = [value.constant()[1] for value in it.arguments[0] if each]
    given = [one for one in found if isinstance(one, int)]
    exact = len(given) == len(found) and 0 < len(given) <= 3 and 0 not in given[2:]
    numbers = range(*given) if exact else range(0)
    if not 0 < len(numbers) <= sizes.MAX_KNOWN:
        return ctx.ops.generic(ctx, f"builtins.{it.name}", it.arguments, it.frame, it.call)
    obj = recency.allocate(ctx, "sequence", it.frame, ("counted", it.call.slot))
    for number, value in enumerate(numbers):
        ctx.store.put((obj, item_field(number)), const(value))
    ctx.store.put((obj, LENGTH), Value(NONE.union(*map(ctx.use, it.arguments[0]))))
    return pointer(obj)


def _listed(ctx: Interpreter, name: str, texts: Sequence[str]) -> Value:
    obj = recency.intern(ctx, "sequence", (name,), name)
    for number, text in enumerate(texts):
        if ctx.store.get((obj, item_field(number))) is None:
            ctx.store.put((obj, item_field(number)), const(text))
    return pointer(obj) if texts else UNKNOWN
