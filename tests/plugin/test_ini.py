"""Options in an ini file: the command line overrides them, and options of other modes are ignored."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl import ini
from pytest_tarl.flags import FLAGS

MARKED = """
import pytest
from pytest_tarl import Sensor

@pytest.mark.tarl(nodes=["node.py"], sensors=[Sensor("x")])
def test_node(tarl):
    print("drawn", tarl.rng("world").integers(10**9))
"""
NO_NODE = "def test_plain():\n    pass\n"


def configured(pytester: pytest.Pytester, lines: str, *flags: str) -> pytest.Config:
    pytester.makeini(f"[pytest]\n{lines}")
    pytester.makepyfile(NO_NODE)
    return pytester.parseconfig(*flags)


def read(pytester: pytest.Pytester, lines: str, *flags: str) -> dict[str, Any]:
    return ini.values(configured(pytester, lines, *flags))[0]


def test_every_flag_has_an_ini_option(pytester: pytest.Pytester) -> None:
    config = configured(pytester, "")
    for flag in FLAGS:
        assert config.getini(ini.ini_name(flag)) is None
    assert read(pytester, "")["alpha"] == 0.05


def test_the_command_line_overrides_the_ini_file(pytester: pytest.Pytester) -> None:
    lines = "tarl_seed = 7\ntarl_alpha = 0.01\ntarl_workers = auto"
    given = read(pytester, lines, "--tarl-online", "--tarl-seed=3")
    assert (given["seed"], given["alpha"], given["workers"], given["budget"]) == (3, 0.01, "auto", "300")


@pytest.mark.parametrize(("text", "said"), [("true", True), ("Yes", True), ("off", False), ("0", False)])
def test_ini_switch_accepts_every_spelling(pytester: pytest.Pytester, text: str, *, said: bool) -> None:
    assert read(pytester, f"tarl_constants = {text}", "--tarl-online")["constants"] is said


def test_a_list_has_one_entry_per_line(pytester: pytest.Pytester) -> None:
    lines = "tarl_search =\n    sweep\n    halving"
    assert read(pytester, lines, "--tarl-online", "--tarl-repair")["search"] == ["sweep", "halving"]


def test_paths_are_relative_to_the_ini_file(pytester: pytest.Pytester) -> None:
    given = read(pytester, "tarl_log = logs/missions.log", "--tarl-online")
    assert given["log"] == str(pytester.path / "logs" / "missions.log")


def test_ini_options_of_another_mode_are_ignored(pytester: pytest.Pytester) -> None:
    lines = "tarl_drift = mud\ntarl_search = sweep\ntarl_strict = true\ntarl_holm = true"
    recorded = read(pytester, lines, "--tarl-record")
    assert (recorded["drift"], recorded["search"], recorded["strict"]) == ("mud", None, False)
    compared = read(pytester, lines, "--tarl-online")
    assert (compared["search"], compared["strict"], compared["holm"]) == (None, True, True)


@pytest.mark.parametrize(
    ("lines", "asked"), [("tarl_online = true", True), ("tarl_drift = mud", False), ("", False)]
)
def test_only_a_mode_activates_the_plugin(pytester: pytest.Pytester, lines: str, *, asked: bool) -> None:
    assert ini.mode_asked(configured(pytester, lines)) is asked
    ended = pytester.runpytest("-q", "-p", "no:asyncio")
    assert ("1 deselected" if asked else "1 passed") in ended.stdout.str()


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("tarl_seed = x", "tarl_seed: it must be a whole number, got 'x'."),
        ("tarl_alpha = high", "tarl_alpha: it must be a number, got 'high'."),
        ("tarl_constants = perhaps", "tarl_constants: it must be true or false, got 'perhaps'."),
        (
            "tarl_alpha = 2",
            "--tarl-alpha: it must be a number from 1e-06 to 0.5, got 2.0. (tarl_alpha is set in ",
        ),
        ("tarl_utility = q", "(tarl_utility is set in "),
    ],
)
def test_an_invalid_value_is_reported_in_one_sentence(
    pytester: pytest.Pytester, lines: str, words: str
) -> None:
    pytester.makeini(f"[pytest]\n{lines}")
    pytester.makepyfile(NO_NODE)
    ended = pytester.runpytest("--tarl-online")
    assert ended.ret == pytest.ExitCode.USAGE_ERROR
    assert words in ended.stderr.str()
    assert "Traceback" not in ended.stderr.str()


def test_run_without_a_mode_uses_the_ini_seed(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_it=MARKED, node="")
    drawn = []
    for lines, flags in [("", ()), ("tarl_seed = 5", ()), ("", ("--tarl-seed=5",))]:
        pytester.makeini(f"[pytest]\n{lines}")
        ended = pytester.runpytest_subprocess("-q", "-s", "-p", "no:asyncio", *flags)
        assert ended.ret == 0
        drawn.append(next(line for line in ended.outlines if "drawn" in line))
    assert drawn[0] != drawn[1] == drawn[2]
