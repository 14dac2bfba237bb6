"""Run CPython's own tests of a module, unmodified and with every statement of the module recorded.

`python law_of_stdlib.py MODULE… ` prints one JSON object: module → [plain result, recorded result, sites, events].
"""

from __future__ import annotations

import ast
import io
import json
import sys
import sysconfig
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.recorder import Recorder

LIBRARY = Path(sysconfig.get_paths()["stdlib"])


def files_of(module: str) -> list[Path]:
    base = LIBRARY.joinpath(*module.split("."))
    return sorted(base.rglob("*.py")) if base.is_dir() else [base.with_suffix(".py")]


def every_site(file: Path) -> dict[tuple[int, int], int]:
    """Return every statement, handler, case and lambda body; a site's number is its line."""
    text = file.read_text(encoding="utf-8")
    lines, sites = text.split("\n"), {}
    for node in ast.walk(ast.parse(text)):
        places: list[Any] = [node] if isinstance(node, (ast.stmt, ast.ExceptHandler)) else []
        places += [node.body] if isinstance(node, ast.Lambda) else []
        places += [node.pattern] if isinstance(node, ast.match_case) else []
        for place in places:
            before = lines[place.lineno - 1].encode()[: place.col_offset].decode()
            sites.setdefault((place.lineno, len(before) + 1), place.lineno)
    return sites


def forget(*modules: str) -> None:
    for name in list(sys.modules):
        if any(name == module or name.startswith(f"{module}.") for module in modules):
            del sys.modules[name]
            package, _, tail = name.rpartition(".")
            if package in sys.modules and hasattr(sys.modules[package], tail):
                delattr(sys.modules[package], tail)


def outcome(module: str) -> list[Any]:
    """Re-import the module and its tests and run them; return [number of tests, failed, skipped]."""
    tests = f"test.test_{module.replace('.', '_')}"
    forget(module, tests)
    result = unittest.TestResult()
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        unittest.defaultTestLoader.loadTestsFromName(tests).run(result)
    failed = sorted(str(test) for test, _ in (*result.failures, *result.errors))
    return [result.testsRun, failed, len(result.skipped)]


def compared(module: str, root: Path) -> list[Any]:
    before = dict(sys.modules)
    plain = outcome(module)
    forget(module, *(sys.modules.keys() - before.keys()))
    recorder = Recorder()
    plan = {file: every_site(file) for file in files_of(module)}
    with NodeImports(root, plan, recorder.hook, bind=recorder.bind):
        recorded = outcome(module)
    forget(module)
    sys.modules.update(
        {name: known for name, known in before.items() if name == module or name.startswith(f"{module}.")}
    )
    return [plain, recorded, sum(map(len, plan.values())), len(recorder.finish().site)]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as root:
        print(json.dumps({module: compared(module, Path(root)) for module in sys.argv[1:]}))
