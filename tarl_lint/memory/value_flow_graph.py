"""The value-flow graph: nodes are values that statements make, edges say what each is made from."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Set
from dataclasses import dataclass, field
from itertools import islice

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.values import Branches, Nodes

MAX_NODES = 6_000  # of a program; after that, content is taken to arrive as it is, too
MAX_EDGES = 200_000  # of data; then few of very many values that meet in one are followed
FEW = 8
MANY = 16  # nodes that meet in a field where everything adds up and are told apart
MANY_CARRIERS = 64  # the same of pointers to objects with data in them
MERGED = "merged"  # the role of nodes that stand for all that meets in a field
NOTHING: Set[int] = frozenset()
MAX_CARRIED = 500  # content times carriers; beyond that, content is taken to arrive as it is


@dataclass(slots=True)
class Place:
    """Where a node belongs: a statement in an activation; no statement for a message arriving."""

    frame: Frame
    statement: ir.Stmt | None
    role: str
    pos: ir.Pos


@dataclass(slots=True, eq=False)
class Graph:
    """Edges lead backwards, from a node to what it depends on.

    `held[c]` holds the nodes that were inside an object when `c` passed the object on; so a value read
    out of it later is known to have come that way.
    """

    places: list[Place] = field(default_factory=list)
    data: list[set[int]] = field(default_factory=list)
    control: list[set[int]] = field(default_factory=list)
    branches: list[Branches] = field(default_factory=list)
    gates: dict[int, tuple[int, Branches]] = field(default_factory=dict)  # node → value, choice
    counts: dict[int, set[int]] = field(
        default_factory=dict
    )  # node that counts elements → what those are made from
    stands_for: dict[int, int] = field(default_factory=dict)  # node → another that nothing chose
    held: dict[int, set[int]] = field(default_factory=dict)
    numbers: dict[Hashable, int] = field(default_factory=dict)
    literals: dict[int, tuple[object, ir.Pos, str]] = field(default_factory=dict)  # node → constant it is
    parameters: set[int] = field(default_factory=set)  # nodes of ROS parameters
    copies: set[int] = field(default_factory=set)  # nodes that pass on their only input unchanged
    carried: dict[int, tuple[int, int]] = field(
        default_factory=dict
    )  # node → who passed on what inside an object
    passed_on: dict[tuple[int, int], int] = field(default_factory=dict)  # (carrier, item) → its node of that
    arriving: dict[tuple[int, int], None] = field(
        default_factory=dict
    )  # (node of a carrier, what it carries)
    edges: int = 0  # of data, that the program at work made
    made: int = 0  # nodes that the program at work made
    grown: int = 0  # how often something new was inside an object that was passed on
    live: set[int] = field(default_factory=set)  # nodes that sources lead to, by data or by decisions
    onward: dict[int, list[int]] = field(default_factory=dict)  # where nodes lead that are not live yet
    asked: int = 0  # edges, and how much was looked at to tell through whom content arrives
    asking: set[tuple[int, int]] = field(default_factory=set)  # questions that are being answered
    reads: Reads = field(default_factory=Reads)  # of the call that is running

    def node(self, key: Hashable, place: Place, branches: Branches) -> int:
        """Return the node with this key, made at the first time."""
        number = self.numbers.get(key)
        if number is None:
            number = self.numbers[key] = len(self.places)
            self.made += 1
            self.places.append(place)
            self.data.append(set())
            self.control.append(set())
            self.branches.append(branches)
        return number

    def flow(self, deps: Iterable[int], node: int) -> None:
        """Let data of `deps` reach `node`, and the choice that was made for them."""
        edges = self.data[node]
        mine = self.branches[node]
        for dep in deps if self.edges < MAX_EDGES else islice(deps, FEW):
            self.asked += 1
            if dep == node:
                self.depend(node, [branch[0] for branch in mine])  # how often it ran is a choice, too
            if dep in edges or dep == node:
                continue
            edges.add(dep)
            self.edges += 1
            self._lead(dep, node)
            theirs = self.branches[dep]
            if theirs and not theirs <= mine:
                self._choose(dep, theirs - mine, node)

    def unchosen(self, dep: int) -> int:
        """Return a node that stands for another one where it does not matter what led there."""
        if dep in self.stands_for:
            return dep
        node = self.node((dep, "unchosen"), self.places[dep], frozenset())
        self.stands_for[node] = dep
        self.copies.add(node)
        self.data[node].add(dep)
        self._lead(dep, node)
        return node

    def meets(self, key: Hashable, deps: Nodes, *, carriers: bool) -> bool:
        """Tell whether too many values meet in a field to be told apart, or did before and more are added.

        `carriers`: they are pointers, whose content arrives by each of them as long as these are few.
        """
        return len(deps) > (MANY_CARRIERS if carriers else MANY) or self.numbers.get(("merged", key)) in deps

    def merged(self, key: Hashable, deps: Nodes, frame: Frame) -> Nodes:
        """Return one node in place of the many that meet in a field where everything adds up.

        Whoever reads the field depends on this node; what is added later is an edge, and news to nobody.
        """
        node = self.node(("merged", key), Place(frame, None, MERGED, (0, 0, 0, 0)), frozenset())
        self.flow([dep for dep in deps if dep != node], node)
        return frozenset([node])

    def choice(self, deps: Iterable[int], node: int) -> None:
        """Let only the choice that was made for `deps` reach `node`, not their data."""
        mine = self.branches[node]
        for dep in deps:
            if not self.branches[dep] <= mine:
                self._choose(dep, self.branches[dep] - mine, node)

    def _choose(self, dep: int, choice: Branches, node: int) -> None:
        """Say that which value arrives at `node` was decided by conditions that `node` is not under."""
        gate = self.node((dep, choice), self.places[dep], self.branches[node])
        self.gates[gate] = (dep, choice)
        self.depend(gate, [branch[0] for branch in choice])
        self.depend(node, (gate,))

    def depend(self, node: int, decisions: Iterable[int]) -> None:
        """Let a node depend on decisions."""
        edges = self.control[node]
        for decision in decisions:
            if decision not in edges:
                edges.add(decision)
                self._lead(decision, node)

    def begin(self, node: int) -> None:
        """Say that a node is a source, which makes all that it leads to live, now and later."""
        pending = [node]
        while pending:
            current = pending.pop()
            if current not in self.live:
                self.live.add(current)
                pending += self.onward.pop(current, ())

    def _lead(self, former: int, node: int) -> None:
        """Let a node be live as soon as what it is made from or depends on is."""
        if former not in self.live:
            self.onward.setdefault(former, []).append(node)
        elif node not in self.live:
            self.begin(node)

    def through(self, content: Nodes, carriers: Nodes) -> Nodes:
        """Return content as it arrives through pointers that the carriers passed on.

        Where a carrier passed the object when the content was already inside, a node of the carrier
        stands between.
        """
        if not content or not carriers or len(content) * len(carriers) > MAX_CARRIED:
            return content
        self.reads.ask(Graph.large, self)
        if self.large():
            return content
        self.asked += len(content) + len(carriers)
        self._consult(carriers)
        found: set[int] = set()
        taken: set[int] = set()
        for carrier in carriers:
            if carrier not in self.carried:
                passed = content & self.held.get(carrier, NOTHING)
                taken |= passed
                found.update([self._carry(carrier, item) for item in passed])
                continue
            inside = self.held.get(self._first(carrier))
            for item in content & inside if inside else ():
                arrived = self._by(carrier, item)
                if arrived:
                    found |= arrived
                    taken.add(item)
        return (content - taken) | found if found else content

    def large(self) -> bool:
        """Tell whether the program at work made too many nodes to say how content arrives."""
        return self.made > MAX_NODES

    def _consult(self, carriers: Nodes) -> None:
        """Note that it matters what carriers have passed on by now, and those through which they were carried."""
        noted = self.reads.held
        for carrier in carriers:
            while carrier not in noted:
                noted[carrier] = self.passed_by(carrier)
                if carrier in self.carried:
                    carrier = self.carried[carrier][1]

    def passed_by(self, carrier: int) -> int:
        """Return how many nodes were inside what a carrier passed on: they only become more."""
        return len(self.held.get(carrier, NOTHING))

    def free(self, node: int) -> bool:
        """Tell whether no decision led to a node so far."""
        return not self.control[node]

    def _first(self, carrier: int) -> int:
        """Return who first held what arrives by a carrier: what was not inside then does not come this way."""
        while carrier in self.carried:
            carrier = self.carried[carrier][1]
        return carrier

    def _by(self, carrier: int, item: int) -> Nodes | set[int]:
        """Return an item as passed on by one carrier, nothing when it was not inside then."""
        parts = self.carried.get(carrier)
        if parts is None:
            return {self._carry(carrier, item)} if item in self.held.get(carrier, ()) else set()
        outer, pointer = parts
        if (carrier, item) in self.asking:
            return set()
        self.asking.add((carrier, item))
        inner = self._by(pointer, item)
        self.asking.discard((carrier, item))
        return self.through(frozenset(inner), frozenset([outer])) if inner else inner

    def _carry(self, carrier: int, item: int) -> int:
        """Return the node of `item` being passed on inside an object by `carrier`.

        What was passed on before is the same thing still, so there are no more such nodes than pairs of a
        carrier and a first maker.
        """
        known = self.passed_on.get((carrier, item))
        if known is not None:
            return known
        origin = self.carried[item][1] if item in self.carried else item
        if carrier in (item, origin):
            return item
        node = self.node(("carry", carrier, origin), self.places[carrier], self.branches[carrier])
        if node not in self.carried:
            self.carried[node] = (carrier, origin)
            for decision, _ in self.branches[item]:
                self._lead(decision, node)
        self._lead(item, node)
        if item != node:
            self.arriving[node, item] = None
        self.passed_on[carrier, item] = node
        return node

    def settle(self) -> None:
        """Follow everything that was passed on inside objects back through those who passed it before."""
        done = self.made = 0
        while done < len(self.arriving):
            pending = list(islice(self.arriving, done, None))
            done += len(pending)
            for node, item in pending:
                carrier = self.carried[node][0]
                self.flow(self.through(frozenset([item]), frozenset(self.data[carrier])), node)
        self._feed()

    def _feed(self) -> None:
        """Let what goes in circles between objects begin somewhere: each maker feeds all that only pass it round."""
        circles: dict[int, list[int]] = {}
        for node, (_, origin) in self.carried.items():
            circles.setdefault(origin, []).append(node)
        for origin, nodes in circles.items():
            fed, rest = {origin}, nodes
            while news := [n for n in rest if not self.data[n].isdisjoint(fed)]:
                fed.update(news)
                rest = [n for n in rest if n not in fed]
            for node in rest:
                self.flow([origin], node)

    def hold(self, carrier: int, content: Nodes) -> None:
        """Remember what was inside an object when `carrier` passed it on."""
        if not content:
            return
        held = self.held.setdefault(carrier, set())
        if not content <= held:
            held |= content
            self.grown += 1
