"""Find the node files of a marker without any recorded statement."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tarl_lint.api import Analysis


def silent_files(files: Sequence[Path], analysis: Analysis, root: Path) -> Iterator[str]:
    """Yield a sentence, with advice, for every named file without a site (a recorded statement)."""
    passed = {(root / step.span.path).resolve() for step in analysis.sites}
    for file in files:
        if file.suffix == ".py" and file.resolve() not in passed:
            place = file.relative_to(root).as_posix() if file.is_relative_to(root) else str(file)
            yield (
                f"{place} is named in nodes, but no flow from a subscription to a publish call passes through it, so "
                f"nothing in it is recorded or repaired: {_why(file, files)}"
            )


def _why(file: Path, files: Sequence[Path]) -> str:
    folder = file.parent
    importing = [one.name for one in files if one != file and f"{folder.name}.{file.stem}" in _imports(one)]
    if importing and not (folder / "__init__.py").exists():
        missing = f"{importing[0]} imports it from {folder.name}, which has no __init__.py"
        return f"{missing}; add an empty one and record again"
    return "remove it from nodes, or run `tarl-lint` to see the flows"


def _imports(file: Path) -> set[str]:
    """Return the dotted names that a file imports, and also the last two parts of each name."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{each.name}" for each in node.names)}
        elif isinstance(node, ast.Import):
            found |= {each.name for each in node.names}
    return {".".join(name.split(".")[-2:]) for name in found} | found
