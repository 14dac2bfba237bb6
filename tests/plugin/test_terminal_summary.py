"""The section of TARL at the end of a pytest run."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.accounts import Account
from pytest_tarl.terminal_summary import Summary, attach


def report(*lines: str, **given: Any) -> Any:
    found: Any = SimpleNamespace()
    attach(found, Account(lines, **given))
    return found


def collected(*reports: Any) -> Summary:
    found = Summary()
    for one in reports:
        found.collect(one)
    return found


def written(summary: Summary, *closing: str) -> list[str]:
    lines: list[str] = []
    terminal: Any = SimpleNamespace(
        section=lambda title, sep: lines.append(f"{sep} {title} {sep}"), write_line=lines.append
    )
    summary.write(terminal, 80, closing)
    return lines


def test_reports_are_separated_by_empty_lines() -> None:
    told = written(collected(report("one", "two"), report("three\x1b[1m")), "The end.")
    assert told == ["= TARL =", "one\ntwo", "\nthree\\x1b[1m", "\nThe end."]


def test_nothing_is_written_without_reports() -> None:
    assert written(collected(SimpleNamespace()), "The end.") == []


def test_a_report_is_collected_once_with_its_patch() -> None:
    one, other = report("one", patch=Path("a.patch")), report("two")
    found = collected(
        one, one, other, report("one", patch=Path("a.patch")), report("three", patch=Path("b.patch"))
    )
    assert found.patches == ["a.patch", "b.patch"]
    assert len(written(found)) == 4


def test_tests_without_a_recording_are_counted() -> None:
    missing, other = report("one", unrecorded=True), report("two")
    assert collected(other).warning() == ""
    assert (
        collected(missing)
        .warning()
        .startswith("NOTHING WAS COMPARED: 1 of 1 tests, since it has no recording.")
    )
    assert collected(missing, other).warning().startswith("NOT COMPARED: 1 of 2 tests, since it has")
    assert (
        collected(missing, other, report("three", unrecorded=True))
        .warning()
        .startswith("NOT COMPARED: 2 of 3 tests, since they have no recording.")
    )


def test_annotations_are_written_last_and_only_on_github(monkeypatch: pytest.MonkeyPatch) -> None:
    found = collected(report("one", annotation="::error::lost"), report("two"))
    for value, expected in (("", []), ("1", []), ("true", ["::error::lost"])):
        monkeypatch.setenv("GITHUB_ACTIONS", value)
        assert written(found, "End.")[4:] == expected


def test_drifts_of_a_test_are_compared_in_a_table() -> None:
    row = ("t.py::test", "mud", "degraded", "1", "2", "3", "4", "5", "6", "7")
    from pytest_tarl.report.table import HEAD

    rows = [(row[0], drift, *row[2 : len(HEAD) + 1]) for drift in ("mud", "wind")]
    told = written(collected(report("one", row=rows[0]), report("two", row=rows[1]), report("three")))
    assert len(told) == 5
    assert told[4].startswith("\nt.py::test, side by side")
    assert "mud" in told[4]
    assert "wind" in told[4]
