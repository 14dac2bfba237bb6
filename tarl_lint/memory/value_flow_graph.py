"""The value-flow graph: nodes are values made by statements, edges are their dependencies.

Terms: content is the set of nodes inside an object. A carrier is a node that passed on a pointer to the object. A
choice is the set of branches that selected a value. A node is live if a source reaches it.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Set
from dataclasses import dataclass, field
from itertools import islice

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import Reads, complete
from tarl_lint.memory.values import Branches, Nodes

MAX_NODES = 12_000  # if a program has more nodes than this, content arrives without carriers
# after this number of data edges in a program, at most FEW dependencies of a value get edges
MAX_EDGES = 200_000
FEW = 8
MANY = 16  # maximum number of separate nodes in a field with weak updates; more nodes are merged
MANY_CARRIERS = 64  # the same limit for a field that holds pointers to objects with content
MERGED = "merged"  # role of the merged node of a field
NOTHING: Set[int] = frozenset()
# way of a branch that decides which element a call removes; the number of elements does not depend on it
WHICH = "which"
CARRIED = 5  # this number of carriers, or of items that carriers pass on, counts as one graph operation
# content arrives without carriers if the number of items times the number of carriers is greater than this
MAX_CARRIED = 500


@dataclass(slots=True)
class Place:
    """The place of a node: a statement in a frame, or only a frame for an arriving message."""

    frame: Frame
    statement: ir.Stmt | None
    role: str
    pos: ir.Pos


@dataclass(slots=True, eq=False)
class Arrival:
    """The nodes by which items arrive.

    `consulted` maps each carrier that was consulted to the number of nodes that it had passed on.
    """

    nodes: Nodes
    consulted: dict[int, int]
    grown: int  # value of `Graph.grown` when this result was last known to be valid


@dataclass(slots=True, eq=False)
class Graph:
    """The graph. Edges lead backwards, from a node to its dependencies.

    `held[c]` has the nodes that were inside an object when carrier `c` passed it on. A value that is read from the
    object later, and comes from one of these nodes, depends on `c`.
    """

    places: list[Place] = field(default_factory=list)
    data: list[set[int]] = field(default_factory=list)
    control: list[set[int]] = field(default_factory=list)
    branches: list[Branches] = field(default_factory=list)
    # node → (node of the value, conditions that selected this value)
    gates: dict[int, tuple[int, Branches]] = field(default_factory=dict)
    counts: dict[int, set[int]] = field(
        default_factory=dict
    )  # node of a container's length → dependencies of the elements
    # copy of a node that lacks the conditions of the node → the node itself
    stands_for: dict[int, int] = field(default_factory=dict)
    held: dict[int, set[int]] = field(default_factory=dict)
    numbers: dict[Hashable, int] = field(default_factory=dict)
    literals: dict[int, tuple[object, ir.Pos, str]] = field(default_factory=dict)  # node → its constant
    parameters: set[int] = field(default_factory=set)  # nodes of ROS parameters
    copies: set[int] = field(default_factory=set)  # nodes that pass on their only input unchanged
    carried: dict[int, tuple[int, int]] = field(
        default_factory=dict
    )  # carry node → (carrier, origin of the content)
    passed_on: dict[tuple[int, int], int] = field(default_factory=dict)  # (carrier, item) → carry node
    arriving: dict[tuple[int, int], None] = field(
        default_factory=dict
    )  # (carry node, item), in order of creation
    edges: int = 0  # number of data edges of the current program
    made: int = 0  # number of nodes of the current program
    grown: int = 0  # number of times that any `held` set has grown
    live: set[int] = field(default_factory=set)  # nodes that a source reaches by data or control
    onward: dict[int, list[int]] = field(default_factory=dict)  # node that is not live yet → its successors
    asked: int = 0  # number of graph operations not yet charged as work
    asking: set[tuple[int, int]] = field(
        default_factory=set
    )  # arguments of the calls of `_by` that are running, to prevent infinite recursion
    arrivals: dict[tuple[int, int], Arrival] = field(
        default_factory=dict
    )  # cache of `_arrival`, by carrier and item
    ways_through: dict[tuple[Nodes, Nodes], Arrival] = field(
        default_factory=dict
    )  # cache of `through`, by content and carriers
    reads: Reads = field(default_factory=Reads)  # values and facts that the running call has read

    def node(self, key: Hashable, place: Place, branches: Branches) -> int:
        """Return the node with this key; create it at first use."""
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
        """Add data edges from `node` to `deps`, and gates for the choices that selected them."""
        edges, branches = self.data[node], self.branches
        mine = branches[node]
        for dep in deps if self.edges < MAX_EDGES else islice(deps, FEW):
            self.asked += 1
            if dep == node:
                self.depend(
                    node, [branch[0] for branch in mine]
                )  # a value that depends on itself is computed in a loop, so it depends on the loop's condition as well
                continue
            if dep in edges:
                continue
            edges.add(dep)
            self.edges += 1
            self._lead(dep, node)
            theirs = branches[dep]
            if theirs and not theirs <= mine:
                self._choose(dep, theirs - mine, node)

    def unchosen(self, dep: int) -> int:
        """Return a copy of a node without its branches, for values that are equal on all paths."""
        if dep in self.stands_for:
            return dep
        node = self.node((dep, "unchosen"), self.places[dep], frozenset())
        self.stands_for[node] = dep
        self.copies.add(node)
        self.data[node].add(dep)
        self._lead(dep, node)
        return node

    def one_of(self, dep: int) -> int:
        """Return a copy of a node that keeps its conditions as data, for one of several constants.

        A loop may be executed for each constant apart. Each is then a known constant, but the conditions decide which
        constants there are.
        """
        inner = self.node((dep, "conditional"), self.places[dep], frozenset())
        self.flow((dep,), inner)
        node = self.node((dep, "one of"), self.places[dep], frozenset())
        self.copies |= {inner, node}
        self.flow((inner,), node)
        return node

    def under(self, dep: int, decision: int, instead: Branches) -> int:
        """Return a copy of a node for readers to which other conditions apply.

        The copy has these conditions in place of a decision of the node.
        """
        branches = self.branches[dep]
        left = frozenset(branch for branch in branches if branch[0] != decision)
        if len(left) == len(branches):
            return dep
        node = self.node((dep, "under", decision, instead), self.places[dep], left | instead)
        self.copies.add(node)
        self.data[node].add(dep)
        self._lead(dep, node)
        return node

    def meets(self, key: Hashable, deps: Nodes, *, carriers: bool) -> bool:
        """Return whether a field has too many values for separate nodes, or has a merged node already.

        With `carriers`, the values are pointers, and the limit is MANY_CARRIERS.
        """
        return len(deps) > (MANY_CARRIERS if carriers else MANY) or self.numbers.get(("merged", key)) in deps

    def merged(self, key: Hashable, deps: Nodes, frame: Frame) -> Nodes:
        """Return the merged node of a field with weak updates, with edges to all of `deps`.

        Readers of the field depend on this node, so a later value adds an edge and leaves the field unchanged.
        """
        node = self.node(("merged", key), Place(frame, None, MERGED, (0, 0, 0, 0)), frozenset())
        self.flow([dep for dep in deps if dep != node], node)
        return frozenset([node])

    def choice(self, deps: Iterable[int], node: int, *, counted: bool = False) -> None:
        """Make `node` depend on the choices that selected `deps`, but not on the data in `deps`.

        With `counted`, only the number of elements matters, so WHICH element was removed is left out.
        """
        mine = self.branches[node]
        for dep in deps:
            theirs = self.branches[dep]
            if theirs <= mine:
                continue
            chosen = theirs - mine
            if counted:
                chosen = frozenset(branch for branch in chosen if branch[1] != WHICH)
            if chosen:
                self._choose(dep, chosen, node)

    def without_removals(self, deps: Nodes) -> Nodes:
        """Return nodes without those that only say WHICH element was removed."""
        return frozenset(d for d in deps if all(way != WHICH for _, way in self.branches[d]))

    def _choose(self, dep: int, choice: Branches, node: int) -> None:
        """Add a gate: besides its own conditions, `node` depends on the conditions that selected `dep`."""
        gate = self.node((dep, choice), self.places[dep], self.branches[node])
        self.gates[gate] = (dep, choice)
        self.depend(gate, [branch[0] for branch in choice])
        self.depend(node, (gate,))

    def depend(self, node: int, decisions: Iterable[int]) -> None:
        """Add control edges from a node to decisions."""
        edges = self.control[node]
        for decision in decisions:
            if decision not in edges:
                edges.add(decision)
                self._lead(decision, node)

    def begin(self, node: int) -> None:
        """Make a node live, and also everything that depends on the node, now or later."""
        pending = [node]
        while pending:
            current = pending.pop()
            if current not in self.live:
                self.live.add(current)
                pending += self.onward.pop(current, ())

    def _lead(self, former: int, node: int) -> None:
        """Make a node live as soon as its dependency `former` is live."""
        if former not in self.live:
            self.onward.setdefault(former, []).append(node)
        elif node not in self.live:
            self.begin(node)

    def through(self, content: Nodes, carriers: Nodes) -> Nodes:
        """Return content after carriers of a pointer have passed it on.

        If the content was already inside the object when a carrier passed the object on, a carry node replaces the
        content.
        """
        if not content or not carriers or len(content) * len(carriers) > MAX_CARRIED:
            return content
        large, facts = self.made > MAX_NODES, self.reads.facts
        question = (Graph.large, self)
        if question not in facts:
            facts[question] = large
        if large:
            return content
        if self.asking:  # inside a cycle of carriers, the result is not complete
            return self._through(content, carriers)
        known = self.ways_through.get((content, carriers))
        if known is None or (known.grown != self.grown and not self._still(known)):
            known = self._consulting(lambda: self._through(content, carriers))
            self.ways_through[content, carriers] = known
        if known not in self.reads.arrivals:
            self._note(known)
        return known.nodes

    def arriving_through(self, item: int, carriers: Set[int]) -> Set[int]:
        """Return the result of `through` for one item, without caching it or recording its dependencies."""
        if len(carriers) > MAX_CARRIED or self.large():
            return {item}
        held = self.held
        found: set[int] = set()
        for carrier in carriers:
            if carrier not in self.carried:
                if item in held.get(carrier, NOTHING):
                    found.add(self._carry(carrier, item))
            elif item in held.get(self._first(carrier), NOTHING):
                found |= self._arrival(carrier, item)
        return found or {item}

    def _consulting(self, find: Callable[[], Nodes]) -> Arrival:
        """Call a function; return its result, and the carriers that the function consulted."""
        reads = self.reads
        outer = reads.held, reads.arrivals
        reads.held, reads.arrivals = {}, set()
        found = Arrival(find(), reads.held, self.grown)
        reads.held, reads.arrivals = outer
        return found

    def _still(self, known: Arrival) -> bool:
        """Return whether every carrier has passed on the same nodes as when a result was computed."""
        if known.grown != self.grown:
            self.asked += len(known.consulted) // CARRIED
            if not self.as_passed(known.consulted):
                return False
            known.grown = self.grown
        return True

    def as_passed(self, sizes: Mapping[int, int]) -> bool:
        """Return whether each carrier has passed on as many nodes as `sizes` says."""
        held = self.held
        for carrier, size in sizes.items():
            passed = held.get(carrier)
            if (0 if passed is None else len(passed)) != size:
                return False
        return True

    def _note(self, known: Arrival) -> None:
        """Make the running call depend on the carriers that were consulted for a result."""
        self.reads.arrivals.add(known)
        complete(self.reads.held, known.consulted)

    def _through(self, content: Nodes, carriers: Nodes) -> Nodes:
        """Return content after carriers have passed it on; create the necessary carry nodes."""
        self.asked += len(carriers) // CARRIED
        self._consult(carriers)
        found: set[int] = set()
        taken: set[int] = set()
        for carrier in carriers:
            if carrier not in self.carried:
                passed = content & self.held.get(carrier, NOTHING)
                if passed:
                    self.asked += len(passed) // CARRIED
                    taken |= passed
                    found.update([self._carry(carrier, item) for item in passed])
                continue
            inside = self.held.get(self._first(carrier))
            for item in content & inside if inside else ():
                arrived = self._arrival(carrier, item)
                if arrived:
                    found |= arrived
                    taken.add(item)
        return (content - taken) | found if found else content

    def large(self) -> bool:
        """Return whether the current program has too many nodes to track carriers."""
        return self.made > MAX_NODES

    def _consult(self, carriers: Nodes) -> None:
        """Record a dependency on the numbers of nodes passed on by carriers and by their carriers."""
        noted, held, carried = self.reads.held, self.held, self.carried
        for carrier in carriers:
            while carrier not in noted:
                passed = held.get(carrier)
                noted[carrier] = 0 if passed is None else len(passed)
                if carrier in carried:
                    carrier = carried[carrier][1]

    def passed_by(self, carrier: int) -> int:
        """Return the number of nodes inside the objects that a carrier passed on. This number never decreases."""
        return len(self.held.get(carrier, NOTHING))

    def free(self, node: int) -> bool:
        """Return whether a node has no control dependencies so far."""
        return not self.control[node]

    def _first(self, carrier: int) -> int:
        """Return the first carrier of a chain. Only content that this carrier held can have come along the chain."""
        while carrier in self.carried:
            carrier = self.carried[carrier][1]
        return carrier

    def _arrival(self, carrier: int, item: int) -> Nodes:
        """Return the nodes by which a carrier passes on an item; cached until a consulted carrier passes on more."""
        if self.asking:
            return frozenset(self._by(carrier, item))
        known = self.arrivals.get((carrier, item))
        if known is None or not self._still(known):
            known = self._consulting(lambda: frozenset(self._by(carrier, item)))
            self.arrivals[carrier, item] = known
        if known not in self.reads.arrivals:
            self._note(known)
        return known.nodes

    def forget_arrivals(self) -> None:
        """Drop the cached results about carriers; they are computed again at the next use."""
        self.arrivals.clear()
        self.ways_through.clear()

    def _by(self, carrier: int, item: int) -> Nodes | set[int]:
        """Return an item as passed on by a carrier; empty if it was not in the object at that time."""
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
        """Return the carry node of `item`, passed on inside an object by `carrier`.

        A carried item keeps its origin. Each pair of carrier and origin therefore has at most one carry node.
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

    def hold(self, carrier: int, content: Nodes) -> None:
        """Record the content of an object that `carrier` passes on."""
        if not content:
            return
        held = self.held.setdefault(carrier, set())
        if not content <= held:
            held |= content
            self.grown += 1
