"""`pytest --tarl-stress --tarl-repair`: repairs at the boundary and beyond, and how far they move it."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import jsonschema
import numpy as np
import pytest

from pytest_tarl import Drift, boundary_repairs
from pytest_tarl.boundary_repairs import Fixed, Placed, _combination, chosen
from pytest_tarl.designation import Designation
from pytest_tarl.drifts import sizes
from pytest_tarl.model import Repair
from pytest_tarl.options import Options
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import json_result, page
from pytest_tarl.stressing.findings import Attempt, Draws, Moved, failure
from pytest_tarl.stressing.guarantee import Outcome
from pytest_tarl.stressing.margin_changes import Row
from pytest_tarl.stressing.margins import Margin
from pytest_tarl.stressing.regions import Region, outwards, regions
from pytest_tarl.stressing.stress_run import Request
from pytest_tarl.stressing.words import repair_lines
from tests.plugin.stressing.worlds import Simulated, World, space_of, stressed
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
    now, before = map(
        int, re.findall(r"(\d+) of 10 fresh draws pass with the repair, (\d+) without it", told)[0]
    )
    assert now > before
    (patch,) = (tank.path / ".tarl" / "patches").glob("*.patch")
    tank.run("git", "apply", str(patch))
    assert "GAIN = 2.0" not in (tank.path / "keeper.py").read_text("utf-8")


def test_boundary_repair_sets_the_drift_of_its_episodes() -> None:
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


def test_repair_ranges_begin_at_the_failure() -> None:
    space = space_of(
        mud=Drift.range(0.0, 1.0, nominal=1.0),
        slope=Drift.range(-0.5, 0.5, nominal=0.0),
        camera=Drift.choice("up", "down"),
    )

    def found(**changed: float) -> list[Region]:
        return [*regions(space, failure(space, {**space.nominal, **changed}))]

    assert [one.words for one in found(mud=0.4)] == ["mud from 0.4 to 0", "mud from 0.4 to 0.3"]
    (only,) = found(mud=0.0)
    assert (only.drift.value, only.words) == (0.0, "mud=0")
    (only,) = found(camera=1.0)
    assert (only.drift.value, only.words) == ("down", "camera='down'")
    wide, narrow = found(mud=0.4, slope=-0.1, camera=1.0)
    assert wide.words == "mud from 0.4 to 0 and slope from -0.1 to -0.5 and camera='down'"
    assert narrow.words == "mud from 0.4 to 0.3 and slope from -0.1 to -0.2 and camera='down'"
    for seed in range(20):
        drawn = {**wide.base, **sizes(wide.drift, "world", seed)}
        assert 0.0 <= drawn["mud"] <= 0.4
        assert -0.5 <= drawn["slope"] <= -0.1
        assert drawn["camera"] == 1.0


def test_combined_ray_ends_where_its_first_range_ends() -> None:
    space = space_of(a=Drift.range(0.0, 1.0, nominal=0.0), b=Drift.range(-1.0, 3.0, nominal=1.0))
    ray = outwards(space, failure(space, {"a": 0.5, "b": 0.5}))
    assert ray.farthest == {"a": 1.0, "b": 0.0}
    assert ray.point(0.5) == {"a": 0.5, "b": 0.5}


def test_nearest_failures_and_combinations_are_repaired() -> None:
    space = space_of(**{name: Drift.range(0.0, 1.0, nominal=0.0) for name in "abc"})
    points = [{"a": 0.1}, {"a": 0.2, "b": 0.2}, {"b": 0.4}, {"c": 0.5}, {"a": 0.5, "c": 0.5}]
    failures = [failure(space, {**space.nominal, **one}) for one in points]
    assert [one.names for one in chosen(failures)] == [("a",), ("a", "b"), ("b",)]


def multiplied(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    return True, 10.0 - 3.0 * point["a"] * point["b"] + float(draws.normal(0.0, 0.02))


def test_combination_repair_reports_both_distances() -> None:
    """Without the repair, the margin is 0 at a · b = 1 / 6; the repair keeps it positive up to the end of the ray."""
    space = space_of(**{name: Drift.range(0.0, 1.0, nominal=0.0) for name in "ab"})
    failed = failure(space, {"a": 0.45, "b": 0.45})
    designation = Designation((), (), drifts={"world": Drift(space)}, min_success=0.95, tolerance=0.5)
    fixture: Any = SimpleNamespace(
        test="t", sample=SimpleNamespace(passed=[1] * 100, total=np.full(100, 10.0), episodes=100)
    )

    def moved(world: World) -> Moved:
        options = Options(stress_budget=250)
        request = Request(Simulated(world), fixture, designation, options, "world", lambda *_: None)
        return _combination(request, space, failed)

    same = moved(multiplied)
    assert same.failed_before == failed.distance
    assert same.failed_after == pytest.approx(failed.distance, abs=0.1)
    assert same.change == "no significant change"
    fixed = moved(lambda _, draws: (True, 10.0 + float(draws.normal(0.0, 0.02))))
    assert (fixed.change, fixed.failed_after) == ("more robust", None)
    assert fixed.name == "a and b together, distance"


def test_attempted_repairs_are_listed_in_text_json_and_page() -> None:
    space = space_of(a=Drift.range(0.0, 1.0, nominal=0.0))
    row = Moved("a to 1", "more robust", "not beyond 0.5", "beyond 0.9", None, 0.5, 0.9, None)
    attempts = (
        Attempt("a from 0.5 to 1", "none accepted: <why>."),
        Attempt(
            "a from 0.5 to 0.6",
            "G → 2 at n.py:3",
            True,
            "a.patch",
            "",
            (row,),
            Draws(60, 30, 59, 1.0, 2.0, 0.92),
        ),
    )
    found = replace(stressed(lambda *_: (True, 1.0), space, budget=100), repairs=attempts)
    document = json.loads(json_result.text(found))
    jsonschema.validate(document, json_result.schema())
    assert document["repairs"][1]["draws"]["passed_after"] == 59
    told = [*repair_lines(found)]
    assert told[0] == "a from 0.5 to 1: none accepted: <why>."
    assert told[2] == "a to 1: not beyond 0.5 → beyond 0.9: more robust"
    assert (
        "59 of 60 fresh draws pass with the repair, 30 without it; success at least 92 % with 95 % confidence"
        in told[3]
    )
    shown = page.render(found)
    assert "&lt;why&gt;" in shown
    assert "<td>beyond 0.9<td>more robust" in shown
    assert "<code>a.patch</code>" in shown
    assert json_result.document(replace(found, repairs=None))["repairs"] is None
    assert "nothing was repaired" in page.render(replace(found, repairs=()))


def test_a_repair_that_loses_reward_elsewhere_is_withheld() -> None:
    wide, narrow = Margin("mud", 1.0, 0.0, 0.2, 0.1), Margin("mud", 1.0, 0.0, 0.5, 0.3)
    row = Row("t[world]", wide, wide)
    fine = tuple(Outcome(True, 9.0 + n / 100) for n in range(60))
    poor = tuple(Outcome(True, 8.9) for _ in range(60))
    assert Fixed((row,), fine, fine).loses == ""
    assert "over the declared space" in Fixed((row,), fine, poor).loses
    failing = tuple(replace(one, passed=number > 30) for number, one in enumerate(fine))
    assert (
        "of 60 draws from the declared space, 31 more fail with the repair than without it"
        in Fixed((row,), fine, failing).loses
    )
    nearer = Fixed((Row("t[world]", wide, narrow),), poor, fine)
    assert nearer.loses == "the boundary of mud to 0 moved nearer to the nominal point"


@pytest.mark.parametrize(
    ("stopped", "kept", "told"), [(True, True, "interrupted before"), (False, False, "withheld")]
)
def test_patch_is_kept_after_ctrl_c(
    stopped: bool, kept: bool, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.patch").write_text("patch")
    job = SimpleNamespace(root=tmp_path)
    space = space_of(mud=Drift.range(0.0, 1.0, nominal=1.0))
    found = stressed(lambda point, _: (point["mud"] > 0.5, 1.0), space, budget=150)
    assert found.failures
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
