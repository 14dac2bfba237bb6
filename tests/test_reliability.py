"""Each row of docs/reliability.md names tests, scripts or nightly jobs that exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROWS = [
    line.strip("|").split(" | ")
    for line in (ROOT / "docs" / "reliability.md").read_text("utf-8").splitlines()
    if line.startswith("| ")
][1:]
NIGHTLY = (ROOT / ".github" / "workflows" / "nightly.yml").read_text("utf-8")
FILES = [
    path.relative_to(ROOT).as_posix()
    for part in ("tests", "benchmarks")
    for path in (ROOT / part).rglob("*.py")
]
MADE = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE)


def exists(name: str) -> bool:
    """Return whether a name in the column of tests is a file, a folder, or the end of one test's path."""
    return (ROOT / name).exists() or any(path.endswith(f"/{name}") for path in FILES)


def test_the_reliability_table_has_more_than_thirty_rows() -> None:
    assert len(ROWS) > 30


@pytest.mark.parametrize("row", ROWS, ids=[row[0].strip()[:50] for row in ROWS])
def test_each_row_of_the_reliability_table_names_existing_files(row: list[str]) -> None:
    _, tested, _, result = row
    assert result.strip()
    named = [one for one in re.findall(r"`([^`]+)`", tested) if "/" in one or one.endswith(".py")]
    files = [one.split()[0] for one in named if "--" not in one.split()[0]]
    jobs = re.findall(r"job `([\w-]+)`", tested)
    targets = re.findall(r"`make ([\w-]+)`", tested)
    assert files or jobs or targets or tested.strip() == "the same file", tested
    assert [one for one in files if not exists(one)] == []
    assert [one for one in jobs if f"\n  {one}:" not in NIGHTLY] == []
    assert [one for one in targets if one not in MADE] == []
