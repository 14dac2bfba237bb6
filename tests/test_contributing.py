"""Configuration files for contributors are valid for the tools that read them."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest

yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).parent.parent
YAML_FILES = [
    *ROOT.glob(".github/**/*.yml"),
    ROOT / ".pre-commit-config.yaml",
    ROOT / ".pre-commit-hooks.yaml",
    ROOT / "CITATION.cff",
]


@pytest.mark.parametrize("path", YAML_FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_are_yaml_mappings_or_lists(path: Path) -> None:
    assert isinstance(yaml.safe_load(path.read_text("utf-8")), dict | list)


def commands(workflow: Path) -> list[str]:
    jobs = yaml.safe_load(workflow.read_text("utf-8"))["jobs"]
    return [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]


def test_workflows_run_the_same_commands_as_contributors() -> None:
    targets = set(re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE))
    ran = [command for path in ROOT.glob(".github/workflows/*.yml") for command in commands(path)]
    assert ".ci/run" in ran
    assert os.access(ROOT / ".ci" / "run", os.X_OK)
    assert {command.split()[1] for command in ran if command.startswith("make ")} <= targets


@pytest.mark.parametrize("path", [*ROOT.glob(".github/ISSUE_TEMPLATE/*_*.yml")], ids=lambda path: path.name)
def test_issue_forms_have_the_keys_that_github_requires(path: Path) -> None:
    form = yaml.safe_load(path.read_text("utf-8"))
    assert form["name"]
    assert form["description"]
    ids = [field["id"] for field in form["body"]]
    assert len(ids) == len(set(ids))
    assert all(field["attributes"]["label"] for field in form["body"])


def test_the_development_container_uses_the_setup_of_the_readme() -> None:
    container = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text("utf-8"))
    assert container["postCreateCommand"] == "make setup"


def test_the_citation_has_the_version_of_the_package() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    assert f'version = "{citation["version"]}"' in (ROOT / "pyproject.toml").read_text("utf-8")
