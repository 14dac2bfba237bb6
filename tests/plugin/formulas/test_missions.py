"""Formulas over recorded missions: bags and logs."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rtamt")

from tests.plugin.formulas.test_recorded import FILLS, KEEPS, required
from tests.plugin.missions import mission, write_bag
from tests.plugin.observing.test_observe import drive, order
from tests.plugin.tank import RECORD, changed

MONITOR = """\
def monitor(moment):
    missing = abs(1.0 - moment.latest('/gauge').data)
    moment.observe(missing=missing)
    return -missing


@pytest.mark.tarl(
    monitor=monitor,
"""


@pytest.fixture(autouse=True)
def _other_modules_stay() -> Iterator[None]:
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name in ("keeper", "test_tank"):
            del sys.modules[name]


def rows(tank: pytest.Pytester) -> dict[str, dict[str, Any]]:
    (path,) = tank.path.glob(".tarl/results/*.json")
    return {row["formula"]: row["worlds"] for row in json.loads(path.read_text())["formulas"]}


@pytest.mark.parametrize("more", ["", 'reward="robustness",'])
def test_bags_are_judged_by_topics_and_observed_signals(tank: pytest.Pytester, more: str) -> None:
    required(tank, more)
    changed(tank, "test_tank", "@pytest.mark.tarl(\n", MONITOR)
    tank.runpytest("-q", *RECORD).assert_outcomes(passed=1, deselected=1)
    bags = [write_bag(tank.path / f"mission{n}.mcap", mission(0.25, n)) for n in range(6)]
    told = tank.runpytest("-q", "--tarl-online", *(f"--tarl-bag={bag}" for bag in bags))
    told.assert_outcomes(failed=1, deselected=1)
    found = rows(tank)
    assert found[FILLS]["online"]["violated"] == found[FILLS]["online"]["episodes"] == 6
    assert found[KEEPS]["online"]["violated"] == 0


def test_a_bag_without_an_observed_signal_is_reported(tank: pytest.Pytester) -> None:
    required(tank)
    changed(
        tank,
        "test_tank",
        "@pytest.mark.tarl(\n",
        MONITOR.replace("    moment.observe(missing=missing)\n", ""),
    )
    tank.runpytest("-q", *RECORD).assert_outcomes(passed=1, deselected=1)
    bag = write_bag(tank.path / "mission.mcap", mission(1.0, 0))
    told = tank.runpytest("-q", "--tarl-online", f"--tarl-bag={bag}")
    assert "needs the signal 'missing', which never had a value" in " ".join(told.stdout.str().split())


UPPER = "always (level < 0.6)"


@pytest.fixture
def observed(tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project recorded with formulas, and observed missions, some of which reach 0.6."""
    valve = 'Signal("flow", topic="/valve", field="data")'
    asked = (
        f'requires=["{UPPER} or eventually (level > 0)", "always (flow > -1)"], signals=[{valve}, "unheard"],'
    )
    changed(tank, "test_tank", "import Sensor", "import Sensor, Signal")
    changed(tank, "test_tank", "    min_success=0.9,", f"    min_success=0.9, {asked}")
    tank.runpytest("-q", *RECORD).assert_outcomes(passed=1, deselected=1)
    monkeypatch.chdir(tank.path)
    drive(order(tank.path), [1.0, 0.1, 1.0])
    sys.modules.pop("test_tank", None)
    return tank.path / ".tarl/missions.log"


def test_logs_are_judged_at_every_recorded_change(tank: pytest.Pytester, observed: Path) -> None:
    changed(tank, "test_tank", f"{UPPER} or eventually (level > 0)", UPPER)
    told = tank.runpytest("-q", "--tarl-online", f"--tarl-log={observed}")
    found = rows(tank)
    assert (found[UPPER]["online"]["episodes"], found[UPPER]["online"]["violated"]) == (3, 2)
    assert found[UPPER]["online"]["least"] < -0.3
    assert found["always (flow > -1)"]["online"]["violated"] == 0
    assert "not required when the test was recorded: 'always (level < 0.6)'" in " ".join(
        told.stdout.str().split()
    )


def test_formula_over_missing_signals_is_skipped(tank: pytest.Pytester, observed: Path) -> None:
    changed(tank, "test_tank", "always (flow > -1)", "always (unheard > 0)")
    told = tank.runpytest("-q", "--tarl-online", f"--tarl-log={observed}")
    text = " ".join(told.stdout.str().split())
    assert "missions.log lacks signals of 'always (unheard > 0)', which is not judged" in text
    assert rows(tank)["always (unheard > 0)"]["online"] is None


def test_logged_missions_earn_their_robustness(tank: pytest.Pytester, observed: Path) -> None:
    changed(tank, "test_tank", f"{UPPER} or eventually (level > 0)", UPPER)
    changed(tank, "test_tank", '"unheard"],', '"unheard"], reward="robustness",')
    tank.runpytest("-q", "--tarl-online", f"--tarl-log={observed}")
    (path,) = tank.path.glob(".tarl/results/*.json")
    assert json.loads(path.read_text())["atr"]["online"] == pytest.approx(
        rows(tank)[UPPER]["online"]["robustness"]
    )


def test_log_without_reward_signals_is_refused(tank: pytest.Pytester, observed: Path) -> None:
    changed(tank, "test_tank", "always (flow > -1)", "always (unheard > 0)")
    changed(tank, "test_tank", '"unheard"],', '"unheard"], reward="robustness",')
    told = tank.runpytest("-q", "--tarl-online", f"--tarl-log={observed}")
    told.assert_outcomes(failed=1, deselected=1)
    text = " ".join(told.stdout.str().split())
    assert "The log lacks signals of the formula 'always (unheard > 0)'" in text
