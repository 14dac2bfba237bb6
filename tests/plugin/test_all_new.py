"""The report and the ranking if a sensor has only new values, so that every situation is new."""

from __future__ import annotations

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed, result


def test_sensor_with_new_values_is_left_out_without_common_cells(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "bins=10)]", 'bins=10), Sensor("tank")]')
    changed(
        tank,
        "test_tank",
        'tarl.start("keeper.py")',
        'tarl.start("keeper.py")\n    tarl.observe(tank=0 if tarl_drift is None else 2)',
    )
    tank.runpytest(*RECORD)
    told = tank.runpytest(*ONLINE)
    told.stdout.fnmatch_lines(["*where*level *regardless of tank; not in the recording: *"])
    told.stdout.no_fnmatch_line("*no longer visited*")
    told.stdout.fnmatch_lines(["*no deployed situation occurs in the recording, because of tank*"])
    found = result(tank)
    scores = [one["score"] for one in found["culprits"]]
    assert scores
    assert scores == sorted(scores, reverse=True)
    assert any(one["difference"] for one in found["sites"])
    assert all(box["tank"] == [2, 2] for box in (*found["region"], *found["novel"]))
