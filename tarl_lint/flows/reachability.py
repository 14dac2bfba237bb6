"""Reachability from sources to sinks: which pairs are flows, and through which statements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from tarl_lint.flows.call_chains import calls, entrances, made_alongside
from tarl_lint.flows.context_steps import Surroundings
from tarl_lint.flows.ends import Ends
from tarl_lint.flows.shortest_path import shortest_path
from tarl_lint.flows.statement_text import Texts, Written
from tarl_lint.flows.topological_order import before_loops, in_order
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import MERGED, Place
from tarl_lint.memory.values import Branches
from tarl_lint.model import Dependence, Flow, Role, Sink, Source, Span, Step
from tarl_lint.models.ros.endpoints import SinkRecord, SourceRecord

ROLES: Mapping[str, Role] = {
    "Return": "return",
    "If": "condition",
    "While": "condition",
    "Try": "condition",
    "Match": "condition",
    "match_case": "condition",
    "Assert": "condition",
    "Expr": "call",
}


@dataclass(slots=True)
class Reach:
    """Nodes that a source reaches: by data edges alone (`data`), and by any edge (`any`)."""

    data: set[int]
    any: set[int]
    # node of a container's length → nodes of source data in those elements that the code adds under a condition
    counted: Mapping[int, set[int]]


class Tracer:
    """Finds the flows of a linked set of modules."""

    def __init__(self, machine: Linker) -> None:
        self.machine = machine
        self.graph = machine.graph
        self.texts = Texts(machine.modules)
        self.ends = Ends(self.texts, machine.sinks.values())
        self.surroundings = Surroundings(self.texts)
        self.forward_data = _reversed(self.graph.data)
        self.forward_control = _reversed(self.graph.control)
        self._alongside = made_alongside(self.graph)
        self._merged = {n for n, place in enumerate(self.graph.places) if place.role == MERGED}
        self._statements: dict[int, Written | None] = {}
        self._formers: dict[int, list[int]] = {}
        self._before: dict[int, Sequence[tuple[int, list[int]]]] = {}
        self._steps: dict[tuple[int, Dependence, Role | None], Step] = {}
        self._chains: dict[tuple[Frame, Frame], Sequence[Written] | None] = {}

    def flows(self) -> tuple[Flow, ...]:
        """Return every flow, sorted by sink and source."""
        found: list[Flow] = []
        sources = [(self.ends.source(r), r, self.reach(r)) for r in self.machine.sources.values()]
        for record in self.machine.sinks.values():
            sink = self.ends.sink(record)
            for source, origin, reach in sources:
                flow = self.flow(source, origin, reach, sink, record)
                if flow is not None:
                    found.append(flow)
        return tuple(sorted(found, key=lambda f: (f.sink.span, f.source.span)))

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

    def flow(
        self, source: Source, origin: SourceRecord, reach: Reach, sink: Sink, record: SinkRecord
    ) -> Flow | None:
        """Return the flow from a source to a sink; None if the source does not reach the sink."""
        ends = record.nodes & reach.any
        if not ends:
            return None
        explicit = bool(record.nodes & reach.data)
        graph = self.graph
        on_data = self.made_from(record.nodes & reach.data, reach)
        on_any = closure(ends, [graph.data, graph.control], reach.any)
        on_any |= on_data | self.made_there(on_any)
        steps, statement_of, keys = self.steps(origin, on_data, on_any, record)
        formers = self.data_formers(reach) if explicit else self.formers
        inside = reach.data if explicit else reach.any
        path = shortest_path(
            sorted(ends & inside),
            origin.nodes,
            lambda n: (f for f in formers(n) if f in inside),
            statement_of,
        )
        chain = ending_in_publish_call([keys[key] for key in path], steps)
        return Flow("explicit" if explicit else "implicit", source, sink, steps, chain)

    def data_formers(self, reach: Reach) -> Callable[[int], list[int]]:
        """Return a function from a node to the data it is made from; for a container's length, also the elements."""
        return lambda node: sorted(self.graph.data[node] | reach.counted.get(node, set()))

    def made_from(self, ends: set[int], reach: Reach) -> set[int]:
        """Return the nodes of a source's data from which the ends are computed."""
        found = closure(ends, [self.graph.data], reach.data)
        while more := set().union(*(reach.counted[n] for n in found & reach.counted.keys())) - found:
            found |= closure(more, [self.graph.data], reach.data)
        return found

    def made_there(self, nodes: set[int]) -> set[int]:
        """Return the constants that conditions among the nodes choose, and the nodes that produce these constants."""
        graph = self.graph
        found: set[int] = set()
        for node in filter((graph.gates.keys() | self._alongside.keys()).__contains__, nodes):
            if node in graph.gates:
                dep, choice = graph.gates[node]
                self._makers(dep, frozenset(b for b in choice if b[0] in nodes), found)
            for dep in self._alongside.get(node, ()):
                ways = frozenset(b for b in graph.branches[dep] - graph.branches[node] if b[0] in nodes)
                if ways:
                    found.add(dep)
                    self._makers(dep, ways, found)
        return found

    def _makers(self, dep: int, ways: Branches, found: set[int]) -> None:
        """Add those inputs of a value that are computed under the conditions that choose the value."""
        data, branches, stands_for = self.graph.data, self.graph.branches, self.graph.stands_for
        pending = [dep] if ways else []
        while pending:
            for near in data[pending.pop()]:
                former = stands_for.get(near, near)
                if former not in found and not ways.isdisjoint(branches[former]):
                    found.add(former)
                    pending.append(former)

    # --- steps --------------------------------------------------------------------------------------------

    def steps(
        self, origin: SourceRecord, on_data: set[int], on_any: set[int], record: SinkRecord
    ) -> tuple[tuple[Step, ...], dict[int, int], dict[int, int]]:
        """Return the taint list: data and control steps of the nodes, and the context steps.

        Also return node → statement, and statement → index in the list.
        """
        dependence: dict[int, Dependence] = {}
        written: dict[int, Written] = {}
        statement_of: dict[int, int] = {}
        for node in sorted(on_any):
            found = self.statement(node)
            if found is None:
                continue
            key = id(found)
            written[key] = found
            statement_of[node] = key
            if node in on_data:
                dependence[key] = "data"
            else:
                dependence.setdefault(key, "control")
        edges = self.edges(on_any, statement_of, written)
        edges += self.entered(on_any, statement_of, written, dependence)
        inside = {(self.graph.places[n].frame, k): written[k] for n, k in statement_of.items()}
        context, outer = self.surroundings.context(origin, [(f, w) for (f, _), w in inside.items()])
        for item in context:
            if id(item) not in written:
                written[id(item)] = item
                dependence[id(item)] = "context"
        registration = self.surroundings.registration(origin)
        arrivals = self.arrivals(origin)
        edges += outer + [(id(registration), a) for a in arrivals]
        spans = {key: w.text.span(w) for key, w in written.items()}
        first = {*arrivals, *(key for key, kind in dependence.items() if kind == "context")}
        order = in_order(spans, edges, first)
        sinks = {id(w) for n in record.nodes if (w := self.statement(n)) is not None}
        roles: dict[int, Role] = {**({id(registration): "register"} if registration is not None else {})}
        roles |= dict.fromkeys(arrivals, "receive")
        roles |= dict.fromkeys(sinks, "publish")
        steps = tuple(self.step(written[k], spans[k], dependence[k], roles.get(k)) for k in order)
        return steps, statement_of, {key: place for place, key in enumerate(order)}

    def entered(
        self,
        nodes: set[int],
        statement_of: Mapping[int, int],
        written: dict[int, Written],
        dependence: dict[int, Dependence],
    ) -> list[tuple[int, int]]:
        """Add the calls between conditions and the values that they choose; return the order constraints."""
        edges: dict[tuple[int, int], None] = {}
        each = (
            (statement_of.get(decision), frame, outer, statement_of.get(made))
            for decision, frame, outer, made in entrances(self.graph, nodes, self._alongside)
        )
        for condition, frame, outer, value in dict.fromkeys(each):
            between = self.calls(frame, outer)
            if between is None:
                continue
            chain = [condition]
            for found in between:
                written.setdefault(id(found), found)
                dependence.setdefault(id(found), "control")
                chain.append(id(found))
            chain.append(value)
            known = [key for key in chain if key is not None]
            edges.update(dict.fromkeys((a, b) for a, b in pairwise(known) if a != b))
        return list(edges)

    def calls(self, frame: Frame, outer: Frame) -> Sequence[Written] | None:
        """Return the statements whose calls lead from one frame to another; None if no calls do."""
        if (frame, outer) not in self._chains:  # cached, because all flows have the same chains
            places = calls(frame, outer)
            found = [written for place in places if (written := self._statement(place)) is not None]
            self._chains[frame, outer] = found if places else None
        return self._chains[frame, outer]

    def statement(self, node: int) -> Written | None:
        """Return the statement of a node; for an arriving message, the header of the callback."""
        if node not in self._statements:
            self._statements[node] = self._statement(self.graph.places[node])
        return self._statements[node]

    def _statement(self, place: Place) -> Written | None:
        text = self.texts[place.frame.program.path]
        if place.statement is not None:
            return text.statement(place.statement.pos)
        return text.function(place.pos) if place.role == "receive" else None

    def arrivals(self, origin: SourceRecord) -> list[int]:
        """Return the steps at which messages of a source arrive."""
        found = (self.statement(n) for n in sorted(origin.nodes))
        return [id(w) for w in found if w is not None]

    def edges(
        self, nodes: Iterable[int], statement_of: Mapping[int, int], written: Mapping[int, Written]
    ) -> list[tuple[int, int]]:
        """Return the order constraints between statements, without dependencies on earlier iterations of a loop."""
        found: dict[tuple[int, int], None] = {}
        turns: dict[tuple[int, int], None] = {}
        function: dict[int, object] = {}
        places = self.graph.places
        for node in sorted(nodes):
            after = statement_of.get(node)
            if after is None:
                continue
            here = function[after] = places[node].frame.function
            for before, formers in self.statements_before(node):
                if before == after or (before, after) in found:
                    continue
                former = next(filter(statement_of.__contains__, formers), None)
                if former is None:
                    continue
                same = places[former].frame.function is here
                if same and written[before].start > written[after].start:
                    turns[before, after] = None
                else:
                    found[before, after] = None
        return [*found, *before_loops(found, turns, function)]

    def statements_before(self, node: int) -> Sequence[tuple[int, list[int]]]:
        """Return the statements that a node depends on, each with its nodes. The result is the same for all flows."""
        known = self._before.get(node)
        if known is None:
            nodes: dict[int, list[int]] = {}
            statements = self._statements
            for former in self.before(node):
                written = statements[former] if former in statements else self.statement(former)
                if written is not None:
                    nodes.setdefault(id(written), []).append(former)
            known = self._before[node] = [*nodes.items()]
        return known

    def before(self, node: int) -> Sequence[int]:
        """Return the inputs and conditions of a node; skip nodes without a statement."""
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

    def step(self, written: Written, span: Span, dependence: Dependence, known: Role | None) -> Step:
        """Return a statement as a step; flows share equal steps."""
        key = id(written), dependence, known
        if key not in self._steps:
            self._steps[key] = self._step(written, span, dependence, known)
        return self._steps[key]

    @staticmethod
    def _step(written: Written, span: Span, dependence: Dependence, known: Role | None) -> Step:
        """Return a new step; an unknown role is derived from the syntax."""
        text = written.text
        role = ROLES.get(type(written.node).__name__, "assign")
        if known is not None:
            role = known
        elif written.qualname.endswith("<lambda>") and role == "assign":
            role = "return"
        elif type(written.node).__name__ in ("For", "AsyncFor") and dependence != "data":
            role = "condition"
        return Step(text.site(written), span, text.code(span), role, dependence)


def ending_in_publish_call(path: Sequence[int], steps: Sequence[Step]) -> tuple[int, ...]:
    """Return a path with its publish call last, even if arguments of this call are calls of functions on the path."""
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
