"""Margins read from files, folders and git revisions, and their tables in `tarl summary`."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from pytest_tarl.commands import margins_files
from pytest_tarl.commands.margins_files import is_recording, margins_in
from pytest_tarl.commands.summary import markdown
from pytest_tarl.errors import FixtureError
from pytest_tarl.stressing.margins import Margin, Margins, text
from tests.plugin.commands.test_applying import git

MUD = Margin("mud", 1.0, 0.0, 0.5, 0.25)
FOUND = Margins("test_it.py::test_it", "world", 0.98, 0.466, 0.9, (MUD,))
OTHER = replace(FOUND, test="test_it.py::test_a")


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two committed files of margins in a repository, which is the working directory, and a file of another kind."""
    folder = tmp_path / ".tarl" / "margins"
    folder.mkdir(parents=True)
    (folder / "b.json").write_text(text(FOUND))
    (folder / "a.json").write_text(text(OTHER))
    (folder / "notes.txt").write_text("not margins")
    git("init", "-q", cwd=tmp_path)
    git("add", "-A", cwd=tmp_path)
    git("commit", "-qm", "margins", cwd=tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_file_of_arrays_is_a_recording() -> None:
    assert is_recording(".tarl/utility/it.npz")
    assert not is_recording(".tarl/margins/it.json")


@pytest.mark.parametrize("place", [".tarl/margins", "HEAD:.tarl/margins", "HEAD:.tarl/margins/"])
def test_margins_of_a_folder_are_sorted_by_name(project: Path, place: str) -> None:
    assert margins_in(place) == [OTHER, FOUND]


@pytest.mark.parametrize("place", [".tarl/margins/b.json", "HEAD:.tarl/margins/b.json"])
def test_one_file_of_margins_can_be_named(project: Path, place: str) -> None:
    assert margins_in(place) == [FOUND]


def test_paths_at_a_revision_are_relative(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project / ".tarl")
    assert margins_in("HEAD:margins") == [OTHER, FOUND]


def test_a_revision_has_the_margins_of_its_time(project: Path) -> None:
    (project / ".tarl/margins/a.json").unlink()
    (project / ".tarl/margins/b.json").write_text(text(replace(FOUND, success=0.5)))
    assert margins_in(".tarl/margins") == [replace(FOUND, success=0.5)]
    assert margins_in("HEAD:.tarl/margins") == [OTHER, FOUND]


def test_folder_missing_in_a_revision_has_no_margins(project: Path) -> None:
    assert margins_in("HEAD:elsewhere") == []


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("nowhere", r"^nowhere: no such file or folder\. Name a file of margins, \.tarl/margins, or REVISION:\.tarl"),
        (":.tarl/margins", "^'' is not a git revision: name a branch"),
        ("--all:.tarl/margins", "^'--all' is not a git revision"),
        ("v9:.tarl/margins", "^v9: git does not know this revision"),
        (".tarl/margins/notes.txt", "notes.txt: not a file of margins"),
    ],
)  # fmt: skip
def test_a_place_without_margins_is_reported(project: Path, place: str, said: str) -> None:
    with pytest.raises(FixtureError, match=said):
        margins_in(place)


def test_without_git_only_files_can_be_compared(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(margins_files.shutil, "which", lambda name: None)
    assert margins_in(".tarl/margins") == [OTHER, FOUND]
    with pytest.raises(FixtureError, match="git is not installed, so HEAD cannot be read: install git"):
        margins_in("HEAD:.tarl/margins")


def test_a_program_that_the_repository_configures_is_not_started(project: Path) -> None:
    ran = project / "ran"
    hook = project / "hook.sh"
    hook.write_text(f"#!/bin/sh\ntouch {ran}\n")
    hook.chmod(0o755)
    subprocess.run(["git", "config", "core.fsmonitor", str(hook)], cwd=project, check=True)
    margins_in("HEAD:.tarl/margins")
    assert not ran.exists()


def test_the_summary_lists_the_current_margins(project: Path) -> None:
    told = markdown(project / ".tarl" / "results").splitlines()
    assert told[:2] == ["| test | direction | boundary |", "|---|---|---|"]
    assert told[2:] == [f"| `{one.title}` | mud to 0 | 0.25 to 0.5 |" for one in (OTHER, FOUND)]


def test_the_summary_compares_the_margins_with_a_revision(project: Path) -> None:
    worse = replace(FOUND, success=0.5, sides=(Margin("mud", 1.0, 0.0, 0.875, 0.75),))
    (project / ".tarl/margins/b.json").write_text(text(worse))
    told = markdown(Path(".tarl/results"), "HEAD").splitlines()
    assert told[0] == "| test | direction | boundary at HEAD | boundary now | change |"
    assert told[2] == f"| `{OTHER.title}` | mud to 0 | 0.25 to 0.5 | 0.25 to 0.5 | no significant change |"
    assert told[3] == f"| `{FOUND.title}` | mud to 0 | 0.25 to 0.5 | 0.75 to 0.875 | ❌ more fragile |"
    note = f"{FOUND.title}: the guarantee changed from a success rate of 98 % and a loss of 0.466 to 50 % and 0.466"
    assert told[4:] == ["", f"{note}, because the test was recorded again."]
