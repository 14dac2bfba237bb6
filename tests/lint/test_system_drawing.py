"""Columns of a system picture: each node follows its inputs; topics without a publisher directly precede readers."""

from __future__ import annotations

from tarl_lint.system.drawing import Drawing, layers


def drawn(*edges: str) -> list[list[str]]:
    """Return the columns of edges, each sorted by name."""
    return [sorted(column) for column in layers(picture(*edges))]


def picture(*edges: str) -> Drawing:
    """Return the drawing of edges such as `t a > n one`; inputs begin with a topic, outputs with a node."""
    pairs = [tuple(edge.split(" > ")) for edge in edges]
    names = sorted({name for pair in pairs for name in pair})
    return Drawing(
        nodes=tuple(name[2:] for name in names if name.startswith("n ")),
        topics=tuple(name[2:] for name in names if name.startswith("t ")),
        inputs=tuple((a[2:], b[2:], "explicit") for a, b in pairs if a.startswith("t ")),
        outputs=tuple((a[2:], b[2:]) for a, b in pairs if a.startswith("n ")),
        touching=(),
        unread=frozenset(),
    )


LINE = ("t a > n one", "n one > t b", "t b > n two", "n two > t c")


def test_chain_of_nodes_has_one_name_per_column():
    assert drawn(*LINE) == [["t a"], ["n one"], ["t b"], ["n two"], ["t c"]]
    assert drawn() == []


def test_topic_without_publisher_is_drawn_before_its_reader():
    assert drawn(*LINE, "t late > n two")[2] == ["t b", "t late"]
    early = drawn(*LINE, "t x > n three", "n three > t c")
    assert early[:2] == [["t a", "t x"], ["n one", "n three"]]


def test_a_cycle_is_cut_where_it_closes():
    assert drawn(*LINE, "t c > n one") == [["t a"], ["n one"], ["t b"], ["n two"], ["t c"]]


def test_column_is_ordered_by_the_height_of_its_inputs():
    crossing = picture("t a > n z", "t b > n y", "t c > n x", "t a > n x", "t a > n w", "t b > n w")
    # heights: a 0, b 1, c 2; means: z 0, y 1, x (2 + 0) / 2 = 1, w (0 + 1) / 2 = 0.5; equal means by name
    assert layers(crossing) == [["t a", "t b", "t c"], ["n z", "n w", "n x", "n y"]]
