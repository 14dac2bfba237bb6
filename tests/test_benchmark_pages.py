"""The pages of benchmarks: each is in the index and the menu, and each section has a command that exists."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
INDEX = ROOT / "docs" / "benchmarks.md"
PAGES = sorted((ROOT / "docs" / "benchmarks").glob("*.md"))
SECTIONS = [
    pytest.param(section, id=f"{page.stem}: {section.splitlines()[0]}")
    for page in PAGES
    for section in re.split(r"^## ", page.read_text("utf-8"), flags=re.MULTILINE)[1:]
]
COMMAND = re.compile(r"(?:^    |`)(?=[^`\n]*(?:python |make |pytest|tarl))[^`\n]+", re.MULTILINE)
SCRIPT = re.compile(r"python (benchmarks/[\w/]+\.py)([^#\n`]*)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_each_page_is_in_index_and_menu(page: Path) -> None:
    assert f"(benchmarks/{page.name})" in INDEX.read_text("utf-8")
    assert f'"benchmarks/{page.name}"' in (ROOT / "website" / "zensical.toml").read_text("utf-8")


@pytest.mark.parametrize("section", SECTIONS)
def test_each_section_has_or_links_to_a_command(section: str) -> None:
    assert COMMAND.search(section) or ".md#" in section or ".md)" in section


@pytest.mark.parametrize("section", SECTIONS)
def test_each_command_names_a_script_and_flags_that_exist(section: str) -> None:
    for name, arguments in SCRIPT.findall(section):
        script = ROOT / name
        assert script.is_file(), name
        text = script.read_text("utf-8")
        assert {flag for flag in re.findall(r"--[a-z][\w-]*", arguments) if flag not in text} == set()
