"""A sensor with one edge, from recording to patch and page."""

from __future__ import annotations

import sys

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed, fixture_file


@pytest.mark.usefixtures("quick_acceptance")
def test_one_edge_sensor_can_be_repaired(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "low=0, high=1, bins=10", "edges=(0.5,)")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    told = tank.runpytest(*ONLINE, "--tarl-repair", "--tarl-seed=3")
    told.stdout.fnmatch_lines(["*where*level below 0.5*"])
    assert list((tank.path / ".tarl" / "report").glob("*.html"))
    tank.run(sys.executable, "-m", "pytest_tarl", "show", fixture_file(tank)).stdout.fnmatch_lines(
        ["*level: /level data, below and above 0.5*"]
    )
