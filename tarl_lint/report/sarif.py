"""SARIF 2.1.0, for code scanning: every flow with its taint list as a code flow, every rule with its help."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from tarl_lint import __version__, explain
from tarl_lint.documentation import rule_page, site
from tarl_lint.files import shown
from tarl_lint.model import OFF_BY_DEFAULT, Dependence, Finding, Flow, Sink, Source, Span, Step
from tarl_lint.read.source import SourceError
from tarl_lint.report import closing_lines
from tarl_lint.report.grading import level, of_error, own_level, told_apart
from tarl_lint.report.line import Line, View, plain
from tarl_lint.report.upload_limits import EVERYTHING, Cut, cuts, taken
from tarl_lint.run.runner import UNREADABLE, Result

SCHEMA: Final = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
ROOT: Final = "%SRCROOT%"  # GitHub resolves this name to the top of the repository
_IMPORTANCE: Final[Mapping[Dependence, str]] = {
    "data": "essential",
    "control": "important",
    "context": "unimportant",
}


def report(result: Result, _view: View) -> Iterator[Line]:
    """Yield the document in one line of ASCII, within the size that servers accept."""
    yield ((written(result), ""),)


def written(result: Result, graphs: Sequence[Mapping[str, Any]] = (), category: str = "") -> str:
    """Return the text of the document, within the size that servers accept; graphs are omitted first."""
    text = ""
    for drawn in (graphs, ()) if graphs else ((),):
        for cut in cuts(len(result.errors) + len(result.findings) + len(result.silenced)):
            text = json.dumps(document(result, cut, drawn, category), separators=(",", ":"))
            if taken(text):
                return text
            if drawn:
                break
    return text


def document(
    result: Result, cut: Cut = EVERYTHING, graphs: Sequence[Mapping[str, Any]] = (), category: str = ""
) -> dict[str, Any]:
    """Return the log of one run, with graphs of its systems; paths are relative to the working directory.

    Servers replace the results of an earlier run only if it had the same `category`.
    """
    codes = list(explain.known_rules())
    errors = [_unreadable(error, codes) for error in result.errors if result.names_errors]
    silenced = set(result.silenced)
    named = list(told_apart((*result.findings, *result.silenced)))
    gravest = sorted(range(len(named)), key=lambda number: _gravity(named[number][0], result, silenced))
    chosen = [named[number] for number in sorted(gravest[: max(0, cut.results - len(errors))])]
    found = [
        _result(finding, identity, codes, result, cut.steps, silenced=finding in silenced)
        for finding, identity in chosen
    ]
    driver = {
        "name": "tarl-lint",
        "version": __version__,
        **({"informationUri": site()} if site() else {}),
        "rules": [_rule(code) for code in codes],
    }
    left_out = [*_left_out(len(named) - len(chosen)), *_shortened([pair[0] for pair in chosen], cut.steps)]
    notes = [*_notifications(result), *_incomplete(result), *left_out]
    run = {
        "tool": {"driver": driver},
        **({"automationDetails": {"id": f"{category}/"}} if category else {}),
        "columnKind": "unicodeCodePoints",
        "originalUriBaseIds": {ROOT: {"description": {"text": "The working directory of tarl-lint."}}},
        "invocations": [{"executionSuccessful": True, "toolExecutionNotifications": notes}],
        **({"graphs": list(graphs)} if graphs else {}),
        "results": errors[: cut.results] + found,
    }
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}


def _gravity(finding: Finding, result: Result, silenced: Set[Finding]) -> tuple[bool, int]:
    """Return a sort key: new findings before known ones, severe before minor."""
    known = finding.status == "accepted" or finding in silenced
    return known, ("error", "warning", "note").index(level(finding.code, result))


def _left_out(count: int) -> list[dict[str, Any]]:
    if not count:
        return []
    return [
        _notification(
            "left-out", f"{closing_lines.many(count, 'finding')} omitted: servers limit the size of a report."
        )
    ]


def _shortened(findings: Sequence[Finding], most: int) -> list[dict[str, Any]]:
    count = sum(_is_cut(f.flow, most) for f in findings if f.flow)
    if not count:
        return []
    shown = closing_lines.many(count, "flow")
    text = f"{shown} reduced to the shortest chain of statements: servers limit the size of a report."
    return [_notification("shortened", text)]


def _is_cut(flow: Flow, most: int) -> bool:
    return len(flow.steps) > max(most, len(flow.chain)) and bool(flow.chain)


def _notification(name: str, text: str) -> dict[str, Any]:
    return {"level": "note", "message": {"text": text}, "descriptor": {"id": name}}


def _rule(code: str) -> dict[str, Any]:
    page = explain.page(code)
    text = "\n".join(plain(line) for line in explain.explanation(code))
    title, _, rest = text.partition("\n")
    description = rest.strip().partition("\n\n")[0].replace("\n", " ")
    grade = own_level(code)
    return {
        "id": code,
        "name": code,
        "shortDescription": {"text": title.partition(": ")[2] or title},
        "fullDescription": {"text": description},
        **({"helpUri": rule_page(code)} if rule_page(code) else {}),
        "help": {"text": text, "markdown": page},
        "defaultConfiguration": {"level": grade} | ({"enabled": False} if code in OFF_BY_DEFAULT else {}),
        "properties": {
            "tags": ["ros", "dataflow"],
            "precision": "high",
            "problem.severity": "recommendation" if grade == "note" else grade,
        },
    }


def _notifications(result: Result) -> list[dict[str, Any]]:
    return [_notification("not-analysed", plain(line)) for line in closing_lines.not_analysed(result)]


def _incomplete(result: Result) -> list[dict[str, Any]]:
    return [
        {
            "level": "warning",
            "message": {"text": _escaped(cut.message)},
            "descriptor": {"id": "budget-spent"},
            "locations": [{"physicalLocation": {"artifactLocation": _artifact(cut.path)}}],
        }
        for cut in result.statistics.cut
    ]


def _unreadable(error: SourceError, codes: Sequence[str]) -> dict[str, Any]:
    region = {"startLine": error.line}
    return {
        "ruleId": UNREADABLE,
        "ruleIndex": codes.index(UNREADABLE),
        "level": own_level(UNREADABLE),
        "message": {"text": _escaped(error.message)},
        "locations": [{"physicalLocation": {"artifactLocation": _artifact(error.path), "region": region}}],
        "partialFingerprints": {"primaryLocationLineHash": f"{of_error(error)}:1"},
    }


def _result(
    finding: Finding, identity: str, codes: Sequence[str], result: Result, most: int, *, silenced: bool
) -> dict[str, Any]:
    flow = finding.flow
    made: dict[str, Any] = {
        "ruleId": finding.code,
        "ruleIndex": codes.index(finding.code) if finding.code in codes else -1,
        "level": own_level(finding.code),
        "message": {"text": _escaped(finding.message) + (" ([subscription](1))" if flow else "")},
        "locations": [location(finding.span, flow.sink if flow else None)],
        "partialFingerprints": _fingerprints(finding, identity),
    }
    if flow:
        made |= _of_flow(flow, most)
    if result.baseline and not silenced:
        made["baselineState"] = "unchanged" if finding.status == "accepted" else "new"
    if silenced:
        made["suppressions"] = [{"kind": "inSource", "status": "accepted"}]
    elif finding.status == "accepted":
        place = shown(result.baseline) if result.baseline else "the baseline"
        made["suppressions"] = [
            {"kind": "external", "status": "accepted", "justification": f"Accepted in {place}."}
        ]
    return made


def _fingerprints(finding: Finding, identity: str) -> dict[str, str]:
    """Return the fingerprints of a result. GitHub uses the first fingerprint, which must be unique within a file."""
    name = "tarlFlow/v1" if finding.flow else "tarlHazard/v1"
    own = {name: finding.fingerprint} if finding.fingerprint else {}
    return {"primaryLocationLineHash": identity, **own}


def _of_flow(flow: Flow, most: int) -> dict[str, Any]:
    source = location(flow.source.span, flow.source)
    steps = [flow.steps[place] for place in flow.chain] if _is_cut(flow, most) else flow.steps
    related = [{"id": 1, "message": {"text": "subscription"}, **source}]
    for number, span in enumerate(flow.source.via, 2):
        related.append({"id": number, "message": {"text": "through this call"}, **location(span)})
    return {
        "relatedLocations": related,
        "codeFlows": [{"threadFlows": [{"locations": [_step(step) for step in steps]}]}],
        "properties": {
            "kind": flow.kind,
            "sourceTopics": list(flow.source.topics),
            "sinkTopics": list(flow.sink.topics),
        },
    }


def _step(step: Step) -> dict[str, Any]:
    place = location(step.span)
    place["message"] = {"text": _escaped(f"{step.role} ({step.dependence}): {step.code}")}
    return {
        "location": place,
        "kinds": [step.role, step.dependence],
        "importance": _IMPORTANCE[step.dependence],
        "properties": {
            "role": step.role,
            "dependence": step.dependence,
            "code": step.code,
            "site": str(step.site),
        },
    }


def location(span: Span, end: Source | Sink | None = None) -> dict[str, Any]:
    """Return the place of a span; for an end of a flow, with the name of its function."""
    region = {
        "startLine": span.line,
        "startColumn": span.column,
        "endLine": span.end_line,
        "endColumn": span.end_column,
    }
    made: dict[str, Any] = {"physicalLocation": {"artifactLocation": _artifact(span.path), "region": region}}
    if end is not None and end.qualname:
        name = ".".join(filter(None, (end.module, end.qualname)))
        made["logicalLocations"] = [{"fullyQualifiedName": name, "kind": "function"}]
    return made


def _artifact(path: str) -> dict[str, str]:
    """Return the location of a file: relative to the source root, or absolute if the file is elsewhere."""
    if Path(path).is_absolute():
        return {"uri": Path(path).as_uri()}
    return {"uri": quote(path.encode("utf-8", "surrogateescape")), "uriBaseId": ROOT}


def _escaped(text: str) -> str:
    """Escape brackets, which would be read as links."""
    return text.replace("\\", "\\\\").replace("[", "\\[").replace("]", "\\]")
