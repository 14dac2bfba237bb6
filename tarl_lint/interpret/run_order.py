"""Parts of state machines and behaviour trees: the outcome of one part decides which other parts run.

A tree of groups is flattened into one graph, whose edges are the outcomes of parts. A part depends on the outcomes
of another part in the way in which a statement depends on a condition (Ferrante, Ottenstein and Warren 1987).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final, Generic, Literal, TypeVar

from tarl_lint.ir.postdominance import EXIT, passed, postdominators
from tarl_lint.memory.values import Obj

P = TypeVar("P")  # a part: a state, a behaviour or a group
# A `machine` runs the member to which an outcome leads. A `chain` runs its members in order, until a member has an
# outcome other than `goes_on`. A `fork` runs all members. A `wrapper` runs its only member.
Kind = Literal["machine", "chain", "fork", "wrapper"]
Cont = Callable[[str], int]
MAX_DEPTH: Final = 12  # maximum depth of nested groups
MAX_PLACES: Final = 2000  # maximum number of places of all parts in a tree of groups
ANY: Final = ""  # stands for an outcome that is not known


@dataclass(slots=True, eq=False)
class Part:
    """A state or behaviour in the value-flow graph.

    `runs` is the node of the decision whether the part runs, and `ended` is the node of the decision how it ends.
    `answers` maps the nodes of the outcomes that the part returns to the possible outcomes of each; the value is
    None if the outcomes are unknown.
    """

    runs: int
    ended: int
    answers: dict[int, frozenset[str] | None] = field(default_factory=dict)
    method: Obj | None = None  # the method of a part that returns its outcome

    def outcomes(self) -> frozenset[str]:
        """Return all outcomes that the part may have; empty if they are not known."""
        known = [one for one in self.answers.values() if one is not None]
        return frozenset[str]().union(*known) if len(known) == len(self.answers) else frozenset()


@dataclass(slots=True, eq=False)
class Group(Generic[P]):
    """A container of parts.

    `members` are the parts by label, in order. `ways` has the labels to which outcomes of a member lead. A label
    without a member is an outcome of the group, and so is an outcome that is not in `ways`. `renames` maps outcomes
    of the member to outcomes of the group. `offers` are the outcomes that a member may have if they are not known
    otherwise; for a fork, they are those of the group.
    """

    kind: Kind
    members: dict[str, dict[P, None]] = field(default_factory=dict)
    ways: dict[tuple[str, str], dict[str, None]] = field(default_factory=dict)
    goes_on: str = ANY
    first: str = ""
    automatic: dict[str, dict[str, None]] = field(
        default_factory=dict
    )  # outcomes of the member with a label that lead to the next member
    renames: Mapping[str, str] = field(default_factory=dict)
    offers: frozenset[str] = frozenset()

    def add(self, label: str, part: P) -> None:
        """Add a part under a label, after the other members."""
        self.members.setdefault(label, {})[part] = None


@dataclass(frozen=True, slots=True)
class Dependence(Generic[P]):
    """`part` runs only after these `outcomes` of `decider`; None if any fork member may decide."""

    part: P
    decider: P
    outcomes: frozenset[str] | None


@dataclass(slots=True, eq=False)
class Flattened(Generic[P]):
    """The graph of a tree of groups: places of parts with the places to which their outcomes lead."""

    groups: Mapping[P, Group[P]]
    outcomes_of: Callable[[P], frozenset[str]]
    edges: dict[int, dict[str, int]] = field(default_factory=dict)
    parts: dict[int, tuple[P, ...]] = field(default_factory=dict)
    forks: set[int] = field(default_factory=set)
    inside: list[tuple[P, P]] = field(default_factory=list)  # (fork, part that runs in it)

    def place(self, parts: tuple[P, ...]) -> int:
        """Return a new place for parts that may stand there."""
        number = len(self.edges) + 1
        self.edges[number], self.parts[number] = {}, parts
        return number

    def lead(
        self,
        number: int,
        parts: tuple[P, ...],
        leave: Cont,
        depth: int,
        offered: frozenset[str] = frozenset(),
    ) -> None:
        """Add the edges of a place and, for a group, the parts inside. `offered` are outcomes that lead elsewhere."""
        group = self.groups.get(parts[0]) if len(parts) == 1 else None
        if group is None or not group.members or depth > MAX_DEPTH or len(self.edges) > MAX_PLACES:
            known = [self.outcomes_of(one) for one in parts]
            outcomes = frozenset[str]().union(*known) if all(known) else offered
            self.edges[number] = {one: leave(one) for one in sorted(outcomes) or [ANY]}
        elif group.kind == "fork":
            self.forks.add(number)
            self.edges[number] = {one: leave(one) for one in sorted(offered | group.offers) or [ANY]}
            for members in group.members.values():
                before = len(self.edges)
                inner = self.place(tuple(members))
                self.lead(inner, tuple(members), _end, depth + 1)
                for one in range(before + 1, len(self.edges) + 1):
                    self.inside += [(parts[0], part) for part in self.parts[one]]
        else:
            places = {label: self.place(tuple(members)) for label, members in group.members.items()}
            self.edges[number] = {ANY: places.get(group.first, next(iter(places.values())))}
            for label, members in group.members.items():
                follow = self._following(group, label, places, leave)
                ways = {outcome for at, outcome in group.ways if at == label}
                ways |= {*group.automatic.get(label, ()), group.goes_on} - {ANY}
                self.lead(places[label], tuple(members), follow, depth + 1, group.offers | ways)

    def _following(self, group: Group[P], label: str, places: Mapping[str, int], leave: Cont) -> Cont:
        """Return the places to which the outcomes of a member lead."""
        labels = list(places)
        after = labels[labels.index(label) + 1 :]

        def follow(outcome: str) -> int:
            ways = group.ways.get((label, outcome))
            if ways:
                target = next(iter(ways))
                return places[target] if target in places else leave(target)
            if after and (outcome == group.goes_on or outcome in group.automatic.get(label, ())):
                return places[after[0]]
            return leave(group.renames.get(outcome, outcome))

        return follow


def _end(outcome: str) -> int:  # noqa: ARG001 - the signature of `Cont`
    """Return the end of the whole graph; every outcome of the outermost group leads to it."""
    return EXIT


def dependences(
    groups: Mapping[P, Group[P]], outcomes_of: Callable[[P], frozenset[str]]
) -> Iterator[Dependence[P]]:
    """Yield the dependences of parts on outcomes of other parts. `outcomes_of` returns a part's outcomes, if known.

    Groups that contain themselves, and very large groups, are cut.
    """
    contained = {part for group in groups.values() for members in group.members.values() for part in members}
    for whole in groups:
        if whole in contained:
            continue
        graph = Flattened(groups, outcomes_of)
        graph.lead(graph.place((whole,)), (whole,), _end, 0)
        yield from _in_graph(graph)


def _in_graph(graph: Flattened[P]) -> Iterator[Dependence[P]]:
    for fork, part in graph.inside:
        yield Dependence(part, fork, frozenset())
    nearest = postdominators(graph.edges, list(graph.edges))
    for decider, ways in graph.edges.items():
        if len(set(ways.values())) < 2 or decider not in nearest:
            continue
        led: dict[int, set[str]] = {}
        for outcome, target in ways.items():
            for place in passed(target, nearest[decider], nearest):
                led.setdefault(place, set()).add(outcome)
        for place, outcomes in led.items():
            for part in graph.parts[place]:
                for one in graph.parts[decider]:
                    yield Dependence(part, one, None if decider in graph.forks else frozenset(outcomes))
