"""Nodes that hang or raise an exception: the line is reported, and the run continues or ends."""

from __future__ import annotations

import re
import signal
import subprocess
import sys

import pytest

from pytest_tarl import held_interpreter
from pytest_tarl.workers import pool
from pytest_tarl.workers.pool import place_held
from tests.plugin.tank import RECORD, changed

BRIEF = """
from pytest_tarl.ros import watchdog
watchdog._HOLD = 0.05  # times ten seconds of CPU time
"""
HOLDS = "            flow = GAIN * missing\n            sum(iter(int, 1))"
SLOW_REGEX = (
    "            import re\n            flow = GAIN * missing\n            re.match('(a+)+b', 'a' * 64)"
)
posix = pytest.mark.skipif(
    held_interpreter.SIGNAL is None, reason="there is no timer of CPU time on this system"
)


@posix
@pytest.mark.parametrize("code", [HOLDS, SLOW_REGEX], ids=["sum", "regex"])
def test_process_ends_with_the_place_of_the_hang(tank: pytest.Pytester, code: str) -> None:
    tank.makeconftest(BRIEF)
    changed(tank, "keeper", "            flow = GAIN * missing", code)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "test_tank.py"],
        cwd=tank.path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == -signal.SIGVTALRM
    assert 'keeper.py", line' in done.stderr
    assert "in main" in done.stderr


@posix
def test_worker_error_names_the_line_of_the_hang(tank: pytest.Pytester) -> None:
    tank.makeconftest(BRIEF)
    changed(tank, "keeper", "            flow = GAIN * missing", SLOW_REGEX)
    told = tank.runpytest_subprocess(*RECORD, "--tarl-workers=2")
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*did not end: a node held the interpreter at keeper.py, line 2?, in main*"])


def test_unresponsive_worker_is_killed(tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "SILENCE", 2)
    tank.makeconftest(BRIEF.replace("0.05", "1e6"))  # the worker's own timer does not end it
    changed(tank, "keeper", "            flow = GAIN * missing", HOLDS)
    told = tank.runpytest(*RECORD, "--tarl-workers=2")
    told.stdout.fnmatch_lines(["*did not end: a node held the interpreter at *keeper.py, line 2*"])


def test_the_reported_place_is_in_user_code() -> None:
    log = f'Current thread 0x1 (most recent call first):\n  File "{re.__file__}", line 3 in match\n'
    log += '  File "/home/me/node.py", line 12 in on_scan\n  File "/home/me/test_node.py", line 40 in test\n'
    assert place_held(log) == "/home/me/node.py, line 12, in on_scan"


def test_long_computation_in_a_test_continues(tank: pytest.Pytester) -> None:
    tank.makeconftest(BRIEF)
    changed(
        tank, "test_tank", "    for _ in range(25):", "    sum(range(60_000_000))\n    for _ in range(25):"
    )
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "test_tank.py"],
        cwd=tank.path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr


ENDS = [
    "GeneratorExit('over')",
    "asyncio.CancelledError()",
    "Odd('mine')",
    "SystemExit(3)",
    "ZeroDivisionError('x')",
]


@pytest.mark.parametrize("ending", ENDS)
def test_node_error_shows_the_traceback_and_the_test_line(tank: pytest.Pytester, ending: str) -> None:
    changed(
        tank,
        "keeper",
        "import rospy\n",
        "import asyncio\nimport rospy\n\n\nclass Odd(BaseException):\n    pass\n",
    )
    changed(tank, "keeper", "            flow = GAIN * missing", "            flow = regulated(missing)")
    changed(
        tank,
        "keeper",
        "def main",
        f"def regulated(missing):\n    if missing:\n        raise {ending}\n    return GAIN * missing\n\n\ndef main",
    )
    told = tank.runpytest("test_tank.py")
    told.assert_outcomes(failed=1, passed=1)
    text = told.stdout.str()
    verb = "exited with status" if ending.startswith("SystemExit") else "raised"
    told.stdout.fnmatch_lines(
        [
            f"Node '/keeper' {verb} *(keeper.py, line *, in regulated).",
            "Traceback (most recent call last):",
            "*keeper.py*line*in main",
            "*flow = regulated(missing)",
            "*in regulated",
            f"*raise {ending}".replace("[", "[[]"),
            "The test was at test_tank.py, line *: tarl.step(0.1)",
        ]
    )
    assert "scheduler.py" not in text
    assert "INTERNALERROR" not in text
    recorded = tank.runpytest(*RECORD)
    recorded.stdout.fnmatch_lines([f"*The first failure: Node '/keeper' {verb} *"])


def test_the_debugger_stops_in_the_node(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "            flow = GAIN * missing", "            flow = GAIN * missing / 0")
    # On a busy machine, pytest alone may need more than pexpect's ten seconds to start.
    child = tank.spawn_pytest("--pdb test_tank.py", expect_timeout=120)
    child.expect(r"\(Pdb\)")
    child.sendline("p missing, GAIN")
    child.expect(r"\(0\.\d+, 2\.0\)")
    child.sendline("q")
    child.expect("1 failed")
