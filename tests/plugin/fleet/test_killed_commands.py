"""Real `tarl ingest` and `tarl fleet` commands are ended at random moments, by `kill -9` or Ctrl-C.

Whatever was interrupted, running the command again leaves each mission in the data set once, and the answer is that of
a data set that was never interrupted, to the last bit. TARL_SLOW=1 takes many moments instead of a few.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import duckdb

from tests.plugin.fleet.test_ingest import world
from tests.slow import SLOW, chance

TIMES = 40 if SLOW else 2
ROBOTS, EACH = (12, 40) if SLOW else (3, 6)
CTRL_C = 130  # exit status


def started(folder: Path, *arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "pytest_tarl", *arguments],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )


def run(folder: Path, *arguments: str) -> float:
    """Run a command to its end; return its seconds."""
    before = time.perf_counter()
    _, err = started(folder, *arguments).communicate()
    assert err == b""
    return time.perf_counter() - before


def interrupted(folder: Path, after: float, how: signal.Signals, *arguments: str) -> None:
    """Run a command that gets a signal after some seconds, unless it has ended."""
    one = started(folder, *arguments)
    time.sleep(after)
    one.send_signal(how)
    _, err = one.communicate()
    assert one.returncode in (0, CTRL_C, -signal.SIGINT, -signal.SIGKILL)
    importing = (
        one.returncode == -signal.SIGINT or b"_get_module_lock" in err
    )  # Python may lose a signal during an import
    assert importing or b"Traceback" not in err


def missions(data: Path) -> list[tuple[object, ...]]:
    query = (
        f"SELECT * FROM read_parquet('{data}/missions/**/*.parquet', hive_partitioning = true) ORDER BY ALL"
    )
    return duckdb.sql(query).fetchall()


def test_killed_commands_lose_and_duplicate_no_mission(tmp_path: Path) -> None:
    test, logs = world(tmp_path, ROBOTS, EACH)
    random = chance(17)
    argv = [*map(str, logs), "--fixture", str(test), "--robot", "{folder}", "--site", "north"]
    lasts = run(tmp_path, "ingest", *argv, "--to", "whole")
    expected = missions(tmp_path / "whole")
    assert len(expected) == ROBOTS * EACH
    asks = run(tmp_path, "fleet", "whole", "--json", "whole.json")
    for number in range(TIMES):
        data = f"data{number // 4}"  # several runs into one data set
        how = random.choice([signal.SIGKILL, signal.SIGINT])
        interrupted(tmp_path, random.uniform(0.1, 1.0) * lasts, how, "ingest", *argv, "--to", data)
        if number % 4 == 3 or number == TIMES - 1:
            run(tmp_path, "ingest", *argv, "--to", data)
            assert missions(tmp_path / data) == expected
            how = random.choice([signal.SIGKILL, signal.SIGINT])
            asking = ("fleet", data, "--workers", "2", "--json", "killed.json")
            interrupted(tmp_path, random.uniform(0.1, 1.0) * asks, how, *asking)
            run(tmp_path, *asking)
            assert missions(tmp_path / data) == expected
            found, whole = ((tmp_path / name).read_bytes() for name in ("killed.json", "whole.json"))
            assert found == whole
