"""JUnit XML, for Jenkins and others: a suite for each file, a case for each finding."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Final, NamedTuple

from tarl_lint.model import Finding
from tarl_lint.report.flows import taint_list
from tarl_lint.report.line import ASCII, Line, View, location, plain, unbroken
from tarl_lint.run.runner import UNREADABLE, Result

# characters that XML 1.0 does not allow
_ILLEGAL: Final = r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"
_ENTITIES: Final = {
    "&": "&amp;",
    "<": "&lt;",
    ">": "&gt;",
    '"': "&quot;",
    "\n": "&#10;",
    "\t": "&#9;",
    "\r": "&#13;",
}


class Case(NamedTuple):
    """One test case. `outcome` is failure, skipped or passed."""

    path: str
    name: str
    outcome: str
    message: str
    text: str


def report(result: Result, _view: View) -> Iterator[Line]:
    """Yield the document. Findings that fail the run are failures; accepted and unreadable ones are skipped."""
    yield from written(cases(result))


def cases(result: Result) -> list[Case]:
    """Return the cases of a run: unreadable files, incomplete programs, findings."""
    found = (_case(finding, result) for finding in result.findings)
    return [*_errors(result), *_incomplete(result), *found]


def written(given: list[Case]) -> Iterator[Line]:
    """Yield the document of some cases; without any, it has one that passes."""
    cases = _numbered(given) or [Case("tarl-lint", "no findings", "passed", "", "")]
    yield (('<?xml version="1.0" encoding="utf-8"?>', ""),)
    yield ((f"<testsuites{_attributes({'name': 'tarl-lint', **_counts(cases)})}>", ""),)
    for path, group in groupby(sorted(cases, key=lambda case: case.path), key=lambda case: case.path):
        yield from _suite(path, list(group))
    yield (("</testsuites>", ""),)


def _errors(result: Result) -> Iterator[Case]:
    for error in result.errors if result.names_errors else ():
        yield Case(error.path, f"{UNREADABLE} the file can be analysed", "skipped", error.message, "")


def _incomplete(result: Result) -> Iterator[Case]:
    for cut in result.statistics.cut:
        yield Case(cut.path, "analysed completely", "skipped", cut.message, "")


def _case(finding: Finding, result: Result) -> Case:
    name = f"{finding.code} {finding.message}"
    head = plain(unbroken(((f"{location(finding.span)}: {finding.message}", ""),)))
    steps = taint_list(finding.flow, View(glyphs=ASCII)) if finding.flow else ()
    text = "\n".join([head, *map(plain, steps)])
    if finding.status == "accepted":
        return Case(finding.span.path, name, "skipped", "accepted in the baseline", text)
    outcome = "failure" if finding.code in result.failing else "passed"
    return Case(finding.span.path, name, outcome, finding.message, text)


def _numbered(cases: list[Case]) -> list[Case]:
    """Number cases of equal name. Line numbers are not used, since they would rename cases after every edit."""
    seen: Counter[tuple[str, str]] = Counter()
    made = []
    for case in cases:
        seen[case[:2]] += 1
        number = seen[case[:2]]
        made.append(case._replace(name=f"{case.name} #{number}") if number > 1 else case)
    return made


def _suite(path: str, cases: list[Case]) -> Iterator[Line]:
    yield ((f" <testsuite{_attributes({'name': path, **_counts(cases)})}>", ""),)
    for case in cases:
        yield ((f"  <testcase{_attributes({'classname': path, 'name': case.name, 'file': path})}>", ""),)
        if case.outcome == "passed":
            yield ((f"   <system-out>{_escaped(case.text)}</system-out>", ""),)
        else:
            attributes = _attributes({"message": case.message})
            yield ((f"   <{case.outcome}{attributes}>{_escaped(case.text)}</{case.outcome}>", ""),)
        yield (("  </testcase>", ""),)
    yield ((" </testsuite>", ""),)


def _counts(cases: list[Case]) -> dict[str, str]:
    outcomes = Counter(case.outcome for case in cases)
    numbers = {
        "tests": len(cases),
        "failures": outcomes["failure"],
        "errors": 0,
        "skipped": outcomes["skipped"],
    }
    return {key: str(number) for key, number in numbers.items()}


def _attributes(values: Mapping[str, str]) -> str:
    return "".join(f' {key}="{_quoted(value)}"' for key, value in values.items())


def _quoted(text: str) -> str:
    return "".join(_ENTITIES.get(character, character) for character in re.sub(_ILLEGAL, "?", text))


def _escaped(text: str) -> str:
    legal = re.sub(_ILLEGAL, "?", text)
    return legal.replace("&", "&amp;").replace("<", "&lt;").replace("]]>", "]]&gt;")
