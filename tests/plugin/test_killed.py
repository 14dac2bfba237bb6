"""After `kill -9` during a recording run, the old recording can still be loaded."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from pytest_tarl.learning.fixture import load
from tests.plugin.tank import RECORD, fixture_file
from tests.slow import SLOW, chance

TIMES = 20 if SLOW else 3


def recording(tank: pytest.Pytester, seed: int) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "pytest", "-q", *RECORD, f"--tarl-seed={seed}"]
    return subprocess.Popen(command, cwd=tank.path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def test_killing_a_recording_leaves_a_valid_file(tank: pytest.Pytester) -> None:
    before = time.perf_counter()
    assert recording(tank, 0).wait() == 0
    lasts = time.perf_counter() - before
    moments = chance(5)
    for seed in range(1, TIMES + 1):
        run = recording(tank, seed)
        time.sleep(moments.uniform(0.3, 1.0) * lasts)
        run.kill()
        run.wait()
        assert load(fixture_file(tank)).seed in range(seed + 1)
    left = [path.name for path in fixture_file(tank).parent.iterdir()]
    assert [name for name in left if not name.startswith(".")] == [fixture_file(tank).name]
    ignored = (tank.path / ".tarl" / ".gitignore").read_text().splitlines()
    assert "utility/.*" in ignored
