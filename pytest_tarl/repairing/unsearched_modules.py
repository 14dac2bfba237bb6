"""Find modules in flows that are not searched, because the marker does not name them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from pytest_tarl.repairing.request import Order


def unnamed_modules(order: Order) -> Iterator[str]:
    """Yield a sentence for each such module."""
    named = {(order.root / shown).resolve() for shown in order.analysis.sources}
    told: set[Path] = set()
    for shown, text in order.analysis.sources.items():
        for name, file in _imports(ast.parse(text), (order.root / shown).resolve(), order.root.resolve()):
            word = re.compile(rf"\b{re.escape(name)}\b")
            passing = (s for s in order.analysis.sites if s.span.path == shown and word.search(s.code))
            step = next(passing, None)
            if step is not None and file not in named and file not in told:
                told.add(file)
                place = file.relative_to(order.root.resolve()).as_posix()
                yield (
                    f"a flow passes through {place} at {shown}:{step.span.line}, but the marker does not name that "
                    "file, so its constants were not searched: add it to nodes and record again"
                )


def _imports(tree: ast.Module, at: Path, root: Path) -> Iterator[tuple[str, Path]]:
    """Yield each name that a module imports from files of the project, and the file."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for each in node.names:
                name = each.asname or each.name.partition(".")[0]
                yield from ((name, file) for file in _files(each.name, 0, at, root))
        elif isinstance(node, ast.ImportFrom):
            for each in node.names:
                inner = f"{node.module}.{each.name}" if node.module else each.name
                files = [
                    *_files(inner, node.level, at, root),
                    *_files(node.module or "", node.level, at, root),
                ]
                yield from ((each.asname or each.name, file) for file in files[:1])


def _files(module: str, level: int, at: Path, root: Path) -> list[Path]:
    """Return the files of a module, next to the importing file or in a parent folder up to the root."""
    starts = [at.parents[level - 1]] if level else [each for each in at.parents if each.is_relative_to(root)]
    parts = module.split(".")
    wanted = [start.joinpath(*parts).with_suffix(".py") for start in starts if module]
    return [file for file in wanted if file.is_file() and file.is_relative_to(root)][:1]
