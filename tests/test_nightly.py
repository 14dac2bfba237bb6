"""Nightly jobs that install their own packages install all packages that their tests import."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from importlib.metadata import packages_distributions
from itertools import pairwise
from pathlib import Path

import pytest

from tests.test_benchmarks import named

ROOT = Path(__file__).parent.parent
NIGHTLY = (ROOT / ".github" / "workflows" / "nightly.yml").read_text()
INSTALLED = re.compile(r'pip install .*-e "?\.\[([\w,]+)\]"?(.*)$', re.MULTILINE)
TESTED = re.compile(r"-m pytest -q (--noconftest )?((?:tests\S* ?)+)$", re.MULTILINE)
OWN = {"pytest_tarl", "tarl_lint", "tests", "website"}
JOBS = {
    name: body
    for name, body in re.findall(r"^  ([\w-]+):.*\n((?:    .*\n)+)", NIGHTLY, re.MULTILINE)
    if INSTALLED.search(body)
}


def started(file: Path) -> Iterator[str]:
    """Yield the packages that a test module imports at its top, or starts as `python -m NAME`."""
    tree = ast.parse(file.read_text())
    for node in tree.body:
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or "").partition(".")[0]
    for node in ast.walk(tree):
        words = [one.value if isinstance(one, ast.Constant) else None for one in getattr(node, "elts", ())]
        yield from (str(word).partition(".")[0] for flag, word in pairwise(words) if flag == "-m" and word)


def test_the_ci_configuration_has_jobs() -> None:
    assert {"lower-bounds", "benchmarks", "newer-pythons"} <= JOBS.keys()


@pytest.mark.parametrize("job", JOBS)
def test_each_ci_job_installs_what_its_tests_import(job: str) -> None:
    extras, more = INSTALLED.findall(JOBS[job])[0]
    allowed = named({*extras.split(",")}) | {re.sub(r"[-_.]+", "-", one).lower() for one in more.split()}
    known = packages_distributions()
    files = {file for bare, listed in TESTED.findall(JOBS[job]) for file in run(listed.split(), not bare)}
    assert files
    missing = {
        (file.relative_to(ROOT).as_posix(), name)
        for file in files
        for name in started(file)
        if name not in OWN | sys.stdlib_module_names
        and not {re.sub(r"[-_.]+", "-", one).lower() for one in known.get(name, [name])} & allowed
        and not guarded(file, name)
    }
    assert not missing


def run(paths: list[str], configured: bool) -> Iterator[Path]:
    """Yield the test modules at some paths and, where they count, the conftest.py of every folder around."""
    for path in (ROOT / path for path in paths):
        yield from [path] if path.is_file() else path.rglob("test_*.py")
        if configured:
            around = [folder for folder in path.parents if folder.is_relative_to(ROOT)]
            yield from path.rglob("conftest.py")
            yield from (found for folder in around if (found := folder / "conftest.py").exists())


def guarded(file: Path, name: str) -> bool:
    """Return whether a module is skipped without a package."""
    return f'pytest.importorskip("{name}' in file.read_text()
