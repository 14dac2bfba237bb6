"""Each format of a report and of a system prints exactly what is recorded under tests/lint/gold."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tarl_lint import __version__
from tarl_lint.cli import main
from tarl_lint.report import FORMATS
from tests.lint.gold_files import expected
from tests.lint.test_cases import CASES

WORKSPACE = Path(__file__).parents[2] / "examples" / "workspace"
FILES = (
    "state/combined.py",
    "state/module_message.py",
    "combined/behaviour_tree.py",
    "calls/helpers_in_modules",
)
OPTIONS = {
    "all": ("--all-steps", "--select", "TARL101,TARL2"),
    "few": ("--max-paths", "2", "--show-paths"),
    "none": ("--max-paths", "0", "--statistics"),
    "paths": ("--show-paths", "--ignore", "TARL102"),
}
SYSTEMS = {
    "svg": ("--format", "svg"),
    "mermaid": ("--format", "mermaid"),
    "dot": ("--format", "dot"),
    "concise": ("--format", "concise"),
    "junit": ("--format", "junit"),
    "text": (),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of some cases; the first test analyses the copy, and the other tests read the cache."""
    copy = tmp_path_factory.mktemp("cases")
    for name in FILES:
        (copy / name).parent.mkdir(exist_ok=True)
        (shutil.copytree if (CASES / name).is_dir() else shutil.copy)(CASES / name, copy / name)
    return copy


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the example workspace."""
    return Path(shutil.copytree(WORKSPACE, tmp_path_factory.mktemp("copy") / "workspace"))


def output(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Return the output of a run, without the parts that depend on the release and the folder."""
    main([*arguments, "--jobs", "1"])
    out, err = capsys.readouterr()
    text = (out + err).replace(__version__, "VERSION")
    return text.replace(Path.cwd().as_uri(), "FOLDER").replace(str(Path.cwd()), "FOLDER")


@pytest.mark.parametrize("name", FORMATS)
def test_reports_in_each_format_equal_the_gold_files(name, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    text = output(capsys, *FILES, "--format", name)
    if name == "sarif":  # without the texts of the rules; one result a line
        (run,) = json.loads(text)["runs"]
        text = "".join(f"{json.dumps(result)}\n" for result in run["results"])
    assert text.splitlines() == expected(f"reports/{name}.txt", text)


@pytest.mark.parametrize("name", OPTIONS)
def test_selected_steps_equal_the_gold_files(name, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    text = output(capsys, *FILES, *OPTIONS[name])
    assert text.splitlines() == expected(f"reports/text_{name}.txt", text)


@pytest.mark.parametrize("name", SYSTEMS)
def test_pictures_of_systems_equal_the_gold_files(name, workspace, monkeypatch, capsys):
    monkeypatch.chdir(workspace)
    text = output(capsys, ".", "--launch", "all", *SYSTEMS[name])
    assert text.splitlines() == expected(f"systems/{name}.txt", text)


@pytest.mark.parametrize(
    ("option", "topic"), [("--from", "/scout/rear/scan"), ("--to", "/scout/cmd_vel"), ("--to", "/unknown")]
)
def test_answers_about_topics_equal_the_gold_files(option, topic, workspace, monkeypatch, capsys):
    monkeypatch.chdir(workspace)
    text = output(capsys, ".", "--launch", "all", option, topic)
    assert text.splitlines() == expected(f"systems/{option[2:]}{topic.replace('/', '_')}.txt", text)
