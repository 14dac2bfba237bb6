"""`tarl fleet` applies the method for one robot to each robot and group; any storage of the rows gives equal bits."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator
from dataclasses import replace
from datetime import date
from functools import partial
from importlib.util import find_spec
from math import log2
from pathlib import Path
from random import Random
from threading import Event
from typing import Any

import duckdb
import jsonschema
import numpy as np
import pyarrow.parquet as pq
import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.errors import FixtureError, FleetError, SettingsError
from pytest_tarl.fleet import (
    changed_robots,
    dask_tasks,
    dataset,
    ingest,
    json_result,
    mission_groups,
    samples,
    scores,
)
from pytest_tarl.fleet.data_folder import Store, store
from pytest_tarl.fleet.database import Filter, opened
from pytest_tarl.fleet.ingest import Order
from pytest_tarl.fleet.logged_samples import logged_samples
from pytest_tarl.fleet.question import Answer, Question, answer
from pytest_tarl.learning.drift import compare
from pytest_tarl.learning.fixture import load
from pytest_tarl.learning.merging import merge
from pytest_tarl.monitoring import watch
from pytest_tarl.monitoring.restarts import log_evidence
from pytest_tarl.monitoring.status import status
from pytest_tarl.seeds import generator
from tests.plugin.monitoring import missions

DAY = 86_400.0
DRIFTED = "r3"  # from its 41st mission on
ROBOTS = 4
COMPARED = mission_groups._compared
EACH = 80


def walks(robot: int) -> list[missions.Walk]:
    """Return the missions of a robot; some visit a place that the recording lacks."""
    found = missions.walks(EACH, 10 + robot)
    if f"r{robot}" == DRIFTED:
        found[40:] = missions.walks(EACH - 40, 90, 1.0)
    strange = found[50]
    found[50] = replace(strange, cells=(*strange.cells, (7, 0), (8, 0)), reward=(*strange.reward, 1.0, 0.5))
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a recording, logs, and the data set of all of them."""
    folder = tmp_path_factory.mktemp("fleet")
    missions.fixture(folder / "test.npz", missions.walks(120, 1))
    for robot in range(ROBOTS):
        path = folder / f"r{robot}" / "missions.log"
        missions.log(path, walks(robot), 20_000 * DAY + robot, apart=DAY / 4)
    add(folder, range(ROBOTS), folder / "data")
    return folder


def add(folder: Path, some: range | list[int], to: Path | str) -> None:
    for robot in some:
        log = folder / f"r{robot}" / "missions.log"
        order = Order((log,), str(to), folder / "test.npz", "{folder}", f"1.{robot % 2}", f"s{robot // 2}")
        assert not [one.problem for one in ingest.ingest(order) if one.problem]


@pytest.fixture(scope="module")
def found(folder: Path) -> Answer:
    return answer(Question(str(folder / "data")))


def test_only_the_drifted_robot_is_found(found: Answer) -> None:
    assert [one.name for one in found.robots.below] == [DRIFTED]
    (one,) = found.robots.below
    assert one.status is not None
    ((_, evidence),) = one.status.bounds
    assert evidence is not None
    assert evidence.since is not None
    assert abs(evidence.since.mission - 41) <= 3
    assert [one.name for one in found.robots.drifted] in ([], [DRIFTED])
    results = {one.values: one.verdict.result for one in found.groups if one.verdict}
    assert results == {
        ("1.0", "s0"): "no difference",
        ("1.0", "s1"): "no difference",
        ("1.1", "s0"): "no difference",
        ("1.1", "s1"): "degraded",
    }


def test_counts_and_bounds_come_from_the_data_set(found: Answer) -> None:
    assert found.missions == ROBOTS * EACH
    for one, robot in zip(found.groups, (0, 2, 1, 3), strict=True):
        own = walks(robot)
        assert (one.missions, one.robots, one.passed) == (EACH, 1, sum(walk.passed for walk in own))
        assert one.reward == pytest.approx(np.mean([sum(walk.reward) for walk in own]))
        assert one.success.low <= one.passed / EACH <= one.success.high
        assert one.mean.low < one.reward < one.mean.high
        assert not one.mean.exact
        assert one.success.exact


@pytest.mark.parametrize("robot", [1, 3])
def test_tarl_fleet_and_tarl_watch_compute_the_same_evidence(
    folder: Path, tmp_path: Path, found: Answer, robot: int
) -> None:
    path = tmp_path / "state.npz"
    log = folder / f"r{robot}" / "missions.log"
    one = watch.begun([log], folder / "test.npz", path, alpha=found.robots.q, seed=0)
    for _ in one.poll():
        pass
    one.close()
    latest = log_evidence(one.monitor.processes)
    world, bound = changed_robots.evidence(one.monitor, one.monitor.processes.peak, latest)
    counts, named = one.monitor.counts, max(world, bound) >= -log2(found.robots.q)
    assert found.robots.every[robot] == changed_robots.Robot(
        f"r{robot}", counts.missions, counts.passed, world, bound, status(one.monitor) if named else None
    )


def test_fleet_and_comparison_give_the_same_verdict(folder: Path, found: Answer) -> None:
    fixture = load(folder / "test.npz")
    own = merge([one for _, one in logged_samples(folder / DRIFTED / "missions.log", fixture)])
    expected = compare(
        fixture.sample,
        own,
        alpha=0.05,
        tolerance=None,
        generator=generator(0, "fleet/1.1/s1"),
        sensors=fixture.sensors,
    )
    group = found.groups[-1]
    assert group.verdict is not None
    assert group.verdict.loss == pytest.approx(expected.verdict.loss)
    assert group.region.cells == expected.region.cells
    assert expected.verdict.result == "degraded"


@pytest.mark.parametrize("seed", range(2))
def test_answer_is_independent_of_order_and_threads(
    folder: Path, found: Answer, seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    random = Random(seed)
    together = random.choice([1, 7, 50])
    monkeypatch.setattr(ingest, "TOGETHER", together)
    order = [*range(ROBOTS)]
    random.shuffle(order)
    add(folder, order, tmp_path / "data")
    if seed:  # the same rows again, in files of another name
        for path in sorted((tmp_path / "data").rglob("*.parquet")):
            path.with_name(f"copy{path.name}").write_bytes(path.read_bytes())
    monkeypatch.setattr(changed_robots, "PORTION", random.choice([1, 100]))
    monkeypatch.setattr(scores, "PORTION", random.choice([1, 100]))
    monkeypatch.setattr(samples, "PORTION", random.choice([1, 100, 100_000]))
    connect = duckdb.connect
    threads = (1, 7)[seed]
    monkeypatch.setattr(
        duckdb, "connect", lambda *args, config: connect(*args, config={**config, "threads": threads})
    )
    again = answer(Question(str(tmp_path / "data"), workers=(2, 7)[seed]))
    assert again.copies == (ROBOTS * EACH if seed else 0)
    assert json_result.text(replace(again, copies=0)) == json_result.text(found)


def test_old_and_new_schemas_are_read_together(folder: Path, found: Answer, tmp_path: Path) -> None:
    add(folder, [1], tmp_path / "data")
    for path in sorted((tmp_path / "data" / "missions").rglob("*.parquet"))[::2]:
        with path.open("rb") as file:
            table = pq.read_table(file)
        table = table.select(["mission", "robot", "site", "time", "passed", "total", "steps"])
        about = {**table.schema.metadata, b"tarl.schema": b"1"}
        pq.write_table(table.replace_schema_metadata(about), path)
    again = answer(Question(str(tmp_path / "data")))
    assert again.robots.every == found.robots.every[1:2]
    assert again.groups[0].mean == found.groups[2].mean


def test_object_store_and_folder_give_the_same_answer(folder: Path, found: Answer) -> None:
    add(folder, [*range(ROBOTS)], "memory://fleet/one")
    again = answer(Question("memory://fleet/one"))
    assert json_result.text(again) == json_result.text(found)


def test_sample_of_a_large_group_does_not_depend_on_files(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mission_groups, "MOST", 60)
    found = answer(Question(str(folder / "data"), by=()))
    assert [(one.missions, one.compared, one.robots) for one in found.groups] == [(ROBOTS * EACH, 60, ROBOTS)]
    by_month = answer(Question(str(folder / "data"), by=("month",)))
    assert [one.values for one in by_month.groups] == [("2024-10",)]


def test_the_flags_since_and_robot_select_missions(folder: Path) -> None:
    found = answer(Question(str(folder / "data"), since=date(2024, 10, 14), robot="r1"))
    jsonschema.validate(json_result.document(found), json_result.schema())
    assert found.missions == EACH - 40
    assert [one.name for one in found.robots.every] == ["r1"]
    totals = [one.total for one in found.lowest]
    assert totals == sorted(totals)
    assert len(totals) == 10


def test_missions_that_cannot_be_compared_are_counted_and_named(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    to = tmp_path / "data"
    add(folder, [0], to)
    sensors = (replace(missions.SENSORS[0], bins=8), missions.SENSORS[1])
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(missions, "SENSORS", sensors)
        missions.fixture(tmp_path / "fine.npz", missions.walks(20, 1))
        log = missions.log(tmp_path / "r9" / "missions.log", missions.walks(6, 3))
        argv = ["ingest", str(log), "--to", str(to), "--fixture", str(tmp_path / "fine.npz"), "--robot", "r9"]
        assert main([*argv, "--version", "1.0"]) == 0
    with pytest.raises(FleetError, match="holds missions of 2 recordings"):
        answer(Question(str(to)))
    capsys.readouterr()
    assert main(["fleet", str(to), "--fixture", str(folder / "test.npz")]) == 0
    out = capsys.readouterr().out
    assert f"{to}: 80 missions of 1 robot" in out
    assert "6 missions of test_walk.py::test_walk with other sensors or bins cannot be compared" in out


def test_report_has_the_documented_exit_status(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, result = str(folder / "data"), tmp_path / "fleet.json"
    assert main(["fleet", data, "--json", str(result), "--fail-if", "degraded"]) == 1
    out = capsys.readouterr().out
    assert "1 of 4 robots: missions fall below a recorded bound (false discovery rate at most 5 %" in out
    assert "r3: " in out
    told = json.loads(result.read_text())
    jsonschema.Draft202012Validator.check_schema(json_result.schema())
    jsonschema.validate(told, json_result.schema())
    assert told["below"] == [DRIFTED]
    assert abs(told["robots"][3]["bound_since"]["mission"] - 41) <= 3
    assert main(["fleet", data, "--robot", "r0", "--fail-if", "robot", "--fail-if", "drifted"]) == 0
    assert "missions of r0 with the lowest reward" in capsys.readouterr().out
    assert main(["fleet", data, "--fail-if", "robot", "--json", "-"]) == 1
    assert json.loads(capsys.readouterr().out) == told


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (["{empty}"], "holds no missions: add some with `tarl ingest"),
        (
            ["{data}", "--by", "version,colour"],
            "--by must name each of version, site, robot, repair, month, week at most once",
        ),
        (["{data}", "--since", "yesterday"], "--since must be a day such as 2026-10-01"),
        (["{data}", "--robot", "r77"], "holds no mission of r77: check --robot"),
        (["{data}", "--alpha", "2"], "--alpha must be a probability"),
        (["{data}", "--fixture", "absent.npz"], "absent.npz: no such recording"),
        (["{data}", "--json", "{data}"], "cannot be written"),
        (["nosuch://x"], "nosuch://x cannot be opened"),
    ],
)
def test_invalid_input_is_reported_in_one_sentence(
    argv: list[str], said: str, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    filled = [one.replace("{data}", str(folder / "data")).replace("{empty}", str(tmp_path)) for one in argv]
    assert main(["fleet", *filled]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1


def test_files_that_are_incomplete_or_foreign_are_named(folder: Path, tmp_path: Path) -> None:
    to = tmp_path / "data"
    add(folder, [0], to)
    first = min((to / "cells").rglob("*.parquet"))
    content = first.read_bytes()
    first.unlink()
    with pytest.raises(FleetError, match=r"is missing, so .* cannot be judged"):
        answer(Question(str(to)))
    first.write_bytes(content[:-20])
    with pytest.raises(FleetError, match="cannot be read"):
        answer(Question(str(to)))
    first.write_bytes(content)
    mission = min((to / "missions").rglob("*.parquet"))
    table = pq.read_table(mission)
    for schema, said in (("", "was not written by `tarl ingest`"), ("9", "has schema 9")):
        about = {**table.schema.metadata, b"tarl.schema": schema.encode()}
        pq.write_table(table.replace_schema_metadata(about), mission)
        with pytest.raises(FleetError, match=said):
            answer(Question(str(to)))


def test_error_names_the_path_of_a_damaged_recording(folder: Path, tmp_path: Path) -> None:
    to = tmp_path / "data"
    add(folder, [0], to)
    recording = min((to / "recordings").glob("*.npz"))
    recording.write_bytes(recording.read_bytes()[:-20])
    with pytest.raises(FixtureError, match=rf"recordings/{recording.name} is damaged"):
        answer(Question(str(to)))


def test_rows_beyond_the_memory_limit_move_to_disk(
    folder: Path, found: Answer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    used = []
    connect = duckdb.connect
    monkeypatch.setattr(
        duckdb,
        "connect",
        lambda *args, config: used.append(Path(config["temp_directory"])) or connect(*args, config=config),
    )
    with opened(store(str(folder / "data")), dataset.parts(store(str(folder / "data"))), (), Filter()) as one:
        one.run("SET memory_limit = '24MB'")
        one.run("CREATE TEMP TABLE large AS SELECT hash(i) AS h FROM range(5000000) AS t(i)")
        assert any(used[0].iterdir())
    assert not any(tmp_path.iterdir())
    Path(".tarl").write_text("no folder")
    with pytest.raises(FleetError, match=r"\.tarl.fleet cannot be created"):
        answer(Question(str(folder / "data")))


@pytest.fixture(scope="module")
def scheduler() -> Iterator[Any]:
    """Start a scheduler without workers, with which clients and workers speak over TCP."""
    from distributed import LocalCluster

    options = {"processes": False, "protocol": "tcp", "silence_logs": 50}
    # any free port; without, Dask takes 8787, which may be in use
    options["dashboard_address"] = "127.0.0.1:0"
    with LocalCluster(n_workers=0, threads_per_worker=1, **options) as cluster:
        yield cluster


@pytest.mark.skipif(find_spec("distributed") is None, reason="needs the extra cluster")
@pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)  # of Dask
def test_cluster_gives_the_same_bits_after_a_worker_dies(
    folder: Path, found: Answer, scheduler: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(changed_robots, "PORTION", 100)
    question = Question(str(folder / "data"), cluster=scheduler.scheduler_address)
    with pytest.raises(SettingsError, match="has no workers; start some: dask worker tcp://"):
        answer(question)
    scheduler.scale(3)
    scheduler.sync(scheduler._correct_state)
    monkeypatch.setattr(mission_groups, "_compared", partial(dying, str(tmp_path / "died")))
    assert json_result.text(answer(question)) == json_result.text(found)
    assert (tmp_path / "died").exists()


def dying(marker: str, *arguments: object) -> object:
    """End the first worker that runs a comparison, together with its task."""
    from distributed import get_worker

    if not Path(marker).exists():
        Path(marker).touch()
        worker = get_worker()
        asyncio.run_coroutine_threadsafe(worker.close(nanny=False), worker.loop.asyncio_loop)
        Event().wait(0.3)
    return COMPARED(*arguments)  # type: ignore[arg-type]


def test_an_unreachable_cluster_is_reported_in_one_sentence(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(dask_tasks, "REACHED", 0.2)
    assert main(["fleet", str(folder / "data"), "--cluster", "tcp://127.0.0.1:9"]) == 2
    err = capsys.readouterr().err
    assert "--cluster: no Dask scheduler answers at tcp://127.0.0.1:9" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("workers", [1, 2, 7])
def test_answer_does_not_depend_on_workers(
    folder: Path, found: Answer, monkeypatch: pytest.MonkeyPatch, workers: int
) -> None:
    for module in (changed_robots, scores, samples):
        monkeypatch.setattr(module, "PORTION", 20)
    again = answer(Question(str(folder / "data"), workers=workers))
    assert json_result.text(again) == json_result.text(found)


def test_concurrently_added_missions_are_counted_once(folder: Path, found: Answer, tmp_path: Path) -> None:
    """Let other runs add missions after a run has read the existing ones and before it writes its first file."""
    write, to = Store.write, tmp_path / "data"
    path = tmp_path / "r0" / "missions.log"
    log = missions.log(path, walks(0)[:30], 20_000 * DAY, apart=DAY / 4)  # before it grew
    early = Order((log,), str(to), folder / "test.npz", "{folder}", "1.0", "s0")

    def meanwhile(self: Store, path: str, content: bytes) -> None:
        monkeypatch.undo()
        assert [(one.missions, one.known) for one in ingest.ingest(early)] == [(30, 0)]
        add(folder, range(ROBOTS), to)
        write(self, path, content)

    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(Store, "write", meanwhile)
        add(folder, [0], to)
    again = answer(Question(str(to)))
    assert 0 < again.copies < 30
    assert json_result.text(replace(again, copies=0)) == json_result.text(found)
