"""GitLab code quality: new findings; GitLab compares them with the findings of the target branch."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, Final

from tarl_lint.fingerprints import digest
from tarl_lint.model import Cut, Span
from tarl_lint.report.grading import Level, level, of_error, told_apart
from tarl_lint.report.line import Line, View
from tarl_lint.run.runner import UNREADABLE, Result

_SEVERITIES: Final[Mapping[Level, str]] = {"note": "info", "warning": "minor", "error": "major"}


def report(result: Result, _view: View) -> Iterator[Line]:
    """Yield the document."""
    yield ((json.dumps(document(result), indent=1), ""),)


def document(result: Result) -> list[dict[str, Any]]:
    """Return unreadable files, new findings and incomplete programs. Each fingerprint occurs once."""
    errors = [
        _entry(UNREADABLE, e.message, of_error(e), Span(e.path, e.line, 1, e.line, 1), "warning")
        for e in result.errors
        if result.names_errors
    ]
    found = [
        _entry(f.code, f.message, identity, f.span, level(f.code, result))
        for f, identity in told_apart(result.findings)
        if f.status == "new"
    ]
    return errors + found + [_incomplete(cut) for cut in result.statistics.cut]


def _incomplete(cut: Cut) -> dict[str, Any]:
    identity = digest(("incomplete", cut.path))
    return _entry("incomplete", cut.message, identity, Span(cut.path, 1, 1, 1, 1), "note")


def _entry(code: str, message: str, identity: str, span: Span, grade: Level) -> dict[str, Any]:
    return {
        "description": message,
        "check_name": code,
        "fingerprint": identity,
        "severity": _SEVERITIES[grade],
        "location": {"path": span.path, "lines": {"begin": span.line, "end": span.end_line}},
    }
