"""Runs with common plugins and options: the same recording, one report, no additional episode."""

from __future__ import annotations

import importlib.util
import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from pytest_tarl.learning.fixture import load
from tests.plugin.learning.test_statistics import same
from tests.plugin.tank import NODE, changed, fixture_file
from tests.slow import slow

MARK = "@pytest.mark.tarl("
FEW = ("--tarl-record", "--tarl-episodes=6")
ASYNCIO = (
    "-p",
    "asyncio",
    "-o",
    "asyncio_default_fixture_loop_scope=function",
    "-W",
    "ignore:Module already",
)
BROKEN = ("keeper", "GAIN = 2.0", "GAIN = 0.1")


def needs(module: str) -> pytest.MarkDecorator:
    """Skip if a plugin is missing; pip install 'tarl[dev]' installs all of them."""
    return pytest.mark.skipif(importlib.util.find_spec(module) is None, reason=f"{module} is not installed")


@pytest.fixture(scope="module")
def plain() -> dict[str, bytes]:
    return {}


@pytest.fixture
def tank(tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """The project with every plugin that is installed, as for a user."""
    monkeypatch.delenv("PYTEST_ADDOPTS")
    return tank


@pytest.fixture
def expected(tank: pytest.Pytester, plain: dict[str, bytes]) -> bytes:
    """The recording made without other plugins, once for all tests."""
    if not plain:
        tank.runpytest(*FEW).assert_outcomes(passed=1, deselected=1)
        plain["fixture"] = fixture_file(tank).read_bytes()
        fixture_file(tank).unlink()
    return plain["fixture"]


TOOLS = {
    "pytest_timeout": ("--timeout=60",),
    "pytest_rerunfailures": ("-p", "rerunfailures", "--reruns=2"),
    "pytest_randomly": ("-p", "randomly"),
    "pytest_cov": ("--cov=.", "--cov-branch"),
}
THEIRS = tuple(flag for tool, flags in TOOLS.items() if importlib.util.find_spec(tool) for flag in flags)


@pytest.mark.parametrize(
    "flags",
    [
        pytest.param(THEIRS, id="other plugins"),
        pytest.param(("--import-mode=prepend", "-s", "-vv", "--setup-show", "--durations=0"), id="loud"),
        pytest.param(
            ("--import-mode=append", "--assert=plain", "-p", "no:logging", "--capture=sys"), id="bare"
        ),
        pytest.param(
            ("--import-mode=importlib", "-p", "no:warnings", "-p", "no:cacheprovider"), id="importlib"
        ),
    ],
)
def test_another_plugin_does_not_change_the_recording(
    tank: pytest.Pytester, expected: bytes, flags: tuple[str, ...]
) -> None:
    told = tank.runpytest_subprocess(*FEW, *flags)
    assert told.ret == pytest.ExitCode.OK
    assert fixture_file(tank).read_bytes() == expected
    told.stdout.fnmatch_lines(["*wrote .tarl/utility/*", "*1 passed*"])


@slow
def test_an_xdist_process_writes_the_same_recording(tank: pytest.Pytester, expected: bytes) -> None:
    told = tank.runpytest_subprocess(*FEW, "-n", "2")
    assert told.ret == pytest.ExitCode.OK
    assert fixture_file(tank).read_bytes() == expected
    told.stdout.fnmatch_lines(["*wrote .tarl/utility/*", "*1 passed*"])


@needs("pytest_asyncio")
@pytest.mark.parametrize("mode", ["strict", "auto"])
def test_a_coroutine_test_is_run_for_every_episode(tank: pytest.Pytester, expected: bytes, mode: str) -> None:
    mark = "@pytest.mark.asyncio\n" if mode == "strict" else ""
    changed(tank, "test_tank", MARK, f"{mark}{MARK}")
    changed(tank, "test_tank", "def test_fills", "async def test_fills")
    changed(
        tank, "test_tank", "        tarl.step(0.1)", "        await asyncio.sleep(0)\n        tarl.step(0.1)"
    )
    changed(tank, "test_tank", "import pytest\n", "import asyncio\nimport pytest\n")
    flags = (*ASYNCIO, "-o", f"asyncio_mode={mode}")
    tank.runpytest(*FEW, *flags).assert_outcomes(passed=1, deselected=1)
    found = load(fixture_file(tank))  # the source of the test differs, but the recorded data is equal
    before = tank.path / "before.npz"
    before.write_bytes(expected)
    assert same(found.sample, load(before).sample)
    assert found.sensors == load(before).sensors


@needs("anyio")
def test_anyio_coroutine_runs_in_every_episode(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", MARK, f"@pytest.mark.anyio\n{MARK}")
    changed(tank, "test_tank", "def test_fills", "async def test_fills")
    tank.makeconftest("import pytest\n\n@pytest.fixture\ndef anyio_backend():\n    return 'asyncio'\n")
    tank.runpytest(*FEW).assert_outcomes(passed=1, deselected=1)
    assert fixture_file(tank)


def test_a_coroutine_test_without_a_runner_is_reported(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "def test_fills", "async def test_fills")
    told = tank.runpytest(*FEW, "-p", "no:anyio")
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*async def functions are not natively supported*"])


@needs("pytest_rerunfailures")
@pytest.mark.parametrize("mark", ["", "@pytest.mark.flaky(reruns=2)\n"])
def test_a_failed_mission_is_not_rerun(tank: pytest.Pytester, mark: str) -> None:
    changed(tank, *BROKEN)
    changed(tank, "test_tank", MARK, f"{mark}{MARK}")
    told = tank.runpytest_subprocess(*FEW, "-p", "rerunfailures", "--reruns", "2")
    told.assert_outcomes(failed=1, deselected=1)
    assert "rerun" not in told.parseoutcomes()


@needs("pytest_timeout")
@pytest.mark.parametrize("func_only", [False, True])
def test_a_timeout_applies_to_each_episode(tank: pytest.Pytester, func_only: bool) -> None:
    changed(tank, "test_tank", MARK, f"@pytest.mark.timeout(60, func_only={func_only})\n{MARK}")
    tank.makeconftest(
        """
        import pytest
        seen = []

        @pytest.hookimpl(tryfirst=True)
        def pytest_timeout_set_timer(item, settings): seen.append(settings.timeout)

        @pytest.hookimpl(tryfirst=True)
        def pytest_timeout_cancel_timer(item): seen.append("cancelled")

        def pytest_unconfigure():
            print("limits", seen[:14] == [60, "cancelled"] * 7, seen[14:])
        """
    )
    tank.runpytest(*FEW, "-s").stdout.fnmatch_lines(["limits True *"])


@needs("pytest_timeout")
def test_timed_out_episode_ends_the_recording(tank: pytest.Pytester) -> None:
    changed(
        tank, "test_tank", "    draws = tarl.rng", "    import time\n    time.sleep(60)\n    draws = tarl.rng"
    )
    told = tank.runpytest(*FEW, "--timeout=1")
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*Stopped at an episode (seed *) that did not end: Timeout (>1.0s)*"])


def covered(tank: pytest.Pytester, *flags: str) -> object:
    path = tank.path / "coverage.json"
    tank.runpytest_subprocess("--cov=.", "--cov-branch", f"--cov-report=json:{path}", "-k", "fills", *flags)
    found = json.loads(path.read_text())["files"]["keeper.py"]
    return [
        found[key] for key in ("executed_lines", "missing_lines", "executed_branches", "missing_branches")
    ]


@needs("pytest_cov")
def test_coverage_is_the_same_without_recording(tank: pytest.Pytester) -> None:
    plain = covered(tank)
    assert covered(tank, *FEW) == plain


def test_a_failed_test_counts_as_one_failure(tank: pytest.Pytester) -> None:
    changed(tank, *BROKEN)
    (tank.path / "test_zebra.py").write_text((tank.path / "test_tank.py").read_text())
    told = tank.runpytest(*FEW, "--maxfail=2", "--junitxml=found.xml")
    told.assert_outcomes(failed=2, deselected=2)
    cases = ElementTree.parse(tank.path / "found.xml").getroot().findall(".//testcase")
    assert [case.get("name") for case in cases] == ["test_fills", "test_fills"]
    for case in cases:
        assert float(case.get("time", "0")) > 0
        (failure,) = case
        assert "episodes failed" in str(failure.get("message")) + str(failure.text)


def test_exitfirst_ends_the_run_at_the_first_failure(tank: pytest.Pytester) -> None:
    changed(tank, *BROKEN)
    (tank.path / "test_zebra.py").write_text((tank.path / "test_tank.py").read_text())
    told = tank.runpytest(*FEW, "-x")
    told.assert_outcomes(failed=1, deselected=2)
    told.stdout.fnmatch_lines(["*stopping after 1 failures*"])


def test_the_duration_is_the_sum_over_all_episodes(tank: pytest.Pytester) -> None:
    told = tank.runpytest(*FEW, "--durations=3", "-vv")
    (line,) = [line for line in told.outlines if re.search(r"^\d+\.\d+s call ", line)]
    assert line.endswith("test_tank.py::test_fills")


def test_the_debugger_opens_in_the_episode_that_failed(tank: pytest.Pytester) -> None:
    changed(tank, *BROKEN)
    tank.makeconftest(
        """
        class Debugger:
            def __init__(self, *_, **__): pass
            def reset(self): pass
            def interaction(self, frame, error): print("entered", frame, type(error).__name__)
        """
    )
    told = tank.runpytest(*FEW, "--pdb", "--pdbcls=conftest:Debugger", "-s")
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*assert 0* < 0.1*"])


def test_nodes_in_a_src_layout_are_recorded(tank: pytest.Pytester) -> None:
    package = tank.path / "src" / "robot"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "gains.py").write_text("GAIN = 2.0\n")
    (package / "keeper.py").write_text(NODE.replace("GAIN = 2.0", "from robot.gains import GAIN"))
    (tank.path / "keeper.py").unlink()
    (tank.path / "tests").mkdir()
    (tank.path / "test_tank.py").rename(tank.path / "tests" / "test_tank.py")
    changed(tank, "tests/test_tank", 'nodes=["keeper.py"]', 'nodes=["../src/robot/keeper.py"]')
    changed(tank, "tests/test_tank", 'tarl.start("keeper.py")', 'tarl.start("../src/robot/keeper.py")')
    told = tank.runpytest(*FEW, "-o", "pythonpath=src", "--import-mode=importlib")
    told.assert_outcomes(passed=1, deselected=1)
    told.stdout.no_fnmatch_line("*no step of*")
    assert Path(fixture_file(tank)).exists()
