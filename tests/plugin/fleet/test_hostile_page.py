"""A page of a fleet whose robots, groups and test have hostile names, in a real browser: nothing runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pytest_tarl.fleet import html
from pytest_tarl.fleet.question import Answer
from tests.plugin.fleet.test_html import data, found
from tests.plugin.report.hostile import HOSTILE, PIECES, PROBE, planted
from tests.plugin.report.test_browser import browser, opened

__all__ = ["browser", "data", "found"]


def test_nothing_in_a_hostile_page_of_a_fleet_runs(browser: str, found: Answer, tmp_path: Path) -> None:
    names = {
        one.name: one.name + PIECES[at % len(PIECES)] + HOSTILE for at, one in enumerate(found.robots.every)
    }
    every = tuple(replace(one, name=names[one.name]) for one in found.robots.every)
    drifted = tuple(replace(one, name=names[one.name]) for one in found.robots.drifted)
    below = tuple(replace(one, name=names[one.name]) for one in found.robots.below)
    bad = planted(found, {"unit", "test", "formula"})
    bad = replace(bad, robots=replace(found.robots, every=every, drifted=drifted, below=below))
    seen = opened(browser, html.render(bad), tmp_path, probe=PROBE)
    assert seen.found["report"] == "drawn"
    assert seen.found["text"] is True  # the hostile text is shown
    assert seen.found["ran"] is None
    assert seen.found["handlers"] == seen.found["links"] == []
    assert seen.found["foreign"] == 0
    assert seen.found["violations"] == seen.console == []
