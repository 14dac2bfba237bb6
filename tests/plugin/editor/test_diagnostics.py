"""Findings as diagnostics and code lenses: ranges, severities, the statements of a flow, the titles."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("lsprotocol")

from lsprotocol import types
from lsprotocol.types import DiagnosticSeverity as Severity

from pytest_tarl.editor import diagnostics
from pytest_tarl.editor.positions import Places
from tarl_lint.run.runner import Result
from tests.plugin.editor.graphs import TEXT, finding, flow, span, step

PUBLISH = types.Range(types.Position(3, 4), types.Position(3, 22))


@pytest.fixture
def places(tmp_path: Path) -> Places:
    return Places(tmp_path, {"pilot.py": TEXT, "other.py": "a\nb\n"})


def one(found: Any, places: Places) -> types.Diagnostic:
    (diagnostic,) = diagnostics.diagnostics(Result(findings=(found,)), places)[found.span.path]
    return diagnostic


def test_only_linted_files_and_findings_have_entries(places: Places) -> None:
    elsewhere = finding("TARL201", span=span(1, path="elsewhere.py"))
    result = Result(findings=(finding(of=flow()), elsewhere), texts={"pilot.py": TEXT, "other.py": "a\nb\n"})
    counts = {path: len(shown) for path, shown in diagnostics.diagnostics(result, places).items()}
    assert counts == {"pilot.py": 1, "other.py": 0, "elsewhere.py": 1}


def test_diagnostic_has_the_range_and_code_of_its_finding(places: Places) -> None:
    shown = one(finding(of=flow()), places)
    assert (shown.range, shown.message, shown.code) == (PUBLISH, "message of TARL101", "TARL101")
    assert shown.source == "tarl-lint"
    assert shown.data == {"fingerprint": "f1", "code": "TARL101", "new": True}
    accepted = one(finding(of=flow(), status="accepted"), places)
    assert accepted.data == {"fingerprint": "f1", "code": "TARL101", "new": False}


@pytest.mark.parametrize(
    ("code", "status", "severity"),
    [
        ("TARL101", "new", Severity.Information),
        ("TARL201", "new", Severity.Warning),
        ("TARL102", "accepted", Severity.Hint),
        ("TARL201", "accepted", Severity.Hint),
    ],
)
def test_severity_depends_on_hazard_flow_or_acceptance(
    places: Places, code: str, status: Any, severity: Severity
) -> None:
    assert one(finding(code, status=status), places).severity == severity


@pytest.mark.parametrize(
    ("chain", "told"),
    [
        ((1,), ["condition: if free"]),
        ((1, 0), ["condition: if free", "assign: speed = 2 * goal"]),
        ((), ["assign: speed = 2 * goal", "condition: if free"]),
    ],
)
def test_a_flow_lists_its_shortest_chain_or_all_statements(
    places: Places, tmp_path: Path, chain: tuple[int, ...], told: list[str]
) -> None:
    related = one(finding(of=flow(chain=chain)), places).related_information or []
    assert [step.message for step in related] == told
    assert {step.location.uri for step in related} == {(tmp_path / "pilot.py").as_uri()}
    lines = {"assign": 1, "condition": 2}
    assert [step.location.range.start.line for step in related] == [
        lines[text.partition(":")[0]] for text in told
    ]


def test_a_hazard_lists_no_statements(places: Places) -> None:
    assert one(finding("TARL201"), places).related_information is None


@pytest.mark.parametrize(("site", "page"), [("", None), ("https://a.example/", "https://a.example/rules/")])
def test_code_links_to_the_page_of_its_rule(
    places: Places, monkeypatch: pytest.MonkeyPatch, site: str, page: str | None
) -> None:
    monkeypatch.setattr("tarl_lint.documentation.site", lambda: site)
    found = one(finding("TARL201"), places).code_description
    assert found == (types.CodeDescription(f"{page}TARL201/") if page else None)


@pytest.mark.parametrize(
    ("line", "start", "end"),
    [
        (2, (1, 0), (1, 16)),
        (9, (8, 0), (8, 0)),  # a line that the editor does not have
        (1, (0, 0), (0, 12)),
    ],
)
def test_unreadable_file_has_an_error_on_its_line(
    places: Places, line: int, start: tuple[int, int], end: tuple[int, int]
) -> None:
    error: Any = SimpleNamespace(path="pilot.py", line=line, message="invalid syntax")
    shown = diagnostics.diagnostics(Result(errors=(error,), texts={"pilot.py": TEXT}), places)["pilot.py"]
    assert [(one.severity, one.code, one.source) for one in shown] == [
        (Severity.Error, "TARL001", "tarl-lint")
    ]
    assert shown[0].message == "invalid syntax"
    assert shown[0].range == types.Range(types.Position(*start), types.Position(*end))


def test_code_lenses_follow_the_order_of_the_file(places: Places) -> None:
    later, first = span(4, 5, 23), span(2, 1, 5)
    result = Result(
        findings=(
            finding(of=flow()),
            finding("TARL102", of=flow("implicit", ("/stop",))),
            finding("TARL201"),
            finding(of=flow(at=span(1, path="other.py"))),
        ),
        silenced=(finding(of=flow(topics=("/odom",), at=first)),),
    )
    shown = diagnostics.lenses(result, "pilot.py", places)
    assert [one.range for one in shown] == [places.range(first), places.range(later)]
    assert [one.command and one.command.title for one in shown] == [
        "data of /odom",
        "data of /goal, decided by /stop",
    ]


@pytest.mark.parametrize(
    ("flows", "title"),
    [
        ([flow(), flow(topics=("/a",)), flow()], "data of /a, /goal"),
        ([flow("implicit", ("/x", "/y"))], "decided by /x or /y"),
        ([flow(topics=(), callback="on_scan")], "data of a topic received in on_scan"),
        ([flow(topics=(), callback="")], "data of a topic received in a call"),
        ([], ""),
    ],
)
def test_code_lens_names_each_topic_once(flows: Any, title: str) -> None:
    assert diagnostics.title(flows) == title


def test_statements_of_other_files_are_located_in_these_files(places: Places, tmp_path: Path) -> None:
    (told,) = one(finding(of=flow(steps=(step(2, "b", path="other.py"),))), places).related_information or []
    assert told.location.uri == (tmp_path / "other.py").as_uri()
    assert told.location.range.start == types.Position(1, 0)
