"""Reports for CI servers: GitHub annotations, GitLab code quality, JUnit XML."""

import json
from dataclasses import replace
from xml.etree import ElementTree

from tarl_lint.report.gitlab import document
from tarl_lint.run.runner import Result
from tests.lint.reports import everything, text_of


def commands(result: Result) -> list[str]:
    return [line for line in text_of("github", result).splitlines() if line.startswith("::")]


def test_github_gets_one_annotation_per_publish_call(example):
    first, hazard, old, unused = commands(everything(example))
    assert hazard.startswith("::error file=node.py,line=11,")
    assert first == (
        "::error file=node.py,line=18,endLine=18,col=9,endColumn=25,"
        "title=TARL101%2C TARL102%3A progress (Float64)"
        "::odom reaches progress: explicit, subscribed at line 22, callback."
        "%0Ascan reaches progress: implicit, subscribed at line 22, callback."
    )
    assert old.startswith("::warning file=old.py,line=3,")
    assert unused.startswith("::notice file=node.py,line=4,")
    assert unused.endswith("There is no TARL102 here for this comment to silence: remove it.")


def test_github_annotations_are_escaped(example):
    (hazard,) = (c for c in commands(everything(example)) if "TARL203" in c)
    assert hazard.endswith("::scan [raw] reaches nothing, 100 %25 lost.")


def test_harmless_findings_are_github_notices(example):
    (command,) = commands(Result(findings=(example.finding(),)))
    assert command.startswith("::notice ")


def test_multi_line_annotations_have_no_columns(example):
    finding = replace(example.finding(), flow=replace(example.flow(), sink=replace(
        example.sink(), span=replace(example.sink().span, end_line=19))))  # fmt: skip
    assert "line=18,endLine=19,title=" in commands(Result(findings=(finding,)))[0]


def test_the_log_on_github_ends_with_the_summary(example):
    text = text_of("github", everything(example))
    assert "2 new flows in 1 of 2 files: 1 explicit, 1 implicit (1 accepted in tarl-flows.json).\n" in text


def test_gitlab_gets_new_findings_with_all_required_keys(example):
    entries = document(everything(example))
    assert [e["check_name"] for e in entries] == ["TARL001", "TARL101", "TARL102", "TARL203"]
    assert [e["severity"] for e in entries] == ["minor", "major", "info", "major"]
    assert entries[1] == {
        "description": "odom reaches progress",
        "check_name": "TARL101",
        "fingerprint": "odom-explicit:1",
        "severity": "major",
        "location": {"path": "node.py", "lines": {"begin": 18, "end": 18}},
    }
    assert json.loads(text_of("gitlab", everything(example))) == entries


def test_gitlab_fingerprints_are_unique_and_independent_of_lines(example):
    findings = (example.finding(),) * 3 + everything(example).findings[3:]
    before = document(Result(findings=findings))
    moved = [
        replace(f, span=replace(f.span, line=f.span.line + 9, end_line=f.span.line + 9)) for f in findings
    ]
    after = document(Result(findings=tuple(moved)))
    assert len({e["fingerprint"] for e in before}) == 4
    assert [e["fingerprint"] for e in before] == [e["fingerprint"] for e in after]


def suites(result: Result) -> ElementTree.Element:
    return ElementTree.fromstring(text_of("junit", result))


def test_junit_has_a_suite_per_file_and_a_case_per_finding(example):
    root = suites(everything(example))
    assert root.attrib == {"name": "tarl-lint", "tests": "5", "failures": "2", "errors": "0", "skipped": "2"}
    assert [(s.get("name"), s.get("tests")) for s in root] == [("node.py", "4"), ("old.py", "1")]
    outcomes = {case.get("name"): case[0].tag for case in root.iter("testcase")}
    assert outcomes == {
        "TARL101 odom reaches progress": "failure",
        "TARL102 scan reaches progress": "system-out",
        "TARL102 joy reaches progress": "skipped",
        "TARL203 scan [raw] reaches nothing, 100 % lost.": "failure",
        "TARL001 the file can be analysed": "skipped",
    }


def test_junit_failures_contain_the_taint_list(example):
    failure = next(suites(everything(example)).iter("failure"))
    assert failure.get("message") == "odom reaches progress"
    assert "node.py:18:9: odom reaches progress" in failure.text
    assert "17  assign     * vel = 5 * delta" in failure.text


def test_junit_names_of_equal_findings_are_numbered_without_lines(example):
    names = [c.get("name") for c in suites(Result(findings=(example.finding(),) * 2)).iter("testcase")]
    assert names == ["TARL101 odom reaches progress", "TARL101 odom reaches progress #2"]


def test_junit_is_valid_xml_for_any_code(example):
    step = replace(example.flow().steps[0], code='if a < b and "\x00]]>&amp;\x1b" > c:')
    finding = replace(example.finding(), message='<"&\n\ud800', flow=replace(example.flow(), steps=(step,)))
    (case,) = suites(Result(findings=(finding,))).iter("testcase")
    assert case.get("name") == 'TARL101 <"&\n?'
    assert 'if a < b and "?]]>&amp;?" > c:' in case[0].text


def test_junit_has_a_passed_case_if_nothing_was_found():
    root = suites(Result())
    assert root.get("tests") == "1"
    assert root.get("failures") == "0"
