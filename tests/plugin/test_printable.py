"""No control sequence from file contents, topics, patch headers or messages reaches the terminal."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pytest_tarl.commands.cli import main
from pytest_tarl.learning.fixture import save
from pytest_tarl.printable import printable, printable_line
from tests.plugin.commands.test_confined import PATCH, robot, sealed
from tests.plugin.learning.test_fixture import example as sound_fixture
from tests.plugin.tank import RECORD, changed
from tests.slow import slow

HOSTILE = "\x1b]0;owned\x07\x1b[2J\x9b31m\u202egnp.exe\u2066\x00\x08\r"
COMMANDS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff]")


@given(st.text(st.characters()) | st.text("\x1b[]\x9b;\x07\u202e\r\n0m"))
@example(HOSTILE)
def test_control_sequences_are_removed_and_text_is_kept(text: str) -> None:
    shown = printable(text)
    assert not COMMANDS.search(shown)
    assert shown.encode() is not None  # fails if a surrogate remains
    assert "\n" not in printable_line(text)
    if all(unicodedata.category(one)[0] in "LNPSZM" and one not in "\u2028\u2029" for one in text):
        assert shown == text


def told(capsys: pytest.CaptureFixture[str], *command: str) -> str:
    main(command)
    printed = capsys.readouterr()
    return printed.out + printed.err


def test_show_and_diff_print_no_control_sequences(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain = sound_fixture()
    place = replace(plain.lists[0].sites[0], code=f"x = '{HOSTILE}'", path=f"{HOSTILE}.py", id=HOSTILE)
    first = replace(plain.lists[0], source=f"/in{HOSTILE}", sites=(place, *plain.lists[0].sites[1:]))
    hostile = replace(plain, lists=(first, *plain.lists[1:]), test=f"test_{HOSTILE}\nforged line")
    path, other = tmp_path / "a.npz", tmp_path / "b.npz"
    save(hostile, path)
    save(plain, other)
    for text in (told(capsys, "show", "--sites", str(path)), told(capsys, "diff", str(path), str(other))):
        assert "owned" in text
        assert not COMMANDS.search(text)
        assert "\nforged line" not in text


@pytest.mark.parametrize("command", ["apply", "suggest"])
def test_headers_of_patches_contain_no_control_sequences(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    hostile = HOSTILE.replace("\r", "").encode()
    with robot() as (_, place):
        place.write_bytes(
            sealed(PATCH.replace(b"again: ", b"again: " + hostile).replace(b"5 \xe2\x86\x92", hostile))
        )
        text = told(capsys, command, str(place))
    assert "owned" in text
    assert not COMMANDS.search(text)


def test_names_of_missing_files_are_printed_without_control_sequences(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for command in ("apply", "revert", "suggest", "show"):
        text = told(capsys, command, f"{HOSTILE.replace(chr(0), '')}.patch")
        assert "owned" in text
        assert not COMMANDS.search(text)


@slow
def test_errors_of_nodes_are_printed_without_control_sequences(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "            flow = GAIN * missing", "            flow = GAIN * missing / FACTOR")
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 2.0\nFACTOR = 1.0\n")
    assert tank.runpytest_subprocess(*RECORD).ret == 0
    ending = f"            if missing:\n                raise ValueError({HOSTILE!a})\n"
    ending += "            flow = GAIN * missing / FACTOR"
    changed(tank, "keeper", "            flow = GAIN * missing / FACTOR", ending)
    for flags in ((), RECORD, ("--tarl-online", "--tarl-episodes=6")):
        done = tank.runpytest_subprocess("test_tank.py", "--color=no", *flags)
        assert "owned" in done.stdout.str() or "--tarl-online" in flags
        assert not COMMANDS.search(done.stdout.str().replace("\r\n", "\n"))
