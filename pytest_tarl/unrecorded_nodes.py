"""Find the node files of a marker without any recorded statement."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pytest_tarl.modules_in_flows import uses

if TYPE_CHECKING:
    from tarl_lint.api import Analysis


def silent_files(files: Sequence[Path], analysis: Analysis, root: Path) -> Iterator[str]:
    """Yield a sentence, with advice, for every named file that takes no part in a flow.

    A file takes part by a site (a recorded statement), or by a name that a site uses, such as a constant.
    """
    passed = {(root / step.span.path).resolve() for step in analysis.sites}
    used = {use.file for use in uses(analysis, root)}
    for file in files:
        if file.suffix != ".py" or file.resolve() in passed:
            continue
        unfollowed = _unfollowed(file, files)
        if unfollowed or file.resolve() not in used:
            place = file.relative_to(root).as_posix() if file.is_relative_to(root) else str(file)
            yield (
                f"{place} is named in nodes, but no flow from a subscription to a publish call passes through it, so "
                "nothing in it is recorded or repaired: "
                f"{unfollowed or 'remove it from nodes, or run `tarl-lint` to see the flows'}"
            )


def _unfollowed(file: Path, files: Sequence[Path]) -> str:
    """Return why the analysis does not follow an import of the file, with advice, or ""."""
    folder = file.parent
    importing = [one.name for one in files if one != file and f"{folder.name}.{file.stem}" in _imports(one)]
    if importing and not (folder / "__init__.py").exists():
        missing = f"{importing[0]} imports it from {folder.name}, which has no __init__.py"
        return f"{missing}; add an empty one and record again"
    return ""


def _imports(file: Path) -> set[str]:
    """Return the dotted names that a file imports, and also the last two parts of each name."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{each.name}" for each in node.names)}
        elif isinstance(node, ast.Import):
            found |= {each.name for each in node.names}
    return {".".join(name.split(".")[-2:]) for name in found} | found
