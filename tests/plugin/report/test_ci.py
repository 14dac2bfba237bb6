"""Results for build servers: JUnit properties of a test case, and GitHub annotations of a line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from pytest_tarl.model import Comparison, Culprit, LossInterval, Region, Repair, SitePlace, Verdict
from pytest_tarl.report import ci

Varied = Callable[..., Comparison]
SITE = SitePlace("node:vel", "src/a,b:node.py", 30, "vel = (\n    5 * delta)", "data", "assign")
QUIET = Verdict("no difference", 0.4, 0.6, 0.1, 0.2, 0.5)


def test_junit_properties_hold_verdict_culprit_and_patch(
    shuttle: Comparison,
) -> None:
    assert ci.properties(shuttle) == (
        ("tarl_verdict", "degraded"),
        ("tarl_p_drift", "0.001"),
        ("tarl_p_loss", "0.0005"),
        ("tarl_loss", "16.90"),
        ("tarl_loss_interval", "15.40 to 18.10"),
        ("tarl_region", "x 4.2-7.1 m, terrain true"),
        ("tarl_culprit", "traveller.py:30 vel = 5 * delta"),
        ("tarl_patch", ".tarl/patches/test-delivers-mud-1a2b3c4d.patch"),
    )


def test_an_unknown_junit_property_is_left_out(varied: Varied) -> None:
    found = dict(ci.properties(varied(culprits=(), repair=None, region=Region())))
    assert [*found] == ["tarl_verdict", "tarl_p_drift", "tarl_p_loss", "tarl_loss", "tarl_loss_interval"]


def test_without_a_difference_neither_region_nor_culprit_is_named(varied: Varied) -> None:
    found = dict(ci.properties(varied(verdict=QUIET, repair=None)))
    assert [*found] == ["tarl_verdict", "tarl_p_drift", "tarl_p_loss", "tarl_loss"]


def test_the_annotation_at_the_line_contains_the_whole_conclusion(
    varied: Varied, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("GITHUB_WORKSPACE", "/checkout")
    one = varied(culprits=(Culprit(SITE, 0.9, "sweep"),), test="t.py::test_a[1,2]")
    assert ci.annotation(one, Path("/checkout/robot")) == (
        "::error file=robot/src/a%2Cb%3Anode.py,line=30,title=t.py%3A%3Atest_a[1%2C2][mud]%3A degraded::"
        "In the drift scenario 'mud' an episode earns 16.90 less than designed (p < 0.001).%0A"
        "Where: x 4.2-7.1 m, terrain true.%0A"
        "vel = ( 5 * delta) is ranked first by simulation.%0A"
        "Accepted repair: 5 → 12 at traveller.py:30 where terrain and 4.167 <= pos <= 7.083 "
        "(.tarl/patches/test-delivers-mud-1a2b3c4d.patch)."
    )


def test_drift_without_loss_warns_with_its_slices(varied: Varied) -> None:
    drifted = Verdict("drifted", 0.001, 0.5, 0.0, 0.4, 0.5)
    one = varied(
        verdict=drifted, drift=None, culprits=(Culprit(SITE, 0.0, "slices"),), repair=None, region=Region()
    )
    told = ci.annotation(one, Path("/elsewhere"))
    assert told.startswith("::warning file=/elsewhere/src/a%2Cb%3Anode.py,line=30,title=")
    assert "[online]%3A drifted::" in told
    assert told.endswith(".%0Avel = ( 5 * delta) is ranked first by its slice.")
    assert "Where:" not in told


def test_patch_is_mentioned_only_if_it_was_written(varied: Varied, shuttle: Comparison) -> None:
    repair = shuttle.repair
    assert repair is not None
    assert "Accepted" not in ci.annotation(varied(repair=replace(repair, accepted=False)), Path.cwd())
    assert ci.annotation(varied(repair=replace(repair, patch="")), Path.cwd()).endswith("<= 7.083.")
    assert ci.annotation(varied(repair=Repair(True, "", repair.edits)), Path.cwd()).endswith(" everywhere.")


def test_annotation_needs_a_difference_or_a_culprit(varied: Varied) -> None:
    assert ci.annotation(varied(verdict=QUIET), Path.cwd()) == ""
    assert ci.annotation(varied(culprits=()), Path.cwd()) == ""


def test_an_interval_with_one_end_names_that_end(varied: Varied, shuttle: Comparison) -> None:
    for low, high, expected in (
        (1.0, float("inf"), "at least 1.00"),
        (float("-inf"), 2.0, "at most 2.00"),
        (float("-inf"), float("inf"), None),
    ):
        verdict = replace(shuttle.verdict, interval=LossInterval(low, high, 0.9))
        assert dict(ci.properties(varied(verdict=verdict))).get("tarl_loss_interval") == expected
