"""The outcomes of tests of other projects that count as changed by recording."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def suites(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    monkeypatch.syspath_prepend(str(Path(__file__).parent.parent / "benchmarks"))
    yield __import__("third_party_suites")
    sys.modules.pop("third_party_suites", None)


@pytest.fixture
def different(suites: Any) -> Any:
    return suites.different


def test_outcome_only_with_recording_is_a_change(different) -> None:  # type: ignore[no-untyped-def]
    passed, failed = ["call passed"], ["call failed"]
    plain = {"a": passed, "b": passed, "c": failed}
    assert different([plain], plain) == []
    assert different([plain], {**plain, "b": failed}) == ["b"]
    assert different([plain, {**plain, "b": failed}], {**plain, "b": failed}) == []


def test_outcome_only_with_or_without_recording_is_a_change(different) -> None:  # type: ignore[no-untyped-def]
    plain = {"a": ["call passed"], "b": ["call passed"]}
    assert different([plain], {"a": plain["a"]}) == ["b"]
    assert different([{"a": plain["a"]}], plain) == ["b"]


@pytest.mark.parametrize(("failing", "left"), [({3}, []), (set(), ["a.py::test"])])
def test_changed_file_runs_again_without_recording(
    suites: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, failing: set[int], left: list[str]
) -> None:
    passed, failed = ["call passed"], ["call failed"]
    plain = {"a.py::test": passed, "b.py::test": passed}
    seen: list[tuple[str, ...]] = []

    def run(python: Path, suite: Any, *_: Path, record: bool) -> tuple[dict[str, Any], float]:
        assert not record
        seen.append(suite.tests)
        return {"tests": {"a.py::test": failed if len(seen) in failing else passed}}, 0.0

    monkeypatch.setattr(suites, "run", run)
    suite, recorded = suites.SUITES["click"], {**plain, "a.py::test": failed}
    more = suites.again(tmp_path, suite, tmp_path, tmp_path, [plain], recorded)
    assert suites.different([plain, *more], recorded) == left
    assert seen == [("a.py",)] * (3 if failing else suites.FILE_RUNS)
