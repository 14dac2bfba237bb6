"""The sentences at the end of a report: counts, silenced findings, what was not analysed, what to do next."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tarl_lint.baseline import Accepted, Baseline
from tarl_lint.fingerprints import OfFlow, OfHazard
from tarl_lint.model import Cut, Finding
from tarl_lint.read.discover import Notes
from tarl_lint.read.source import SourceError
from tarl_lint.report import closing_lines
from tarl_lint.report.line import View, plain
from tarl_lint.run.runner import Result, Statistics
from tarl_lint.suppress import Suppression

BASE = Path("tarl-flows.json")
FLOW = OfFlow("arm", "", "odom", "on", "cmd_vel", "run", "explicit")
HAZARD = OfHazard("arm", "TARL203", "odom → x", "C.on")


def closing(result: Result) -> list[str]:
    return [plain(line) for line in closing_lines.closing(result)]


def hazard(example, code: str = "TARL203", status: str = "new") -> Finding:
    return Finding(code, example.span("pos = data"), "m", status=status)  # type: ignore[arg-type]


def of(*findings: Finding, files: int = 3, **given) -> Result:
    return Result(findings=findings, statistics=Statistics(files=files), **given)


def test_flows_are_counted_by_kind_and_file(example):
    one, two = example.finding(), example.finding("implicit", "scan")
    other = replace(one, span=replace(one.span, path="b.py"))
    assert closing(of(one, files=1)) == ["1 flow in 1 file: 1 explicit."]
    assert closing(of(one, two, files=1)) == ["2 flows in 1 file: 1 explicit, 1 implicit."]
    assert closing(of(one, one)) == ["2 flows in 1 of 3 files: 2 explicit."]
    assert closing(of(one, other, two)) == ["3 flows in 2 of 3 files: 2 explicit, 1 implicit."]
    assert closing(of(one, replace(two, status="accepted"), baseline=BASE)) == [
        "1 new flow in 1 of 3 files: 1 explicit (1 accepted in tarl-flows.json)."
    ]


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({}, "No flow from a subscription to a publish call in 3 files."),
        ({"has_endpoints": False}, "No flow: nothing in 3 files subscribes or publishes."),
        ({"has_endpoints": False, "baseline": BASE}, "No new flow in 3 files."),
        ({"baseline": BASE}, "No new flow in 3 files."),
        ({"kinds": ("explicit",)}, "No explicit flow from a subscription to a publish call in 3 files."),
        ({"left_out": 2}, "No further flow from a subscription to a publish call in 3 files."),
        ({"kinds": (), "reports_hazards": False}, "3 files read; no rule for flows or hazards is enabled."),
        ({"kinds": ()}, "No hazard in 3 files."),
        ({"kinds": (), "baseline": BASE}, "No new hazard in 3 files."),
    ],
)
def test_a_run_without_findings_states_what_it_searched_for(given, sentence):
    assert closing(of(**given))[0] == sentence


def test_hazards_are_counted_by_rule(example):
    one, two = hazard(example), hazard(example, "TARL204")
    assert closing(of(example.finding(), one, one, two))[1] == "3 hazards: 2 TARL203, 1 TARL204."
    assert closing(of(one, kinds=())) == ["1 hazard: 1 TARL203 in 3 files."]
    accepted = hazard(example, status="accepted")
    assert closing(of(one, accepted, baseline=BASE))[1] == (
        "1 new hazard: 1 TARL203 (1 accepted in tarl-flows.json)."
    )
    assert (
        closing(of(accepted, accepted, baseline=BASE))[1] == "No new hazard (2 accepted in tarl-flows.json)."
    )


def test_silenced_findings_are_counted(example):
    silenced = (example.finding(), example.finding())
    assert closing(of(silenced=silenced))[1:] == ["Silenced: 2 by comments."]
    assert closing(of(left_out=1))[1:] == ["Silenced: 1 by per-file-ignores."]
    assert closing(of(silenced=silenced, left_out=3))[1] == "Silenced: 2 by comments, 3 by per-file-ignores."
    assert closing(of(off_by_default=1))[1:] == [
        "Not shown: 1 flow from a request to its own response (--extend-select TARL103)."
    ]


@pytest.mark.parametrize(
    ("notes", "cut", "errors", "said"),
    [
        (Notes(cpp_nodes=1), (), 0, "1 C++ node"),
        (Notes(cpp_nodes=2, remapping_launch_files=1), (), 0, "2 C++ nodes, remaps in 1 launch file"),
        (Notes(unreadable=("a",)), (), 0, "1 unreadable place (a)"),
        (Notes(unreadable=("a", "b", "c", "d")), (), 0, "4 unreadable places (a, b, c)"),
        (Notes(), (Cut("a.py"),), 0, "parts of 1 large program (a.py)"),
        (Notes(), (Cut("a.py", "n"), Cut("b.py")), 0, "parts of 2 large programs (a.py as n, b.py)"),
        (Notes(), (), 1, "1 file that is not readable as Python 3 (TARL001)"),
        (Notes(), (), 2, "2 files that are not readable as Python 3 (TARL001)"),
    ],
)
def test_files_and_programs_that_were_not_analysed_are_named(notes, cut, errors, said):
    broken = (SourceError("x.py", 1, "Broken."),) * errors
    result = Result(statistics=Statistics(3, 9, notes, cut), errors=broken)
    assert [plain(line) for line in closing_lines.not_analysed(result)] == [f"Not analysed: {said}."]


def test_a_long_list_of_incomplete_programs_is_abbreviated():
    cut = tuple(Cut(f"{number}.py") for number in range(21))
    (line,) = closing_lines.not_analysed(Result(statistics=Statistics(cut=cut)))
    assert plain(line).endswith("19.py and 1 more).")
    (line,) = closing_lines.not_analysed(Result(statistics=Statistics(cut=cut[:20])))
    assert plain(line).endswith("18.py, 19.py).")


def test_topics_with_computed_names_are_counted_once(example):
    unnamed = replace(example.flow(), source=replace(example.source(), topics=()))
    one = replace(example.finding(), flow=unnamed)
    assert closing_lines.unknown_topics(of(one, one, example.finding())) == 1
    assert closing(of(one))[-1] == "Not analysed: the names of 1 topic computed at run time."
    assert list(closing_lines.not_analysed(of(example.finding()))) == []


def test_classes_outside_the_files_and_packages_are_named():
    names = ("a.A", "a.B", "b.C", "c.D", "d.E", "e.F")
    (line,) = closing_lines._beyond(Result(ended=names[:1]))
    assert plain(line) == (
        'Not followed: data that is passed to classes outside the linted files, a.A (follow-installed = ["a"]).'
    )
    (line,) = closing_lines._beyond(Result(ended=names[:5]))
    assert ", a.A, a.B, b.C, c.D, d.E (" in plain(line)
    first, last = closing_lines._beyond(Result(followed=("a 1", "b"), ended=names))
    assert plain(first) == "Followed into installed packages: a 1, b."
    assert ', a.A, a.B, b.C, c.D, d.E and 1 more (follow-installed = ["a", "b", "c", "d", "e"])' in plain(
        last
    )


def test_the_next_command_is_named_only_after_new_findings(example):
    one, plain_view = example.finding(), View()

    def hints(result: Result, view: View = plain_view) -> list[str]:
        return [plain(line).partition(" ")[0] for line in closing_lines.hints(result, view)]

    assert hints(of(one)) == ["--write-baseline"]
    assert hints(of(one, one)) == ["--show-paths", "--write-baseline"]
    assert hints(of(one, one), View(show_paths=True)) == ["--write-baseline"]
    assert hints(of(one, one), View(most_flows=1)) == ["--show-paths", "--max-paths", "--write-baseline"]
    assert hints(of(one, one), View(most_flows=2)) == ["--show-paths", "--write-baseline"]
    assert hints(of(one, baseline=BASE)) == hints(of()) == hints(of(replace(one, status="accepted"))) == []


def test_the_report_shows_a_single_new_flow_in_full(example):
    one, old = example.finding(), replace(example.finding(), status="accepted")
    assert [
        closing_lines.is_single(of(*some))
        for some in ((), (one,), (one, one), (one, old), (one, hazard(example)))
    ] == [
        False,
        True,
        False,
        True,
        True,
    ]


def test_accepted_findings_are_described_in_words():
    assert closing_lines.in_words(Accepted(FLOW, 1, ()), "→") == (
        "odom → cmd_vel, explicit, received by on, published in run (arm)"
    )
    plain_flow = replace(FLOW, callback="", place="", kind="implicit")
    assert (
        closing_lines.in_words(Accepted(plain_flow, 2, ()), "->")
        == "odom -> cmd_vel, implicit (arm), 2 times"
    )
    assert closing_lines.in_words(Accepted(HAZARD, 1, ()), "->") == "TARL203 odom -> x in C.on (arm)"
    assert (
        closing_lines.in_words(Accepted(replace(HAZARD, place=""), 3, ()), "→")
        == "TARL203 odom → x (arm), 3 times"
    )


def test_at_most_twenty_vanished_findings_are_named(example):
    gone = (Accepted(FLOW, 1, ()),) * 21
    assert list(closing_lines.vanished(Result(vanished=gone), View())) == []
    assert list(closing_lines.vanished(Result(baseline=BASE), View())) == []
    lines = [plain(line) for line in closing_lines.vanished(Result(vanished=gone, baseline=BASE), View())]
    assert lines[0] == "Accepted but no longer found, in tarl-flows.json:"
    assert lines[-4:] == [lines[1], "  and 1 more", "  Run --write-baseline to remove them.", ""]
    lines = [plain(line) for line in closing_lines.vanished(Result(vanished=gone[1:], baseline=BASE), View())]
    assert len(lines) == 23


def test_a_baseline_is_counted_by_flows_and_hazards():
    def of_entries(*entries: Accepted) -> str:
        return closing_lines.numbers(Baseline(entries))

    flow, two = Accepted(FLOW, 1, ()), Accepted(HAZARD, 2, ())
    assert of_entries() == "0 flows"
    assert of_entries(flow) == "1 flow"
    assert of_entries(flow, replace(flow, count=4), two) == "5 flows and 2 hazards"


@pytest.mark.parametrize(
    ("code", "rules", "reason"),
    [
        ("TARL101", ("TARL101",), "there is no TARL101 here for this comment to silence: remove it."),
        ("", ("TARL101",), "there is no finding here for this comment to silence: remove it."),
        ("TARL9", (), "there is no rule TARL9: correct or remove this comment."),
    ],
)
def test_report_says_why_a_comment_silences_nothing(code, rules, reason):
    comment = Suppression("a.py", 3, 5, code)
    if not rules:
        assert comment.rules == ()
    assert closing_lines.in_vain(comment) == reason
    first, last = closing_lines.unused(Result(unused=(comment,)))
    assert (plain(first), last) == (f"a.py:3:5 note: {reason}", ())


def test_settings_without_effect_are_named():
    assert [plain(line) for line in closing_lines.unmatched(Result(unmatched=("No a.", "No b.")))] == [
        "No a.",
        "No b.",
    ]


def test_statistics_count_findings_steps_and_topics(example):
    other = replace(example.finding("implicit", "scan"), status="accepted")
    short = replace(other.flow, steps=other.flow.steps[-1:])
    result = of(example.finding(), other, replace(other, flow=short), hazard(example), left_out=4)
    rows = [plain(line).strip().split("  ", 1) for line in closing_lines.statistics(result)]
    assert rows == [
        ["1", "TARL101"],
        ["2", "TARL102"],
        ["1", "TARL203"],
        ["0", "TARL001"],
        ["0", "silenced by comments"],
        ["4", "silenced by per-file-ignores"],
        ["2", "accepted in the baseline"],
        ["2", "subscriptions that reach a publish call"],
        ["1", "publish calls reached"],
        ["11", "steps that pass on the value"],
        ["2", "steps that are conditions"],
        ["6", "steps of a flow, median"],
        ["3", "files analysed"],
        ["0", "lines analysed"],
        [""],
        ["Publish calls reached, by subscribed topic:"],
        ["1", "odom"],
        ["1", "scan"],
        [""],
    ]
    assert len(list(closing_lines.statistics(of()))) == 12, "without topics"
