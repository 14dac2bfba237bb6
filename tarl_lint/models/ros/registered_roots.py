"""Conditions under which a program registers a callback, a timer or a thread: they decide whether it ever runs.

A root that any call registers without such a condition always runs. Whether a source reaches all of the conditions is
known only at the end, so that the conditions are connected to the root's publish calls after the fixpoint. Until then,
every call is recorded in the same way, so that the order in which calls are seen does not matter.
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
        known.plain = True
        return
    place = Place(frame, statement, "call", statement.pos)
    if known.node is None:
        known.node = ctx.graph.node(("registered", root), place, frozenset())
    guards = [node for node, _ in ctx.guards]
    key = (frame.id, statement.id, "registers", *guards, *frame.turn)
    way = ctx.graph.node(key, place, frozenset())
    known.ways.setdefault(way, set()).add(ctx.store.root.key)
    publications.under(ctx, frame, statement, way)
    ctx.graph.depend(way, guards)


def connect(ctx: Interpreter) -> None:
    """Let the conditions decide about the roots that are registered only under conditions that a source reaches."""
    live = {way for one in ctx.registered.values() for way in one.ways if way in ctx.graph.live}
    uncertain = dict(ctx.registered)
    while found := [root for root, one in uncertain.items() if _certain(one, live, uncertain)]:
        for root in found:
            del uncertain[root]
    for one in uncertain.values():
        if one.node is not None:
            ctx.graph.depend(one.node, sorted(one.ways))


def _certain(one: Registered, live: set[int], uncertain: dict[Hashable, Registered]) -> bool:
    """Return whether a call without a live condition registers a root, in a root that certainly runs."""
    return one.plain or any(
        way not in live and any(root not in uncertain for root in roots) for way, roots in one.ways.items()
    )
