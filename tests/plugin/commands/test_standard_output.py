"""Each command prints to any standard output: of another encoding, closed, full or closed by its reader."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.learning.fixture import save
from tests.plugin.learning.test_fixture import example

FULL = Path("/dev/full")
COMMANDS = {
    "show": ["show", "--sites", "a.npz"],
    "diff": ["diff", "a.npz", "a.npz"],
    "watch": ["watch", "log", "--fixture", "a.npz", "--once"],
    "JSON": ["watch", "log", "--fixture", "a.npz", "--once", "--json", "-"],
}

WHOLE = "größe → 試験"
SHOWN = {
    "ascii": r"\u8a66\u9a13",
    "latin-1": r"größe \u2192 \u8a66\u9a13",
    "cp1252": r"größe \u2192 \u8a66\u9a13",
    "shift_jis": r"gr\xf6\xdfe → 試験",
    "utf-8": WHOLE,
    "utf-16": WHOLE,
}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a folder with a recording, whose test has a name beyond every 8-bit encoding, and an empty log."""
    monkeypatch.chdir(tmp_path)
    save(replace(example(), test=f"test_{WHOLE}\x9b2J"), Path("a.npz"))
    Path("log").touch()


@pytest.mark.parametrize("encoding", SHOWN)
@pytest.mark.parametrize("command", COMMANDS)
def test_characters_that_the_encoding_lacks_are_escaped(
    command: str, encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = io.BytesIO()
    stream = io.TextIOWrapper(written, encoding=encoding)
    monkeypatch.setattr(sys, "stdout", stream)
    assert main(list(COMMANDS[command])) == 0
    stream.flush()
    text = written.getvalue().decode(encoding)
    expected = SHOWN["ascii" if command == "JSON" else encoding]
    assert expected in text
    assert "\x9b" not in text


@pytest.fixture
def full() -> Iterator[io.TextIOWrapper]:
    if not FULL.exists():
        pytest.skip("there is no /dev/full on this system")
    with FULL.open("w", encoding="utf-8") as stream:
        yield stream


@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_disk_is_reported_in_one_sentence(
    command: str, full: io.TextIOWrapper, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdout", full)
    assert main(list(COMMANDS[command])) == 2
    assert capsys.readouterr().err == "tarl: Cannot write to standard output: No space left on device.\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_closed_pipe_ends_the_command_silently(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w", encoding="utf-8") as stream:
        monkeypatch.setattr(sys, "stdout", stream)
        assert main(list(COMMANDS[command])) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("command", COMMANDS)
def test_closed_standard_streams_are_not_an_error(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    assert main(list(COMMANDS[command])) == 0
    assert main(["show", "missing.npz"]) == 2
    for stream in (sys.stdout, sys.stderr):
        stream.close()
