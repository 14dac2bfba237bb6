"""Ways in which teams get the architecture of a robot wrong, and ways that only look wrong, for each rule TARL3xx.

The cases of a rule are in one file of `variants/`: each has a title after `===`, then a line for each expected report,
with the rule and words that its message contains, then its files. No other report is expected.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import ALL, Request, systems
from tarl_lint.system.hazards import hazards

CASES = {
    f"{path.stem}: {case.partition(chr(10))[0]}": case.partition("\n")[2]
    for path in sorted((Path(__file__).parent / "variants").glob("*.txt"))
    for case in re.split(r"^=== ", path.read_text("utf-8"), flags=re.MULTILINE)[1:]
}


def unpacked(files: list[str], root: Path) -> None:
    """Write the files of a package `robot`; its package.xml is added."""
    written = {
        "package.xml": "<package><name>robot</name></package>",
        **dict(zip(files[::2], files[1::2], strict=True)),
    }
    for name, text in written.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(
            f"#!/usr/bin/env python3\n{text}" if name.startswith("scripts/") else text, "utf-8"
        )


@pytest.mark.parametrize("title", CASES)
def test_exactly_the_stated_misconfigurations_are_reported(title: str, tmp_path: Path) -> None:
    head, *files = re.split(r"^--- (\S+)\n", CASES[title], flags=re.MULTILINE)
    unpacked(files, tmp_path / "robot")
    config = resolve(Options((tmp_path,), select=("TARL3",)))
    found = sorted(
        {f"{one.code} {one.message}" for each in systems(Request(ALL, (), (tmp_path,)), config)
         for one in hazards(each, config)}
    )  # fmt: skip
    expected = [line.split() for line in head.split("\n") if line]
    fits = [[all(re.search(rf"(?<![\w/]){re.escape(word)}(?![\w/])", report) for word in words) for words in expected]
            for report in found]  # fmt: skip
    missed = [" ".join(words) for i, words in enumerate(expected) if not any(row[i] for row in fits)]
    surplus = [report for report, row in zip(found, fits, strict=True) if not any(row)]
    assert (missed, surplus) == ([], [])
