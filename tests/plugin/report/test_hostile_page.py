"""A report page whose topics, code, names and messages are hostile, in a real browser: nothing runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from pytest_tarl.model import Comparison
from pytest_tarl.report.html import render
from tests.plugin.report.hostile import HOSTILE, HUGE, PIECES, PROBE, planted
from tests.plugin.report.test_browser import browser, opened

__all__ = ["browser"]
# data, script of the page and probe; the page removes the element of its library once it is loaded
SCRIPTS = 3
FIELDS = {
    "test", "drift", "path", "code", "qualname", "source", "sink", "unit", "field", "guard", "diff", "patch", "what",
    "method", "formula", "part", "ranking", "target",
}  # fmt: skip


def hostile(comparison: Comparison, text: str = HOSTILE) -> Comparison:
    """Return the comparison with hostile text in every place where it shows text of the user."""
    new: Comparison = planted(comparison, FIELDS, text)
    lists = tuple(
        replace(one, slices=tuple(replace(slice_, list_name=one.taint_list.name) for slice_ in one.slices))
        for one in new.lists
    )
    sensors = tuple(
        replace(
            one,
            topic=f"{one.topic}<img/src=x/onerror={PIECES[1].split(chr(34))[3]}>" if one.topic else None,
            categories=tuple(name + text for name in one.categories),
        )
        for one in new.sensors
    )
    labels = tuple(replace(one, labels=tuple(label + text for label in one.labels)) for one in new.searches)
    return replace(
        new,
        lists=lists,
        sensors=sensors,
        searches=labels,
        notes=(*new.notes, *PIECES, text),
        parts={name + text: value for name, value in new.parts.items()},
    )


@pytest.mark.parametrize("name", ["shuttle", "two_lists"])
def test_nothing_in_a_hostile_page_runs(
    browser: str, name: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    seen = opened(browser, render(hostile(request.getfixturevalue(name))), tmp_path, probe=PROBE)
    assert seen.found["report"] == "drawn"
    assert seen.found["text"] is True  # the hostile text is shown
    assert seen.found["ran"] is None
    assert seen.found["scripts"] == SCRIPTS
    assert seen.found["handlers"] == seen.found["links"] == []
    assert seen.found["foreign"] == 0
    assert seen.found["violations"] == seen.console == []


def test_huge_names_do_not_break_the_page(browser: str, shuttle: Comparison, tmp_path: Path) -> None:
    seen = opened(browser, render(replace(shuttle, test=HUGE, drift=HUGE)), tmp_path, probe=PROBE)
    assert (seen.found["report"], seen.found["ran"], seen.found["scripts"]) == ("drawn", None, SCRIPTS)


@pytest.mark.parametrize("at", [0, 1])
def test_the_check_detects_a_page_that_does_not_escape(
    browser: str, shuttle: Comparison, tmp_path: Path, at: int
) -> None:
    text = render(shuttle).replace("</h1>", f"{PIECES[at]}</h1>", 1)
    assert seen_to_run(browser, text, tmp_path)


def seen_to_run(browser: str, text: str, folder: Path) -> bool:
    found = opened(browser, text, folder, probe=PROBE).found
    return found["ran"] is not None or bool(found["handlers"])
