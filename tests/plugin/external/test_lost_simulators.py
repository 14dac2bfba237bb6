"""Lost simulators are reported: the number of episodes, the reasons, and that the episodes ran again (no ROS)."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from pytest_tarl.external.simulator import _ending
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.item_episode import Instruments
from pytest_tarl.lost_simulators import LostSimulators
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun
from pytest_tarl.workers import protocol
from tests.plugin.tank import changed, fixture_file, result

NONE = np.zeros(0, np.int32)
DIED = "it ended with status 3 (last output: out of water)"
LOSING = """\
    import os, pathlib
    from pytest_tarl.errors import SimulatorLostError
    path = pathlib.Path(__file__).parent / "losses"
    left = int(path.read_text()) if path.exists() else 0
    if left:
        path.write_text(str(left - 1))
        raise SimulatorLostError("The simulator sim ended.", "it ended with status 3 (last output: out of water)")
    draws = """


@pytest.fixture
def losing(tank: pytest.Pytester) -> pytest.Pytester:
    """A tank whose first episodes lose their simulator, as often as the file `losses` says."""
    changed(tank, "test_tank", "    draws = ", LOSING)
    return tank


def run(*lost: str) -> EpisodeRun:
    return EpisodeRun(
        EpisodePlan(1),
        Trace((), NONE, np.zeros(0), NONE, NONE, NONE, np.array([1.0]), {}),
        passed=True,
        lost=lost,
    )


def test_lost_simulators_are_in_every_report(
    losing: pytest.Pytester,
) -> None:
    (losing.path / "losses").write_text("2")
    told = losing.runpytest("--tarl-record", "--tarl-episodes=4").stdout.str()
    note = f"1 of 5 episodes lost its simulator and was run again with a new one: 2 × {DIED}."
    assert note in told  # the first episode runs once more, to compare both results
    recorded = fixture_file(losing).read_bytes()
    told = losing.runpytest("--tarl-record", "--tarl-episodes=4").stdout.str()
    assert "again with a new one" not in told
    assert fixture_file(losing).read_bytes() == recorded
    (losing.path / "losses").write_text("1")
    told = losing.runpytest("--tarl-online", "--tarl-episodes=4").stdout.str()
    (note,) = (one for one in result(losing)["notes"] if "simulator" in one)
    assert "1 of 4 episodes lost its simulator" in note
    assert "out of water" in told
    (page,) = (losing.path / ".tarl" / "report").glob("*.html")
    assert "1 of 4 episodes lost its simulator and was run again" in page.read_text()


def test_simulator_lost_in_each_run_ends_with_all_reasons(losing: pytest.Pytester) -> None:
    (losing.path / "losses").write_text("3")
    told = losing.runpytest("--tarl-record", "--tarl-episodes=4").stdout.str()
    assert re.search(r"The simulator sim ended\. TARL ran the episode with seed \d+ 3 times", told)
    assert f"gave up. Before: {DIED}." in told


def test_the_note_names_the_most_frequent_reasons_first() -> None:
    lost = LostSimulators()
    assert lost.notes() == ()
    for one in ((), ("c",), ("d", "b"), ("b",), (), ("a",)):
        lost.count(run(*one))
    assert lost.notes() == (
        "4 of 6 episodes lost their simulator and were run again with a new one: 2 × b; 1 × a; 1 × c; and 1 more.",
    )


def test_watched_rollouts_count_their_episodes() -> None:
    class Inner:
        workers = 3

        def __call__(self, plan: EpisodePlan) -> EpisodeRun:
            return run("it hung")

        def begin(self, plan: EpisodePlan) -> Any:
            return Deferred(self, plan)

    lost = LostSimulators()
    rollout = lost.watched(lambda *_: Inner())(Instruments(), ())
    assert rollout.workers == 3
    assert rollout(EpisodePlan(1)).lost == rollout.begin(EpisodePlan(1)).result().lost == ("it hung",)
    rollout.begin(EpisodePlan(1)).cancel()
    assert lost.notes()[0].startswith("2 of 2 episodes")


def test_workers_report_why_simulators_were_lost() -> None:
    message = protocol.run_message(run("it hung", DIED))
    assert protocol.answered(EpisodePlan(1), message).lost == ("it hung", DIED)


def test_the_reason_for_an_ended_simulator_names_the_signal() -> None:
    assert [_ending(one) for one in (0, 3, -11, -40)] == [
        "ended with status 0", "ended with status 3", "was killed by SIGSEGV", "was killed by signal 40",
    ]  # fmt: skip
