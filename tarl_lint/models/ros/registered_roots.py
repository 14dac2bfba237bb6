"""Conditions under which a program registers a callback, a timer or a thread: they decide whether it ever runs.

A root that any call registers without such a condition always runs. Whether a source reaches all of the conditions is
known only at the end, so that the conditions are connected to the root's publish calls after the fixpoint.
"""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.state import Registered
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.models.ros import publications


def note(ctx: Interpreter, root: Hashable) -> None:
    """Record that the current statement registers a root."""
    frame = ctx.stack[-1] if ctx.stack else None
    statement = frame.statement if frame is not None else None
    if frame is None or statement is None:
        if root in ctx.registered:
            ctx.registered[root].always = True
        return
    place = Place(frame, statement, "call", statement.pos)
    way = ctx.graph.node((frame.id, statement.id, "registers", *frame.turn), place, frozenset())
    known = ctx.registered.get(root)
    if known is None:
        node = ctx.graph.node(("registered", root), place, frozenset())
        known = ctx.registered[root] = Registered(node)
    known.ways.add(way)
    publications.under(ctx, frame, statement, way)
    ctx.graph.depend(way, [n for n, _ in ctx.guards])


def connect(ctx: Interpreter) -> None:
    """Let the conditions decide about the roots that are registered only under conditions that a source reaches."""
    open_roots = {root: one for root, one in ctx.registered.items() if not one.always}
    while decided := [r for r, one in open_roots.items() if all(way in ctx.graph.live for way in one.ways)]:
        for root in decided:
            one = open_roots.pop(root)
            ctx.graph.depend(one.node, sorted(one.ways))
