"""The estimated effect of a repair in a staged rollout is not biased by seasons or sites."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.fleet import json_result
from pytest_tarl.fleet.repairs import Effect, effect, strata
from pytest_tarl.patching.patch import TITLE, unified_diff, write
from tests.plugin.monitoring import missions
from tests.slow import SLOW

WEEK = 7 * 86_400.0


def rolled_out(seed: int, true: float, robots: int = 24, each: int = 40) -> Effect:
    """Draw a rollout: each site starts at another time with half of its robots; seasons change rewards at all sites."""
    rng = np.random.default_rng(seed)
    robot, number = np.repeat(np.arange(robots), each), np.tile(np.arange(each), robots)
    site, week = robot % 4, number * 8 // each
    begins = np.where(robot // 4 % 2 == 0, 2, 5) + site % 2
    treated = week >= begins
    seasons = rng.normal(0, 2.0, 8)
    total = 3.0 * site + seasons[week] + true * treated + rng.normal(0, 0.5, robots)[robot]
    total += rng.normal(0, 1, robot.size)
    passed = rng.random(robot.size) < 0.8 + 0.1 * treated
    return effect("fix", (), strata(robot, site * 8 + week, treated, total, passed), 0.975)


def test_repair_effect_is_found_in_any_season() -> None:
    found = [rolled_out(seed, 0.8) for seed in range(40)]
    held = [one.reward_bound.low <= 0.8 <= one.reward_bound.high for one in found]
    assert np.mean(held) >= 0.85
    assert np.mean([one.reward for one in found]) == pytest.approx(0.8, abs=0.12)
    assert np.mean([one.success for one in found]) == pytest.approx(0.1, abs=0.03)
    assert sum(one.verdict == "helps" for one in found) >= 30
    assert not any(one.verdict == "harms" for one in found)


@pytest.mark.skipif(not SLOW, reason="a campaign; set TARL_SLOW=1")
@pytest.mark.parametrize("true", [0.0, 0.8, -0.8])
def test_intervals_contain_simulated_repair_effects(true: float) -> None:
    found = [rolled_out(seed, true) for seed in range(2000)]
    held = [one.reward_bound.low <= true <= one.reward_bound.high for one in found]
    assert 0.92 <= np.mean(held) <= 0.99


def test_missions_of_other_weeks_are_not_compared() -> None:
    robot = np.repeat(np.arange(10), 6)
    week = np.tile(np.arange(6), 10)
    rng = np.random.default_rng(0)
    total = rng.normal(0, 1, 60) + 5.0 * week
    found = effect("fix", (), strata(robot, week, week >= 3, total, total > 0), 0.975)
    assert (found.verdict, found.strata, found.missions) == ("not comparable", 0, (0, 0))
    late = (week >= 3) & (robot < 2)
    few = effect("fix", (), strata(robot, week, late, total, total > 0), 0.975)
    assert (few.verdict, few.strata, few.missions, few.robots) == ("too few robots", 3, (6, 24), (2, 8))
    assert abs(few.reward) < 2.0


def test_effect_of_equal_groups_is_the_mean_difference() -> None:
    rng = np.random.default_rng(2)
    robot, total = np.arange(20), rng.normal(0, 1, 20)
    arm = robot % 2
    found = effect("fix", (), strata(robot, np.zeros(20, np.int64), arm, total, total > 0), 0.975)
    assert found.reward == pytest.approx(total[arm == 1].mean() - total[arm == 0].mean())


def test_tarl_fleet_prints_which_repair_helps_which_group(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    test, data = tmp_path / "test.npz", str(tmp_path / "data")
    (tmp_path / "node.py").write_text("speed = 5\n")
    header = [f"{TITLE}1: speed 5 → 4", "test: test_walk.py::test_walk", "drift: mud", "seed: 0"]
    changed = {tmp_path / "node.py": "speed = 4\n"}
    diff = unified_diff({tmp_path / "node.py": b"speed = 5\n"}, changed, tmp_path, header)
    guard = write(diff, tmp_path / ".tarl" / "patches", "test_walk", "mud")
    missions.fixture(test, missions.walks(60, 1))
    for repaired in (False, True):
        logs = [
            missions.log(
                tmp_path / f"{repaired}" / f"r{n}.log",
                missions.walks(8, n + 50 * repaired, 0.0 if repaired and n < 5 else 1.0),
                100 * WEEK,
            )
            for n in range(10)
        ]
        for site, some in (("wet", logs[:5]), ("dry", logs[5:])):
            prefix = "new-" if repaired else ""
            argv = [
                "ingest",
                *map(str, some),
                "--to",
                data,
                "--fixture",
                str(test),
                "--robot",
                prefix + "{file}",
            ]
            assert main([*argv, "--site", site, *(["--repair", str(guard)] if repaired else [])]) == 0
    capsys.readouterr()
    result = tmp_path / "fleet.json"
    assert main(["fleet", data, "--by", "site", "--json", str(result)]) == 0
    out = capsys.readouterr().out
    jsonschema.validate(told := json.loads(result.read_text()), json_result.schema())
    assert [one["verdict"] for one in told["repairs"]] == ["no effect shown", "helps"]
    assert [one["of"] for one in told["components"]["rows"]][3] == "repair"
    assert f"{guard.stem} at dry: no effect shown" in out
    assert f"{guard.stem} at wet: helps, reward +" in out
    assert f"{guard.stem} was accepted in simulation for the drift mud" in out
    assert {one["accepted_for"] for one in told["repairs"]} == {"mud"}
    assert not [
        path for path in (tmp_path / "data").rglob("*") if path.is_file() and b"speed" in path.read_bytes()
    ]
