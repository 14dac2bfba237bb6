"""What a set of nodes contributes to a taint list: statements, their order, and the calls between them.

The flows into one publish call mostly have the same nodes. Their common part is therefore computed once, and each flow
extends a copy of it by its other nodes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass, field
from itertools import pairwise

from tarl_lint.flows.choices import Choices, Entrance
from tarl_lint.flows.precedence import Precedence
from tarl_lint.flows.statement_text import Written
from tarl_lint.flows.statements import Statements
from tarl_lint.memory.frames import Frame

Pairs = dict[tuple[int, int], None]  # (`id` of a statement, `id` of a statement that it precedes)


@dataclass(slots=True)
class Part:
    """Statements (by `id`) of a set of nodes, and their order."""

    nodes: Set[int] = frozenset()
    statement_of: dict[int, int] = field(default_factory=dict)  # node → statement
    written: dict[int, Written] = field(default_factory=dict)
    # (frame, `id` of a statement) → the statement as written
    placed: dict[tuple[Frame, int], Written] = field(default_factory=dict)
    precedence: Precedence = field(default_factory=Precedence)
    turns: Pairs = field(default_factory=dict)  # dependencies on earlier iterations of a loop
    function: dict[int, object] = field(default_factory=dict)  # statement → its function
    passed: dict[int, Written] = field(
        default_factory=dict
    )  # calls between conditions and the values they choose
    # pairs that order conditions, the calls between them, and the values they choose
    entrances: Pairs = field(default_factory=dict)

    def copy(self) -> Part:
        """Return an equal part that can be extended without a change of this one."""
        return Part(
            self.nodes,
            {**self.statement_of},
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
        self._entrances: dict[int, Sequence[Entrance]] = {}

    def of(self, nodes: Set[int], known: Part) -> Part:
        """Return the part of a set of nodes. `known` is the part of a subset of the nodes; it is not changed."""
        news = nodes - known.nodes
        part = known.copy()
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
                part.statement_of[node] = id(found)
                part.written[id(found)] = found
                part.placed[places[node].frame, id(found)] = found

    def _add_order(self, part: Part, nodes: Iterable[int]) -> None:
        """Add the order between statements; set apart dependencies on earlier iterations of a loop."""
        statement_of, written, places = part.statement_of, part.written, self.statements.graph.places
        numbers = part.precedence.numbers
        for node in nodes:
            after = statement_of.get(node)
            if after is None:
                continue
            here = part.function[after] = places[node].frame.function
            known, earlier = part.precedence.before.get(after, 0), 0
            for before, formers in self.statements.before(node):
                bit = 1 << numbers[before]
                if before == after or known & bit:
                    continue
                former = next(filter(statement_of.__contains__, formers), None)
                if former is None:
                    continue
                same = places[former].frame.function is here
                if same and written[before].start > written[after].start:
                    part.turns[before, after] = None
                else:
                    earlier |= bit
            if earlier:
                part.precedence.add(earlier, after)

    def _add_entrances(self, part: Part, nodes: Iterable[int]) -> None:
        """Add the calls between conditions and the values that they choose, and their order."""
        inside, statement_of = part.nodes, part.statement_of
        found: dict[tuple[Frame, Frame, int | None, int | None], None] = {}
        for node in nodes:
            for condition, frame, outer, value in self._through_calls(node):
                if condition in inside and value in inside:
                    found[frame, outer, statement_of.get(condition), statement_of.get(value)] = None
        for frame, outer, first, last in found:
            between = self.statements.calls(frame, outer) or ()
            part.passed.update((id(call), call) for call in between)
            chain = [key for key in (first, *map(id, between), last) if key is not None]
            part.entrances.update(((a, b), None) for a, b in pairwise(chain) if a != b)

    def _through_calls(self, node: int) -> Sequence[Entrance]:
        """Return the conditions that choose the value of a node, if calls lead from them to the value."""
        known = self._entrances.get(node)
        if known is None:
            every = self.choices.entrances(node)
            calls = self.statements.calls
            known = [one for one in every if calls(one.frame, one.outer) is not None]
            self._entrances[node] = known
        return known
