"""Widened call contexts: where an entry point calls one function very often, its further calls share a context.

A context of its own for each call keeps callers apart, but the number of contexts is a product along chains of calls.
Calls that share a context are analysed like the turns of a loop: arguments and conditions of all of them are joined, so
that no flow is missed; data of one caller may appear to reach what only another one does.
"""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import MERGED, Place
from tarl_lint.memory.values import Branches, Value, join

CALLED = -1  # stands for the statement of the decision that a shared context runs at all
CALLBACKS = frozenset(["closure", "bound", "partial", "method"])


def may_share(arguments: Arguments) -> bool:
    """Tell whether a call may share a context: a subscription is told by the call that supplies its callback."""
    plain, named = arguments
    return not any(obj.kind in CALLBACKS for value in (*plain, *named.values()) for obj in value.pts)


def shared_key(own: tuple[Hashable, ...], root: Hashable, arguments: Arguments) -> Hashable:
    """Return the key of the context that calls share: of one entry point, function, receiver and kind of arguments.

    `own` is the key that the call would have for itself: caller, statement, slot, function, receiver.
    """
    plain, named = arguments
    return ("shared", root, (len(plain), *sorted(named)), own[3], own[4])


def conditions(ctx: Interpreter, frame: Frame) -> Branches:
    """Return the condition of everything in a shared context: that any of its calls runs."""
    return frozenset([ctx.branch(frame, (CALLED, "called"))])


def enter(ctx: Interpreter, frame: Frame, caller: Frame, passed: Arguments) -> Arguments:
    """Add a call to a shared context; return the arguments of all calls so far, joined one by one.

    The data of each parameter arrives by one node, so that one more call is an edge and no news.
    """
    ((called, _),) = conditions(ctx, frame)
    above = ctx.branches(caller, caller.statement) | frozenset(ctx.guards)
    ctx.graph.depend(called, [decision for decision, _ in above if decision != called])
    plain = [_arriving(ctx, frame, number, value) for number, value in enumerate(passed[0])]
    named = {name: _arriving(ctx, frame, name, value) for name, value in passed[1].items()}
    before = frame.passed
    if before is not None:
        plain = [join(a, b) for a, b in zip(before[0], plain, strict=True)]
        named = {name: join(before[1][name], value) for name, value in named.items()}
    frame.passed = plain, named
    return frame.passed


def _arriving(ctx: Interpreter, frame: Frame, parameter: Hashable, value: Value) -> Value:
    """Return an argument as it arrives in a shared context."""
    if not value.deps:
        return value
    place = Place(frame, None, MERGED, (0, 0, 0, 0))
    node = ctx.graph.node((frame.id, "parameter", parameter), place, frame.base)
    return ctx.carry(value, node)
