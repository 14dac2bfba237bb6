"""Bags are replayed by one worker, whose job describes the recorded test, with the numbers of the recorded sites."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.errors import (
    AnalysisError,
    FixtureError,
    LogError,
    NodeError,
    RecordingError,
    SettingsError,
    TarlError,
)
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.sensors import binning_digest
from pytest_tarl.workers import protocol, replaying
from pytest_tarl.workers.pool import Post, WorkerDiedError, WorkerHeldError
from pytest_tarl.workers.replaying import RenumberedRollout
from pytest_tarl.workers.replays import OFF, Replays
from tests.plugin.workers.test_protocol import RUN

SENSORS = (Sensor("x", edges=(0.0, 1.0, 4.0), learned=2), Sensor("y", edges=(0.0, 1.0)))
FIXTURE: Any = SimpleNamespace(
    test="missions/test_it.py::test_it[mud]",
    sensors=SENSORS,
    lists=[
        SimpleNamespace(sites=[SimpleNamespace(id=one) for one in sites])
        for sites in (("b", "a"), ("a", "c"))
    ],
)


class Served:
    """A pool that answers every request with the same episode, or raises an error."""

    def __init__(self, run: Any = RUN, error: Exception | None = None) -> None:
        self.answer = protocol.run_message(run)
        self.error = error
        self.requests: list[tuple[Post, EpisodePlan]] = []
        self.closed = False

    def serve(self, post: Post, request: bytes) -> bytes:
        self.requests.append((post, protocol.planned(request)))
        if self.error is not None:
            raise self.error
        return self.answer

    def close(self) -> None:
        self.closed = True


SOUND = replace(RUN, stuck=False, broken="", failure="")


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The project of the recorded test, with two bags; the working directory is the folder of the bags."""
    (tmp_path / "missions").mkdir()
    (tmp_path / "missions" / "test_it.py").write_text("")
    (tmp_path / "bags").mkdir()
    monkeypatch.chdir(tmp_path / "bags")
    return tmp_path


def replays(project: Path, **served: Any) -> tuple[Replays, Served]:
    pool = Served(**served)
    return Replays(FIXTURE, project, pool), pool  # type: ignore[arg-type]


def test_each_bag_is_an_episode_of_the_same_worker(project: Path) -> None:
    replay, pool = replays(project, run=SOUND)
    found = replay(Path("one.bag"), 3)
    replay(Path("two.bag"), 4)
    assert (found.plan.seed, found.passed, found.topics) == (3, RUN.passed, RUN.topics)
    (first, one), (second, two) = pool.requests
    assert first == second
    assert one == EpisodePlan(3, record=True, bag=project / "bags" / "one.bag")
    assert two == EpisodePlan(4, record=True, bag=project / "bags" / "two.bag")


def test_replay_job_contains_the_test_and_learned_bins(project: Path) -> None:
    replay, pool = replays(project, run=SOUND)
    replay(Path("one.bag"), 3)
    post = pool.requests[0][0]
    start, first = json.loads(post.start), json.loads(post.first)
    assert (post.folder, post.loud) == (str(project), False)
    assert start == {
        "path": [str(project), *sys.path],
        "arguments": [
            *("--rootdir", str(project), "-p", "no:terminal", "-p", "no:cacheprovider", "--tarl-online"),
            f"--tarl-bag={project / 'bags' / 'one.bag'}",
            "missions/test_it.py::test_it",
        ],
        "options": OFF,
    }
    assert first == {
        "nodeid": "missions/test_it.py::test_it[mud]",
        "edges": {"x": [0.0, 1.0, 4.0]},
        "instruments": None,
        "sensors": binning_digest(SENSORS),
        "sites": ["b", "a", "c"],
    }


@pytest.mark.parametrize(
    "error",
    [
        LogError("no such topic"),
        RecordingError("it crashed"),
        NodeError("it never waits"),
        WorkerDiedError("ended with status 1"),
        WorkerHeldError("a.py:3"),
        protocol.SkippedError("rain"),
    ],
)
def test_an_error_of_one_bag_concerns_only_this_bag(project: Path, error: TarlError) -> None:
    replay, _ = replays(project, error=error)
    with pytest.raises(LogError) as raised:
        replay(Path("one.bag"), 3)
    assert str(raised.value) == f"one.bag cannot be replayed: {error}"


@pytest.mark.parametrize("error", [SettingsError("no judge"), FixtureError("old"), AnalysisError("no node")])
def test_an_error_of_the_test_concerns_all_bags(project: Path, error: TarlError) -> None:
    replay, _ = replays(project, error=error)
    with pytest.raises(type(error)) as raised:
        replay(Path("one.bag"), 3)
    assert raised.value is error


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"stuck": True, "failure": "it never waits"}, "it never waits"),
        ({"broken": "Traceback\n  line 3\nValueError: 7\n"}, "ValueError: 7"),
        ({"broken": "ValueError: 7", "failure": "fell"}, "fell"),
    ],
)
def test_a_mission_that_ends_in_an_error_is_refused(project: Path, changes: Any, why: str) -> None:
    replay, _ = replays(project, run=replace(SOUND, **changes))
    with pytest.raises(LogError) as raised:
        replay(Path("one.bag"), 3)
    assert str(raised.value) == f"one.bag cannot be replayed: the test ended in an error ({why})."


def test_a_mission_that_fails_is_still_a_mission(project: Path) -> None:
    replay, _ = replays(project, run=replace(SOUND, passed=False, failure="fell"))
    assert not replay(Path("one.bag"), 3).passed


def test_a_missing_test_is_reported_before_a_worker_starts(project: Path) -> None:
    (project / "missions" / "test_it.py").unlink()
    replay, pool = replays(project)
    with pytest.raises(SettingsError) as raised:
        replay(Path("one.bag"), 3)
    assert str(raised.value).startswith(f"missions/test_it.py::test_it was not found in {project}, and bags")
    assert not pool.requests


def test_closing_ends_the_worker(project: Path) -> None:
    replay, pool = replays(project)
    assert not pool.closed
    replay.close()
    assert pool.closed


class Rollout:
    """A rollout that counts its episodes; each has an event at the sites 0, 1, 2 and 1."""

    def __init__(self, *, threads: bool = False) -> None:
        self.plans: list[EpisodePlan] = []
        self.threads = threads

    def __call__(self, plan: EpisodePlan) -> Any:
        self.plans.append(plan)
        recorder = Recorder()
        recorder.latch((0,))
        for site, flow in ((0, 0.5), (1, 1.5), (2, 2.5), (1, 3.5)):
            recorder.hook(site, flow)
        recorder.reward(1.0, {})
        found = recorder.finish()
        thread = np.array([0, 1, 0, 1], np.int32) if self.threads else None
        return replace(RUN, plan=plan, trace=replace(found, thread=thread))


def test_sites_get_their_recorded_numbers() -> None:
    rollout = RenumberedRollout(Rollout(threads=True), np.array([5, -1, 0], np.int32))  # type: ignore[arg-type]
    found = rollout(EpisodePlan(1)).trace
    assert found.site.tolist() == [5, 0]
    assert found.flow.tolist() == [0.5, 2.5]
    assert found.event_cell.tolist() == [0, 0]
    assert len(found.event_step) == 2
    assert found.thread is not None
    assert found.thread.tolist() == [0, 0]
    assert found.reward.tolist() == [1.0]
    kept = RenumberedRollout(Rollout(), np.array([2, 1, 0], np.int32))(EpisodePlan(1)).trace  # type: ignore[arg-type]
    assert (kept.site.tolist(), kept.thread) == ([2, 1, 0, 1], None)


def test_an_episode_runs_when_its_result_is_requested() -> None:
    inner = Rollout()
    rollout = RenumberedRollout(inner, np.array([0, 1, 2], np.int32))  # type: ignore[arg-type]
    begun = rollout.begin(EpisodePlan(9))
    assert not inner.plans
    assert begun.result().plan == EpisodePlan(9)
    assert (rollout.workers, inner.plans) == (1, [EpisodePlan(9)])


def test_bags_need_the_sensors_of_the_recording(monkeypatch: pytest.MonkeyPatch) -> None:
    checked: list[Any] = []
    monkeypatch.setattr(replaying, "check", checked.append)
    marked: Any = SimpleNamespace(sensors=SENSORS)
    item: Any = SimpleNamespace(nodeid="test_it.py::test_it")
    with pytest.raises(FixtureError, match=r"sensors of test_it\.py::test_it differ") as raised:
        replaying.replaying(item, marked, binning_digest(SENSORS[:1]), ("a",))
    assert "--tarl-record" in str(raised.value)
    assert checked == [marked]


def test_recorded_sites_are_found_by_their_ids(monkeypatch: pytest.MonkeyPatch) -> None:
    places = [SimpleNamespace(id=one) for one in ("c", "new", "a")]
    monkeypatch.setattr(replaying, "check", lambda marked: None)
    monkeypatch.setattr(replaying, "analysed", lambda marked, folder, root: (folder, root))
    monkeypatch.setattr(replaying, "plan", lambda found: SimpleNamespace(places=places, found=found))
    monkeypatch.setattr(replaying, "instruments", lambda current, root: (current.found, root))
    marked: Any = SimpleNamespace(sensors=SENSORS)
    item: Any = SimpleNamespace(
        nodeid="t", path=Path("/p/missions/test_it.py"), config=SimpleNamespace(rootpath=Path("/p"))
    )
    monkeypatch.setattr(replaying, "ItemRollout", lambda *given: given)
    digest = binning_digest(SENSORS)
    found: Any = replaying.replaying(item, marked, digest, ("a", "b", "c"))
    assert found.number.tolist() == [2, -1, 0]
    assert found.rollout == (item, marked, ((Path("/p/missions"), Path("/p")), Path("/p")))
    places.clear()
    assert replaying.replaying(item, marked, digest, ()).number.tolist() == [-1]
