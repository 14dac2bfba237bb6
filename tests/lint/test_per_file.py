from pathlib import Path

import pytest

from tarl_lint.model import Finding, Span
from tarl_lint.settings.per_file import FileIgnores


@pytest.mark.parametrize(
    ("pattern", "path", "silenced"),
    [
        ("tests/", "tests/a.py", True),
        ("tests/", "src/tests/deep/a.py", True),
        ("/tests/", "src/tests/a.py", False),
        ("*_demo.py", "src/arm_demo.py", True),
        ("*_demo.py", "src/arm.py", False),
        ("src/*.py", "src/a.py", True),
        ("src/*.py", "src/b/a.py", False),
        ("src/**/a.py", "src/b/c/a.py", True),
        ("a.py", "tests/a.py", True),
        ("a.py/", "a.py", False),
    ],
)
def test_patterns_match_files_and_everything_below_directories(
    tmp_path, monkeypatch, pattern, path, silenced
):
    monkeypatch.chdir(tmp_path)
    ignores = FileIgnores(Path(), [(pattern, ("TARL1",))])
    assert ignores.silences(Finding("TARL101", Span(path, 1, 1, 1, 2), "")) is silenced


def test_named_rules_are_silenced_only_below_the_root(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ignores = FileIgnores(tmp_path / "src", [("*.py", ("TARL102", "TARL2"))])

    def silenced(code: str, path: str) -> bool:
        return ignores.silences(Finding(code, Span(path, 1, 1, 1, 2), ""))

    assert not silenced("TARL101", "src/a.py")
    assert silenced("TARL102", "src/a.py")
    assert silenced("TARL203", "src/a.py")
    assert not silenced("TARL102", "a.py")
