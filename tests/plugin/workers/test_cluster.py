"""Episodes on a Dask cluster: a local scheduler with two workers."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.plugin.tank import RECORD, changed, columns_of, fixture_file

pytest.importorskip("distributed")

DASK = Path(sys.executable).with_name("dask")
PATIENCE = 60.0  # seconds


@pytest.fixture
def scheduler(tank: pytest.Pytester) -> Iterator[str]:
    """Return the address of a scheduler with two workers, started by their commands."""
    with ExitStack() as running:
        address = tank.path / "scheduler.json"

        def start(*command: str) -> None:
            quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
            arguments = [DASK, *command, "--scheduler-file", str(address), "--no-dashboard"]
            process = subprocess.Popen(arguments, cwd=tank.path, **quiet)  # type: ignore[call-overload]
            running.callback(process.wait, PATIENCE)
            running.callback(process.terminate)

        start("scheduler", "--host", "127.0.0.1", "--port", "0")
        for _ in range(2):
            start("worker", "--nthreads", "1")
        yield waited(address)


def waited(file: Path) -> str:
    """Return the address of the scheduler once both workers have joined it."""
    from distributed import Client

    with Client(scheduler_file=str(file), timeout=PATIENCE, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=PATIENCE)
        return str(client.scheduler.address)


def test_cluster_recording_survives_a_dead_process(tank: pytest.Pytester, scheduler: str) -> None:
    tank.runpytest_subprocess(*RECORD).assert_outcomes(passed=1)
    alone = fixture_file(tank).read_bytes()
    fixture_file(tank).unlink()
    dies_once = (
        "    from pathlib import Path\n    died = Path(__file__).with_name('died')\n"
        "    if not died.exists():\n        died.touch()\n        __import__('os')._exit(3)\n"
    )
    changed(tank, "test_tank", "    draws = ", f"{dies_once}    draws = ")
    tank.runpytest_subprocess(*RECORD, f"--tarl-cluster={scheduler}").assert_outcomes(passed=1)
    assert (tank.path / "died").exists()
    assert columns_of(fixture_file(tank).read_bytes()) == columns_of(alone)


def test_an_unreachable_cluster_is_reported(tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pytest_tarl.workers.cluster.REACHED", 0.5)
    found = tank.runpytest(*RECORD, "--tarl-cluster=tcp://127.0.0.1:9")
    found.assert_outcomes(failed=1, deselected=1)
    found.stdout.fnmatch_lines(["*no Dask scheduler answers at tcp://127.0.0.1:9*"])
