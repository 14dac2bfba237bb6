"""The shortest path of a flow, from a message's arrival to the publish call, is minimal."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise, product
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.api import analyse
from tarl_lint.flows.shortest_path import ShortestPaths

CASES = sorted((Path(__file__).parent.parent / "cases").glob("*.py"))


@st.composite
def graphs(draw: st.DrawFn) -> tuple[list[list[int]], dict[int, int]]:
    """Draw the dependencies of each node, and the statements of some nodes."""
    size = draw(st.integers(2, 7))
    nodes = st.integers(0, size - 1)
    formers = draw(st.lists(st.lists(nodes, max_size=3, unique=True), min_size=size, max_size=size))
    statements = draw(st.dictionaries(nodes, st.integers(100, 103), max_size=size))
    return formers, statements


def cheapest(formers: list[list[int]], statements: Mapping[int, int], start: int, end: int) -> float:
    """Return the least number of statement changes on a path, by Bellman-Ford relaxation."""
    cost = [float("inf")] * len(formers)
    cost[end] = 0
    for _, node in product(formers, range(len(formers))):
        for former in formers[node]:
            step = former in statements and statements[former] != statements.get(node)
            cost[former] = min(cost[former], cost[node] + step)
    return cost[start]


@given(graphs())
def test_the_reported_path_is_a_shortest_path(graph: tuple[list[list[int]], dict[int, int]]) -> None:
    formers, statements = graph
    path = ShortestPaths([0], formers.__getitem__, statements.get).path_from({1})
    least = cheapest(formers, statements, 1, 0)
    assert len(path) <= (least + 1 if least < float("inf") else 0)
    assert set(path) <= set(statements.values())


@given(graphs(), st.lists(st.sets(st.integers(0, 6)), min_size=1, max_size=3))
def test_shared_search_finds_the_paths_of_separate_searches(
    graph: tuple[list[list[int]], dict[int, int]], starts: list[set[int]]
) -> None:
    formers, statements = graph
    shared = ShortestPaths([0], formers.__getitem__, statements.get)
    for start in starts:
        reached = reached_from(start, formers)

        def inside(node: int, reached: set[int] = reached) -> list[int]:
            return [former for former in formers[node] if former in reached]

        ends = [0] if 0 in reached else []
        assert shared.path_from(start) == ShortestPaths(ends, inside, statements.get).path_from(start)


def reached_from(start: set[int], formers: list[list[int]]) -> set[int]:
    """Return the nodes that some nodes lead to."""
    found = set(start)
    while more := {node for node, before in enumerate(formers) if not found.isdisjoint(before)} - found:
        found |= more
    return found


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)
def test_every_flow_has_a_path_to_its_publish_call(case: Path) -> None:
    flows = analyse([case]).flows
    assert flows
    for flow in flows:
        path = [flow.steps[place] for place in flow.chain]
        assert path, flow
        assert path[-1].role == "publish"
        assert path[0].role == "receive" or not any(step.role == "receive" for step in flow.steps)
        assert len(set(flow.chain)) == len(flow.chain)
        if flow.kind == "explicit":
            assert {step.dependence for step in path} == {"data"}
        assert all(a != b for a, b in pairwise(path))
