"""Limits, widths and boundaries of reports, each with the value on both sides."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import islice
from types import SimpleNamespace

import pytest

from tarl_lint.model import Span
from tarl_lint.report import upload_limits
from tarl_lint.report.flows import shown_steps
from tarl_lint.report.frame import TALL, frame, lines_of
from tarl_lint.report.line import View, columns, crop, location, plain, tabs, unbroken
from tarl_lint.report.upload_limits import MOST_RESULTS, MOST_STEPS, Cut, cuts, taken
from tarl_lint.run import groups
from tarl_lint.system import svg

LONGEST = 12  # steps that are shown in full


@pytest.mark.parametrize(
    ("results", "smaller"),
    [
        (3, [Cut(3, MOST_STEPS), Cut(3, 0), Cut(1, 0), Cut(0, 0)]),
        (0, [Cut(0, MOST_STEPS), Cut(0, 0)]),
        (MOST_RESULTS + 1, [Cut(MOST_RESULTS, MOST_STEPS), Cut(MOST_RESULTS, 0)]),
    ],
)
def test_too_large_report_is_cut_step_by_step(results, smaller):
    assert list(islice(cuts(results), len(smaller))) == smaller
    assert list(cuts(results))[-1] == Cut(0, 0)


def test_a_report_of_exactly_the_maximum_size_is_accepted(monkeypatch):
    monkeypatch.setattr(upload_limits, "MOST_BYTES", 1000)
    assert taken("x" * 1000)
    assert taken("x" * 1001)  # the compressed text is smaller
    noise = random.Random(0).choices("abcdefghijklmnop", k=4000)
    assert not taken("".join(noise))


def test_only_long_step_lists_are_reduced_to_a_chain(example):
    flow = example.flow()
    exact = replace(flow, steps=flow.steps[:1] * LONGEST, chain=(1, 2))
    longer = replace(exact, steps=(*exact.steps, flow.steps[-1]))
    assert shown_steps(exact, View()) == exact.steps
    assert shown_steps(replace(longer, chain=()), View()) == longer.steps
    assert shown_steps(longer, View(all_steps=True)) == longer.steps
    registrations = [step for step in longer.steps if step.role == "register"]
    assert len(registrations) == LONGEST
    assert list(shown_steps(longer, View())) == [*registrations, longer.steps[1], longer.steps[2]]


@pytest.mark.parametrize(
    ("text", "width", "shown"),
    [
        ("abcdef", 6, "abcdef"),
        ("abcdef", 5, "abcd…"),
        ("abcdef", 0, "abcdef"),
        ("abcdef", -1, "abcdef"),
        ("漢字", 4, "漢字"),
        ("漢字", 3, "漢…"),
        ("é" + "\u0301" * 3, 1, "é" + "\u0301" * 3),
    ],
)
def test_a_text_is_shortened_to_a_width_in_columns(text, width, shown):
    assert crop(text, width, "…") == shown


def test_tabs_and_escaped_line_ends_count_in_the_width():
    assert [columns(text) for text in ("abc", "漢", "e\u0301", "é")] == [3, 2, 1, 1]
    assert tabs("\tx") == "    x"
    assert location(Span("a\nb.py", 2, 3, 4, 5)) == "a\\nb.py:2:3"
    line = (("a\nb", ""), ("c\rd", "strong"))
    assert unbroken(line) == (("a\\nb", ""), ("c\\rd", "strong"))
    assert unbroken((("ab", ""),)) == (("ab", ""),)
    assert lines_of("a\r\nb\rc\n\x0cd") == ["a", "b", "c", "\x0cd"]


def framed(text: str, span: Span, view: View = View()) -> list[str]:  # noqa: B008 - frozen
    return [plain(line).rstrip() for line in frame(text.split("\n"), span, "", view)]


def test_code_frame_has_lines_before_the_span_and_carets():
    text = "\n\na = 1\nf(\n  x,\n)\nb"
    assert framed(text, Span("n", 4, 1, 6, 2)) == [
        "   3 │ a = 1",
        "   4 │ f(",
        "     │ ^^",
        "   5 │   x,",
        "     │   ^^",
        "   6 │ )",
        "     │ ^",
    ]
    assert framed(text, Span("n", 1, 1, 1, 1)) == ["   1 │"]
    assert framed(text, Span("n", 8, 1, 8, 2)) == []
    assert framed(text, Span("n", 7, 1, 9, 2))[-2:] == ["   7 │ b", "     │ ^"]


def test_frame_of_a_long_statement_has_its_first_and_last_lines():
    text = "\n".join("x" for _ in range(20))
    exact, taller = (framed(text, Span("n", 1, 1, end, 2)) for end in (TALL, TALL + 1))
    assert len(exact) == 2 * TALL
    assert [line[:5].strip() for line in taller[::2]] == ["1", "2", "3", "4", "…", ""]
    assert taller[-2] == f"   {TALL + 1} │ x"


def test_a_narrow_frame_is_cropped_with_its_carets():
    assert framed("abcdefghij", Span("n", 1, 3, 1, 10), View(width=12)) == ["   1 │ abcd…", "     │   ^^^"]


def test_a_picture_without_nodes_has_only_margins():
    (start,) = (line for line in svg.report([]) if line.startswith("<svg"))
    assert f'width="{svg.MARGIN:.0f}" height="{svg.MARGIN:.0f}"' in start


def processes(monkeypatch: pytest.MonkeyPatch, *lines: int, jobs: int | None = None) -> int:
    tasks = [SimpleNamespace(analyse=True, lines=count) for count in lines]
    monkeypatch.setattr(groups, "_processors", lambda: 8)
    return groups._workers(tasks, jobs)  # type: ignore[arg-type]


def test_processes_are_limited_by_the_largest_group(monkeypatch):
    many = groups.MANY_LINES
    assert processes(monkeypatch, many - 1) == 1
    assert processes(monkeypatch, *[many // 4] * 4) == 4
    assert processes(monkeypatch, *[many // 4] * 3, many // 2) == 2
    assert processes(monkeypatch, *[many] * 20) == 8
    assert processes(monkeypatch, 1, 1, jobs=9) == 2
    assert processes(monkeypatch, 1, 1, jobs=0) == 1


def test_only_usable_processors_are_counted(monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda process: {*range(5 - process)}, raising=False)
    assert groups._processors() == 5
    monkeypatch.delattr("os.sched_getaffinity")
    monkeypatch.setattr("os.cpu_count", lambda: None)
    assert groups._processors() == 1
    monkeypatch.setattr("os.cpu_count", lambda: 7)
    assert groups._processors() == 7
