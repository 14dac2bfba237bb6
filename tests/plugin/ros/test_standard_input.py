"""The standard input of code outside nodes while nodes run."""

from __future__ import annotations

import io
import sys

import pytest

from pytest_tarl.ros.keyboard import _StandardInput


def test_the_real_stream_is_used_for_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    real = io.StringIO("a\nb\n")
    ours = _StandardInput(real)
    monkeypatch.setattr(sys, "stdin", ours)
    with ours.by_real():
        assert sys.stdin is real
    assert sys.stdin is ours
    with pytest.raises(ValueError, match="inside"), ours.by_real():
        raise ValueError("inside")
    assert sys.stdin is ours  # type: ignore[comparison-overlap]
    assert list(ours) == ["a\n", "b\n"]
    assert ours.getvalue() == "a\nb\n"


def test_a_stream_that_a_test_has_replaced_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    other = io.StringIO()
    ours = _StandardInput(io.StringIO())
    monkeypatch.setattr(sys, "stdin", other)
    with ours.by_real():
        assert sys.stdin is other
    assert sys.stdin is other
