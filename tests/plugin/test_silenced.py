"""A drift may silence the node, or a sensor: that is a result of the comparison, and can be repaired."""

from __future__ import annotations

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed, result

CAREFUL = "if level is not None and level > LOWEST:"


@pytest.fixture
def careful(tank: pytest.Pytester) -> pytest.Pytester:
    """A tank whose node ignores levels below a limit; the drifts are a sensor with an offset and a dead one."""
    changed(tank, "keeper", "if level is not None:", CAREFUL)
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 2.0\nLOWEST = -0.5")
    changed(tank, "test_tank", '{"clogged": 0.25}', '{"offset": Drift(-0.8, permanent=True), "dead": "dead"}')
    changed(tank, "test_tank", "import Sensor", "import Drift, Sensor")
    changed(tank, "test_tank", "1.0 if tarl_drift is None else tarl_drift", "1.0")
    changed(
        tank,
        "test_tank",
        '        tarl.bus.publish("/level", Float64(data=level + float(draws.normal(0, 0.005))))',
        "        offset = tarl_drift if isinstance(tarl_drift, float) else float(draws.normal(0, 0.005))\n"
        '        if tarl_drift != "dead":\n'
        '            tarl.bus.publish("/level", Float64(data=level + offset))',
    )
    changed(tank, "test_tank", "tank not full", "tank at {level:.2f}")
    return tank


def test_a_node_that_a_drift_silences_is_degraded(careful: pytest.Pytester) -> None:
    careful.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    ran = careful.runpytest(*ONLINE, "--tarl-drift=offset")
    ran.assert_outcomes(failed=1, deselected=1)
    ran.stdout.fnmatch_lines(
        ["*offset*: degraded", "*note *The node published nothing in a whole episode of this*"]
    )
    assert result(careful)["verdict"]["result"] == "degraded"


def test_a_sensor_that_a_drift_silences_is_degraded(careful: pytest.Pytester) -> None:
    careful.runpytest(*RECORD)
    ran = careful.runpytest(*ONLINE, "--tarl-drift=dead")
    ran.assert_outcomes(failed=1, deselected=1)
    ran.stdout.fnmatch_lines(["*dead*: degraded"])


@pytest.mark.usefixtures("quick_acceptance")
def test_the_cause_of_a_silent_node_is_repaired(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "if level is not None:", CAREFUL)
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 2.0\nLOWEST = -0.1")
    changed(tank, "test_tank", '{"clogged": 0.25},', '{"empty": Drift(-0.3, permanent=True)}, tolerance=2.0,')
    changed(tank, "test_tank", "import Sensor", "import Drift, Sensor")
    changed(
        tank,
        "test_tank",
        "float(draws.uniform(0.0, 0.2)), 1.0 if tarl_drift is None else tarl_drift",
        "float(draws.uniform(0.0, 0.2)) + (tarl_drift or 0.0), 1.0",
    )
    tank.runpytest(*RECORD)
    ran = tank.runpytest(*ONLINE, "--tarl-repair")
    ran.stdout.fnmatch_lines(["*repair *accepted: LOWEST*"])


def test_drifted_recording_needs_a_publishing_node(careful: pytest.Pytester) -> None:
    ran = careful.runpytest(*RECORD, "--tarl-drift=offset")
    ran.assert_outcomes(failed=1, deselected=1)
    ran.stdout.fnmatch_lines(["*published nothing*/level*"])


def test_lossless_failures_are_degraded(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "tarl.reward(-abs(1.0 - level))", "tarl.reward(-1.0)")
    tank.runpytest(*RECORD)
    ran = tank.runpytest(*ONLINE, "--tarl-repair")
    ran.assert_outcomes(failed=1, deselected=1)
    ran.stdout.fnmatch_lines(
        [
            "*: degraded",
            "  verdict  In * missions succeed in 0 % of the*",
            "*episodes, instead of 100 % (p = 0.001).",
            "  note     more missions fail, but no loss of reward was found*",
        ]
    )
    ran.stdout.no_fnmatch_line("  repair *")
    ran.stdout.no_fnmatch_line("  next *")


def test_sometimes_silent_sensor_is_noted(tank: pytest.Pytester) -> None:
    changed(
        tank,
        "test_tank",
        "sensors=[",
        'sensors=[Sensor("alarm", topic="/alarm", field="data", low=0, high=1, bins=2), ',
    )
    changed(
        tank,
        "test_tank",
        "    for _ in range(25):\n",
        "    rings = draws.uniform() < 0.6\n    for _ in range(25):\n"
        '        if rings:\n            tarl.bus.publish("/alarm", Float64(data=0.5))\n',
    )
    ran = tank.runpytest(*RECORD)
    ran.assert_outcomes(passed=1, deselected=1)
    told = " ".join(ran.stdout.str().split())
    assert "of 16 missions, which count like the others: Sensor 'alarm' received no message on /alarm" in told
    tank.runpytest(*ONLINE).stdout.fnmatch_lines(["*clogged*: degraded*"])


def test_sometimes_silent_node_is_noted(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "if level is not None:", "if level is not None and level < 0.95:")
    changed(tank, "test_tank", "float(draws.uniform(0.0, 0.2))", "float(draws.choice([0.1, 1.0]))")
    changed(tank, "test_tank", "float(draws.normal(0, 0.005))", "0.0")
    ran = tank.runpytest(*RECORD)
    ran.assert_outcomes(passed=1, deselected=1)
    told = " ".join(ran.stdout.str().split())
    assert "of 16 missions, which count like the others: The node published nothing" in told
