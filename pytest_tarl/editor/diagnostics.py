"""Convert the linter's findings to protocol objects: diagnostics with the statements of a flow, and code lenses."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from lsprotocol import types

from pytest_tarl.editor.positions import Places
from tarl_lint.documentation import rule_page
from tarl_lint.editing import Result
from tarl_lint.model import Finding, Flow, Span

SOURCE = "tarl-lint"
_HAZARD = "TARL2"


def diagnostics(result: Result, places: Places) -> dict[str, list[types.Diagnostic]]:
    """Return the diagnostics of each linted file by path. Accepted findings become hints."""
    found: dict[str, list[types.Diagnostic]] = {path: [] for path in result.texts}
    for finding in result.findings:
        found.setdefault(finding.span.path, []).append(_diagnostic(finding, places))
    for error in result.errors:
        start, end = types.Position(error.line - 1, 0), places.end_of_line(error.path, error.line)
        found.setdefault(error.path, []).append(
            types.Diagnostic(
                types.Range(start, end),
                error.message,
                severity=types.DiagnosticSeverity.Error,
                source=SOURCE,
                code="TARL001",
                code_description=_page("TARL001"),
            )
        )
    return found


def _diagnostic(finding: Finding, places: Places) -> types.Diagnostic:
    return types.Diagnostic(
        places.range(finding.span),
        finding.message,
        severity=_severity(finding),
        source=SOURCE,
        code=finding.code,
        code_description=_page(finding.code),
        related_information=_taint_list(finding.flow, places) if finding.flow else None,
        data={"fingerprint": finding.fingerprint, "code": finding.code, "new": finding.status == "new"},
    )


def _page(code: str) -> types.CodeDescription | None:
    """Return the URL of a rule's documentation; editors link it to the rule's code."""
    page = rule_page(code)
    return types.CodeDescription(page) if page else None


def _severity(finding: Finding) -> types.DiagnosticSeverity:
    if finding.status == "accepted":
        return types.DiagnosticSeverity.Hint
    if finding.code.startswith(_HAZARD):
        return types.DiagnosticSeverity.Warning
    return types.DiagnosticSeverity.Information


def _taint_list(flow: Flow, places: Places) -> list[types.DiagnosticRelatedInformation]:
    """Return a flow's statements with their roles; only those on the shortest chain if there is one."""
    chosen = [flow.steps[at] for at in flow.chain] or list(flow.steps)
    return [
        types.DiagnosticRelatedInformation(places.location(step.span), f"{step.role}: {step.code}")
        for step in chosen
    ]


def lenses(result: Result, path: str, places: Places) -> list[types.CodeLens]:
    """Return a code lens above each publish call in a file, with the sources of its data and conditions."""
    by_call: dict[Span, list[Flow]] = defaultdict(list)
    for finding in (*result.findings, *result.silenced):
        if finding.flow is not None and finding.flow.sink.span.path == path:
            by_call[finding.flow.sink.span].append(finding.flow)
    return [
        types.CodeLens(places.range(span), types.Command(title(flows), ""))
        for span, flows in sorted(by_call.items())
    ]


def title(flows: Sequence[Flow]) -> str:
    """Return the title of a lens, such as `data of /odom, decided by /estop`."""
    words = {"explicit": "data of", "implicit": "decided by"}
    parts = []
    for kind, word in words.items():
        names = sorted({_name(flow) for flow in flows if flow.kind == kind})
        if names:
            parts.append(f"{word} {', '.join(names)}")
    return ", ".join(parts)


def _name(flow: Flow) -> str:
    return " or ".join(flow.source.topics) or f"a topic received in {flow.source.callback or 'a call'}"
