"""After `tarl ingest`, each mission is in the data set once, even if commands or logs are repeated or interrupted."""

from __future__ import annotations

import sys
from contextlib import suppress
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from random import Random

import duckdb
import hypothesis.strategies as st
import jsonschema
import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings

from pytest_tarl.commands.cli import main
from pytest_tarl.fleet import ingest as ingesting
from pytest_tarl.fleet import json_result
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.ingest import Order, ingest
from pytest_tarl.fleet.question import Question, answer
from pytest_tarl.formulas.signals import Signal
from pytest_tarl.learning.fixture import save
from pytest_tarl.learning.tables import Judgements
from pytest_tarl.sensors import binning_digest
from tests.plugin.monitoring import missions

DAY = 86_400.0


def world(folder: Path, robots: int = 3, each: int = 5) -> tuple[Path, list[Path]]:
    """Write a recording and a log for each robot, whose missions are half a day apart."""
    test = folder / "test.npz"
    missions.fixture(test, missions.walks(20, 1))
    return test, [log(folder, f"r{n}", missions.walks(each, 10 + n)) for n in range(robots)]


def log(folder: Path, robot: str, walks: list[missions.Walk], first: float = 10 * DAY) -> Path:
    return missions.log(folder / robot / "missions.log", walks, first, apart=DAY / 2)


def order(test: Path, logs: list[Path], to: Path) -> Order:
    return Order(tuple(logs), str(to), test, "{folder}", "1.2", "north")


def rows(to: Path, table: str = "missions") -> list[tuple[object, ...]]:
    """Return all rows as DuckDB reads them, without tarl."""
    return duckdb.sql(
        f"SELECT * FROM read_parquet('{to}/{table}/**/*.parquet', hive_partitioning = true) ORDER BY ALL"
    ).fetchall()


def test_data_set_rows_are_logged_missions(tmp_path: Path) -> None:
    test, logs = world(tmp_path)
    to = tmp_path / "data"
    assert sum(one.missions for one in ingest(order(test, logs, to))) == 15
    walks = [one for n in range(3) for one in missions.walks(5, 10 + n)]
    found = rows(to)
    assert sorted(row[5] for row in found) == pytest.approx(sorted(sum(one.reward) for one in walks))
    assert sum(bool(row[4]) for row in found) == sum(one.passed for one in walks)
    assert {(row[1], row[2]) for row in found} == {(f"r{n}", "north") for n in range(3)}
    query = f"SELECT sum(count), sum(reward) FROM read_parquet('{to}/cells/**/*.parquet')"
    (steps,) = duckdb.sql(query).fetchall()
    assert steps[0] == sum(len(one.cells) for one in walks)
    assert steps[1] == pytest.approx(sum(sum(one.reward) for one in walks))
    dates = duckdb.sql(
        f"SELECT DISTINCT version, date FROM read_parquet('{to}/missions/**/*.parquet', hive_partitioning = true, "
        "hive_types_autocast = false) ORDER BY ALL"
    ).fetchall()
    assert dates == [("1.2", "1970-01-11"), ("1.2", "1970-01-12"), ("1.2", "1970-01-13")]


def test_documented_examples_read_the_data_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    guide = Path(__file__).parents[3] / "docs" / "howto" / "fleet-logs.md"
    blocks = [one for one in guide.read_text("utf-8").split("```python\n")[1:] if "fleet/missions" in one]
    examples = {one.split("import ")[1].split()[0]: one.split("```")[0] for one in blocks}
    assert {*examples} == {"duckdb", "pandas"}
    test, logs = world(tmp_path)
    list(ingest(order(test, logs, tmp_path / "fleet")))
    monkeypatch.chdir(tmp_path)
    exec(examples["duckdb"], {})
    assert "north" in capsys.readouterr().out
    if find_spec("pandas") is not None:
        exec(examples["pandas"], {})
        assert "r2" in capsys.readouterr().out


def test_pandas_reads_the_data_set_without_tarl(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    test, logs = world(tmp_path)
    list(ingest(order(test, logs, tmp_path / "data")))
    found = pandas.read_parquet(tmp_path / "data" / "missions")
    assert found.groupby("robot", observed=True).total.count().to_dict() == {"r0": 5, "r1": 5, "r2": 5}


def test_file_metadata_names_schema_and_recording(tmp_path: Path) -> None:
    test, logs = world(tmp_path)
    list(ingest(order(test, logs, tmp_path / "data")))
    for path in (tmp_path / "data").rglob("*.parquet"):
        about = pq.read_schema(path).metadata
        assert about[b"tarl.schema"] == b"2"
        assert about[b"tarl.test"] == missions.TEST.encode()
        assert about[b"tarl.sensors"] == binning_digest(missions.SENSORS).encode()


class Killed(BaseException):
    """Simulates a process that ends between writing two files."""


@given(
    st.lists(st.tuples(st.sets(st.integers(0, 2), min_size=1), st.integers(0, 12)), max_size=4),
    st.integers(1, 9),
    st.randoms(use_true_random=False),
)
@settings(max_examples=6, deadline=None)
def test_interrupted_repeated_and_reordered_runs_give_the_same_rows(
    tmp_path_factory: pytest.TempPathFactory,
    runs: list[tuple[set[int], int]],
    together: int,
    random: Random,
) -> None:
    folder = tmp_path_factory.mktemp("fleet")
    test, logs = world(folder)
    list(ingest(order(test, logs, folder / "once")))
    to, write = folder / "often", Store.write
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(ingesting, "TOGETHER", together)
        for some, files in runs:
            left = [files]

            def killed(self: Store, path: str, content: bytes, left: list[int] = left) -> None:
                left[0] -= 1
                if left[0] < 0:
                    raise Killed
                write(self, path, content)

            patched.setattr(Store, "write", killed)
            picked = [logs[n] for n in some]
            random.shuffle(picked)
            with suppress(Killed):
                list(ingest(order(test, picked, to)))
            if any((to / "missions").rglob("*.parquet")):
                assert any((to / "recordings").iterdir())
        patched.setattr(Store, "write", write)
        random.shuffle(logs)
        list(ingest(order(test, logs, to)))
    assert rows(to) == rows(folder / "once")
    finished = {path.name for path in (to / "missions").rglob("*.parquet")}
    assert finished <= {path.name for path in (to / "cells").rglob("*.parquet")}


def test_ingesting_the_same_logs_again_writes_nothing(tmp_path: Path) -> None:
    test, logs = world(tmp_path)
    to = tmp_path / "data"
    list(ingest(order(test, logs, to)))
    before = {path: path.stat().st_mtime_ns for path in to.rglob("*.parquet")}
    again = list(ingest(order(test, logs, to)))
    assert [(one.missions, one.known) for one in again] == [(0, 5)] * 3
    assert {path: path.stat().st_mtime_ns for path in to.rglob("*.parquet")} == before


def test_a_log_that_has_grown_adds_its_new_missions(tmp_path: Path) -> None:
    test, logs = world(tmp_path, robots=1)
    to = tmp_path / "data"
    list(ingest(order(test, logs, to)))
    log(tmp_path, "r0", missions.walks(4, 99), first=20 * DAY)
    (found,) = ingest(order(test, logs, to))
    assert (found.missions, found.known) == (4, 5)
    assert len(rows(to)) == 9


def test_copy_for_another_robot_is_refused(tmp_path: Path) -> None:
    test, logs = world(tmp_path, robots=1)
    to = tmp_path / "data"
    list(ingest(order(test, logs, to)))
    (found,) = ingest(replace(order(test, logs, to), robot="r9"))
    assert "A mission of r9 is already in" in found.problem
    assert ", as a mission of r0" in found.problem
    assert len(rows(to)) == 5


def test_hashed_names_are_equal_only_for_equal_salts(tmp_path: Path) -> None:
    test, logs = world(tmp_path)
    for name, salt in (("a", "pepper"), ("b", "pepper"), ("c", "sugar")):
        list(ingest(replace(order(test, logs, tmp_path / name), salt=salt)))
    a, b, c = ({row[1] for row in rows(tmp_path / name)} for name in "abc")
    assert a == b
    assert len(a) == 3
    assert not a & (c | {"r0", "r1", "r2"})


@pytest.mark.parametrize("change", ["sensors", "bins", "test"])
def test_log_of_another_recording_is_named_and_skipped(
    change: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    test, logs = world(tmp_path)
    told = {"sensors": ["x", "dry"], "bins": "0" * 16, "test": "test_other.py::test_it"}[change]
    logs[1].unlink()
    missions.log(logs[1], missions.walks(5, 7), **{change: told})
    argv = [
        "ingest",
        *map(str, logs),
        "--to",
        str(tmp_path / "data"),
        "--fixture",
        str(test),
        "--robot",
        "{folder}",
    ]
    assert main(argv) == 2
    out, err = capsys.readouterr()
    assert str(logs[1]) in err
    assert err.count("\n") == 1
    assert f"{tmp_path / 'data'}: 10 missions added" in out
    assert {row[1] for row in rows(tmp_path / "data")} == {"r0", "r2"}


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (["{log}", "--robot", " "], "--robot is empty"),
        (["{log}", "{other}", "--robot", "r"], "--robot {folder}"),
        (["{log}", "--robot", "r", "--to", "nosuch://bucket/x"], "nosuch://bucket/x cannot be opened"),
        (["{log}", "--robot", "r", "--fixture", "absent.npz"], "absent.npz: no such recording"),
        (["absent.log", "--robot", "r"], "absent.log cannot be read"),
        (["{log}", "--robot", "r", "--to", "{log}/data"], "cannot be"),
    ],
)
def test_invalid_input_is_reported_in_one_sentence(
    argv: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    test, logs = world(tmp_path)
    filled = [one.replace("{log}", str(logs[0])).replace("{other}", str(logs[1])) for one in argv]
    filled = filled if "--to" in filled else [*filled, "--to", str(tmp_path / "data")]
    filled = filled if "--fixture" in filled else [*filled, "--fixture", str(test)]
    assert main(["ingest", *filled]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1


def test_a_damaged_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    test, logs = world(tmp_path)
    to = tmp_path / "data"
    list(ingest(order(test, logs, to)))
    damaged = min((to / "missions").rglob("*.parquet"))
    damaged.write_bytes(damaged.read_bytes()[:100])
    argv = [
        "ingest",
        *map(str, logs),
        "--to",
        str(to),
        "--fixture",
        str(test),
        "--robot",
        "{folder}",
        "--version",
        "1.2",
    ]
    assert main(argv) == 2
    err = capsys.readouterr().err
    assert f"{damaged} is damaged or cannot be read" in err
    assert err.count("\n") == 1


def test_a_missing_package_is_reported_in_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("pytest_tarl.extras.FLEET", ("no_such_package",))
    assert main(["ingest", "a.log", "--to", "x", "--fixture", "f", "--robot", "r"]) == 2
    assert (
        "tarl ingest needs no_such_package, which is not installed: run pip install"
        in capsys.readouterr().err
    )


def test_other_commands_do_not_import_ingest_packages() -> None:
    import subprocess

    code = (
        "import sys, pytest_tarl.commands.cli, pytest_tarl.plugin; "
        "print({'duckdb', 'pyarrow', 'fsspec'} & {*sys.modules})"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


FORMULA = "always (gap > 0.3)"


def judged_log(folder: Path, gaps: list[float]) -> Path:
    """Write a log of missions in which a signal falls to each of the values `gaps`."""
    path = folder / "r0" / "missions.log"
    file = missions.LogFile(path)
    file.append(missions.start())
    for n, (one, gap) in enumerate(zip(missions.walks(len(gaps), 3), gaps, strict=True)):
        *begin, end = missions.records(one, DAY * n)
        follow = {"changes": [[0.0, "gap", 1.0], [0.5, "gap", gap]], "lasted": 1.0}
        for record in (*begin, {**end, "passed": True, **follow}):
            file.append(record)
    file.close()
    return path


def test_formulas_of_each_mission_are_stored_and_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rtamt")
    test = tmp_path / "test.npz"
    plain = missions.fixture(test, missions.walks(20, 1))
    rows_of = np.ones((20, 1))
    sample = replace(plain.sample, judgements=Judgements((FORMULA,), rows_of, rows_of * np.nan))
    save(replace(plain, signals=(Signal("gap"),), sample=sample), test)
    log = judged_log(tmp_path, [0.5, 0.1, 0.4])
    data = tmp_path / "data"
    argv = ["ingest", str(log), "--to", str(data), "--fixture", str(test), "--robot", "{folder}"]
    assert main(argv) == 0
    found = duckdb.sql(
        f"SELECT passed, formulas['{FORMULA}'] FROM read_parquet('{data}/missions/**/*.parquet') ORDER BY time"
    ).fetchall()
    assert [row[0] for row in found] == [True, False, True]
    assert [row[1] for row in found] == pytest.approx([0.2, -0.2, 0.1])
    capsys.readouterr()
    assert main(["fleet", str(data)]) == 0
    said = f"{FORMULA}: violated by 1 of 3 missions in unknown unknown, least robustness -0.2"
    assert said in capsys.readouterr().out
    jsonschema.validate(json_result.document(answer(Question(str(data)))), json_result.schema())
    silent = missions.log(tmp_path / "r1" / "missions.log", missions.walks(2, 4))
    assert main([*argv[:1], str(silent), *argv[2:]]) == 0
    assert "2 missions of r1, 2 not judged by every formula" in capsys.readouterr().out


def test_the_repair_in_the_software_is_stored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    test, logs = world(tmp_path)
    patch = tmp_path / "test_walk-rain-12345678.patch"
    argv = ["--to", str(tmp_path / "data"), "--fixture", str(test), "--robot", "{folder}"]
    for log, repair in zip(logs, (None, "guard-2", str(patch)), strict=True):
        patch.write_text("")
        assert main(["ingest", str(log), *argv, *(["--repair", repair] if repair else [])]) == 0
    assert sorted({(row[1], row[7]) for row in rows(tmp_path / "data")}) == [
        ("r0", ""),
        ("r1", "guard-2"),
        ("r2", patch.stem),
    ]
    assert main(["ingest", str(logs[0]), *argv, "--repair", "absent.patch"]) == 2
    assert "absent.patch: no such patch" in capsys.readouterr().err
