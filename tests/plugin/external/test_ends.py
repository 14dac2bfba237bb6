"""No process of a simulator outlives its test, whichever process is killed and whatever the simulator does (no ROS)."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from textwrap import dedent

import pytest

from tests.held import HOLD, comes_free

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs prctl of Linux")
ROOT = Path(__file__).parents[3]
BOTH = (
    HOLD + "import signal, subprocess, sys\nsleep = ['sleep', '600']; keep = {'pass_fds': [lock.fileno()]}\n"
)
SAY = "print('up', flush=True)\n"
SIMULATORS = {
    "waits": BOTH + "subprocess.Popen(sleep, **keep)\n" + SAY + "signal.pause()",
    "ignores": BOTH
    + "[signal.signal(number, signal.SIG_IGN) for number in (2, 15)]\n"
    + "subprocess.Popen(sleep, **keep)\n"
    + SAY
    + "while True: signal.pause()",
    "leaves": BOTH + "subprocess.Popen(sleep, start_new_session=True, **keep)\n" + SAY + "signal.pause()",
    "orphans": BOTH
    + "subprocess.Popen(['sh', '-c', 'sleep 600 & exec sleep 600'], start_new_session=True, **keep)\n"
    + SAY
    + "signal.pause()",
}
# The process of the guardian: it ends a group, then reads the lock without waiting
ENDED = """
    import os, signal, sys
    from pathlib import Path
    from pytest_tarl.external import group
    from pytest_tarl.external.descendants import outlive_the_test
    from tests.held import held
    outlive_the_test()
    reader, writer = os.pipe()
    os.dup2(writer, 2)
    group.STEPS = [(number, 60.0 if number == signal.SIGKILL else float(sys.argv[2])) for number, _ in group.STEPS]
    one = group.Group([sys.executable, "-c", sys.argv[1]], ".", {})
    assert os.read(reader, 2) == b"up"
    lock = Path(os.environ["HELD"])
    assert held(lock)
    one.end()
    assert not held(lock)
    print("ended", one.status)
"""
# A guardian with a stand-in middleware that can block, and the process of the test, which starts the guardian
GUARDIAN = """
    import sys, time, types
    from pytest_tarl.external import guardian
    class Link:
        def __init__(self, *_): pass
        def spin(self, seconds): time.sleep({block} or seconds)
        def look(self): pass
        def subscribe(self, topics): guardian.Guardian.say(kept[0], {{"kind": "up"}})
        def wake(self): pass
        def close(self): pass
    kept = []
    start = guardian.Guardian.__init__
    guardian.Guardian.__init__ = lambda one, events: (start(one, events), kept.append(one))[0]
    guardian.Link, guardian.LAST = Link, {last}
    guardian.main()
"""
TEST = """
    import json, os, subprocess, sys
    pipes = dict(stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    guardian = subprocess.Popen([sys.executable, "-c", sys.argv[1]], **pipes)
    start = dict(do="start", command=[sys.executable, "-c", sys.argv[2]], folder=".", environment=dict(os.environ),
                 clock="/clock", topics=[])
    guardian.stdin.write(json.dumps(start) + "\\n"); guardian.stdin.flush()
    while "up" not in (line := guardian.stdout.readline()): assert line, "the guardian ended"
    {last}
    print("ran", flush=True)
    sys.stdin.read()
"""


@pytest.mark.parametrize(
    ("simulator", "limit", "status"),
    [("waits", 60.0, -2), ("ignores", 0.1, -9), ("leaves", 60.0, -2), ("orphans", 60.0, -2)],
)
def test_process_group_ends_with_its_descendants(
    tmp_path: Path, simulator: str, limit: float, status: int
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", dedent(ENDED), SIMULATORS[simulator], str(limit)],
        cwd=ROOT,
        env={**os.environ, "HELD": str(tmp_path / "held")},
        capture_output=True,
        text=True,
    )
    assert done.stdout == f"ended {status}\n", done.stdout + done.stderr
    assert comes_free(tmp_path / "held")


@contextmanager
def running(
    lock: Path, *, block: float = 0.0, last: float = 60.0, do: str = "pass"
) -> Iterator[subprocess.Popen[str]]:
    """Run a test's process with guardian and simulator, up to the point where it waits."""
    guardian = dedent(GUARDIAN).format(block=block, last=last)
    with subprocess.Popen(
        [sys.executable, "-c", dedent(TEST).format(last=do), guardian, SIMULATORS["waits"]],
        cwd=ROOT,
        env={**os.environ, "HELD": str(lock)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
        text=True,
    ) as test:
        assert test.stdout is not None
        try:
            assert test.stdout.readline() == "ran\n"
            yield test
        finally:
            with suppress(ProcessLookupError):
                os.killpg(test.pid, signal.SIGKILL)


@pytest.mark.parametrize(
    "do",
    [
        "pass",
        "guardian.stdin.write('{'); guardian.stdin.flush()",
        "os.fork() or __import__('time').sleep(600)",
    ],
    ids=["alone", "within a line", "with a forked child"],
)
def test_no_process_of_the_simulator_survives_a_killed_test(tmp_path: Path, do: str) -> None:
    lock = tmp_path / "held"
    with running(lock, do=do) as test:
        test.kill()
        assert comes_free(lock)


def test_no_process_survives_if_the_middleware_blocks_the_guardian(tmp_path: Path) -> None:
    lock = tmp_path / "held"
    with running(lock, block=600.0, last=0.1) as test:
        test.kill()
        assert comes_free(lock)
