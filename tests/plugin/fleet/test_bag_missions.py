"""`tarl ingest` replays each bag once through the nodes of the recorded test."""

from __future__ import annotations

from pathlib import Path

import duckdb
import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.workers import pool
from tests.plugin.missions import mission, write_bag
from tests.plugin.tank import RECORD, changed, fixture_file

MONITOR = "    monitor=lambda moment: -abs(1.0 - moment.latest('/gauge').data),\n"
FORMATS = (".bag", ".mcap", ".db3", "")


@pytest.fixture(scope="module")
def recorded() -> dict[str, bytes]:
    return {}


@pytest.fixture
def project(tank: pytest.Pytester, recorded: dict[str, bytes]) -> pytest.Pytester:
    changed(tank, "test_tank", "    drifts={", MONITOR + "    drifts={")
    folder = tank.path / ".tarl" / "utility"
    if not recorded:
        tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
        recorded.update({file.name: file.read_bytes() for file in folder.glob("*.npz")})
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in recorded.items():
        (folder / name).write_bytes(content)
    return tank


def ingested(project: pytest.Pytester, *bags: Path, also: tuple[str, ...] = ()) -> int:
    fixture = str(fixture_file(project))
    return main(
        [
            *("ingest", *map(str, bags), "--to", str(project.path / "fleet"), "--fixture", fixture),
            *("--robot", "{file}", "--version", "1", *also),
        ]
    )


def missions(project: pytest.Pytester) -> list[tuple[str, int, float]]:
    data = f"{project.path}/fleet/missions/**/*.parquet"
    return duckdb.sql(
        f"SELECT robot, steps, total FROM read_parquet('{data}', hive_partitioning = true) ORDER BY ALL"
    ).fetchall()


def test_bags_of_every_format_are_replayed_and_compared(
    project: pytest.Pytester, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    bags = [write_bag(project.path / f"r{n}{kind}", mission(1.0, n)) for n, kind in enumerate(FORMATS)]
    assert ingested(project, *bags) == 0
    found = missions(project)
    assert [row[0] for row in found] == ["r0", "r1", "r2", "r3"]
    assert all(row[1] == 25 and -25 < row[2] < 0 for row in found)
    statements = duckdb.sql(
        f"SELECT count(*) FROM read_parquet('{project.path}/fleet/statements/**/*.parquet')"
    )
    assert statements.fetchall()[0][0] > 0
    monkeypatch.setattr(pool, "Worker", None)  # nothing is replayed again
    converted = write_bag(project.path / "again" / "r1.db3", mission(1.0, 1))
    assert ingested(project, *bags, converted) == 0
    assert missions(project) == found
    assert "1 were already in the data set" in capsys.readouterr().out
    assert main(["fleet", str(project.path / "fleet"), "--by", "version"]) == 0
    assert "4 missions of 4 robots" in capsys.readouterr().out


def test_truncated_or_unfit_bag_is_skipped_with_a_note(
    project: pytest.Pytester, capsys: pytest.CaptureFixture[str]
) -> None:
    good = write_bag(project.path / "good.bag", mission(1.0, 1))
    cut = write_bag(project.path / "cut.bag", mission(1.0, 2, steps=400))
    cut.write_bytes(cut.read_bytes()[:40_000])
    other = write_bag(
        project.path / "other.mcap", iter([(0.0, [("/else", "std_msgs/msg/Float64", {"data": 1.0})])])
    )
    assert ingested(project, cut, other, good) == 2
    told = capsys.readouterr()
    assert "cut.bag was cut off" in told.err
    assert "ros2 bag reindex" in told.err
    assert "other.mcap has no messages on /level" in told.err
    assert [row[0] for row in missions(project)] == ["good"]


def test_error_names_the_missing_project_test_or_monitor(
    project: pytest.Pytester, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = write_bag(project.path / "r0.bag", mission(1.0, 1))
    elsewhere = project.path / "elsewhere"
    elsewhere.mkdir()
    assert ingested(project, bag, also=("--project", str(elsewhere))) == 2
    assert "--project" in capsys.readouterr().err
    changed(project, "test_tank", MONITOR, "")
    assert ingested(project, bag) == 2
    assert "monitor=" in capsys.readouterr().err
