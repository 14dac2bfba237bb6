"""`pytest --tarl-stress --tarl-repair`: repairs at the boundary and beyond, and how far they move it."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from pytest_tarl import Drift, boundary_repairs
from pytest_tarl.boundary_repairs import Fixed, Placed, _worlds
from pytest_tarl.model import Repair
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.stressing.findings import Curve
from pytest_tarl.stressing.guarantee import Outcome
from pytest_tarl.stressing.margin_changes import Row
from pytest_tarl.stressing.margins import Margin
from pytest_tarl.stressing.rays import rays
from tests.plugin.stressing.worlds import Simulated, space_of
from tests.plugin.tank import RECORD, changed

SPACE = '{"world": Drift.space(pump=Drift.range(0.1, 1.0, nominal=1.0))}'
REPAIR = (
    "--tarl-stress",
    "--tarl-repair",
    "--tarl-stress-budget=90",
    "--tarl-constants",
    "--tarl-episodes=8",
)


def test_a_repair_moves_the_boundary_and_can_be_applied(
    tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(boundary_repairs, "DRAWS", 10)  # fewer episodes
    changed(tank, "test_tank", "import Sensor", "import Drift, Sensor")
    changed(tank, "test_tank", '{"clogged": 0.25}', SPACE)
    changed(tank, "test_tank", "1.0 if tarl_drift is None else tarl_drift", 'tarl_drift["pump"]')
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    done = tank.runpytest(*REPAIR)
    done.assert_outcomes(passed=1, deselected=1)
    told = done.stdout.str()
    assert re.search(r"  repair     pump from 0\.9\d+ to 0\.1: GAIN → ", told)
    assert re.search(r"pump to 0\.1: not beyond 0\.9\d+ → no failure shown", told)
    before, now = map(int, re.findall(r"(\d+) instead of (\d+) of 10 fresh draws", told)[0][::-1])
    assert now > before
    (patch,) = (tank.path / ".tarl" / "patches").glob("*.patch")
    tank.run("git", "apply", str(patch))
    assert "GAIN = 2.0" not in (tank.path / "keeper.py").read_text("utf-8")


def test_only_episodes_of_the_drift_without_a_point_are_placed() -> None:
    simulated = Simulated(lambda point, _: (True, float(point["mud"])))
    placed = Placed(
        simulated, "world", lambda seed: {"mud": float(seed)}, {Path("a.py"): "1", Path("b.py"): "2"}
    )
    for plan in (
        EpisodePlan(3, "world", {Path("b.py"): "3"}),
        EpisodePlan(4, "world", point={"mud": 0.5}),
        EpisodePlan(5, "other", point={"mud": 0.5}),
    ):
        placed(plan)
    assert [one.point for one in simulated.plans] == [{"mud": 3.0}, {"mud": 0.5}, {"mud": 0.5}]
    assert simulated.plans[0].overlay == {Path("a.py"): "1", Path("b.py"): "3"}


def test_the_range_to_repair_begins_at_the_boundary() -> None:
    space = space_of(mud=Drift.range(0.0, 1.0, nominal=1.0), camera=Drift.choice("up", "down"))
    mud, camera = rays(space, {})
    told = [words for _, words in _worlds(Curve(mud, confirmed=0.6))]
    assert told == ["mud from 0.4 to 0", "mud from 0.4 to 0.3"]
    ((world, _),) = _worlds(Curve(mud, confirmed=1.0))
    assert world.value == 0.0
    ((world, words),) = _worlds(Curve(camera, confirmed=1.0))
    assert (world.value, words) == ("down", "camera='down'")


def test_a_repair_that_loses_elsewhere_is_withheld() -> None:
    wide, narrow = Margin("mud", 1.0, 0.0, 0.2, 0.1), Margin("mud", 1.0, 0.0, 0.5, 0.3)
    row = Row("t[world]", wide, wide)
    fine = tuple(Outcome(True, 9.0 + n / 100) for n in range(60))
    poor = tuple(Outcome(True, 8.9) for _ in range(60))
    assert Fixed((row,), fine, fine).loses == ""
    assert "over the declared space" in Fixed((row,), fine, poor).loses
    nearer = Fixed((Row("t[world]", wide, narrow),), poor, fine)
    assert nearer.loses == "the boundary of mud to 0 came nearer"


@pytest.mark.parametrize(
    ("stopped", "kept", "told"), [(True, True, "Interrupted before"), (False, False, "withheld")]
)
def test_a_patch_stays_after_ctrl_c_and_goes_if_it_loses(
    stopped: bool, kept: bool, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.patch").write_text("patch")
    job = SimpleNamespace(root=tmp_path)
    ray = rays(space_of(mud=Drift.range(0.0, 1.0, nominal=1.0)), {})[0]
    found = SimpleNamespace(curves=(Curve(ray, confirmed=0.5),))
    fine, poor = (tuple(Outcome(True, total) for _ in range(60)) for total in (9.0, 8.0))

    def examined(*_: object) -> Fixed:
        if stopped:
            raise KeyboardInterrupt
        return Fixed((), fine, poor)

    monkeypatch.setattr(
        boundary_repairs, "_searched", lambda *_: (Repair(True, "", (), patch="a.patch"), {}, "")
    )
    monkeypatch.setattr(boundary_repairs, "_examined", examined)
    done = boundary_repairs.repair_boundary(job, found)  # type: ignore[arg-type]
    assert (done.interrupted, done.patch is not None) == (stopped, kept)
    assert told in done.lines[-1]
    assert (tmp_path / "a.patch").exists() == kept
