"""Build the gallery: run examples (record, compare, search for a repair) and collect their report pages.

A run takes minutes, so its pages are kept in build/gallery until the example or the packages change.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from website.other_plugins import BLOCKED
from website.pages import ROOT

KEPT = ROOT / "build" / "gallery"


class Shown(NamedTuple):
    """A test of an example, with a description, whose report pages are in the gallery."""

    example: str
    test: str
    words: str

    @property
    def address(self) -> str:
        """Return the prefix of its pages' names."""
        return f"{self.example}-{self.test.rpartition('::')[2].replace('_', '-')}"


SHOWN = (
    Shown("shuttle", "test_shuttle.py::test_delivers", "A delivery robot gets into mud"),
    Shown("line_follower", "test_line_follower.py::test_follows_the_line", "Dusk falls on a line follower"),
    Shown("quadrotor", "test_quadrotor.py", "A quadrotor carries a payload, and meets a gust"),
)  # fmt: skip


def digest(example: str) -> str:
    """Return a digest of all files that affect an example's pages."""
    folders = (ROOT / "examples" / example, ROOT / "pytest_tarl", ROOT / "tarl_lint")
    files = sorted(path for folder in folders for path in folder.rglob("*") if _source(path))
    found = hashlib.sha256()
    for path in files:
        found.update(f"{path.relative_to(ROOT)}\0".encode() + path.read_bytes())
    return found.hexdigest()[:16]


def _source(path: Path) -> bool:
    hidden = {".tarl", "__pycache__"} & set(path.parts)
    return (
        path.is_file()
        and not hidden
        and path.suffix in {".py", ".ini", ".html", ".css", ".js", ".json", ".toml"}
    )


def reports(shown: Shown) -> list[Path]:
    """Return an example's report pages; run it if none are kept. Raise ValueError if the run writes no page."""
    folder = KEPT / f"{shown.address}-{digest(shown.example)}"
    if not folder.is_dir():
        with tempfile.TemporaryDirectory() as parent:
            _made(shown, Path(parent).resolve() / shown.example, folder)
    return sorted(folder.glob("*.html"))


def _made(shown: Shown, work: Path, folder: Path) -> None:
    """Run an example in a copy of its folder, and copy its report pages to `folder`."""
    shutil.copytree(
        ROOT / "examples" / shown.example, work, ignore=shutil.ignore_patterns(".tarl", "__pycache__")
    )
    environment = {**os.environ, "PYTEST_ADDOPTS": BLOCKED}
    for flags in (["--tarl-record"], ["--tarl-online", "--tarl-repair"]):
        command = [sys.executable, "-m", "pytest", "-q", shown.test, *flags]
        print(f"gallery: {shown.example}: pytest {' '.join(command[3:])}", flush=True)
        ran = subprocess.run(command, cwd=work, env=environment, capture_output=True, text=True, check=False)
    pages = sorted((work / ".tarl" / "report").glob("*.html"))
    if not pages:
        raise ValueError(f"the example {shown.example} wrote no report:\n{ran.stdout}")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for page in pages:
        shutil.copyfile(page, folder / page.name)


def write(staged: Path) -> None:
    """Write the page that lists the reports, and copy the reports next to it."""
    folder = staged / "gallery"
    folder.mkdir()
    lines = [
        "# Gallery of reports",
        "",
        "The [examples](../examples/index.md) wrote these reports when this site was built. Each report is one",
        "file and loads nothing from the network.",
        "",
        "| report | example | what it shows |",
        "|---|---|---|",
    ]
    for shown in SHOWN:
        for page in reports(shown):
            name = f"{shown.address}-{page.name}"
            shutil.copyfile(page, folder / name)
            example = f"[{shown.example}](../examples/{shown.example}/index.md)"
            lines.append(f"| [{page.stem}]({name}) | {example} | {shown.words} |")
    (folder / "index.md").write_text("\n".join(lines) + "\n", "utf-8")
