"""Conditions that choose a value: the chosen constants, and the function that computes the value."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass
from typing import Final, NamedTuple

from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import Graph
from tarl_lint.memory.values import Branches


class Entrance(NamedTuple):
    """A condition that chooses a value."""

    condition: int
    frame: Frame  # the frame of the value
    outer: Frame  # the frame of the condition
    # the node that uses the value; if no condition decides whether the value is used, the value itself
    value: int


@dataclass(frozen=True, slots=True)
class Made:
    """A set of nodes, with the result of `Choices.made_there` for them."""

    nodes: Set[int]
    found: Set[int]


NOTHING_MADE: Final = Made(frozenset(), frozenset())


class Choices:
    """Answers which values of a value-flow graph conditions choose."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.alongside = made_alongside(graph)
        self._choosing: dict[int, Sequence[tuple[int, Branches]]] = {}
        self._chosen_by: dict[int, list[int]] | None = None

    def made_there(self, nodes: Set[int], known: Made = NOTHING_MADE) -> set[int]:
        """Return the constants that conditions among the nodes choose, and the nodes that produce these constants.

        `known` holds a subset of the nodes, with the result for this subset.
        """
        graph = self.graph
        found = set(known.found)
        starts: dict[Branches, set[int]] = {}  # conditions → values that they choose
        for node in self.renewed(nodes, known.nodes):
            if node in graph.gates:
                made, choice = graph.gates[node]
                starts.setdefault(choice, set()).add(made)
            for made, choice in self._alongside(node):
                if any(decision in nodes for decision, _ in choice):
                    found.add(made)
                    starts.setdefault(choice, set()).add(made)
        # as `starts`, but only with conditions that are among the nodes
        inside: dict[Branches, set[int]] = {}
        for choice, values in starts.items():
            inside.setdefault(frozenset(b for b in choice if b[0] in nodes), set()).update(values)
        for ways, values in inside.items():
            found |= self.makers(values, ways)
        return found

    def made_of(self, nodes: Set[int], known: Made) -> Made:
        """Return nodes with the result of `made_there` for them; `known` is the same for a subset of the nodes."""
        return Made(nodes, self.made_there(nodes, known))

    def _alongside(self, node: int) -> Sequence[tuple[int, Branches]]:
        """Return the values that a node uses through a copy without conditions, and the conditions of each."""
        known = self._choosing.get(node)
        if known is None:
            branches = self.graph.branches
            made = self.alongside.get(node, ())
            known = self._choosing[node] = [(one, branches[one] - branches[node]) for one in made]
        return known

    def makers(self, values: Iterable[int], ways: Branches) -> set[int]:
        """Return the inputs of values, direct or indirect, that are computed under one of the conditions `ways`."""
        data, branches, stands_for = self.graph.data, self.graph.branches, self.graph.stands_for
        found: set[int] = set()
        pending = list(values) if ways else []
        while pending:
            for near in data[pending.pop()]:
                former = stands_for.get(near, near)
                if former not in found and not ways.isdisjoint(branches[former]):
                    found.add(former)
                    pending.append(former)
        return found

    def renewed(self, nodes: Set[int], known: Set[int]) -> set[int]:
        """Return the nodes whose value is chosen by conditions in `nodes` other than those in the subset `known`."""
        news = nodes - known
        asking = (news & self.graph.gates.keys()) | (news & self.alongside.keys())
        if known:
            asking.update(node for node in self._affected(news) if node in nodes)
        return asking

    def entrances(self, node: int) -> Iterator[Entrance]:
        """Yield the conditions that choose the value of a node; the value may be computed in another function.

        `call_chains.calls` returns the calls between the frames of condition and value.
        """
        graph = self.graph
        if node in graph.gates:
            made, choice = graph.gates[node]
            yield from self._entrances(choice, made, node)
        for made in self.alongside.get(node, ()):
            yield from self._entrances(graph.branches[made] - graph.branches[node], made, made)

    def _entrances(self, choice: Branches, made: int, value: int) -> Iterator[Entrance]:
        places = self.graph.places
        for decision in dict.fromkeys(decision for decision, _ in choice):
            yield Entrance(decision, places[made].frame, places[decision].frame, value)

    def _affected(self, news: Iterable[int]) -> Iterator[int]:
        if self._chosen_by is None:
            self._chosen_by = self._reversed()
        for node in news:
            yield from self._chosen_by.get(node, ())

    def _reversed(self) -> dict[int, list[int]]:
        """Return, for each condition and each value used without conditions, the nodes that depend on it."""
        graph = self.graph
        found: dict[int, dict[int, None]] = {}
        for node, (_, choice) in graph.gates.items():
            for decision, _ in choice:
                found.setdefault(decision, {})[node] = None
        for node, values in self.alongside.items():
            for made in values:
                found.setdefault(made, {})[node] = None
                for decision, _ in graph.branches[made] - graph.branches[node]:
                    found.setdefault(decision, {})[node] = None
        return {asked: list(nodes) for asked, nodes in found.items()}


def made_alongside(graph: Graph) -> dict[int, list[int]]:
    """Return, for each node, the nodes whose values it uses through a copy without conditions."""
    found: dict[int, list[int]] = {}
    for node, formers in enumerate(graph.data):
        if not graph.stands_for.keys().isdisjoint(formers):
            found[node] = [graph.stands_for[f] for f in sorted(formers) if f in graph.stands_for]
    return found
