"""Groups, maps and identities of findings written down by hand."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import pytest

from tarl_lint.model import Finding, Flow, Sink, Source, Span
from tarl_lint.report import github, gitlab, json2, sarif, settings, text
from tarl_lint.report.by_package import TESTS_AND_EXAMPLES, grouped
from tarl_lint.report.grading import level, of_error, own_level, told_apart
from tarl_lint.report.line import ASCII, View, plain
from tarl_lint.report.overview import _few, _wrapped, overview
from tarl_lint.report.paint import glyphs_for, wants_colour, width_of, write
from tarl_lint.settings.schema import Wrapper

SPAN = Span("src/a.py", 3, 1, 3, 9)


def flow(source: str, sink: str, line: int = 1, kind="explicit") -> Flow:
    at = Span("src/a.py", line, 1, line, 9)
    topics = tuple(sink.split("|"))
    return Flow(kind, Source("s", SPAN, (source,), "", "cb", "sub"), Sink("k", at, topics, "", "pub"), ())


def finding(path: str = "src/a.py", package: str = "p", code: str = "TARL201", **changes) -> Finding:
    one = Finding(code, Span(path, 3, 1, 4, 9), "a message", package=package)
    return replace(one, **changes)


def test_findings_are_grouped_by_package():
    some = [
        finding("b/x.py", "b"),
        finding("a/tests/x.py", "a"),
        finding("a/x.py", "a", flow=flow("/s", "/k")),
        finding("a/y.py", "a"),
        finding("a/y.py", "a", flow=flow("/s", "/k")),
    ]
    a, b, aside = grouped(some)
    assert (a.name, a.findings, a.counted) == ("a", (some[2], some[3], some[4]), "2 flows, 1 hazard")
    assert (b.name, b.counted) == ("b", "1 hazard")
    assert (aside.name, aside.findings) == (TESTS_AND_EXAMPLES, (some[1],))
    assert [group.name for group in grouped(some[:1])] == ["b"]
    assert [group.name for group in grouped(some[1:2])] == ["a"]  # examples only
    assert grouped([]) == ()


@pytest.mark.parametrize(
    ("path", "aside"),
    [
        ("tests/a.py", True),
        ("src/test/a.py", True),
        ("example/a.py", True),
        ("demos/a.py", True),
        ("tutorial/x/a.py", True),
        ("samples/a.py", True),
        ("src/test_a.py", True),
        ("a_test.py", True),
        ("src/a_test.cpp.py", False),
        ("src/latest/a.py", False),
        ("src/testing.py", False),
        ("contest_a.py", False),
    ],
)
def test_paths_of_tests_and_examples_are_recognised(path, aside):
    groups = grouped([finding("src/robot.py"), finding(path)])
    assert (groups[-1].name == TESTS_AND_EXAMPLES) is aside


def test_overview_lists_data_and_conditions_per_topic():
    flows = [
        flow("/scan", "/cmd", 1),
        flow("/odom", "/cmd", 2),
        flow("/odom", "/cmd", 2, "implicit"),
        flow("/stop", "/cmd", 3, "implicit"),
        flow("/map", "/a_topic_with_a_name_of_more_than_thirty", 4),
        flow("/map", "/x", 5),
        flow("/map", "/y", 6),
    ]
    told = [plain(line) for line in overview(flows, View())]
    assert told == [
        "Published topics, and the topics that reach them:",
        "  /a_topic_with_a_name_of_more_than_thirty",
        " " * 34 + "● data of    /map",
        "  /cmd" + " " * 28 + "● data of    /odom, /scan",
        " " * 34 + "◆ decided by /stop",
        "  /x" + " " * 30 + "● data of    /map",
        "  /y" + " " * 30 + "● data of    /map",
        "",
    ]
    assert [*overview(flows[:-1], View())] == []  # five publish calls fit on a screen


def test_long_lists_in_the_overview_are_abbreviated():
    assert [*_wrapped(["a", "b", "c"], 4)] == ["a,", "b,", "c"]
    assert [*_wrapped(["a", "b", "c"], 5)] == ["a, b,", "c"]
    assert [*_wrapped([], 6)] == []
    assert [*_wrapped(["long name"], 2)] == ["long name"]
    assert _few(("a", "b", "c", "d")) == "a or b or c or d"
    assert _few(("a", "b", "c", "d", "e")) == "a or b or c or 2 others"
    assert _few(()) == "?"


def test_finding_that_fails_the_run_is_an_error():
    result = SimpleNamespace(failing={"TARL101"})
    assert [own_level(code) for code in ("TARL101", "TARL201", "TARL001")] == ["note", "warning", "warning"]
    assert [level(code, result) for code in ("TARL101", "TARL102", "TARL201")] == ["error", "note", "warning"]


def test_findings_with_equal_fingerprints_get_consecutive_numbers():
    some = [
        finding(fingerprint="f"),
        finding(fingerprint="g"),
        finding(fingerprint="f"),
        finding(),
        finding(),
    ]
    names = [name for _, name in told_apart(some)]
    assert names[:3] == ["f:1", "g:1", "f:2"]
    assert names[3].endswith(":1")
    assert names[4] == names[3][:-1] + "2"
    assert names[3][:-2] != next(name for _, name in told_apart([finding(code="TARL202")]))[:-2]
    assert of_error(SimpleNamespace(path="a.py")) != of_error(SimpleNamespace(path="b.py"))


def result(**changes):
    every = {
        "failing": set(),
        "findings": (),
        "new": (),
        "errors": (),
        "names_errors": True,
        "unused": (),
        "statistics": SimpleNamespace(cut=()),
    }
    return SimpleNamespace(**every | changes)


CUT = SimpleNamespace(path="big.py", message="it was cut")
BROKEN = SimpleNamespace(path="bad.py", line=7, message="it cannot be read")


def test_code_quality_report_has_new_findings_and_errors():
    some = (finding(fingerprint="f"), finding(fingerprint="g", status="accepted"))
    found = gitlab.document(result(findings=some, errors=(BROKEN,), statistics=SimpleNamespace(cut=(CUT,))))
    assert [(one["check_name"], one["severity"]) for one in found] == [
        ("TARL001", "minor"),
        ("TARL201", "minor"),
        ("incomplete", "info"),
    ]
    assert found[1] == {
        "description": "a message",
        "check_name": "TARL201",
        "fingerprint": "f:1",
        "severity": "minor",
        "location": {"path": "src/a.py", "lines": {"begin": 3, "end": 4}},
    }
    assert found[0]["location"] == {"path": "bad.py", "lines": {"begin": 7, "end": 7}}
    assert found[2]["location"] == {"path": "big.py", "lines": {"begin": 1, "end": 1}}
    assert len({one["fingerprint"] for one in found}) == 3
    assert gitlab.document(result(errors=(BROKEN,), names_errors=False)) == []
    failing = gitlab.document(result(findings=some, failing={"TARL201"}))
    assert [one["severity"] for one in failing] == ["major"]


def test_an_annotation_has_columns_within_one_line_only():
    one_line = github._command("warning", SPAN, "a:b,c", "50 %\nof")
    assert one_line == (
        "::warning file=src/a.py,line=3,endLine=3,col=1,endColumn=9,title=a%3Ab%2Cc::50 %25%0Aof"
    )
    several = github._command("note", Span("a.py", 3, 1, 4, 9), "t", "x\ry")
    assert several == "::notice file=a.py,line=3,endLine=4,title=t::x%0Dy"


def test_errors_and_hazards_and_incomplete_programs_have_annotations():
    told = result(
        new=(finding(), finding(flow=flow("/s", "/k"))),
        errors=(BROKEN,),
        statistics=SimpleNamespace(cut=(CUT,)),
    )
    assert [*github._errors(told)] == [
        ("warning", Span("bad.py", 7, 1, 7, 1), "TARL001", "it cannot be read")
    ]
    assert [*github._errors(result(errors=(BROKEN,), names_errors=False))] == []
    assert [*github._hazards(told)] == [("warning", Span("src/a.py", 3, 1, 4, 9), "TARL201", "a message")]
    assert [*github._incomplete(told)] == [
        ("note", Span("big.py", 1, 1, 1, 1), "tarl-lint: incomplete", "it was cut")
    ]
    comment = SimpleNamespace(path="c.py", line=2, column=5, code="TARL101", rules=("TARL101",))
    ((own, span, title, text),) = github._unused(result(unused=(comment,)))
    assert (own, span, title) == ("note", Span("c.py", 2, 5, 2, 5), "tarl-lint")
    assert text[0].isupper()


class Stream:
    """A stream with an encoding, on a terminal or not."""

    def __init__(self, encoding, terminal: bool = False) -> None:
        self.encoding, self.terminal, self.text = encoding, terminal, ""

    def isatty(self) -> bool:
        return self.terminal

    def write(self, text: str) -> None:
        self.text += text


@pytest.mark.parametrize(
    ("environment", "terminal", "expected"),
    [
        ({}, True, True),
        ({}, False, False),
        ({"FORCE_COLOR": "1"}, False, True),
        ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, True, False),
        ({"TERM": "dumb", "FORCE_COLOR": "1"}, True, False),
        ({"NO_COLOR": ""}, True, True),
    ],
)
def test_colours_are_used_on_terminals_unless_refused(environment, terminal, expected):
    assert wants_colour(Stream("utf-8", terminal), environment) is expected


@pytest.mark.parametrize(
    ("encoding", "ascii_only"), [("utf-8", False), ("ascii", True), (None, True), ("no-such", True)]
)
def test_a_stream_that_cannot_encode_unicode_gets_ascii_signs(encoding, ascii_only):
    assert (glyphs_for(Stream(encoding)) == ASCII) is ascii_only


def test_a_stream_without_a_terminal_has_no_width():
    assert width_of(Stream("utf-8")) == 0
    assert width_of(Stream("utf-8", True)) > 0


def test_control_characters_and_direction_marks_are_escaped():
    stream = Stream("ascii")
    write([(("a\x1b[31m\u202eb", "error"), ("\tc\x9f\x7f", ""))], stream, colour=False)
    assert stream.text == "a\\x1b[31m\\u202eb\tc\\x9f\\x7f\n"
    wide = Stream("utf-8")
    write([(("é\ufeff\u061c", ""),), ()], wide, colour=False)
    assert wide.text == "é\\ufeff\\u061c\n\n"
    assert Counter(wide.text)["\n"] == 2


def test_omitted_findings_are_counted_if_there_are_any():
    assert sarif._left_out(0) == []
    (told,) = sarif._left_out(2)
    assert told["message"]["text"] == "2 findings omitted: servers limit the size of a report."
    steps = tuple(range(5))
    long = replace(flow("/s", "/k"), steps=steps, chain=(0, 4))
    assert [sarif._is_cut(long, most) for most in (4, 5)] == [True, False]
    assert not sarif._is_cut(replace(long, chain=()), 0)
    assert not sarif._is_cut(replace(long, chain=(0, 1, 2, 3, 4)), 0)
    assert sarif._shortened([finding(flow=long), finding()], 5) == []
    (told,) = sarif._shortened([finding(flow=long), finding(), finding(flow=long)], 4)
    assert told["message"]["text"].startswith("2 flows reduced to the shortest chain of statements")


def test_new_and_severe_findings_come_first():
    failing = SimpleNamespace(failing={"TARL201"})
    accepted, silenced = finding(status="accepted"), finding(code="TARL101")
    order = [finding(), finding(code="TARL202"), finding(code="TARL102"), accepted, silenced]
    keys = [sarif._gravity(one, failing, {silenced}) for one in order]
    assert keys == [(False, 0), (False, 1), (False, 2), (True, 0), (True, 2)]


def test_wrapper_settings_contain_only_positions_that_were_set():
    assert settings._wrapper(Wrapper("a.b", "rospy.Timer")) == "rospy.Timer"
    assert settings._wrapper(Wrapper("a.b", "rospy.Timer", topic=0, callback="on")) == {
        "like": "rospy.Timer",
        "topic": 0,
        "callback": "on",
    }
    assert settings._toml({"a b": [1, "é"], "c": {"d": True}}) == '{"a b" = [1, "é"], "c" = {"d" = true}}'
    assert settings._toml(["x"]) == '["x"]'


def test_legend_follows_the_first_flows_with_chains(monkeypatch):
    monkeypatch.setattr(text, "_flows", lambda flows, *_: [(("flow", ""),)] * len(flows))
    monkeypatch.setattr(text, "_hazard", lambda *_: [(("hazard", ""),)])
    monkeypatch.setattr(text, "_legend", lambda _: [(("legend", ""),)])

    def told(view: View, *findings: Finding, single: bool = False) -> list[str]:
        monkeypatch.setattr(text.closing_lines, "is_single", lambda _: single)
        return [plain(line) for line in text._findings(result(new=findings), view)]

    one, two = (finding(f"{name}/x.py", name, flow=flow("/s", "/k")) for name in "ab")
    hazard, paths = finding("a/x.py", "a"), View(show_paths=True)
    assert told(View(), one, one) == ["flow", "flow"]
    assert told(paths, one, one) == ["flow", "flow", "legend"]
    assert told(View(), one, single=True) == ["flow", "legend"]
    assert told(paths, one, two) == ["a: 1 flow", "", "flow", "legend", "b: 1 flow", "", "flow"]
    assert told(paths, hazard, one) == ["flow", "legend", "hazard"]
    assert told(paths, hazard) == ["hazard"]
    assert told(View(most_flows=1), one, one, one) == ["flow", "    and 2 further flows", ""]
    assert told(View(most_flows=3), one, one, one) == ["flow"] * 3
    assert told(View(most_flows=1), one, two)[-2:] == ["    and 1 further flow", ""]
    assert told(View()) == []


def test_each_item_of_compact_json_has_its_own_line(monkeypatch):
    monkeypatch.setattr(
        json2, "document", lambda _: {"a": 1, "b": [], "c": [1], "d": [1, 2, 3], "e": {"x": []}}
    )
    lines = [plain(line) for line in json2.report(result(), View())]
    assert lines == [
        "{",
        '"a":1,',
        '"b":[],',
        '"c":[',
        "1],",
        '"d":[',
        "1,",
        "2,",
        "3],",
        '"e":{"x":[]}',
        "}",
    ]
