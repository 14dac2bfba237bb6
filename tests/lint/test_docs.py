"""The examples in docs/lint.md and docs/ci.md match the tool."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tarl_lint.cli import main
from tarl_lint.options import parser
from tarl_lint.report import FORMATS
from tarl_lint.settings.config import Options, resolve
from tarl_lint.settings.schema import KEYS
from tarl_lint.settings.wrappers import facts

ROOT = Path(__file__).parents[2]
PICTURED = ("examples/line_follower/line_follower.py", "examples/shuttle/traveller.py")
LINT, CI = ((ROOT / "docs" / name).read_text("utf-8") for name in ("lint.md", "ci.md"))


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)


@pytest.fixture
def output(monkeypatch, capsys):
    """Return the tool's output in the root of the project."""

    def of(*arguments: str) -> str:
        monkeypatch.chdir(ROOT)
        main(arguments)
        return capsys.readouterr().out

    return of


@pytest.mark.parametrize("command", re.findall(r"^\$ tarl-lint (examples.*)$", LINT, re.MULTILINE))
def test_guide_console_output_matches_the_tool(output, command):
    (shown,) = (b for b in blocks(LINT, "console") if b.startswith(f"$ tarl-lint {command}\n"))
    assert output(*command.split()) == shown.partition("\n")[2]


def test_guide_picture_matches_the_tool(output):
    assert blocks(LINT, "mermaid") == [output(*PICTURED, "--format", "mermaid")]


def test_guide_annotation_matches_the_tool(output):
    (shown,) = (line for line in CI.splitlines() if line.startswith("::") and "title=TARL" in line)
    assert shown in output("examples/shuttle/traveller.py", "--format", "github").splitlines()


def test_every_format_option_and_key_is_described():
    options = {o for action in parser()._actions for o in action.option_strings if o.startswith("--")}
    missing = [o for o in sorted(options - {"--help", "--version"}) if o not in LINT]
    assert missing == []
    assert [name for name in FORMATS if f"`{name}`" not in LINT] == []
    assert [key for key in KEYS if key not in "".join(blocks(LINT, "toml"))] == []


def test_the_example_settings_are_valid(in_directory):
    (text,) = blocks(LINT, "toml")
    in_directory(
        {"pyproject.toml": text, "tarl-flows.json": '{"format": 1, "tool": "tarl-lint", "flows": []}'}
    )
    config = resolve(Options())
    assert set(facts(config.wrappers)) == {"robot.bus.subscribe", "robot.bus.advertise"}
