"""A pytest plugin that stores each test's outcome while it records every statement of a package.

`third_party_suites.py` passes the package's folder in SUITE_RECORDED (empty: do not record), and the path for the
result in SUITE_RESULT.
"""

from __future__ import annotations

import ast
import json
import os
import re
import signal
import tempfile
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.recorder import Recorder

EVERY = 0.2  # CPU seconds after which recorded events are dropped, to limit memory
OPEN = ExitStack()
FOUND: dict[str, list[str]] = {}
COUNTS = {"sites": 0, "events": 0, "files": 0}


def every_site(file: Path, first: int) -> dict[tuple[int, int], int]:
    """Return the positions of all statements, handlers, cases and lambda bodies, numbered from `first`."""
    text = file.read_text(encoding="utf-8")
    lines, sites = text.split("\n"), dict[tuple[int, int], int]()
    for node in ast.walk(ast.parse(text)):
        places: list[Any] = [node] if isinstance(node, ast.stmt | ast.ExceptHandler) else []
        places += [node.body] if isinstance(node, ast.Lambda) else []
        places += [node.pattern] if isinstance(node, ast.match_case) else []
        for place in places:
            before = lines[place.lineno - 1].encode()[: place.col_offset].decode()
            sites.setdefault((place.lineno, len(before) + 1), first + len(sites))
    return sites


def begin() -> None:
    """Start recording if requested, and make Hypothesis deterministic."""
    if folder := os.environ["SUITE_RECORDED"]:
        _record(Path(folder))
    try:
        settings = import_module("hypothesis").settings  # a module in the suite's environment
    except ImportError:
        return
    settings.register_profile("suites", deadline=None, derandomize=True, database=None)
    settings.load_profile("suites")


def _record(package: Path) -> None:
    plan: dict[Path, dict[tuple[int, int], int]] = {}
    for file in sorted(package.rglob("*.py")):
        if "tests" not in file.relative_to(package).parts:
            plan[file] = every_site(file, COUNTS["sites"])
            COUNTS["sites"] += len(plan[file])
    recorder = Recorder()
    scratch = OPEN.enter_context(tempfile.TemporaryDirectory())
    imports = NodeImports(Path(scratch), plan, recorder.hook, bind=recorder.bind)

    def clear(*_: object) -> None:
        for buffer in recorder._buffers:
            COUNTS["events"] += len(buffer.entries) // 2
            buffer.entries.clear()

    def close() -> None:
        clear()
        COUNTS["files"] = len(imports._executed)
        recorder.finish()

    OPEN.enter_context(imports)
    OPEN.callback(close)
    signal.signal(signal.SIGVTALRM, clear)
    signal.setitimer(signal.ITIMER_VIRTUAL, EVERY, EVERY)
    OPEN.callback(signal.setitimer, signal.ITIMER_VIRTUAL, 0)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Store the outcome of a test phase."""
    name = re.sub(r"0x[0-9a-f]+", "0x", report.nodeid)
    word = f"{report.when} {report.outcome}" + (" (expected)" if hasattr(report, "wasxfail") else "")
    FOUND.setdefault(name, []).append(word)


def pytest_collectreport(report: pytest.CollectReport) -> None:
    """Store failures of collection."""
    if not report.passed:
        FOUND.setdefault(report.nodeid, []).append(f"collection {report.outcome}")


@pytest.hookimpl(trylast=True)
def pytest_unconfigure() -> None:
    """Write the result."""
    OPEN.close()
    Path(os.environ["SUITE_RESULT"]).write_text(json.dumps({"tests": FOUND, **COUNTS}))


if "SUITE_RESULT" in os.environ:
    begin()  # called on import, before a conftest.py imports the package
