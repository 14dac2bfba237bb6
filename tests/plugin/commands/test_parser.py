"""Invalid command lines of `tarl`, and shell completion."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pytest_tarl.commands.cli import main


@pytest.mark.parametrize(
    ("words", "usage", "sentence"),
    [
        (["dif", "a", "b"], "usage: tarl [-h]", "tarl: There is no command 'dif': did you mean 'diff'?"),
        (["qqq"], "usage: tarl [-h]", "tarl: There is no command 'qqq'."),
        (
            [],
            "usage: tarl [-h]",
            "tarl: Name one of the commands above, as in `tarl show .tarl/utility/NAME.npz`.",
        ),
        (["diff"], "usage: tarl diff", "tarl diff: first is missing."),
        (["diff", "a.npz"], "usage: tarl diff", "tarl diff: Name a second recording to compare with a.npz."),
        (["watch"], "usage: tarl watch", "tarl watch: LOG and --fixture are missing."),
        (["diff", "a", "b", "c"], "usage: tarl diff", "tarl diff: Unknown argument 'c'."),
        (["show", "--site", "--x"], "usage: tarl show", "tarl show: fixture is missing."),
        (
            ["diff", "a", "b", "--alpha", "x"],
            "usage: tarl diff",
            "tarl diff: Argument --alpha: invalid float value: 'x'.",
        ),
    ],
)
def test_invalid_command_line_shows_the_usage(
    words: list[str], usage: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith(usage)
    command = sentence.partition(":")[0]
    assert said.endswith(f"\n{sentence} Run {command} --help for more.\n")
    assert ("positional arguments:" in said) == (words == [])  # the list of commands, if none is given


@pytest.mark.parametrize("parser", ["pytest_tarl.commands.cli.parser", "tarl_lint.options.parser"])
def test_shells_get_completions_from_the_parsers(parser: str, tmp_path: Path) -> None:
    made = subprocess.run(
        [sys.executable, "-m", "shtab", "--shell=bash", parser], capture_output=True, text=True, check=True
    )
    script = tmp_path / "completion"
    script.write_text(made.stdout)
    assert ("--format" if "lint" in parser else "revert") in made.stdout
    if bash := shutil.which("bash"):
        subprocess.run([bash, "-n", script], check=True)


def test_a_folder_given_as_a_recording_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert said == f"tarl: {tmp_path} is a folder. Name a file in it, such as NAME.npz.\n"
