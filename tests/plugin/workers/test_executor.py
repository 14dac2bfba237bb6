"""Episodes in other processes give the same recording, whatever happens to the workers."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed, columns_of, fixture_file, result
from tests.slow import SLOW

TWO = "--tarl-workers=2"


def recorded(tank: pytest.Pytester, *flags: str) -> bytes:
    tank.runpytest(*RECORD, *flags).assert_outcomes(passed=1, deselected=1)
    return fixture_file(tank).read_bytes()


def test_recording_does_not_depend_on_workers(tank: pytest.Pytester) -> None:
    alone = recorded(tank)
    fixture_file(tank).unlink()
    assert recorded(tank, "--tarl-workers=3") == alone


@pytest.mark.skipif(not SLOW, reason="runs a whole repair twice: set TARL_SLOW=1")
def test_comparison_and_repair_do_not_depend_on_workers(tank: pytest.Pytester) -> None:
    recorded(tank)
    tank.runpytest(*ONLINE, "--tarl-repair").assert_outcomes(failed=1, deselected=1)
    alone = result(tank)
    shutil.rmtree(tank.path / ".tarl" / "results")
    tank.runpytest(*ONLINE, "--tarl-repair", TWO).assert_outcomes(failed=1, deselected=1)
    assert result(tank) == alone
    assert alone["repair"]["accepted"]


def test_an_episode_is_retried_if_its_worker_dies(tank: pytest.Pytester) -> None:
    alone = recorded(tank)
    dies_once = (
        "import os\n    from pathlib import Path\n"
        "    if os.environ.get('DYING') and draws.uniform() < 0.3:\n"
        "        died = Path(__file__).parent / f'{tarl.seed}.died'\n"
        "        if not died.exists():\n            died.touch()\n            os._exit(3)\n"
    )
    changed(
        tank,
        "test_tank",
        "    level, pump =",
        f"    {dies_once}    draws = tarl.rng('world')\n    level, pump =",
    )
    changed(
        tank, "test_tank", 'draws = tarl.rng("world")\n    import', 'draws = tarl.rng("dying")\n    import'
    )
    edited = recorded(tank)
    assert columns_of(edited) == columns_of(alone)
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("DYING", "1")
        assert recorded(tank, TWO) == edited
    assert list(tank.path.glob("*.died"))


def test_episode_that_kills_workers_keeps_the_old_recording(
    tank: pytest.Pytester,
) -> None:
    before = recorded(tank)
    changed(
        tank,
        "test_tank",
        "    for _ in range(25):",
        "    import os\n    for _ in range(25):\n        os.kill(os.getpid(), 9)",
    )
    found = tank.runpytest(*RECORD, TWO)
    found.assert_outcomes(failed=1, deselected=1)
    found.stdout.fnmatch_lines(
        ["*In each of 3 attempts, the worker process of the episode with seed * ended with status -9*"]
    )
    assert fixture_file(tank).read_bytes() == before


def test_worker_test_errors_are_reported(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "tarl.reward(-abs(1.0 - level))", "pass")
    tank.runpytest(*RECORD, TWO).stdout.fnmatch_lines(["*The test never called tarl.reward*"])


def test_worker_skip_skips_the_test(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "    for _ in", "    pytest.skip('no pump today')\n    for _ in")
    skipped = tank.runpytest(*RECORD, TWO, "-rs")
    skipped.assert_outcomes(skipped=1, deselected=1)
    skipped.stdout.fnmatch_lines(["*no pump today*"])


def test_unprepared_worker_gives_the_reason(tank: pytest.Pytester) -> None:
    tank.makeconftest("import sys\nassert 'worker_main' not in sys.argv[0], 'not in a worker'\n")
    tank.runpytest(*RECORD, TWO).stdout.fnmatch_lines(["*not in a worker*"])


def test_worker_has_the_fixtures_and_options_of_the_run(
    tank: pytest.Pytester,
) -> None:
    tank.makeconftest(
        """
        import pytest
        def pytest_addoption(parser):
            parser.addoption("--pump")
        @pytest.fixture(scope="session", autouse=True)
        def plant(request):
            assert request.config.getoption("--pump") == "big"
            yield
            (request.config.rootpath / f"down-{__import__('os').getpid()}").touch()
        """
    )
    tank.runpytest(*RECORD, TWO, "--pump=big", "--junitxml=out.xml").assert_outcomes(passed=1, deselected=1)
    assert len(list(tank.path.glob("down-*"))) == 2
    assert "test_fills" in (tank.path / "out.xml").read_text()


def test_blocked_plugin_is_not_imported_by_workers(
    tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    tank.makepyfile(noisy="raise SystemExit('the blocked plugin was imported')")
    noisy = tank.mkdir("noisy-1.dist-info")
    (noisy / "METADATA").write_text("Metadata-Version: 2.1\nName: noisy\nVersion: 1\n")
    (noisy / "entry_points.txt").write_text("[pytest11]\nnoisy = noisy\n")
    monkeypatch.setenv("PYTHONPATH", str(tank.path))
    blocked = ("-p", "no:noisy")
    assert tank.runpytest_subprocess(*RECORD).ret != pytest.ExitCode.OK
    tank.runpytest_subprocess(*RECORD, *blocked, TWO).assert_outcomes(passed=1, deselected=1)


def test_each_xdist_worker_has_its_own_workers(tank: pytest.Pytester) -> None:
    alone = recorded(tank)
    fixture_file(tank).unlink()
    tank.runpytest_subprocess(*RECORD, TWO, "-n2").assert_outcomes(passed=1)
    assert fixture_file(tank).read_bytes() == alone


def started(tank: pytest.Pytester, *flags: str) -> subprocess.Popen[bytes]:
    """Start a recording in its own process group, as a terminal does."""
    return subprocess.Popen(
        [sys.executable, "-m", "pytest", "-q", *RECORD, *flags],
        cwd=tank.path,
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )


def runs_in(process: Path, folder: Path) -> bool:
    """Return whether a process is alive and runs in a folder."""
    if process.name == str(os.getpid()):
        return False
    try:
        return (process / "cwd").readlink() == folder and b") Z" not in (process / "stat").read_bytes()
    except OSError:
        return False


def gone(folder: Path) -> bool:
    """Return whether all processes in a folder end within a time limit."""
    for _ in range(100):
        if not any(runs_in(process, folder) for process in Path("/proc").glob("[0-9]*")):
            return True
        time.sleep(0.1)
    return False


@pytest.fixture
def slow_tank(tank: pytest.Pytester) -> pytest.Pytester:
    """Return a project with a recording, whose next recording is slow."""
    recorded(tank)
    slowly = "    Path('begun').touch()\n    for _ in range(25):\n        time.sleep(0.02)"
    changed(tank, "test_tank", "import pytest\n", "import time\nfrom pathlib import Path\n\nimport pytest\n")
    changed(tank, "test_tank", "    for _ in range(25):", slowly)
    return tank


@pytest.mark.skipif(not Path("/proc/self/cwd").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL], ids=["Ctrl-C", "kill -9"])
def test_aborted_run_leaves_no_process(slow_tank: pytest.Pytester, how: signal.Signals) -> None:
    before = fixture_file(slow_tank).read_bytes()
    run = started(slow_tank, TWO)
    while not (slow_tank.path / "begun").exists():
        assert run.poll() is None, run.communicate()[0].decode()
        time.sleep(0.05)
    if how == signal.SIGINT:
        os.killpg(run.pid, how)
    else:
        run.kill()
    run.communicate(timeout=60)
    assert gone(slow_tank.path)
    assert fixture_file(slow_tank).read_bytes() == before
