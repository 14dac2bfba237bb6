"""Connect carry nodes to the content that they stand for, once the graph is complete."""

from __future__ import annotations

from itertools import islice

from tarl_lint.memory.value_flow_graph import Graph


def settle(graph: Graph) -> None:
    """Connect every carry node to its item through the carriers that passed the item on before."""
    done = graph.made = 0
    while done < len(graph.arriving):
        pending = list(islice(graph.arriving, done, None))
        done += len(pending)
        for node, item in pending:
            carrier = graph.carried[node][0]
            graph.flow(graph.arriving_through(item, graph.data[carrier]), node)
    _feed(graph)


def _feed(graph: Graph) -> None:
    """Connect each cycle of carry nodes to its origin, so that data can enter the cycle."""
    circles: dict[int, list[int]] = {}
    for node, (_, origin) in graph.carried.items():
        circles.setdefault(origin, []).append(node)
    for origin, nodes in circles.items():
        fed, rest = {origin}, nodes
        while news := [n for n in rest if not graph.data[n].isdisjoint(fed)]:
            fed.update(news)
            rest = [n for n in rest if n not in fed]
        for node in rest:
            graph.flow([origin], node)
