"""Printed commands can be pasted in the folder in which pytest was started."""

from __future__ import annotations

import shlex

import pytest

from tests.plugin.tank import NODE, TEST


@pytest.fixture
def nested(pytester: pytest.Pytester) -> pytest.Pytester:
    """A project whose root is a folder below the current one."""
    folder = pytester.mkdir("tank")
    (folder / "pytest.ini").write_text("[pytest]\n")
    (folder / "keeper.py").write_text(NODE)
    (folder / "test_tank.py").write_text(TEST)
    return pytester


def printed(result: pytest.RunResult, label: str) -> list[str]:
    line = next(line for line in result.outlines if line.split()[:1] == [label])
    return shlex.split(line.partition(label)[2])


def test_printed_commands_name_the_test_from_the_folder(
    nested: pytest.Pytester,
) -> None:
    test = "tank/test_tank.py::test_fills"
    nested.runpytest(test, "--tarl-record", "--tarl-episodes=16").assert_outcomes(passed=1)
    result = nested.runpytest(test, "--tarl-online", "--tarl-episodes=12", "--tarl-alpha=0.1")
    again = printed(result, "again")
    assert again == [
        "pytest", test, "--tarl-online", "--tarl-drift", "clogged", "--tarl-episodes", "12", "--tarl-alpha", "0.1",
    ]  # fmt: skip
    assert printed(result, "next") == [*again, "--tarl-repair"]
    nested.runpytest(*again[1:]).assert_outcomes(failed=1)


def test_the_command_for_a_missing_recording_can_be_pasted(nested: pytest.Pytester) -> None:
    result = nested.runpytest("tank", "--tarl-online", "--tarl-strict")
    assert "run `pytest tank/test_tank.py::test_fills --tarl-record` first" in result.stdout.str()


@pytest.mark.parametrize("position", ["before", "after"])
def test_printed_commands_keep_the_parameters_of_the_test(nested: pytest.Pytester, position: str) -> None:
    arguments = "(tarl, tarl_drift, size)" if position == "after" else "(size, tarl, tarl_drift)"
    two = TEST.replace(
        "@pytest.mark.tarl(", '@pytest.mark.parametrize("size", ["a b", 2])\n@pytest.mark.tarl('
    )
    nested.path.joinpath("tank", "test_tank.py").write_text(two.replace("(tarl, tarl_drift)", arguments))
    one = "tank/test_tank.py::test_fills[a b]"
    missing = nested.runpytest("tank", "--tarl-online", "--tarl-strict")
    assert f"run `pytest '{one}' --tarl-record` first" in missing.stdout.str()
    nested.runpytest(one, "--tarl-record", "--tarl-episodes=16").assert_outcomes(passed=1)
    result = nested.runpytest("tank", "--tarl-online", "--tarl-episodes=12", "-k", "not 2")
    again = printed(result, "again")
    assert "a b" in again[1]
    repeated = nested.runpytest(*again[1:])
    repeated.assert_outcomes(failed=1)
    assert printed(repeated, "again")[1] == again[1]


@pytest.mark.parametrize("flag", ["--tarl-drift=clogged", "--tarl-strict", "--tarl-search=sweep"])
def test_a_flag_without_a_mode_is_refused(nested: pytest.Pytester, flag: str) -> None:
    result = nested.runpytest("tank", flag)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*needs --tarl-online*"])
