"""Positions in the protocol: lines from 0, columns in UTF-16 code units."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("lsprotocol")

from lsprotocol import types

from pytest_tarl.editor.positions import Places, units
from tarl_lint.model import Span


@pytest.mark.parametrize(
    ("text", "count"), [("", 0), ("abc", 3), ("é", 1), ("\uffff", 1), ("\U00010000", 2), ("a🤖b🤖", 6)]
)
def test_characters_beyond_the_basic_plane_count_as_two_units(text: str, count: int) -> None:
    assert units(text) == count


@pytest.fixture
def places(tmp_path: Path) -> Places:
    return Places(tmp_path, {"a.py": "first\r\n🤖 = x\nlast", "b.py": "other"})


@pytest.mark.parametrize(
    ("path", "number", "text"),
    [
        ("a.py", 1, "first"),
        ("a.py", 2, "🤖 = x"),
        ("a.py", 3, "last"),
        ("a.py", 0, ""),
        ("a.py", -1, ""),
        ("a.py", 4, ""),
        ("b.py", 1, "other"),
        ("unknown.py", 1, ""),
    ],
)
def test_lines_start_at_one_without_line_endings(places: Places, path: str, number: int, text: str) -> None:
    assert places.line(path, number) == text


def test_a_span_becomes_a_range_of_code_units(places: Places, tmp_path: Path) -> None:
    span = Span("a.py", 2, 5, 2, 6)  # `x`
    expected = types.Range(types.Position(1, 5), types.Position(1, 6))
    assert places.range(span) == expected
    assert places.location(span) == types.Location((tmp_path / "a.py").as_uri(), expected)
    assert places.range(Span("a.py", 1, 1, 3, 5)) == types.Range(types.Position(0, 0), types.Position(2, 4))


def test_line_end_is_after_its_last_unit(places: Places) -> None:
    assert places.end_of_line("a.py", 1) == types.Position(0, 5)
    assert places.end_of_line("a.py", 2) == types.Position(1, 6)
    assert places.end_of_line("a.py", 9) == types.Position(8, 0)
