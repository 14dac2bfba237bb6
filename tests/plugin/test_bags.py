"""`--tarl-bag`: recorded missions instead of the simulated world."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from pytest_tarl.bags import reading
from tests.plugin.missions import NUMBER, mission, write_bag
from tests.plugin.tank import RECORD, changed, result

CLOGGED = 0.25
SAYS = "    drifts={"
MONITOR = "    monitor=lambda moment: -abs(1.0 - moment.latest('/gauge').data),\n"


@pytest.fixture(scope="module")
def record_once() -> dict[str, bytes]:
    return {}


@pytest.fixture
def deployed(tank: pytest.Pytester, record_once: dict[str, bytes]) -> pytest.Pytester:
    """The project with its utility recorded and a monitor for bags."""
    changed(tank, "test_tank", SAYS, MONITOR + SAYS)
    folder = tank.path / ".tarl" / "utility"
    if not record_once:
        tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
        record_once.update({file.name: file.read_bytes() for file in folder.glob("*.npz")})
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in record_once.items():
        (folder / name).write_bytes(content)
    return tank


def online(tank: pytest.Pytester, *bags: Path, also: Sequence[str] = ()) -> pytest.RunResult:
    return tank.runpytest("--tarl-online", *(f"--tarl-bag={bag}" for bag in bags), *also)


def said(told: pytest.RunResult) -> str:
    return " ".join(told.stdout.str().split())


def some(tank: pytest.Pytester, ending: str, pump: float, count: int = 6) -> list[Path]:
    return [write_bag(tank.path / f"mission{n}{ending}", mission(pump, n)) for n in range(count)]


@pytest.mark.parametrize("ending", [".bag", ".mcap", ".db3", ""])
def test_drifted_missions_are_degraded_in_every_format(deployed: pytest.Pytester, ending: str) -> None:
    told = online(deployed, *some(deployed, ending, CLOGGED))
    told.assert_outcomes(failed=1, deselected=1)
    found = result(deployed)
    assert found["verdict"]["result"] == "degraded"
    assert found["episodes"]["online"] == 6
    assert found["drift"] is None
    assert found["sites"][0]["path"] == "keeper.py"
    told.stdout.no_fnmatch_line("*--tarl-repair*")


def test_single_nominal_mission_passes(deployed: pytest.Pytester) -> None:
    online(deployed, *some(deployed, ".mcap", 1.0)).assert_outcomes(passed=1, deselected=1)
    assert result(deployed)["verdict"]["result"] == "no difference"
    online(deployed, deployed.path / "mission0.mcap").assert_outcomes(passed=1, deselected=1)
    assert result(deployed)["episodes"]["online"] == 1


@pytest.mark.parametrize(("ending", "share"), [(".bag", 0.6), (".mcap", 0.6), (".db3", 0.9)])
def test_truncated_bag_is_used_with_a_note(deployed: pytest.Pytester, ending: str, share: float) -> None:
    (bag,) = some(deployed, ending, 1.0, 1)
    long = write_bag(deployed.path / f"long{ending}", mission(1.0, 7, steps=400))
    content = long.read_bytes()
    long.write_bytes(content[: int(len(content) * share)])
    told = online(deployed, bag, long)
    assert re.search(
        rf"long{ending} was cut off: only its first [0-9.]+ s with \d+ messages are used\.", said(told)
    )
    assert result(deployed)["episodes"]["online"] == 2


def test_recording_without_metadata_is_read(deployed: pytest.Pytester) -> None:
    folder = write_bag(deployed.path / "killed", mission(1.0, 0))
    (folder / "metadata.yaml").unlink()
    told = online(deployed, folder)
    told.assert_outcomes(passed=1, deselected=1)
    told.stdout.fnmatch_lines(["*killed was cut off: only its first * s with 50 messages are used*"])


def test_an_unreadable_bag_is_skipped(deployed: pytest.Pytester) -> None:
    (bag,) = some(deployed, ".bag", 1.0, 1)
    torn = deployed.path / "torn.bag"
    torn.write_bytes(bag.read_bytes()[:40])
    told = online(deployed, bag, torn)
    assert re.search(r"torn.bag cannot be read .*: bag skipped\.", said(told))
    assert result(deployed)["episodes"]["online"] == 1
    online(deployed, torn).stdout.fnmatch_lines(["*No bag can be compared with the recording. *torn.bag*"])


def test_wrong_sensor_topic_is_reported(deployed: pytest.Pytester) -> None:
    (bag,) = some(deployed, ".mcap", 1.0, 1)
    other = write_bag(deployed.path / "other.mcap", iter([(0.0, [("/depth", NUMBER, {"data": 1.0})])]))
    kind = "std_msgs/msg/Float32"
    single = write_bag(deployed.path / "single.mcap", iter([(0.0, [("/level", kind, {"data": 1.0})])]))
    told = online(deployed, bag, other, single)
    told.assert_outcomes(passed=1, deselected=1)
    text = said(told)
    assert (
        "other.mcap has no messages on /level, the topic of sensor 'level' (it holds /depth): bag skipped."
        in text
    )
    assert "single.mcap has std_msgs/msg/Float32 on /level" in text


def test_subscribed_topics_may_be_missing_or_of_another_type(
    deployed: pytest.Pytester,
) -> None:
    listens = 'rospy.Subscriber("/level", Float64, on_level)'
    more = 'rospy.Subscriber("/mode", Float64, print)\n    rospy.Subscriber("/lamp", Float64, print)'
    changed(deployed, "keeper", listens, f"{listens}\n    {more}")
    lamp = [("/lamp", "std_msgs/msg/Bool", {"data": True})]
    bag = write_bag(deployed.path / "mission.mcap", mission(1.0, 0, lamp))
    told = online(deployed, bag)
    told.assert_outcomes(passed=1, deselected=1)
    text = said(told)
    assert "mission.mcap lacks /mode, which the node subscribes to: it received no message." in text
    assert "/lamp was not replayed: the bag has std_msgs/msg/Bool there, the node subscribes to it as" in text


def test_node_topics_are_kept_for_the_monitor(
    deployed: pytest.Pytester,
) -> None:
    changed(deployed, "test_tank", MONITOR, "    monitor=Watch,\n")
    watch = (
        "class Watch:\n    worst = 0.0\n\n    def __call__(self, moment):\n"
        "        self.worst = max(self.worst, moment.latest('valve').data)\n"
        "        assert not moment.over or self.worst < 5, 'too much water'\n"
        "        return {'level': -abs(1.0 - moment.latest('/gauge').data), 'time': -moment.now}\n\n\n"
    )
    changed(deployed, "test_tank", "@pytest.mark.tarl", f"{watch}@pytest.mark.tarl")
    valve = [("/valve", NUMBER, {"data": 9.0})]
    bags = [write_bag(deployed.path / f"{n}.mcap", mission(1.0, n, valve)) for n in range(4)]
    online(deployed, *bags)
    found = result(deployed)
    assert found["verdict"]["loss"] > 20  # time costs reward
    assert found["sites"][0]["online"] != 0  # the node ran


def test_replay_without_monitor_or_judge_is_an_error(
    deployed: pytest.Pytester,
) -> None:
    judge = "    judge=lambda before, after: -abs(1.0 - after['level']),\n"
    changed(deployed, "test_tank", MONITOR, judge)
    bags = some(deployed, ".bag", CLOGGED)
    online(deployed, *bags).assert_outcomes(failed=1, deselected=1)
    assert result(deployed)["verdict"]["result"] == "degraded"
    changed(deployed, "test_tank", judge, "")
    online(deployed, *bags).stdout.fnmatch_lines(["*A bag holds no rewards: give the marker monitor=*"])


def test_a_test_that_never_steps_cannot_replay_a_bag(deployed: pytest.Pytester) -> None:
    changed(deployed, "test_tank", "range(25)", "range(0)")
    told = online(deployed, *some(deployed, ".bag", 1.0, 1))
    told.stdout.fnmatch_lines(["*mission0.bag was not replayed: the test ended before its first tarl.step*"])


def test_bags_give_the_same_result_in_workers(deployed: pytest.Pytester) -> None:
    bags = some(deployed, ".bag", CLOGGED, 4)
    online(deployed, *bags)
    alone = result(deployed)
    online(deployed, *bags, also=["--tarl-workers=2"])
    assert result(deployed) == alone


@pytest.mark.parametrize(
    "flag", ["--tarl-repair", "--tarl-drift=clogged", "--tarl-episodes=5", "--tarl-ros=real"]
)
def test_world_options_conflict_with_bags(deployed: pytest.Pytester, flag: str) -> None:
    told = online(deployed, deployed.path / "m.bag", also=[flag])
    told.stderr.fnmatch_lines([f"*--tarl-bag*{flag.partition('=')[0]}*"])


def test_a_missing_or_invalid_bag_is_refused(deployed: pytest.Pytester) -> None:
    online(deployed, deployed.path / "m.bag").stdout.fnmatch_lines(["*m.bag: no such bag*"])
    online(deployed, deployed.path / "keeper.py").stdout.fnmatch_lines(
        ["*keeper.py is not a bag: --tarl-bag takes*"]
    )
    deployed.runpytest("--tarl-bag=m.bag").stderr.fnmatch_lines(["*--tarl-bag needs --tarl-online*"])


@pytest.mark.parametrize("absent", ["apsw", "sqlite3"])
def test_damaged_database_is_noticed(monkeypatch: pytest.MonkeyPatch, absent: str) -> None:
    present = pytest.importorskip("sqlite3" if absent == "apsw" else "apsw")
    monkeypatch.setitem(sys.modules, absent, None)
    assert present.Error in reading._unreadable()
