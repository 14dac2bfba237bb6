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
    known = ctx.registered.setdefault(root, Registered())
    if frame is None or statement is None:
        known.plain.add(None)
        return
    key = (frame.id, statement.id, "registers", *frame.turn)
    around = ctx.registered.get(ctx.store.root.key)  # the root that registers this one
    if not ctx.guards and not ctx.branches(frame, statement) and (around is None or around.node is None):
        known.plain.add(key)
        return
    known.plain.discard(key)
    place = Place(frame, statement, "call", statement.pos)
    way = ctx.graph.node(key, place, frozenset())
    if known.node is None:
        known.node = ctx.graph.node(("registered", root), place, frozenset())
    known.ways.add(way)
    publications.under(ctx, frame, statement, way)
    ctx.graph.depend(way, [n for n, _ in ctx.guards])


def connect(ctx: Interpreter) -> None:
    """Let the conditions decide about the roots that are registered only under conditions that a source reaches."""
    open_roots = {root: one for root, one in ctx.registered.items() if not one.plain}
    while decided := [r for r, one in open_roots.items() if all(way in ctx.graph.live for way in one.ways)]:
        for root in decided:
            one = open_roots.pop(root)
            if one.node is not None:
                ctx.graph.depend(one.node, sorted(one.ways))
