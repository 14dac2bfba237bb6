"""Reachability from sources to sinks: which pairs of a source and a sink are flows, and through which statements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass

from tarl_lint.flows.apart import named_first, named_sinks_first, sinks_told_apart, told_apart
from tarl_lint.flows.choices import NOTHING_MADE, Choices
from tarl_lint.flows.ends import Ends
from tarl_lint.flows.node_statements import Statements
from tarl_lint.flows.shortest_path import ShortestPaths
from tarl_lint.flows.statement_text import Texts
from tarl_lint.flows.subset_results import Nearest
from tarl_lint.flows.taint_list import TaintLists
from tarl_lint.flows.taint_list_parts import Part, Parts
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.model import Flow, Kind, Source, Step
from tarl_lint.models.ros.endpoints import SinkRecord, SourceRecord


@dataclass(slots=True)
class Reach:
    """Nodes that a source reaches: by data edges alone (`data`), and by any edge (`any`)."""

    data: set[int]
    any: set[int]
    # node of a container's length → data of the source in those elements that are added under a condition
    counted: Mapping[int, set[int]]


Reaching = tuple[Source, SourceRecord, Reach]


class Tracer:
    """Finds the flows of a linked set of modules."""

    def __init__(self, machine: Linker) -> None:
        self.machine = machine
        self.graph = machine.graph
        self.texts = Texts(machine.modules)
        # in a run for a launch file, every call context has its own source
        self.apart = not machine.launching
        records, sinks = machine.sources.values(), machine.sinks.values()
        self.sources = told_apart(records) if self.apart else list(records)
        self.sinks = sinks_told_apart(sinks) if self.apart else list(sinks)
        self.ends = Ends(self.texts, self.sinks)
        self.forward_data = _reversed(self.graph.data)
        self.forward_control = _reversed(self.graph.control)
        self.choices = Choices(self.graph)
        self.statements = Statements(self.graph, self.texts, (self.forward_data, self.forward_control))
        self.made = Nearest(NOTHING_MADE, self.choices.made_of)
        self.listed = Nearest(Part(), Parts(self.statements, self.choices).of)
        self.lists = TaintLists(self.texts, self.statements)

    def flows(self) -> tuple[Flow, ...]:
        """Return every flow, sorted by sink and source."""
        sources = [(self.ends.source(r), r, self.reach(r)) for r in self.sources]
        into = (self.flows_into(sink, sources) for sink in self.sinks)
        found = (flow for flows in into for flow in (named_first(flows) if self.apart else flows))
        kept = named_sinks_first(found) if self.apart else found
        return tuple(sorted(kept, key=lambda f: (f.sink.span, f.source.span, f.source.topics, f.sink.topics)))

    def reach(self, record: SourceRecord) -> Reach:
        """Return the nodes that messages of a source reach."""
        data = closure(record.nodes, [self.forward_data])
        counted: dict[int, set[int]] = {}
        while more := self.counts(data):
            counted.update(more)
            data |= closure(more, [self.forward_data])
        return Reach(data, closure(record.nodes, [self.forward_data, self.forward_control]), counted)

    def counts(self, data: set[int]) -> dict[int, set[int]]:
        """Return the lengths, not yet in `data`, of containers whose elements come from `data`."""
        graph = self.graph
        found: dict[int, set[int]] = {}
        for node, elements in graph.counts.items():
            if node not in data and not elements.isdisjoint(data):
                gates = graph.control[node] & graph.gates.keys()
                if any(not graph.control[gate].isdisjoint(data) for gate in gates):
                    found[node] = elements & data
        return found

    def flows_into(self, record: SinkRecord, sources: Iterable[Reaching]) -> Iterator[Flow]:
        """Yield the flows from these sources to one sink."""
        reaching = [one for one in sources if not record.nodes.isdisjoint(one[2].any)]
        if not reaching:
            return
        sink = self.ends.sink(record)
        graph = self.graph
        # all nodes that follow a reached node are reached too, so a node in both sets is on a path to the sink
        behind = closure(record.nodes, [graph.data]), closure(record.nodes, [graph.data, graph.control])
        on_data = [self.made_from(behind[0] & reach.data, reach) for _, _, reach in reaching]
        on_any = [behind[1] & reach.any for _, _, reach in reaching]
        made = self.made.of(set.intersection(*on_any), None)
        for data, nodes in zip(on_data, on_any, strict=True):
            nodes |= data | self.choices.made_there(nodes, made)
        common = self.listed.of(set.intersection(*on_any), None)
        paths = self.paths(record, reaching)
        for (source, origin, reach), data, nodes, path_from in zip(
            reaching, on_data, on_any, paths, strict=True
        ):
            listed = self.lists.of(origin, data, self.listed.of(nodes, id(origin), common), record)
            path = [listed.index[key] for key in path_from(origin.nodes)]
            chain = ending_in_publish_call(path, listed.steps)
            kind: Kind = "implicit" if record.nodes.isdisjoint(reach.data) else "explicit"
            yield Flow(kind, source, sink, listed.steps, chain)

    def paths(
        self, record: SinkRecord, reaching: Iterable[Reaching]
    ) -> Iterator[Callable[[Set[int]], Sequence[int]]]:
        """For each source, yield a function that finds a path to the sink.

        The path leads only through data if data of the source reaches the sink.
        """
        ends = sorted(record.nodes)
        statement_of = self.statements.key_of.__getitem__
        through_data = ShortestPaths(ends, self.data_formers({}), statement_of)
        through_any = ShortestPaths(ends, self.statements.formers, statement_of)
        for _, _, reach in reaching:
            if record.nodes.isdisjoint(reach.data):
                yield through_any.path_from
            elif reach.counted:
                yield ShortestPaths(ends, self.data_formers(reach.counted), statement_of).path_from
            else:
                yield through_data.path_from

    def data_formers(self, counted: Mapping[int, set[int]]) -> Callable[[int], list[int]]:
        """Return a function that maps a node to the data from which it is made.

        For the node of a container's length, this includes the elements.
        """
        data = self.graph.data
        return lambda node: sorted(data[node] | counted[node] if node in counted else data[node])

    def made_from(self, ends: set[int], reach: Reach) -> set[int]:
        """Return the nodes with data of the source from which the ends are computed.

        If data of the source leads to one of the ends by data edges, all this data is among the ends.
        """
        found = set(ends)
        while more := set().union(*(reach.counted[n] for n in found & reach.counted.keys())) - found:
            found |= closure(more, [self.graph.data], reach.data)
        return found


def ending_in_publish_call(path: Sequence[int], steps: Sequence[Step]) -> tuple[int, ...]:
    """Return a path that ends with its publish call, even if arguments of this call are calls of functions on it."""
    calls = [place for place in path if steps[place].role == "publish"]
    return (*(place for place in path if place not in calls), *calls[-1:])


def _reversed(edges: Sequence[set[int]]) -> list[list[int]]:
    forward: list[list[int]] = [[] for _ in edges]
    for node, formers in enumerate(edges):
        for former in formers:
            forward[former].append(node)
    return forward


def closure(
    start: Iterable[int], tables: Sequence[Sequence[Iterable[int]]], within: set[int] | None = None
) -> set[int]:
    """Return all nodes reached from `start` along edges in any of the tables, through nodes in `within` only."""
    found = set(start)
    pending = list(found)
    while pending:
        node = pending.pop()
        for table in tables:
            for following in table[node]:
                if following not in found and (within is None or following in within):
                    found.add(following)
                    pending.append(following)
    return found
