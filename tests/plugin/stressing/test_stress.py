"""`pytest --tarl-stress` for users: report, files, guarantees, mistakes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis.database import DirectoryBasedExampleDatabase

from pytest_tarl import Drift, faults
from pytest_tarl.drifts import drift
from pytest_tarl.errors import SettingsError
from pytest_tarl.promises import must_hold
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import json_result, kept, words
from pytest_tarl.stressing import margins as margins_file
from pytest_tarl.stressing.boundary import confirm
from pytest_tarl.stressing.findings import Curve, failure
from pytest_tarl.stressing.guarantee import Evidence
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.stress_run import along_rays
from tests.plugin.stressing.worlds import evaluator_of, space_of, stressed
from tests.plugin.tank import RECORD, changed
from tests.slow import slow

STRESS = ("--tarl-stress", "--tarl-stress-budget=150")
SPACE = '{"world": Drift.space(pump=Drift.range(0.1, 1.0, nominal=1.0))}'


@pytest.fixture
def spaced(tank: pytest.Pytester) -> pytest.Pytester:
    """A recorded tank whose pump may be clogged."""
    changed(tank, "test_tank", "import Sensor", "import Drift, Sensor")
    changed(tank, "test_tank", '{"clogged": 0.25}', SPACE)
    changed(tank, "test_tank", "1.0 if tarl_drift is None else tarl_drift", 'tarl_drift["pump"]')
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    return tank


def written(tank: pytest.Pytester) -> tuple[bytes, bytes]:
    folder = tank.path / ".tarl"
    (found,), (page,) = folder.glob("stress/*-world.json"), folder.glob("report/*-stress.html")
    return found.read_bytes(), page.read_bytes()


def test_a_run_prints_and_writes_results_and_replays_failures(spaced: pytest.Pytester) -> None:
    done = spaced.runpytest(*STRESS)
    done.assert_outcomes(passed=1, deselected=1)
    done.stdout.fnmatch_lines(
        [
            "*test_fills[[]world]: stress, * episodes",
            "  guarantee  At least *",
            "  pump       No failure found while*",
        ]
    )
    first = written(spaced)
    assert first[1].count(b"<svg") == 1
    assert not [
        *spaced.path.glob(".tarl/results/*")
    ]  # folders that contain only comparisons, as `tarl summary` expects
    found = json.loads(first[0])
    jsonschema.validate(found, json_result.schema())
    (pump,) = found["directions"]
    # the reward is about -3.6 / pump, and 5 % less than -3.6 is tolerated: 1 / 1.05 = 0.952
    assert 0.93 < pump["boundary"]["estimate"] < 0.98
    (margins,) = spaced.path.glob(".tarl/margins/*.json")
    assert margins_file.read(margins.read_bytes(), "it").sides[0].fails_at == pump["boundary"]["failed_at"]
    assert "!margins/**" in (spaced.path / ".tarl" / ".gitignore").read_text("utf-8")
    again = spaced.runpytest(*STRESS, "--tarl-workers=2")
    assert "still fails: 4 of 4 episodes pass, and the mean loss is 0." in again.stdout.str()
    assert written(spaced) == first


@slow
def test_kept_failures_do_not_change_a_search(
    spaced: pytest.Pytester,
) -> None:
    changed(spaced, "test_tank", "import Drift, Sensor", "import Drift, Sensor, faults")
    changed(spaced, "test_tank", "nominal=1.0)", 'nominal=1.0), high=faults.bias("/level", "data", 0.0, 0.2)')
    budget = ("--tarl-stress", "--tarl-stress-budget=300")
    spaced.runpytest(*budget).assert_outcomes(passed=1, deselected=1)
    first = written(spaced)
    found = json.loads(first[0])
    assert {one["name"] for one in found["directions"]} == {"pump", "high"}
    assert found["failures"]
    again = spaced.runpytest(*budget, "--tarl-workers=2")
    assert "still fails:" in again.stdout.str()
    assert written(spaced) == first


def test_a_failure_inside_must_hold_fails_the_test(spaced: pytest.Pytester) -> None:
    changed(spaced, "test_tank", "    episodes=30,", '    episodes=30,\n    must_hold={"pump": (0.2, 1.0)},')
    done = spaced.runpytest(*STRESS)
    done.assert_outcomes(failed=1, deselected=1)
    assert "but must_hold is 0.2 to 1." in done.stdout.str()


def test_changed_nominal_world_is_reported(spaced: pytest.Pytester) -> None:
    changed(spaced, "test_tank", "nominal=1.0", "nominal=0.2")
    done = spaced.runpytest(*STRESS)
    done.assert_outcomes(failed=1, deselected=1)
    assert "The guarantee already fails at the nominal values" in done.stdout.str()


def test_ctrl_c_keeps_the_findings_so_far(spaced: pytest.Pytester) -> None:
    stop = "    if tarl_drift['pump'] < 0.5:\n        raise KeyboardInterrupt\n    tarl.start"
    changed(spaced, "test_tank", "    tarl.start", stop)
    with pytest.raises(KeyboardInterrupt):
        spaced.runpytest(*STRESS)
    found = json.loads(written(spaced)[0])
    assert (found["ended"], found["episodes"]) == ("interrupted", 16)


def test_message_gives_the_next_step_without_a_recording(tank: pytest.Pytester) -> None:
    done = tank.runpytest(*STRESS)
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(["*No test declares a space of drifts*"])
    changed(tank, "test_tank", "import Sensor", "import Drift, Sensor")
    changed(tank, "test_tank", '{"clogged": 0.25}', SPACE)
    done = tank.runpytest(*STRESS, "-rs")
    done.assert_outcomes(skipped=1, deselected=1)
    assert "--tarl-record" in done.stdout.str()


@pytest.mark.parametrize(
    ("flags", "told"),
    [
        (("--tarl-stress", "--tarl-online"), "need separate runs"),
        (("--tarl-stress", "--tarl-record"), "need separate runs"),
        (("--tarl-stress", "--tarl-holm"), "--tarl-holm needs --tarl-online"),
        (("--tarl-stress", "--tarl-ros=real"), "needs the embedded ROS"),
        (
            ("--tarl-stress", "--tarl-stress-budget=3"),
            "--tarl-stress-budget: it must be a whole number from 32 to 1000000, got 3.",
        ),
        (
            ("--tarl-stress", "--tarl-stress-budget=soon"),
            "--tarl-stress-budget: it must be a number of episodes",
        ),
    ],
)
def test_conflicting_flags_are_refused(tank: pytest.Pytester, flags: tuple[str, ...], told: str) -> None:
    done = tank.runpytest(*flags)
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines([f"*{told}*"])


DRIFTS = {
    "world": drift(
        "t",
        "world",
        Drift.space(
            mud=Drift.range(0.0, 1.0, nominal=1.0),
            camera=Drift.choice("up", "down"),
            late=faults.latency("/cmd", 0.5),
        ),
    )
}


def test_must_hold_accepts_ranges_or_options_of_a_direction() -> None:
    given = {"mud": (0.4, 1), "camera": ["up", "down"], "late": (0, 0.1)}
    assert must_hold("t", given, DRIFTS) == {"mud": (0.4, 1.0), "camera": ("up", "down"), "late": (0.0, 0.1)}
    assert must_hold("t", {"mud": (0.4, None)}, DRIFTS) == {"mud": (0.4, 1.0)}
    assert must_hold("t", {"late": (None, 0.1)}, DRIFTS) == {"late": (0.0, 0.1)}


def test_failures_violate_must_hold() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return point["slope"] < 0.1 and point["camera"] != 1.0, 1.0

    space = space_of(slope=Drift.range(-0.5, 0.5, nominal=0.0), camera=Drift.choice("up", "down", "left"))
    found = stressed(world, space)
    drifts = {"world": drift("t", "world", Drift.space(**space.directions))}

    def broken(**given: object) -> list[str]:
        return words.broken_promises(replace(found, must_hold=must_hold("t", given, drifts)))

    assert broken(slope=(None, 0.05), camera=("up", "left")) == []
    assert "but must_hold is 0 to 0.5" in broken(slope=(0.0, None))[0]
    assert broken(camera=("up", "down")) == [
        "The guarantee fails with camera='down', but must_hold includes 'down'."
    ]


def test_must_hold_ends_are_tested() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return bool(draws.random() < 1.0 - 1.5 * point["slope"]), 1.0  # 30 % fail at 0.2, 5 % at 0.033

    space = space_of(slope=Drift.range(0.0, 0.5, nominal=0.0))
    curve = Curve(rays(space, {"slope": (0.0, 0.2)})[0])
    along_rays([curve], evaluator_of(world, space), 0.01)
    assert curve.confirmed is not None
    assert curve.ray.value(curve.confirmed) <= 0.2


def test_clear_failure_is_confirmed_despite_misleading_episodes() -> None:
    space = space_of(slope=Drift.range(0.0, 1.0, nominal=0.0))
    evaluator = evaluator_of(lambda point, _: (point["slope"] < 0.5, 1.0), space)
    curve = Curve(rays(space, {})[0])
    failed, passed = (
        Evidence(one, margin, 4, 0, 0.0, 0.0) for one, margin in (("fails", -5.0), ("holds", 1.0))
    )
    curve.evidence = {0.25: passed, 0.3: failed, 0.4: failed, 0.5: failed, 0.75: failed, 1.0: failed}
    confirm(curve, evaluator, 0.01)
    assert curve.confirmed == 0.75
    assert all(t < 0.5 for t in curve.rejected)


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (3, "must_hold maps directions"),
        ({"mdu": (0.4, 1.0)}, r"'mdu', which is not a direction of a space \(mud, camera, late\)"),
        ({"mud": (0.4, 0.9)}, "around the nominal 1"),
        ({"mud": 0.4}, "two numbers from 0 to 1"),
        ({"mud": (-1, 1)}, "two numbers from 0 to 1"),
        ({"camera": ("left",)}, "options of its choice"),
        ({"camera": "up"}, "options of its choice"),
    ],
)
def test_invalid_values_of_must_hold_are_refused(value: Any, told: str) -> None:
    with pytest.raises(SettingsError, match=told):
        must_hold("t", value, DRIFTS)


def test_kept_failures_belong_to_their_space_and_test(tmp_path: Path) -> None:
    space = space_of(mud=Drift.range(0.0, 1.0, nominal=1.0), camera=Drift.choice("up", "down"))
    memory = kept.Kept(tmp_path / "failing", "test_a.py::test_a[world]")
    assert memory.read(space) == []
    point = {"mud": 0.5, "camera": 1.0}
    memory.write([failure(space, point)])
    assert memory.read(space) == [point]
    assert memory.read(space_of(mud=Drift.range(0.0, 1.0, nominal=1.0))) == []
    assert memory.read(space_of(mud=Drift.range(0.6, 1.0, nominal=1.0), camera=Drift.choice(1, 2))) == []
    other = replace(memory, key="test_a.py::test_b[world]")
    other.write([failure(space, {"mud": 0.25, "camera": 0.0})])
    assert memory.read(space) == [point]
    memory.write([])
    assert (memory.read(space), len(other.read(space))) == ([], 1)


def test_hypothesis_reads_the_kept_failures(tmp_path: Path) -> None:
    space = space_of(mud=Drift.range(0.0, 1.0, nominal=1.0))
    kept.Kept(tmp_path, "test_a.py::test_a[world]").write([failure(space, {"mud": 0.5})])
    database = DirectoryBasedExampleDatabase(tmp_path)
    assert [*database.fetch(b"test_a.py::test_a[world]")] == [b'{"mud": 0.5}']
