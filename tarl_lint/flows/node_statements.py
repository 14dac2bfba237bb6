"""The statement of each value-flow node, and those that lead to it; shared by all flows."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from tarl_lint.flows.call_chains import calls
from tarl_lint.flows.statement_text import Texts, Written
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import MERGED, Graph, Place
from tarl_lint.models.ros.endpoints import SourceRecord


class Found(dict[int, Written | None]):
    """A table from nodes to their statements (or None), filled at the first use of a node."""

    def __init__(self, graph: Graph, texts: Texts) -> None:
        super().__init__()
        self._places = graph.places
        self._texts = texts

    def __missing__(self, node: int) -> Written | None:
        """Compute the entry of a node."""
        found = self[node] = self.at(self._places[node])
        return found

    def at(self, place: Place) -> Written | None:
        """Return the statement at a place; for an arriving message, the header of the callback."""
        text = self._texts[place.frame.program.path]
        if place.statement is not None:
            return text.statement(place.statement.pos)
        return text.function(place.pos) if place.role == "receive" else None


class Keys(dict[int, int | None]):
    """A table from nodes to their statement's `id` (or None), filled at the first use of a node."""

    def __init__(self, found: Mapping[int, object | None]) -> None:
        super().__init__()
        self._found = found

    def __missing__(self, node: int) -> int | None:
        """Compute the entry of a node."""
        found = self._found[node]
        key = self[node] = None if found is None else id(found)
        return key


class Statements:
    """Finds the statements of nodes. A node without a statement is passed through."""

    def __init__(self, graph: Graph, texts: Texts, forward: Sequence[Sequence[Sequence[int]]]) -> None:
        self.graph = graph
        self.texts = texts
        self.forward = forward  # tables from a node to the nodes that depend on it
        self._merged = {n for n, place in enumerate(graph.places) if place.role == MERGED}
        # these tables do not refer to this object: a reference cycle would keep all of them in memory
        self._found = Found(graph, texts)
        self.key_of = Keys(self._found)
        self._formers: dict[int, list[int]] = {}
        self._chains: dict[tuple[Frame, Frame], Sequence[Written] | None] = {}

    def of(self, node: int) -> Written | None:
        """Return the statement of a node; for an arriving message, the header of the callback."""
        return self._found[node]

    def arrivals(self, origin: SourceRecord) -> list[int]:
        """Return the statements (by `id`) at which messages of a source arrive."""
        found = (self.of(n) for n in sorted(origin.nodes))
        return [id(w) for w in found if w is not None]

    def calls(self, frame: Frame, outer: Frame) -> Sequence[Written] | None:
        """Return the statements whose calls lead from one frame to another; None if no calls do."""
        if (frame, outer) not in self._chains:
            places = calls(frame, outer)
            found = [written for place in places if (written := self._found.at(place)) is not None]
            self._chains[frame, outer] = found if places else None
        return self._chains[frame, outer]

    def nodes_before(self, node: int) -> Sequence[int]:
        """Return the inputs and conditions of a node; skip the merged nodes of fields."""
        formers = self.formers(node)
        merged = self._merged
        if merged.isdisjoint(formers):
            return formers
        pending = list(reversed(formers))
        found: list[int] = []
        seen: set[int] = set()
        while pending:
            former = pending.pop()
            if former in merged and former not in seen:
                seen.add(former)
                pending += reversed(self.formers(former))
            elif former not in seen:
                found.append(former)
        return found

    def formers(self, node: int) -> list[int]:
        """Return the nodes that a node is made from or depends on, in order."""
        known = self._formers.get(node)
        if known is None:
            known = self._formers[node] = sorted(self.graph.data[node] | self.graph.control[node])
        return known

    def nodes_after(self, nodes: Collection[int]) -> Iterator[int]:
        """Yield the nodes for which `nodes_before` returns one of these nodes, and the merged nodes between them."""
        pending = list(nodes)
        seen: set[int] = set()
        while pending:
            node = pending.pop()
            for table in self.forward:
                for latter in table[node]:
                    if latter not in seen:
                        seen.add(latter)
                        yield latter
                        if latter in self._merged:
                            pending.append(latter)
