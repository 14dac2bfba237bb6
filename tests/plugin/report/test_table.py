"""The table of several drifts of one test."""

from __future__ import annotations

from pytest_tarl.report.table import side_by_side

MUD = ("t.py::test_a", "mud", "10.0", "4.00", "6.00", "degraded", "x ≥ 3")
SAME = ("t.py::test_a", "same", "10.0", "10.0", "0.00", "no difference", "")
OTHER = ("t.py::test_b", "mud", "1.0", "1.0", "0.0", "no difference", "")


def test_only_tests_with_several_drifts_get_a_table() -> None:
    assert side_by_side([MUD, OTHER], 100) == []
    title, head, *rows = side_by_side([MUD, OTHER, SAME], 100)
    assert title == "t.py::test_a, side by side"
    assert head.split() == ["designed", "deployed", "loss", "verdict", "where"]
    assert [row.split()[0] for row in rows] == ["mud", "same"]


def test_numbers_are_right_aligned_and_words_left_aligned() -> None:
    _, head, mud, same = side_by_side([MUD, SAME], 100)
    assert head.index("deployed") + len("deployed") == mud.index("4.00") + len("4.00")
    assert same.index("0.00") + len("0.00") == mud.index("6.00") + len("6.00")
    assert head.index("verdict") == mud.index("degraded") == same.index("no difference")


def test_tables_are_separated_and_cut_at_the_width() -> None:
    told = side_by_side([MUD, SAME, OTHER, OTHER], 40)
    assert told.count("") == 1
    rows = [line for line in told if line.startswith("  ")]
    assert len(rows) == 6
    assert max(map(len, rows)) <= 40
    assert "  mud" in rows[1]
    assert rows[1].endswith("…")
