"""Compare the state with recorded reads."""

from __future__ import annotations

from collections.abc import Mapping

from tarl_lint.memory.reads import Reads
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Graph
from tarl_lint.memory.values import ABSENT, Key, Value


def unchanged(
    reads: Reads, found: Mapping[Key, Value | None], stored: Mapping[Key, bool], store: Store, graph: Graph
) -> bool:
    """Return whether all recorded reads are unchanged, including the values `found` and the flags `stored`."""
    if not reads.unreached.isdisjoint(graph.live):
        return False
    current, waited = store.now, store.waited
    for key, value in found.items():
        now = current.get(key)
        if now is None or waited or now is ABSENT:
            now = store.peek(key)
        if now is not value and now != value:
            return False
    for key, there in stored.items():
        if (key in current) is not there:
            return False
    for obj, stamp in reads.objects.items():
        if obj.stamp != stamp:
            return False
    for carrier, size in reads.held.items():
        if graph.passed_by(carrier) != size:
            return False
    return all(question(of) == answer for (question, of), answer in reads.facts.items())
