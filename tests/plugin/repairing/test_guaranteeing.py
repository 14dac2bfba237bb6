"""The patch and the report state bounds for the repaired program in both worlds."""

from __future__ import annotations

import pytest

from tests.plugin.tank import ONLINE, RECORD, result


def test_patch_page_and_result_state_the_repair_bounds(
    tank: pytest.Pytester,
) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*ONLINE, "--tarl-repair").stdout.fnmatch_lines(["*repaired: success at least*"])
    (patch,) = (tank.path / ".tarl" / "patches").glob("*.patch")
    told = [line for line in patch.read_text().splitlines() if line.startswith("# bounds, ")]
    assert [line.partition(":")[0] for line in told] == [
        "# bounds, drifted and repaired",
        "# bounds, designed and repaired",
    ]
    found = result(tank)["bounds"]
    assert found["repaired"]["episodes"] == 12  # as many seeds as compared episodes
    assert found["repaired"]["success"]["low"] == pytest.approx(0.05 ** (1 / 12))
    assert found["nominal_repaired"]["success"]["exact"]
    (page,) = (tank.path / ".tarl" / "report").glob("*.html")
    assert "Bounds on future missions" in page.read_text("utf-8")
