"""SARIF of systems: hazards as results, and each system as a graph of its nodes and topics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from tarl_lint.files import shown
from tarl_lint.model import Span
from tarl_lint.report.line import Line
from tarl_lint.report.sarif import location, written
from tarl_lint.run.runner import Result
from tarl_lint.system.drawing import drawing_of
from tarl_lint.system.flow_chains import chains
from tarl_lint.system.model import Chain, System, place_of

CATEGORY: Final = "tarl-lint/launch"  # separates these results from the results of a run without launch files


def report(systems: Sequence[System], result: Result, origin: str = "", target: str = "") -> Iterator[Line]:
    """Yield the document in one line of ASCII, within the size that servers accept; the graphs are omitted first."""
    yield ((written(result, [_graph(one, origin, target) for one in systems], CATEGORY), ""),)


def _graph(system: System, origin: str, target: str) -> dict[str, Any]:
    """Return a system as a graph. Identifiers begin with `n ` for nodes and with `t ` for topics."""
    found, _ = chains(system.hops, origin, target)
    drawn = drawing_of(system, found if origin or target else None)
    places = {one.name: place_of(one) for one in reversed(system.instances)}
    pairs = [(f"t {topic}", f"n {node}", kind) for topic, node, kind in drawn.inputs]
    pairs += [(f"n {node}", f"t {topic}", "") for node, topic in drawn.outputs]
    return {
        "description": {"text": shown(system.file)},
        "nodes": [
            *(_node(name, places, read=name not in drawn.unread) for name in drawn.nodes),
            *({"id": f"t {name}", "label": {"text": name}, "properties": {"kind": "topic"}} for name in drawn.topics),
        ],
        "edges": [
            {
                "id": str(number),
                "sourceNodeId": one,
                "targetNodeId": other,
                **({"properties": {"flow": kind}} if kind else {}),
            }
            for number, (one, other, kind) in enumerate(pairs)
        ],
        "properties": {"flows": _flows(found)},
    }  # fmt: skip


def _node(name: str, places: Mapping[str, Span], *, read: bool) -> dict[str, Any]:
    place = {"location": location(places[name])} if name in places else {}
    return {
        "id": f"n {name}",
        "label": {"text": name},
        **place,
        "properties": {"kind": "node", "read": read},
    }


def _flows(found: Sequence[Chain]) -> list[dict[str, Any]]:
    """Return the flows across nodes, each as the names on its way: topic, node, topic and so on."""
    return [
        {
            "kind": one.kind,
            "path": [one.hops[0].source, *(name for hop in one.hops for name in (hop.node, hop.sink))],
        }
        for one in found
    ]
