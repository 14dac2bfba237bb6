"""Observe a node on the embedded ROS: the content of its log, and a comparison with it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from time import sleep

import numpy as np
import pytest

from pytest_tarl.errors import LogError
from pytest_tarl.learning.fixture import load
from pytest_tarl.logged import missions
from pytest_tarl.observing.command import Order, observe
from pytest_tarl.observing.writer import unpacked
from pytest_tarl.ros import Ros, message_type
from tests.plugin.tank import NODE, RECORD, TEST

Float64 = message_type("std_msgs/Float64")
String = message_type("std_msgs/String")
STEPS = 30


@pytest.fixture
def recorded(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Path:
    pytester.makeini("[pytest]\naddopts = -p no:rerunfailures\n")
    pytester.path.joinpath("keeper.py").write_text(NODE)
    pytester.path.joinpath("test_tank.py").write_text(TEST)
    assert pytester.runpytest_inprocess(*RECORD).ret == 0
    monkeypatch.chdir(pytester.path)
    return pytester.path


@pytest.fixture(autouse=True)
def _other_modules_stay() -> Iterator[None]:
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name in ("keeper", "test_tank"):
            del sys.modules[name]


def drive(order: Order, runs: list[float], pause: float = 0.0) -> None:
    """Fill a tank once for each given share of flow that the valve passes; `pause` is the wall time per step in s."""
    ros = Ros()
    with ros.installed():
        ros.start(lambda: observe(order) and None, name="observe")
        for share in runs:
            level = 0.0
            ros.bus.publish("/mission", String(data="begin"))
            for _ in range(STEPS):
                ros.bus.publish("/level", Float64(data=level))
                ros.step(0.1)
                sleep(pause)
                command = ros.bus.latest("/valve")
                level += 0.1 * share * max(0.0, min(1.0, command.data if command else 0.0))
                ros.bus.publish("/monitor", Float64(data=-abs(1.0 - level)))
            ros.bus.publish("/mission", String(data="succeeded" if level > 0.5 else "failed"))
        ros.close()


def order(root: Path, **changes: object) -> Order:
    return Order(**{"node": root / "keeper.py", "reward": "/monitor", "mission": "/mission", **changes})  # type: ignore[arg-type]


def test_each_mission_contains_every_step_event_and_cell(recorded: Path) -> None:
    drive(order(recorded), [1.0, 0.1])
    fixture = load(next(recorded.glob(".tarl/utility/*.npz")))
    first, second = missions(recorded / ".tarl/missions.log", fixture)
    assert (first.ended, first.passed, second.ended, second.passed) == (True, True, True, False)
    for mission in (first, second):
        rewards = np.concatenate([unpacked(chunk["reward"], "float64") for chunk in mission.chunks])
        assert len(rewards) == STEPS
    assert set(first.sites) >= {site.id for one in fixture.lists for site in one.sites}


def test_only_the_log_of_a_drifted_world_is_degraded(recorded: Path, pytester: pytest.Pytester) -> None:
    drive(order(recorded, log=recorded / "clogged.log"), [0.05] * 8)
    result = pytester.runpytest_inprocess("--tarl-online", "--tarl-log=clogged.log")
    result.stdout.fnmatch_lines(["*test_fills[[]online[]]: degraded*"])
    assert result.ret == 1


def test_missions_of_renamed_logs_are_also_compared(recorded: Path) -> None:
    drive(order(recorded, log_size=1), [1.0, 0.1, 1.0])
    assert len(list(recorded.glob(".tarl/missions.log.*"))) == 3
    fixture = load(next(recorded.glob(".tarl/utility/*.npz")))
    found = missions(recorded / ".tarl/missions.log", fixture)
    assert [(one.ended, one.passed) for one in found] == [(True, True), (True, False), (True, True)]


def test_mission_without_an_end_is_skipped(recorded: Path, pytester: pytest.Pytester) -> None:
    drive(order(recorded), [0.05] * 8)
    log = recorded / ".tarl/missions.log"
    log.write_bytes(log.read_bytes()[:-20])
    result = pytester.runpytest_inprocess("--tarl-online", "--tarl-log=.tarl/missions.log")
    result.stdout.fnmatch_lines(["*1 mission has no end or no reward in missions.log: skipped*"])


def test_judge_gives_the_rewards_without_a_reward_topic(recorded: Path, pytester: pytest.Pytester) -> None:
    drive(order(recorded, reward="", step=0.001), [0.05] * 8, pause=0.003)
    options = ("--tarl-online", "--tarl-log=.tarl/missions.log")
    pytester.runpytest_inprocess(*options).stdout.fnmatch_lines(["*The log holds no rewards*judge=*"])
    judge = "judge=lambda before, after: -abs(1.0 - (after['level'] or 0.0)), episodes=30,"
    judged = TEST.replace("episodes=30,", judge)
    pytester.path.joinpath("test_tank.py").write_text(judged)
    sys.modules.pop("test_tank", None)
    pytester.runpytest_inprocess(*options).stdout.fnmatch_lines(["*test_fills[[]online[]]: degraded*"])


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"reward": ""}, "Give either --reward-topic"),
        ({"idle": 1.0}, "cannot be used together"),
        ({"node": Path("nowhere.py")}, "no such file"),
        ({"reward": "/monitor:nonsense_msgs/Float99"}, "nonsense_msgs"),
    ],
)
def test_unobservable_node_is_reported_in_one_sentence(
    recorded: Path, changes: dict[str, object], says: str
) -> None:
    ros = Ros()
    with ros.installed(), pytest.raises(Exception, match=says):
        ros.start(lambda: observe(order(recorded, **changes)) and None, name="observe")
    ros.close()


def test_the_flag_for_a_log_needs_online_mode(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_nothing(): pass")
    for flags, says in (
        (["--tarl-log=x"], "*--tarl-log needs --tarl-online*"),
        (["--tarl-online", "--tarl-repair", "--tarl-log=x"], "*cannot be used together*"),
    ):
        pytester.runpytest_inprocess(*flags).stderr.fnmatch_lines([says])


def test_a_node_can_be_observed_only_with_a_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "keeper.py").write_text(NODE)
    with pytest.raises(LogError, match="Choose one with --fixture"):
        observe(order(tmp_path))
