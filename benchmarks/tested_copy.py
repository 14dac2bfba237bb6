"""A copy of the checkout for running tests: its environment, its compiled files, and pytest runs in it."""

from __future__ import annotations

import compileall
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from py_compile import PycInvalidationMode


def environment(copy: Path) -> dict[str, str]:
    """Return an environment that imports the copy and caches nothing."""
    return {
        **os.environ,
        "PYTHONPATH": str(copy),
        "PYTHONDONTWRITEBYTECODE": "1",
        "HYPOTHESIS_STORAGE_DIRECTORY": os.devnull,
    }


def with_own_settings(copy: Path, tests: Iterable[str]) -> list[str]:
    """Return the tests, and folders below them, that have their own pytest.ini."""
    inner = {
        ini.parent.relative_to(copy).as_posix()
        for test in tests
        for ini in (copy / test).rglob("*/pytest.ini")
    }
    return [*tests, *sorted(inner)]


def apart(copy: Path, tests: Iterable[str]) -> list[list[str]]:
    """Return the arguments of each pytest run; tests with different pytest.ini files run separately."""
    runs: dict[str, list[str]] = {}
    for test in tests:
        file = Path(test.partition("::")[0])
        above = (folder / "pytest.ini" for folder in (file, *file.parents))
        ini = next((one.as_posix() for one in above if (copy / one).is_file()), "")
        runs.setdefault(ini, ["-c", ini, "--rootdir", "."] if ini else []).append(test)
    return list(runs.values())


def precompiled(copy: Path) -> None:
    """Compile the sources of the copy.

    The compiled files contain the digests of their sources, which Python compares; so it notices every inserted fault.
    """
    for package in ("pytest_tarl", "tarl_lint"):
        compileall.compile_dir(copy / package, quiet=2, invalidation_mode=PycInvalidationMode.CHECKED_HASH)


def collected(copy: Path, tests: Sequence[str]) -> None:
    """Compile the copy's tests by collecting them, without running any."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider"]
    surroundings = {**environment(copy), "PYTHONDONTWRITEBYTECODE": ""}
    for arguments in apart(copy, tests):
        subprocess.run(
            [*command, *arguments], cwd=copy, env=surroundings, check=False, stdout=subprocess.DEVNULL
        )


def without_caches(copy: Path) -> None:
    """Remove the caches of TARL from the copy."""
    for cache in copy.rglob(".tarl"):
        shutil.rmtree(cache, ignore_errors=True)
