"""Suspending the machine, or Ctrl-Z and `fg`, does not change the recording."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.plugin.tank import RECORD, fixture_file
from tests.slow import SLOW

IMPATIENT = """
import pytest_tarl.ros.watchdog as watchdog
import pytest_tarl.workers.pool as pool
watchdog._PATIENCE = 0.2  # times 10 s
pool.SILENCE = 2
"""


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="this system cannot stop a process")
@pytest.mark.parametrize("workers", [1, 2] if SLOW else [2])
def test_a_suspended_run_writes_the_same_recording(tank: pytest.Pytester, workers: int) -> None:
    lasts = 5.0 if SLOW else 0.2  # longer than any time limit of the run
    if SLOW:
        (tank.path / "conftest.py").write_text(IMPATIENT)
    moments = random.Random(workers)
    begun = time.perf_counter()
    assert started(tank, 1).wait() == 0
    whole, expected = time.perf_counter() - begun, fixture_file(tank).read_bytes()
    for _ in range(10 if SLOW else 1):
        fixture_file(tank).unlink()
        run = started(tank, workers)
        time.sleep(moments.uniform(0.4, 0.9) * whole)
        every = [run.pid, *children(run.pid)]
        suspended = [process for process in every if signalled(process, signal.SIGSTOP)]
        time.sleep(lasts)
        assert suspended or run.poll() is not None
        for process in suspended:
            signalled(process, signal.SIGCONT)
        assert run.wait() == 0
        assert fixture_file(tank).read_bytes() == expected


def started(tank: pytest.Pytester, workers: int) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "pytest", "-q", *RECORD, f"--tarl-workers={workers}"]
    return subprocess.Popen(command, cwd=tank.path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def children(parent: int) -> list[int]:
    """Return the child processes of a process, if the system lists them."""
    listed = Path(f"/proc/{parent}/task/{parent}/children")
    return [int(one) for one in listed.read_text().split()] if listed.exists() else []


def signalled(process: int, number: int) -> bool:
    try:
        os.kill(process, number)
    except ProcessLookupError:
        return False
    return True
