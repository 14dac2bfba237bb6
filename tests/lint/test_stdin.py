"""Text from standard input, as editors send it."""

import io
import json
import sys
from pathlib import Path

import pytest

from tarl_lint.cli import main


@pytest.fixture
def lint(monkeypatch, capsys):
    def go(text: str, *arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
        code = main(arguments)
        return code, *capsys.readouterr()

    return go


def test_stdin_replaces_the_text_of_the_named_file(example, in_directory, lint):
    in_directory({"src/node.py": "x = 1\n"})
    code, out, _ = lint(example.text, "-", "--stdin-filename", "src/node.py", "--format", "concise")
    assert code == 1
    assert out.startswith("src/node.py:18:9 TARL101 ")


def test_stdin_needs_no_existing_file(example, in_directory, lint):
    in_directory({})
    assert lint(example.text, "-", "--format", "concise")[1].startswith("stdin.py:18:9 TARL101 ")
    assert lint(example.text, "-", "--stdin-filename", "new/a.py", "--format", "concise")[1].startswith(
        "new/a.py:18"
    )


def test_other_files_are_read_from_disk(example, in_directory, lint):
    in_directory({"node.py": "x = 1\n", "other.py": example.text})
    _, out, _ = lint(example.text, "-", ".", "--stdin-filename", "node.py", "--format", "json")
    assert [d["path"] for d in json.loads(out)["diagnostics"]] == ["node.py", "other.py"]


def test_the_settings_of_the_named_file_are_used(example, in_directory, lint):
    in_directory({"package/pyproject.toml": '[tool.tarl-lint]\nignore = ["TARL101"]\n'})
    assert lint(example.text, "-", "--stdin-filename", "package/node.py")[0] == 0
    assert lint(example.text, "-", "--stdin-filename", "node.py")[0] == 1


def test_unreadable_stdin_is_reported_like_an_unreadable_file(in_directory, lint):
    in_directory({})
    assert (
        "a.py:1:1 TARL001 The file is not valid Python" in lint("def (", "-", "--stdin-filename", "a.py")[1]
    )


def test_a_file_name_without_text_is_refused(in_directory, lint):
    in_directory({"a.py": ""})
    code, _, err = lint("", "a.py", "--stdin-filename", "a.py")
    assert (code, err) == (
        2,
        "tarl-lint: --stdin-filename needs text on standard input: add - to the paths.\n",
    )


def test_standard_input_is_read_only_on_request(in_directory, monkeypatch):
    in_directory({"a.py": ""})
    monkeypatch.setattr(sys, "stdin", None)
    assert main([str(Path("a.py"))]) == 0
