"""`os._exit` in a node ends the node; it must not end pytest, which would report success without a verdict."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.plugin.ros.conftest import Start
from tests.plugin.tank import RECORD, changed

FLOW = "            flow = GAIN * missing"
HEARD = "    level = msg.data"


def ending(tank: pytest.Pytester, place: str, status: int) -> None:
    """Let the node end itself, in its main loop or in a callback."""
    if place == "loop":
        changed(
            tank,
            "keeper",
            FLOW,
            f"{FLOW}\n            if level > 0.3:\n                leave({status}, flow)",
        )
    else:
        changed(tank, "keeper", HEARD, f"{HEARD}\n    if level > 0.3:\n        leave({status}, level)")
    changed(
        tank,
        "keeper",
        "def main",
        "def leave(status, value):\n    import os\n    os._exit(status)\n\n\ndef main",
    )


@pytest.mark.parametrize("place", ["loop", "callback"])
def test_exit_status_fails_the_test(tank: pytest.Pytester, place: str) -> None:
    ending(tank, place, 7)
    real = os._exit
    told = tank.runpytest_subprocess("test_tank.py")
    told.assert_outcomes(failed=1, passed=1)
    told.stdout.fnmatch_lines(["Node '/keeper' exited with status 7 (keeper.py, line *, in leave).*"])
    assert os._exit is real


@pytest.mark.parametrize("place", ["loop", "callback"])
def test_test_continues_after_a_clean_node_exit(tank: pytest.Pytester, place: str) -> None:
    ending(tank, place, 0)
    told = tank.runpytest_subprocess("test_tank.py")
    told.assert_outcomes(failed=1, passed=1)
    told.stdout.fnmatch_lines(["*tank not full*"])


def test_a_recording_says_that_its_episodes_failed(tank: pytest.Pytester) -> None:
    ending(tank, "loop", 0)
    told = tank.runpytest_subprocess(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["5 of the first 5 episodes failed*tank not full*"])


def test_forked_child_ends_at_once(tank: pytest.Pytester) -> None:
    forks = "                import os\n                child = os.fork()\n                if not child:\n"
    forks += "                    os._exit(5)\n"
    forks += "                assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 5"
    changed(tank, "keeper", FLOW, f"{FLOW}\n            if level > 0.9:\n{forks}")
    tank.runpytest_subprocess("test_tank.py").assert_outcomes(passed=2)


@pytest.mark.parametrize(
    ("ends", "status", "printed"),
    [
        ("sys.exit(3)", 3, ""),
        ("sys.exit()", 0, ""),
        ("sys.exit('no map')", 1, "no map\n"),
        ("missing()", 1, "NameError: name 'missing' is not defined\n"),
        ("print('done')", 0, "done\n"),
        ("import time; time.sleep(1.0)", 1, "start it as a program of its own with subprocess.\n"),
    ],
)
def test_a_forked_child_ends_as_a_program_does(
    start: Start, capfd: pytest.CaptureFixture[str], ends: str, status: int, printed: str
) -> None:
    ros = start(f"""
        import os, sys
        child = os.fork()
        if not child:
            {ends}
        else:
            status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    """)
    assert ros.namespace["status"] == status
    assert "".join(capfd.readouterr()).endswith(printed)


def test_a_forked_child_does_not_repeat_what_its_node_printed(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text(
        "import os\nprint('once', end=' ')\nchild = os.fork()\nif child:\n    os.waitpid(child, 0)\n"
    )
    episode = (
        "import runpy\nfrom pytest_tarl.ros import Ros\nros = Ros()\nwith ros.installed():\n"
        "    ros.start(lambda: runpy.run_path('node.py'), name='node.py')\n    ros.close()\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", episode], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert ran.stdout.split() == ["once"]
