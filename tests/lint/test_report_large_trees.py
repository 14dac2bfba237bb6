"""Reports of trees with hundreds of flows: order, counts and omissions."""

from __future__ import annotations

import gzip
import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tarl_lint.model import Finding
from tarl_lint.report import by_package, render, sarif, upload_limits
from tarl_lint.report.line import View, plain
from tarl_lint.run.runner import Result, Statistics
from tests.lint.reports import everything, text_of

SCHEMA = json.loads((Path(by_package.__file__).parent / "findings2.schema.json").read_text("utf-8"))


def located(finding: Finding, path: str, package: str, line: int = 1) -> Finding:
    """Move a flow to another file."""
    flow = finding.flow
    assert flow is not None
    span = replace(finding.span, path=path, line=line, end_line=line)
    moved = replace(flow, sink=replace(flow.sink, span=span, id=f"{path}:{line}"))
    return replace(finding, span=span, flow=moved, package=package)


@pytest.fixture
def many(example) -> Result:
    """Return eight flows of two packages and two of tests."""
    found = [located(example.finding(), f"arm/src/{n}.py", "arm") for n in range(5)]
    found += [located(example.finding("implicit"), f"base/{n}.py", "base") for n in range(3)]
    found += [located(example.finding(), name, "arm") for name in ("arm/tests/x.py", "base/test_y.py")]
    return Result(findings=tuple(found), statistics=Statistics(files=10, lines=100))


def lines(result: Result, **view: object) -> list[str]:
    return [plain(line) for line in render("text", result, View(**view))]  # type: ignore[arg-type]


def test_the_overview_comes_first_then_packages_then_tests(many):
    shown = lines(many)
    wanted = [
        "Published topics, and the topics that reach them:",
        "arm: 5 flows",
        "base: 3 flows",
        "Tests and examples: 2 flows",
    ]
    assert [line for line in shown if line in wanted] == wanted
    assert shown[0] == wanted[0]


def test_one_package_needs_no_heading(example):
    shown = lines(Result(findings=(located(example.finding(), "a.py", "arm"),)))
    assert not any(line.startswith("arm") for line in shown)


def test_a_tree_of_examples_is_shown_by_package(example):
    found = tuple(located(example.finding(), f"examples/{n}/a.py", n) for n in ("arm", "base"))
    assert [group.name for group in by_package.grouped(found)] == ["arm", "base"]


@given(
    st.lists(st.sampled_from(["a.py", "test/a.py", "src/latest/b.py", "demos/c.py", "b_test.py"]), max_size=8)
)
def test_no_finding_is_lost_by_grouping(paths: list[str]) -> None:
    from tarl_lint.model import Span

    found = [Finding("TARL203", Span(path, 1, 1, 1, 2), str(n)) for n, path in enumerate(paths)]
    grouped = [finding for group in by_package.grouped(found) for finding in group.findings]
    assert sorted(f.message for f in grouped) == sorted(f.message for f in found)


@pytest.mark.parametrize("most", [1, 4, 5, 6, 9])
def test_flows_beyond_the_requested_number_are_counted(many, most):
    shown = lines(many, most_flows=most)
    assert sum("TARL10" in line for line in shown) == most
    left = [int(line.split()[1]) for line in shown if line.startswith("    and ")]
    assert most + sum(left) == 10
    assert "--max-paths 0 shows all 10 flows." in shown
    assert "10 flows in 10 files: 7 explicit, 3 implicit." in shown


def test_long_step_lists_become_the_shortest_chain(example):
    finding = example.finding()
    steps = (*finding.flow.steps[:-1], *[example.step("delta = goal - pos")] * 10, finding.flow.steps[-1])
    long = replace(finding, flow=replace(finding.flow, steps=steps, chain=(1, 2, len(steps) - 1)))
    short = lines(Result(findings=(long,)), show_paths=True)
    assert not any("delta = goal" in line for line in short)
    assert any(f"{len(steps) - 4} more statements (--all-steps)" in line for line in short)
    full = lines(Result(findings=(long,)), show_paths=True, all_steps=True)
    assert sum("delta = goal" in line for line in full) == 11


@pytest.mark.parametrize("baseline", [None, Path("tarl-flows.json")])
def test_json2_is_valid_by_its_schema(example, baseline):
    made = json.loads(text_of("json2", everything(example, baseline=baseline)))
    jsonschema.Draft202012Validator(SCHEMA).validate(made)
    jsonschema.Draft202012Validator(SCHEMA).validate(json.loads(text_of("json2", Result())))


def test_json2_names_followed_packages_and_classes_where_flows_end(example):
    result = replace(everything(example), followed=("robot-base 1.4.0",), ended=("driver.base.Base",))
    made = json.loads(text_of("json2", result))
    jsonschema.Draft202012Validator(SCHEMA).validate(made)
    assert (made["followed"], made["opaque"]) == (["robot-base 1.4.0"], ["driver.base.Base"])
    assert not {"followed", "opaque"} & json.loads(text_of("json2", Result())).keys()


def test_json2_has_the_same_contents_as_json(example):
    result = everything(example)
    one, two = (json.loads(text_of(name, result)) for name in ("json", "json2"))
    for old, new in zip(one["diagnostics"], two["diagnostics"], strict=True):
        assert (old["code"], old["message"], old["status"]) == (new["code"], new["message"], new["status"])
        if "flow" not in old:
            assert [old["path"], old["line"]] == [new["path"], new["at"][0]]
            continue
        steps = [two["steps"][number] for number in new["flow"]["steps"]]
        assert [step["code"] for step in steps] == [step["code"] for step in old["flow"]["steps"]]
        assert two["sources"][new["flow"]["source"]]["id"] == old["flow"]["source"]["id"]
        assert two["sinks"][new["flow"]["sink"]]["topics"] == old["flow"]["sink"]["topics"]
    assert len({json.dumps(step) for step in two["steps"]}) == len(two["steps"])


def test_too_large_reports_are_reduced_with_a_note(example, monkeypatch):
    empty = len(gzip.compress(text_of("sarif", Result()).encode("ascii"), 6))  # the table of the rules
    monkeypatch.setattr(upload_limits, "MOST_BYTES", empty + 2_000)
    finding = example.finding()
    flow = replace(finding.flow, chain=(1, 6))
    found = tuple(
        replace(finding, flow=flow, message=f"{n * 7919 % 1000:064x}", fingerprint=str(n)) for n in range(300)
    )
    text = text_of("sarif", Result(findings=found))
    assert upload_limits.taken(text.strip())
    (run,) = json.loads(text)["runs"]
    assert 0 < len(run["results"]) < 300
    notes = {
        n["descriptor"]["id"]: n["message"]["text"]
        for n in run["invocations"][0]["toolExecutionNotifications"]
    }
    assert notes["left-out"].startswith(f"{300 - len(run['results'])} findings omitted")
    assert notes["shortened"].startswith(f"{len(run['results'])} flows reduced")


def test_the_least_severe_findings_are_omitted_first(example):
    hazard = Finding("TARL203", example.span("pos = data.pose"), "scan reaches nothing.")
    result = Result(findings=(example.finding(), example.finding("implicit"), hazard))
    (run,) = sarif.document(result, upload_limits.Cut(1, 1_000))["runs"]
    assert [made["ruleId"] for made in run["results"]] == ["TARL203"]
