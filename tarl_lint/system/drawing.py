"""The layout of a system's picture: nodes, topics, and edges for publishers and subscriptions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from tarl_lint.system.compose import SERVER, UNKNOWN
from tarl_lint.system.flow_chains import chains
from tarl_lint.system.model import Chain, System

BoxKind = Literal["topic", "node", "unread"]
# solid: data is published; dashed: data is used only in conditions, or the node was not read; faint: the node
# publishes nothing that depends on the topic; touching: like dashed, but without an arrowhead
EdgeKind = Literal["solid", "dashed", "faint", "touching"]


@dataclass(frozen=True)
class Drawing:
    """Names of nodes and topics, and edges between them, by name. Nodes in `unread` are drawn dashed.

    An edge from a topic to a node is `(topic, node, kind)`. `kind` is the kind of the strongest flow from the topic
    through the node; "" if there is no such flow. `touching` are pairs of a node that was not read and a topic that
    its remappings name. The key of a box is `n ` and the name of the node, or `t ` and the name of the topic.
    """

    nodes: tuple[str, ...]
    topics: tuple[str, ...]
    unread: frozenset[str]
    inputs: tuple[tuple[str, str, str], ...]
    outputs: tuple[tuple[str, str], ...]
    touching: tuple[tuple[str, str], ...]

    def kind(self, box: str) -> BoxKind:
        """Return the kind of the box with this key."""
        return "topic" if box.startswith("t ") else "unread" if box[2:] in self.unread else "node"

    def short_names(self, prefix: str) -> dict[str, str]:
        """Return an identifier of letters and digits for the key of each box, topics first."""
        topics = {f"t {name}": f"{prefix}t{number}" for number, name in enumerate(self.topics)}
        nodes = {f"n {name}": f"{prefix}n{number}" for number, name in enumerate(self.nodes)}
        return topics | nodes

    def edges(self) -> Iterator[tuple[str, str, EdgeKind]]:
        """Yield each edge: the keys of the boxes where it starts and ends, and its kind."""
        for topic, node, kind in self.inputs:
            yield f"t {topic}", f"n {node}", "solid" if kind == "explicit" else "dashed" if kind else "faint"
        for node, topic in self.outputs:
            yield f"n {node}", f"t {topic}", "dashed" if node in self.unread else "solid"
        for node, topic in self.touching:
            yield f"n {node}", f"t {topic}", "touching"


def drawing(system: System, origin: str = "", target: str = "") -> Drawing:
    """Return the picture of a system; equal systems have equal pictures.

    With `origin` or `target`, the picture has only the nodes and topics of the chains between these topics.
    """
    return drawing_of(system, chains(system.hops, origin, target)[0] if origin or target else None)


def drawing_of(system: System, only: Iterable[Chain] | None) -> Drawing:
    """Return the picture of a system, or of the chains `only`."""
    drawn = _everything(system)
    return drawn if only is None else _between(drawn, only)


def _between(drawn: Drawing, found: Iterable[Chain]) -> Drawing:
    hops = {hop for chain in found for hop in chain.hops}
    inputs, outputs = {(hop.source, hop.node) for hop in hops}, {(hop.node, hop.sink) for hop in hops}
    nodes = {hop.node for hop in hops}
    topics = {name for hop in hops for name in (hop.source, hop.sink)}
    return Drawing(
        tuple(one for one in drawn.nodes if one in nodes),
        tuple(one for one in drawn.topics if one in topics),
        drawn.unread & nodes,
        tuple(one for one in drawn.inputs if one[:2] in inputs),
        tuple(one for one in drawn.outputs if one in outputs),
        (),
    )


def _everything(system: System) -> Drawing:
    kinds: dict[tuple[str, str], str] = {}
    outputs: set[tuple[str, str]] = set()
    for hop in system.hops:
        key = (hop.source, hop.node)
        kinds[key] = "explicit" if "explicit" in (hop.kind, kinds.get(key)) else hop.kind
        outputs.add((hop.node, hop.sink))
    for instance in system.instances:
        for name, _ in instance.named("subscribes"):
            kinds.setdefault((name, instance.name), "")
    outputs |= {(one.name, name) for one in system.instances for name, _ in one.named("publishes")}
    inputs = tuple(sorted((topic, node, kind) for (topic, node), kind in kinds.items()))
    drawn = {(node, topic) for topic, node, _ in inputs} | outputs
    touching = {(one.name, name) for one in system.instances for name in one.touched} - drawn
    topics = {topic for _, topic in drawn | touching} - {UNKNOWN}
    nodes = [one for one in system.instances if one.node.kind != "test"]
    servers = [hop.node for hop in system.hops if hop.node.startswith(SERVER)]
    return Drawing(
        tuple(dict.fromkeys([*(one.name for one in nodes), *servers])),
        tuple(sorted(topics)),
        frozenset([*(one.name for one in nodes if one.interface is None), *servers]),
        tuple(one for one in inputs if one[0] in topics),
        tuple(sorted(one for one in outputs if one[1] in topics)),
        tuple(sorted(touching)),
    )


def layers(drawn: Drawing) -> list[list[str]]:
    """Return the boxes in columns, each after its predecessors."""
    edges = [(start, end) for start, end, _ in drawn.edges()]
    every = [*(f"n {one}" for one in drawn.nodes), *(f"t {one}" for one in drawn.topics)]
    forward = _without_cycles(every, edges)
    depth = dict.fromkeys(every, 0)
    for _ in every:
        moved = False
        for one, other in forward:
            if depth[other] <= depth[one]:
                depth[other], moved = depth[one] + 1, True
        if not moved:
            break
    entered = {other for _, other in forward}
    for name in every:  # names without predecessors are placed just before their successors
        after = [depth[other] for one, other in forward if one == name]
        if name not in entered and after:
            depth[name] = min(after) - 1
    columns: list[list[str]] = [[] for _ in range(max((at + 1 for at in depth.values()), default=0))]
    for name in every:
        columns[depth[name]].append(name)
    return _untangled(columns, forward)


def _without_cycles(every: Iterable[str], edges: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the edges without the back edges of a depth-first search."""
    after: dict[str, list[str]] = {}
    for one, other in edges:
        after.setdefault(one, []).append(other)
    entered = {other for _, other in edges}
    kept: list[tuple[str, str]] = []
    state: dict[str, int] = {}
    for start in sorted(every, key=lambda name: (name in entered, name)):
        pending = [(start, iter(after.get(start, ())))] if start not in state else []
        state.setdefault(start, 1)
        while pending:
            name, left = pending[-1]
            other = next(left, "")
            if not other:
                state[name] = 2
                pending.pop()
            elif state.get(other) != 1:
                kept.append((name, other))
                if other not in state:
                    state[other] = 1
                    pending.append((other, iter(after.get(other, ()))))
    return kept


def _untangled(columns: list[list[str]], edges: list[tuple[str, str]]) -> list[list[str]]:
    """Return the columns, each sorted by the predecessors' mean height (Sugiyama et al. 1981)."""
    before: dict[str, list[str]] = {}
    for one, other in edges:
        before.setdefault(other, []).append(one)
    height: dict[str, float] = {}
    ordered = []
    for column in columns:
        means = {
            name: sum(found) / len(found)
            for name in column
            if (found := [height[one] for one in before.get(name, ()) if one in height])
        }
        ordered.append(sorted(column, key=lambda name: (means.get(name, float(len(column))), name)))
        height.update({name: float(number) for number, name in enumerate(ordered[-1])})
    return ordered
