"""Shared call contexts: if a root calls one function very often, further calls of it share a context.

Separate contexts distinguish callers, but the number of contexts multiplies along call chains. Calls that share a
context are analysed like iterations of a loop: their arguments and conditions are joined. No flow is missed,
but the report may connect data of one caller with effects of another caller.
"""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import MERGED, Place
from tarl_lint.memory.values import Branches, Value, join

CALLED = -1  # number of a pseudo-statement that decides whether a shared context runs
CALLBACKS = frozenset(["closure", "bound", "partial", "method"])


def may_share(arguments: Arguments) -> bool:
    """Return whether a call may share a context.

    A call that passes a callback may not, because such a call identifies a subscription.
    """
    plain, named = arguments
    return not any(obj.kind in CALLBACKS for value in (*plain, *named.values()) for obj in value.pts)


def shared_key(own: tuple[Hashable, ...], root: Hashable, arguments: Arguments) -> Hashable:
    """Return the key of a shared context: root, function, receiver and kinds of arguments.

    `own` is the key of the call's own context: caller, statement, slot, function, receiver.
    """
    plain, named = arguments
    return ("shared", root, (len(plain), *sorted(named)), own[3], own[4])


def conditions(ctx: Interpreter, frame: Frame) -> Branches:
    """Return the condition of a shared context: that one of its calls runs."""
    return frozenset([ctx.branch(frame, (CALLED, "called"))])


def enter(ctx: Interpreter, frame: Frame, caller: Frame, passed: Arguments) -> Arguments:
    """Add a call to a shared context; return the joined arguments of all its calls so far.

    Each parameter has one node for its data, so a further call adds an edge and changes no value.
    """
    ((called, _),) = conditions(ctx, frame)
    above = ctx.calling(caller) | frozenset(ctx.guards)
    ctx.graph.depend(called, [decision for decision, _ in above if decision != called])
    plain = [_arriving(ctx, frame, number, value) for number, value in enumerate(passed[0])]
    named = {name: _arriving(ctx, frame, name, value) for name, value in passed[1].items()}
    before = frame.passed
    if before is not None:
        plain = [join(a, b) for a, b in zip(before[0], plain, strict=True)]
        named = {name: join(before[1][name], value) for name, value in named.items()}
    frame.passed = plain, named
    return frame.passed


def leave(ctx: Interpreter, frame: Frame, result: Value) -> Value:
    """Return the result of a call as its caller gets it.

    A caller reads the result only if its own call runs, so the conditions of other calls do not decide the result.
    Conditions inside the calling expression, such as the choice between several callees, decide it.
    """
    ((called, _),) = conditions(ctx, frame)
    instead = frozenset(ctx.guards)
    deps = frozenset(ctx.graph.under(dep, called, instead) for dep in result.deps)
    return Value(deps, result.pts, result.consts)


def _arriving(ctx: Interpreter, frame: Frame, parameter: Hashable, value: Value) -> Value:
    """Return an argument as passed through its parameter's node."""
    if not value.deps:
        return value
    place = Place(frame, None, MERGED, (0, 0, 0, 0))
    node = ctx.graph.node((frame.id, "parameter", parameter), place, frame.base)
    return ctx.carry(value, node)
