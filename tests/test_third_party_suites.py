"""Which outcomes of other projects' tests count as changed by recording."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest


@pytest.fixture
def different(monkeypatch: pytest.MonkeyPatch):  # type: ignore[no-untyped-def]
    monkeypatch.syspath_prepend(str(Path(__file__).parent.parent / "benchmarks"))
    yield __import__("third_party_suites").different
    sys.modules.pop("third_party_suites", None)


def test_an_outcome_that_no_plain_run_had_was_changed(different) -> None:  # type: ignore[no-untyped-def]
    passed, failed = ["call passed"], ["call failed"]
    plain = {"a": passed, "b": passed, "c": failed}
    assert different([plain], plain) == []
    assert different([plain], {**plain, "b": failed}) == ["b"]
    assert different([plain, {**plain, "b": failed}], {**plain, "b": failed}) == []


def test_a_test_that_only_one_side_has_was_changed(different) -> None:  # type: ignore[no-untyped-def]
    plain = {"a": ["call passed"], "b": ["call passed"]}
    assert different([plain], {"a": plain["a"]}) == ["b"]
    assert different([{"a": plain["a"]}], plain) == ["b"]
