"""Statements that decide what is published, although they are on no flow.

There are three typical examples: a watchdog compares two times, a state machine waits for a clock, and a set point
is sent unchanged. A repair may have to change the constants of such statements.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from tarl_lint.flows.reachability import Tracer, closure
from tarl_lint.flows.statement_text import FUNCTIONS, LOOPS, Written
from tarl_lint.model import Flow, Step

CONSTRUCTORS = frozenset(["__init__", "__post_init__"])


def deciding(tracer: Tracer, flows: Collection[Flow]) -> tuple[Step, ...]:
    """Return the statements that are on no flow although published values depend on them, by data or control.

    Only files that contain a statement of a flow count. Assignments that set up a node (in a module, a class or a
    constructor) are left out: their constants are found where they are used.
    """
    paths = {step.span.path for flow in flows for step in flow.steps}
    inside = {step.site for flow in flows for step in flow.steps}
    found: dict[int, Written] = {}
    for node in sorted(_behind(tracer)):
        written = tracer.statements.of(node)
        if written is not None and not _sets_up(written):
            found.setdefault(id(written), written)
    steps = (tracer.lists.step(one, one.text.span(one), "control", None) for one in found.values())
    kept = (step for step in steps if step.span.path in paths and step.site not in inside)
    return tuple(sorted(kept, key=lambda step: step.span))


def _behind(tracer: Tracer) -> set[int]:
    """Return every node on which a publish call depends."""
    graph, sinks = tracer.graph, tracer.machine.sinks.values()
    found: set[int] = set()
    news: set[int] = set().union(*(record.nodes for record in sinks))
    while news:
        found |= closure(news, [graph.data, graph.control])
        news = tracer.choices.made_there(found) - found
    return found


def _sets_up(written: Written) -> bool:
    """Return whether a statement assigns a value once, before the node runs."""
    if not isinstance(written.node, ast.Assign | ast.AnnAssign):
        return False
    for around in _around(written):
        if isinstance(around.node, LOOPS):
            return False
        if isinstance(around.node, FUNCTIONS):
            return around.node.name in CONSTRUCTORS
    return True


def _around(written: Written) -> Iterator[Written]:
    outer = written.around
    while outer is not None:
        yield outer
        outer = outer.around
