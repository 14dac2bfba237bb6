"""Episodes and pytest's own features: xfail, skips, interrupts, captured output, parameters."""

from __future__ import annotations

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed

MARK = "@pytest.mark.tarl("


@pytest.mark.parametrize("strict", [False, True])
def test_an_expected_failure_counts_as_a_failed_mission(tank: pytest.Pytester, strict: bool) -> None:
    changed(tank, "test_tank", MARK, f"@pytest.mark.xfail(strict={strict})\n{MARK}")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 0.1")
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*5 of the first 5 episodes failed*the other 11 were not run*tank not full*"])


def test_a_test_marked_to_be_skipped_is_skipped(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", MARK, f'@pytest.mark.xfail(run=False, reason="no pump")\n{MARK}')
    told = tank.runpytest(*RECORD, "-rs")
    told.assert_outcomes(skipped=1, deselected=1)
    told.stdout.fnmatch_lines(["*no pump*"])


def test_only_the_output_of_the_last_episode_is_shown(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "    draws = tarl.rng", '    print("begun")\n    draws = tarl.rng')
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 0.1")
    assert tank.runpytest(*RECORD).stdout.str().count("begun") == 1


@pytest.mark.parametrize("place", ["    yield\n    ", "    "])
def test_an_interrupt_ends_the_run(tank: pytest.Pytester, place: str) -> None:
    tank.makeconftest(
        f"""
import pytest

@pytest.fixture(scope="module", autouse=True)
def wide():
{place}raise KeyboardInterrupt
    yield
"""
    )
    told = tank.runpytest_subprocess(*RECORD)  # in-process, the interrupt would end the outer pytest run
    assert told.ret == pytest.ExitCode.INTERRUPTED


def test_exit_in_a_test_ends_the_run(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "    draws = tarl.rng", '    pytest.exit("enough")\n    draws = tarl.rng')
    tank.runpytest(*RECORD).stdout.fnmatch_lines(["*Exit: enough*"])


def test_teardown_error_is_no_failed_mission(tank: pytest.Pytester) -> None:
    tank.makeconftest(
        """
        import pytest

        @pytest.fixture(autouse=True)
        def narrow():
            yield
            raise ValueError("left open")
        """
    )
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*failed outside the mission*", "*left open*"])


def test_test_without_the_fixture_is_refused(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "(tarl, tarl_drift):", "():\n    print('ran')")
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["The test does not use the fixture `tarl`: take it as an argument."])
    told.stdout.no_fnmatch_line("*ran*")


def test_unittest_method_gets_fixture_advice(tank: pytest.Pytester) -> None:
    tank.path.joinpath("test_case.py").write_text(
        """
import unittest
import pytest
from pytest_tarl import Sensor

class TestTank(unittest.TestCase):
    @pytest.mark.tarl(nodes=["keeper.py"], sensors=[Sensor("level", topic="/level", field="data", bins=4)])
    def test_fills(self, tarl=None):
        pass
"""
    )
    told = tank.runpytest("--tarl-record", "test_case.py")
    told.stdout.fnmatch_lines(["*unittest.TestCase cannot take it as an argument*TestTank*autouse=True*"])


@pytest.mark.parametrize("flags", [(), ("--tarl-drift=clogged",)])
def test_drifts_without_the_fixture_tarl_drift_are_refused(
    tank: pytest.Pytester, flags: tuple[str, ...]
) -> None:
    changed(tank, "test_tank", "(tarl, tarl_drift):", "(tarl):\n    tarl_drift = None")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    told = tank.runpytest(*ONLINE, *flags)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*does not use the fixture `tarl_drift`*"])


@pytest.mark.parametrize("drifts", ["5", "None", "{1: 2}"])
def test_an_invalid_marker_is_reported_in_one_sentence(tank: pytest.Pytester, drifts: str) -> None:
    changed(tank, "test_tank", '{"clogged": 0.25}', drifts)
    told = tank.runpytest(*ONLINE)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*drifts maps names to values*"])
    told = tank.runpytest(*ONLINE, "--tarl-drift=clogged")
    assert told.ret == pytest.ExitCode.USAGE_ERROR
    told.stderr.fnmatch_lines(["*drifts maps names to values*"])


def test_tests_with_any_parameter_ids_have_their_own_recordings(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", MARK, f'@pytest.mark.parametrize("pump", ["clogged", "clogged-2"])\n{MARK}')
    changed(tank, "test_tank", "(tarl, tarl_drift)", "(tarl, tarl_drift, pump)")
    tank.runpytest(*RECORD).assert_outcomes(passed=2, deselected=1)
    assert len(list((tank.path / ".tarl" / "utility").glob("*.npz"))) == 2
    told = tank.runpytest(*ONLINE)
    told.assert_outcomes(failed=2, deselected=1)
    assert told.stdout.str().count(": degraded") >= 2


def test_a_sensor_that_is_always_nan_is_reported(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "Float64(data=level +", 'Float64(data=float("nan") +')
    changed(tank, "test_tank", "tarl.reward(-abs(1.0 - level))", "tarl.reward(1.0)")
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*'level' was NaN*"])


def test_parts_of_a_reward_must_be_finite_numbers(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "tarl.reward(-abs(1.0 - level))", 'tarl.reward(1.0, depth=float("nan"))')
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*rewards must be finite*"])


def test_failures_that_earn_more_are_reported(tank: pytest.Pytester) -> None:
    changed(
        tank,
        "test_tank",
        "        tarl.reward(",
        '        assert pump == 1.0, "no pressure"\n        tarl.reward(',
    )
    changed(tank, "test_tank", "    for _ in range(25):", "    tarl.reward(0.0)\n    for _ in range(25):")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    told = tank.runpytest(*ONLINE)
    told.assert_outcomes(failed=1, deselected=1)
    assert "missions succeed in 0 % of the episodes, instead of 100 %" in " ".join(told.stdout.str().split())
