"""The conditions of a run: kept episodes are reused only if all of them are unchanged."""

from __future__ import annotations

import ast
import hashlib
import json
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from pytest_tarl.designation import Designation
from pytest_tarl.modules_of_tests import modules
from pytest_tarl.options import Options
from pytest_tarl.sensors import declared

NAMED = 3  # maximum number of changes to name in a message
FOLDERS = (".venv", "__pycache__", ".git", ".tarl")


def conditions(
    test: str, folder: Path, root: Path, designation: Designation, options: Options, files: Sequence[Path]
) -> dict[str, Any]:
    """Return the conditions of a run by name, as JSON: digests of files, and values of settings.

    `files` are the files of the recorded statements. Settings that only select or judge episodes are left out: the
    number of episodes, the significance level, and the search.
    """
    nodes = [(folder / node).resolve() for node in designation.nodes]
    code = {path.resolve() for path in files} | {one for node in nodes for one in _sources(node)}
    first = (root / test.partition("[")[0].partition("::")[0]).resolve()
    found: dict[str, Any] = {_shown(path, root): _digest(path.read_bytes()) for path in sorted(code)}
    for path, tree in modules(first, root, nodes):
        found[_shown(path, root)] = _digest(ast.unparse(tree).encode())
    sensors = [asdict(declared(sensor)) for sensor in designation.sensors]
    return {
        **dict(sorted(found.items())),
        "the sensors": _digest(json.dumps(sensors, sort_keys=True).encode()),
        "--tarl-seed": str(options.seed),
        "--tarl-ros": options.ros,
        "the version of tarl": version("tarl"),
        "the version of numpy": version("numpy"),
        "the version of Python": platform.python_version(),
        "the machine": platform.machine(),
    }


def changed(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Describe the differences between two runs, or return an empty text."""
    found = list(_changes(before, now))
    more = f" and {len(found) - NAMED} more" if len(found) > NAMED else ""
    return "; ".join(found[:NAMED]) + more


def _changes(before: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    for name in sorted({*before, *now}):
        if before.get(name) == now.get(name):
            continue
        if name.startswith(("--", "the version", "the machine")):
            yield f"{name} was {before.get(name)} and is {now.get(name)}"
        elif name not in now:
            yield f"{name} no longer takes part"
        else:
            yield f"{name} {'changed' if name in before else 'is new'}"


def _sources(node: Path) -> Iterator[Path]:
    """Yield the Python files of a node, which may be a folder."""
    if node.is_dir():
        inside = (path for path in sorted(node.rglob("*.py")) if not {*path.parts} & {*FOLDERS})
        yield from inside
    elif node.is_file():
        yield node


def _shown(path: Path, root: Path) -> str:
    resolved = root.resolve()
    return path.relative_to(resolved).as_posix() if path.is_relative_to(resolved) else path.as_posix()


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]
