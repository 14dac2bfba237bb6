"""Calls that lead from a condition to the function that computes the chosen value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import Graph, Place
from tarl_lint.memory.values import Branches

Entrance = tuple[int, Frame, Frame, int]  # (condition, frame of the value, frame of the condition, value)


def made_alongside(graph: Graph) -> dict[int, list[int]]:
    """Return, for each node, the nodes whose values it uses through a copy without conditions."""
    found: dict[int, list[int]] = {}
    for node, formers in enumerate(graph.data):
        if not graph.stands_for.keys().isdisjoint(formers):
            found[node] = [graph.stands_for[f] for f in sorted(formers) if f in graph.stands_for]
    return found


def entrances(graph: Graph, nodes: set[int], alongside: Mapping[int, Sequence[int]]) -> Iterator[Entrance]:
    """Yield every condition among the nodes that chooses a value; another function may compute this value.

    `calls` returns the calls between the frames of condition and value. `alongside` is the result of
    `made_alongside`.
    """
    for node in sorted(nodes & (graph.gates.keys() | alongside.keys())):
        if node in graph.gates:
            made, choice = graph.gates[node]
            yield from _between(graph, choice, nodes, made, node)
        for made in alongside.get(node, ()):
            if made in nodes:
                yield from _between(graph, graph.branches[made] - graph.branches[node], nodes, made, made)


def _between(graph: Graph, choice: Branches, nodes: set[int], made: int, shown: int) -> Iterator[Entrance]:
    frame = graph.places[made].frame
    for decision, _ in sorted(choice):
        if decision in nodes:
            yield decision, frame, graph.places[decision].frame, shown


def calls(frame: Frame, outer: Frame) -> list[Place]:
    """Return the calls that lead from one frame to another, outermost first; empty if no calls do."""
    found: list[Place] = []
    current: Frame | None = frame
    while current is not None and current is not outer:
        if current.caller is None or current.call is None:
            return []
        found.append(Place(current.caller, current.call, "call", current.call.pos))
        current = current.caller
    return found[::-1]
