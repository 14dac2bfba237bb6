"""Tests of what the guide says about classes, fixtures, debuggers, skips and interrupts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.plugin.tank import RECORD, changed, columns_of, fixture_file

FEW = ("--tarl-record", "--tarl-episodes=6")
HEAD = "def test_fills(tarl, tarl_drift):\n"
MARK = "@pytest.mark.tarl("


def fixture_of(tank: pytest.Pytester, *flags: str) -> bytes:
    tank.runpytest(*FEW, *flags).assert_outcomes(passed=1, deselected=1)
    return fixture_file(tank).read_bytes()


def lines_of(path: Path) -> list[str]:
    return path.read_text().splitlines()


def test_the_debugger_opens_at_each_failed_episode_and_continues(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 0.1")
    asked = "p 'level is', round(level, 1)\nc\n" * 9
    told = tank.run(sys.executable, "-m", "pytest", *FEW, "--pdb", stdin=asked.encode())
    told.assert_outcomes(failed=1, deselected=1)
    shown = [line for line in told.outlines if "('level is', 0." in line]
    assert len(shown) == 6


def test_quitting_the_debugger_ends_the_run(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 0.1")
    told = tank.run(sys.executable, "-m", "pytest", *FEW, "--pdb", stdin=b"q\n")
    assert told.ret == pytest.ExitCode.INTERRUPTED
    assert told.stdout.str().count("(Pdb)") == 1


def test_methods_of_classes_run_with_setup_in_every_episode(tank: pytest.Pytester) -> None:
    head, body = (tank.path / "test_tank.py").read_text().split(MARK, 1)
    body, ordinary = body.split("def test_ordinary", 1)
    body = body.replace("(tarl, tarl_drift)", "(self, tarl, tarl_drift)")
    body = body.replace("assert abs", "self.filled = level; assert abs")
    inside = "".join(f"    {line}\n" if line else "\n" for line in (MARK + body).splitlines())
    (tank.path / "test_tank.py").write_text(
        f"""{head}
from pathlib import Path

def note(text):
    with Path("order.txt").open("a") as file:
        print(text, file=file)


class TestTank:
    @classmethod
    def setup_class(cls):
        note("class")

    def setup_method(self):
        note("method")
        assert not hasattr(self, "filled")
        self.filled = 0.0

    def teardown_method(self):
        note(f"after {{self.filled > 0}}")

{inside}

def test_ordinary{ordinary}"""
    )
    tank.runpytest(*FEW).assert_outcomes(passed=1, deselected=1)
    episodes = 6 + 1  # the first seed runs twice
    assert lines_of(tank.path / "order.txt") == ["class", *["method", "after True"] * episodes]


@pytest.mark.parametrize("scope", ["function", "module"])
def test_fixtures_requested_by_name_are_fresh_in_every_episode(tank: pytest.Pytester, scope: str) -> None:
    before = columns_of(fixture_of(tank))
    tank.makeconftest(
        f"""
        from pathlib import Path
        import pytest

        @pytest.fixture(scope="{scope}")
        def pump():
            with Path("pumps.txt").open("a") as file:
                print("on", file=file)
            yield
            with Path("pumps.txt").open("a") as file:
                print("off", file=file)
        """
    )
    changed(tank, "test_tank", MARK, f'@pytest.mark.usefixtures("pump")\n{MARK}')
    assert columns_of(fixture_of(tank)) == before
    assert lines_of(tank.path / "pumps.txt") == ["on", "off"] * (7 if scope == "function" else 1)


def test_a_skip_in_an_episode_skips_the_test(tank: pytest.Pytester) -> None:
    changed(
        tank, "test_tank", HEAD, f'{HEAD}    if tarl.rng("luck").random() < 0.5: pytest.skip("no water")\n'
    )
    told = tank.runpytest(*FEW, "-rs")
    told.assert_outcomes(skipped=1, deselected=1)
    told.stdout.fnmatch_lines(["*no water*"])
    assert not (tank.path / ".tarl" / "utility").exists()


def test_a_call_to_xfail_counts_as_a_failed_mission(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", HEAD, f'{HEAD}    if tarl.rng("luck").random() < 0.5: pytest.xfail("leaks")\n')
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*episodes failed*The first failure: leaks*"])


def test_an_interrupt_between_episodes_keeps_the_old_recording_only(
    tank: pytest.Pytester,
) -> None:
    changed(tank, "test_tank", HEAD, f'{HEAD}    print("begun", flush=True)\n')
    before = fixture_of(tank)
    files = sorted(path for path in tank.path.rglob("*") if "__pycache__" not in path.parts)
    # An interrupt between opening a file and the `with` around it leaves the file to the garbage collector
    quiet = ["-W", "ignore::pytest.PytestUnraisableExceptionWarning", "-W", "ignore::ResourceWarning"]
    command = [sys.executable, "-m", "pytest", "-s", "-p", "no:cacheprovider", *quiet, "--tarl-record"]
    run = subprocess.Popen(
        [*command, "--tarl-episodes=100000", "--tarl-seed=7"],
        cwd=tank.path,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert run.stdout is not None
    for _ in range(5):
        while "begun" not in (line := run.stdout.readline()):
            assert line, "it ended before"
    run.send_signal(signal.SIGINT)
    told, _ = run.communicate(timeout=60)
    assert run.returncode == pytest.ExitCode.INTERRUPTED, told
    assert "KeyboardInterrupt" in told
    assert fixture_file(tank).read_bytes() == before
    unfinished = tank.path / ".tarl" / "unfinished"
    left = [path for path in tank.path.rglob("*") if not {"__pycache__", "unfinished"} & {*path.parts}]
    assert sorted(left) == files
    assert [path.suffix for path in unfinished.iterdir()] == [".episodes"]
