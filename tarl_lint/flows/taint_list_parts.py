"""The contribution of a set of nodes to a taint list: statements, their order, and the calls between them.

The flows into one publish call mostly have the same nodes. Their common part is therefore computed once, and each flow
extends a copy of it by its other nodes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from itertools import pairwise

from tarl_lint.flows.choices import Choices
from tarl_lint.flows.node_statements import Statements
from tarl_lint.flows.precedence import Bits, Precedence
from tarl_lint.flows.statement_text import Written
from tarl_lint.memory.frames import Frame

Pairs = dict[tuple[int, int], None]  # (`id` of a statement, `id` of a statement that it precedes)


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """Calls that lead from a condition to a value that it chooses; many conditions and values share them."""

    passed: Mapping[int, Written]  # `id` of a call → the call, as written in the code
    between: Pairs  # the order of the calls, as pairs of the `id` of each
    ends: tuple[int, int] | None  # `id` of the first and of the last call; None if there are no calls

    def joining(self, first: int | None, last: int | None) -> Iterator[tuple[int, int]]:
        """Yield the pairs that order two statements around the calls."""
        head, tail = self.ends or (last, first)
        for former, latter in ((first, head), (tail, last)):
            if former is not None and latter is not None and former != latter:
                yield former, latter


@dataclass(slots=True)
class Part:
    """Statements (by `id`) of a set of nodes, and their order."""

    nodes: Set[int] = frozenset()
    written: dict[int, Written] = field(default_factory=dict)
    # (frame, `id` of a statement) → the statement as written
    placed: dict[tuple[Frame, int], Written] = field(default_factory=dict)
    precedence: Precedence = field(default_factory=Precedence)
    turns: Pairs = field(default_factory=dict)  # dependencies on earlier iterations of a loop
    function: dict[int, object] = field(default_factory=dict)  # statement → its function
    passed: dict[int, Written] = field(
        default_factory=dict
    )  # calls between conditions and the values they choose
    # pairs that put these in order: conditions, the values they choose, and the calls between conditions and values
    entrances: Pairs = field(default_factory=dict)

    def copy(self) -> Part:
        """Return an equal part; extending the copy does not change this part."""
        return Part(
            self.nodes,
            {**self.written},
            {**self.placed},
            self.precedence.copy(),
            {**self.turns},
            {**self.function},
            {**self.passed},
            {**self.entrances},
        )


class Parts:
    """Computes the parts of sets of nodes."""

    def __init__(self, statements: Statements, choices: Choices) -> None:
        self.statements = statements
        self.choices = choices
        self.bits = Bits()  # bits of all statements, shared by the orders of all parts
        # node → the nodes of other statements on which the node depends, and the bits of these statements
        self._formers: dict[int, tuple[tuple[int, ...], int]] = {}
        # bits → the one object that represents all equal bits; this saves memory, since nodes in many contexts have
        # equal bits
        self._bits: dict[int, int] = {}
        self._ways: dict[tuple[Frame, Frame], Way | None] = {}
        # node → one triple for each condition that chooses the value of the node: the condition, the node that uses
        # the value, and the calls between these two
        self._entrances: dict[int, Sequence[tuple[int, int, Way]]] = {}

    def of(self, nodes: Set[int], known: Part) -> Part:
        """Return the part of a set of nodes; `known`, the part of a subset, is not changed."""
        news = nodes - known.nodes
        part = known.copy() if known.nodes else Part(precedence=Precedence(bits=self.bits))
        part.nodes = nodes
        self._add_statements(part, sorted(news))
        affected = {n for n in self.statements.nodes_after(news) if n in nodes} if known.nodes else set()
        self._add_order(part, sorted(news | affected))
        self._add_entrances(part, self.choices.renewed(nodes, known.nodes))
        return part

    def _add_statements(self, part: Part, nodes: Iterable[int]) -> None:
        places = self.statements.graph.places
        for node in nodes:
            found = self.statements.of(node)
            if found is not None:
                part.written[id(found)] = found
                part.placed[places[node].frame, id(found)] = found

    def _add_order(self, part: Part, nodes: Iterable[int]) -> None:
        """Add the order between statements; store dependencies on earlier iterations of a loop separately."""
        inside, written, places = part.nodes, part.written, self.statements.graph.places
        key_of, bits = self.statements.key_of, self.bits
        for node in nodes:
            after = key_of[node]
            if after is None:
                continue
            here = part.function[after] = places[node].frame.function
            # the first node of a statement decides whether the statement belongs to an earlier iteration
            seen, earlier = part.precedence.before.get(after, 0), 0
            formers, asked = self._formers.get(node) or self._formers_of(node, after)
            for former in formers if asked & ~seen else ():
                if former not in inside or (before := key_of[former]) is None:
                    continue
                bit = bits[before]
                if seen & bit:
                    continue
                seen |= bit
                same = places[former].frame.function is here
                if same and written[before].start > written[after].start:
                    part.turns[before, after] = None
                else:
                    earlier |= bit
            if earlier:
                part.precedence.add(earlier, after)

    def _formers_of(self, node: int, after: int) -> tuple[tuple[int, ...], int]:
        """Return the nodes of other statements than `after` on which a node depends, and the bits of the statements."""
        key_of, bits = self.statements.key_of, self.bits
        formers: list[int] = []
        asked = 0
        for former in self.statements.nodes_before(node):
            key = key_of[former]
            if key is not None and key != after:
                formers.append(former)
                asked |= bits[key]
        known = self._formers[node] = tuple(formers), self._bits.setdefault(asked, asked)
        return known

    def _add_entrances(self, part: Part, nodes: Iterable[int]) -> None:
        """Add the calls between conditions and the values that they choose, and their order."""
        inside, key_of = part.nodes, self.statements.key_of
        found: dict[Way, dict[tuple[int | None, int | None], None]] = {}
        for node in nodes:
            for condition, value, way in self._through_calls(node):
                if condition in inside and value in inside:
                    found.setdefault(way, {})[key_of[condition], key_of[value]] = None
        for way, ends in found.items():
            part.passed.update(way.passed)
            part.entrances.update(way.between)
            part.entrances.update((pair, None) for first, last in ends for pair in way.joining(first, last))

    def _through_calls(self, node: int) -> Sequence[tuple[int, int, Way]]:
        """Return the conditions that choose the value of a node, if calls lead from them to the value."""
        known = self._entrances.get(node)
        if known is None:
            every = ((one, self._way(one.frame, one.outer)) for one in self.choices.entrances(node))
            known = [(one.condition, one.value, way) for one, way in every if way is not None]
            self._entrances[node] = known
        return known

    def _way(self, frame: Frame, outer: Frame) -> Way | None:
        """Return the calls that lead from one frame to another; None if no calls do."""
        if (frame, outer) not in self._ways:
            calls = self.statements.calls(frame, outer)
            self._ways[frame, outer] = None if calls is None else _way(calls)
        return self._ways[frame, outer]


def _way(calls: Sequence[Written]) -> Way:
    keys = [id(call) for call in calls]
    between = {(a, b): None for a, b in pairwise(keys) if a != b}
    return Way(dict(zip(keys, calls, strict=True)), between, (keys[0], keys[-1]) if keys else None)
