"""Orders, paths and chains on graphs small enough to be read."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.flows.ends import Ends
from tarl_lint.flows.precedence import Precedence
from tarl_lint.flows.shortest_path import ShortestPaths
from tarl_lint.flows.topological_order import in_order
from tarl_lint.model import Span
from tarl_lint.system import flow_chains as module
from tarl_lint.system.flow_chains import chains, slashed
from tarl_lint.system.model import Hop


def spans(count: int) -> dict[int, Span]:
    """Return a span for each key; the span of a lower key comes first."""
    return {key: Span("n.py", key + 1, 1, key + 1, 9) for key in range(count)}


@pytest.mark.parametrize(
    ("edges", "first", "expected"),
    [
        ([], None, [0, 1, 2, 3]),
        ([(3, 0)], None, [1, 2, 3, 0]),
        ([(3, 0), (0, 1)], None, [2, 3, 0, 1]),
        ([(1, 0), (0, 1)], None, [2, 3, 0, 1]),  # a cycle is broken by position
        ([(0, 0)], None, [0, 1, 2, 3]),
        ([(3, 0), (3, 0)], None, [1, 2, 3, 0]),
        ([(9, 0), (0, 9)], None, [0, 1, 2, 3]),  # keys without a span
        ([(0, 2)], {1}, [1, 0, 2, 3]),
        ([(1, 3)], {0}, [0, 1, 3, 2]),
        ([(0, 3)], {0, 1, 2}, [0, 1, 2, 3]),
    ],
)
def test_statements_are_ordered_by_edges_and_position(edges, first, expected):
    assert in_order(spans(4), Precedence(edges), first) == expected


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)).filter(lambda one: one[0] < one[1])))
def test_an_order_without_cycles_is_kept(edges):
    turned = [(6 - one, 6 - other) for one, other in edges]
    order = in_order(spans(7), Precedence(turned))
    assert sorted(order) == [*range(7)]
    assert all(order.index(one) < order.index(other) for one, other in turned)


def test_statements_used_in_a_loop_come_before_it():
    function = {1: "run", 2: "run", 3: "helper", 4: "helper", 5: "run", 9: "run"}
    edges = [(3, 2), (4, 3), (5, 2), (1, 9)]
    assert ahead(edges, [(2, 9)], function) == {3, 4}
    assert ahead(edges, [], function) == set()
    assert ahead(edges, [(3, 9)], function) == {3, 4}
    assert ahead(edges, [(2, 9), (2, 5)], function) == {3, 4}  # two loops use the same values
    assert ahead([(3, 2), (2, 3)], [(2, 9)], function) == {3}


def ahead(edges, turns, function) -> set[int]:
    """Return the statements that precede the loop's head 9 because the loop uses their values."""
    order = Precedence(edges)
    known = order.formers(9)
    order.add_ahead_of_loops(turns, function)
    return order.formers(9) - known


def test_copy_of_an_order_relation_is_independent():
    order = Precedence([(1, 2), (2, 2), (3, 2)])
    copied = order.copy()
    copied.update([(4, 2), (2, 1)])
    assert (order.formers(2), order.formers(1)) == ({1, 3}, set())
    assert (copied.formers(2), copied.formers(1)) == ({1, 3, 4}, {2})


def path(formers: dict[int, list[int]], statements: dict[int, int], ends=(0,), starts=(9,)):
    return ShortestPaths(ends, lambda node: formers.get(node, ()), statements.get).path_from({*starts})


def test_path_with_fewer_statements_is_shorter():
    statements = {0: 100, 1: 101, 2: 102, 9: 109, 5: 100, 6: 109}
    formers = {0: [1, 5], 1: [2], 2: [9], 5: [6], 6: [9]}
    assert path(formers, statements) == (109, 100)
    assert path({0: [1], 1: [2], 2: [9]}, statements) == (109, 102, 101, 100)


def test_nodes_without_a_statement_cost_nothing():
    assert path({0: [1, 2], 1: [9], 2: [3], 3: [9]}, {0: 100, 1: 101, 9: 109}) == (109, 100)
    assert path({0: [9]}, {0: 100}) == (100,)
    assert path({}, {0: 100}) == ()
    assert path({}, {0: 100}, starts=(0,)) == (100,)
    assert path({0: [1], 1: [0]}, {0: 100, 1: 101}) == ()


def test_the_first_of_equally_short_paths_is_taken():
    statements = {0: 100, 1: 101, 2: 102, 9: 109}
    assert path({0: [2, 1], 1: [9], 2: [9]}, statements) == (109, 102, 100)
    assert path({0: [1, 2], 1: [9], 2: [9]}, statements) == (109, 101, 100)


def hop(source: str, sink: str, kind="explicit", node="/n") -> Hop:
    return Hop(node, source, sink, kind)


def walked(hops: list[Hop], origin: str = "", target: str = "") -> list[str]:
    found, more = chains(hops, origin, target)
    assert not more
    return [" ".join([chain.hops[0].source, *(one.sink for one in chain.hops)]) for chain in found]


def test_chains_run_from_entry_to_exit_of_data():
    hops = [hop("/a", "/b"), hop("/b", "/c"), hop("/b", "/d"), hop("/x", "/c"), hop("/c", "/c")]
    assert walked(hops) == ["/a /b /c", "/a /b /d", "/x /c"]
    assert walked(hops, origin="b") == ["/b /c", "/b /d"]
    assert walked(hops, target="/b") == ["/a /b"]
    assert walked(hops, "a", "c") == ["/a /b /c"]
    assert walked(hops, "/d", "") == []
    assert walked(hops, "/a", "/x") == []


def test_a_chain_passes_through_each_topic_at_most_once():
    ring = [hop("/a", "/b"), hop("/b", "/c"), hop("/c", "/a")]
    assert walked(ring, "/a", "/c") == ["/a /b /c"]
    assert walked(ring) == ["/a /b", "/a /b /c", "/b /c", "/b /c /a", "/c /a", "/c /a /b"]


def test_chains_pass_through_their_target():
    hops = [hop("/a", "/b"), hop("/b", "/c"), hop("/b", "?"), hop("?", "/z")]
    assert walked(hops, "/a", "/b") == ["/a /b"]
    assert "/a /b ?" in walked(hops, "/a")


def test_the_search_for_chains_is_bounded(monkeypatch):
    monkeypatch.setattr(module, "STEPS", 2)
    line = [hop(f"/{n}", f"/{n + 1}") for n in range(5)]
    assert chains(line) == ((), True)
    monkeypatch.setattr(module, "STEPS", 5)
    assert walked(line) == ["/0 /1 /2 /3 /4 /5"]
    monkeypatch.setattr(module, "MOST", 1)
    found, more = chains([hop("/a", "/b"), hop("/a", "/c")])
    assert (len(found), more) == (1, True)
    found, more = chains([hop("/a", "/b")])
    assert (len(found), more) == (1, False)


def test_a_chain_is_as_strong_as_its_weakest_hop():
    def kind(*kinds: str) -> str:
        hops = [hop(f"/{n}", f"/{n + 1}", one) for n, one in enumerate(kinds)]
        (chain,), _ = chains(hops)
        return chain.kind

    assert kind("explicit", "explicit") == "explicit"
    assert kind("explicit", "implicit") == "implicit"
    assert kind("implicit", "not read") == "not read"
    assert slashed("scan") == slashed("/scan") == "/scan"


class Texts:
    """Source files in which the text of a span consists of the first four numbers of that span."""

    def __getitem__(self, path: str) -> Texts:
        self.path = path
        return self

    def stretch(self, pos) -> Span:
        return Span(self.path, *pos)


class Record:
    def __init__(self, line: int, *topics: str, qualname: str = "f") -> None:
        self.module, self.qualname, self.topics, self.types = "m", qualname, {*topics}, {"B", "A"}
        self.path, self.pos, self.api = "n.py", (line, 1, line, 9), "pub"
        self.callbacks, self.registered, self.via = {"b", "a"}, set(), {("n.py", (7, 1, 7, 2))}


def test_sinks_with_equal_topics_are_numbered():
    first, second, other, elsewhere = (
        Record(3, "/x"),
        Record(5, "/x"),
        Record(4, "/y"),
        Record(6, "/x", qualname="g"),
    )
    ends = Ends(Texts(), [second, first, other, elsewhere])
    assert [ends.sink(one).id for one in (first, second, other, elsewhere)] == [
        "m:f:/x#1",
        "m:f:/x#2",
        "m:f:/y",
        "m:g:/x",
    ]
    assert ends.sink(first).type == "A | B"
    unnamed = Record(8, qualname="")
    assert Ends(Texts(), [unnamed]).sink(unnamed).id == "m:<module>:line 8"


def test_a_source_is_named_by_its_topics_and_callbacks():
    ends = Ends(Texts(), [])
    source = ends.source(Record(3, "/y", "/x"))
    assert (source.id, source.topics, source.callback) == ("m:f:/x, /y:a, b", ("/x", "/y"), "a, b")
    assert source.registered == (Span("n.py", 3, 1, 3, 9),)
    assert source.via == (Span("n.py", 7, 1, 7, 2),)
    bare = Record(4)
    bare.callbacks, bare.registered = set(), {("o.py", (2, 1, 2, 3)), ("n.py", (9, 1, 9, 3))}
    assert ends.source(bare).id == "m:f:line 4:pub"
    assert ends.source(bare).registered == (Span("n.py", 9, 1, 9, 3), Span("o.py", 2, 1, 2, 3))
