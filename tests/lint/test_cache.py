"""The cache is used if nothing changed, never gives a wrong result, and never makes a run fail."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tarl_lint.cli import main
from tarl_lint.run import cache, groups

PLACE = Path(".tarl/cache/lint")


@pytest.fixture
def node(example, in_directory) -> Path:
    return in_directory({"node.py": example.text}) / "node.py"


@pytest.fixture
def analysed(monkeypatch) -> list[str]:
    """Return the files that were analysed, not found in the cache."""
    seen: list[str] = []
    perform = groups.perform

    def noted(task, config, *parsed):
        seen.extend(script.path for script in task.scripts)
        return perform(task, config, *parsed)

    monkeypatch.setattr(groups, "perform", noted)
    return seen


def lint(capsys, *arguments: str) -> str:
    main(["--exit-zero", *arguments])
    return capsys.readouterr().out


def entries() -> list[Path]:
    return sorted(PLACE.glob("*.json"))


def test_second_run_analyses_nothing(node, capsys, analysed):
    first = lint(capsys, "--format", "json")
    assert analysed == ["node.py"]
    assert lint(capsys, "--format", "json") == first
    assert analysed == ["node.py"]


def test_the_cache_is_ignored_by_git(node, capsys):
    lint(capsys)
    assert len(entries()) == 1
    assert (PLACE / ".gitignore").read_text() == "*\n"


def test_a_cache_without_a_file_stores_nothing():
    kept = cache.Cache(None)
    kept.put("key", cache.Report())
    assert kept.report("key") is None


def test_an_edited_file_is_analysed_again(node, capsys, analysed):
    lint(capsys)
    node.write_text(node.read_text().replace("vel = 5 * delta", "vel = 5"))
    assert "No flow from a subscription" in lint(capsys)
    assert analysed == ["node.py", "node.py"]


@pytest.mark.parametrize(
    "settings", ['sanitizers = ["robot.clamp"]', 'select = ["TARL1"]', 'sources = ["robot.listen"]']
)
def test_changed_settings_invalidate_the_cache(node, capsys, analysed, settings):
    Path("pyproject.toml").write_text("[tool.tarl-lint]\n")
    lint(capsys)
    Path("pyproject.toml").write_text(f"[tool.tarl-lint]\n{settings}\n")
    lint(capsys)
    assert analysed == ["node.py", "node.py"]


def test_the_cache_of_another_version_is_ignored(node, capsys, analysed, monkeypatch):
    lint(capsys)
    monkeypatch.setattr(cache, "__version__", "0.0.0")
    lint(capsys)
    assert analysed == ["node.py", "node.py"]


def test_no_cache_option_uses_no_cache(node, capsys, analysed):
    lint(capsys, "--no-cache")
    assert not Path(".tarl").exists()
    lint(capsys)
    lint(capsys, "--no-cache")
    assert analysed == ["node.py"] * 3


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[: len(data) // 2],
        lambda data: data.replace(b"node.py", b"nude.py"),
        lambda data: b"\xff\x00" + data,
        lambda data: data.partition(b"\n")[0] + b"\n[]",
    ],
)
def test_a_damaged_cache_file_is_ignored(node, capsys, analysed, damage):
    first = lint(capsys)
    (file,) = entries()
    file.write_bytes(damage(file.read_bytes()))
    assert lint(capsys) == first
    assert analysed == ["node.py", "node.py"]
    assert lint(capsys) == first
    assert len(analysed) == 2


def test_a_cache_file_of_another_structure_is_ignored(node, capsys, analysed):
    first = lint(capsys)
    (file,) = entries()
    for value in ([], {}, 3, [{}, []], [[], {}], None):
        text = json.dumps(value)
        file.write_text(f"{cache.digest([text])}\n{text}")
        assert lint(capsys) == first


def test_an_unwritable_cache_does_not_fail_the_run(node, capsys, analysed):
    Path(".tarl").write_text("in the way\n")
    first = lint(capsys)
    assert lint(capsys) == first
    assert analysed == ["node.py", "node.py"]


def test_two_processes_share_a_cold_cache(example, node, capsys, analysed):
    for number in range(20):
        (node.parent / f"node{number}.py").write_text(example.text.replace("odom", f"odom{number}"))
    command = [sys.executable, "-m", "tarl_lint", "--exit-zero", "--format", "json"]
    runs = [subprocess.Popen(command, stdout=subprocess.PIPE) for _ in range(2)]
    one, other = (run.communicate()[0] for run in runs)
    assert [run.returncode for run in runs] == [0, 0]
    assert one == other
    assert lint(capsys, "--format", "json") == one.decode()
    assert analysed == []
    assert {path.name for path in PLACE.iterdir()} == {".gitignore", entries()[0].name}
