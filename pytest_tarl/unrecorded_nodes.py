"""Find the node files of a marker that have no recorded statement."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pytest_tarl.modules_in_flows import uses

if TYPE_CHECKING:
    from tarl_lint.api import Analysis


def silent_files(
    files: Sequence[Path],
    analysis: Analysis,
    root: Path,
    passed_with_imports: Callable[[Sequence[Path], Path], Sequence[Path]],
) -> Iterator[str]:
    """Yield sentences, with advice, on the named files that take no part in a flow.

    A file takes part if it has a site (a recorded statement), or a name that a site uses, such as a constant.
    `passed_with_imports` returns the files that flows pass through if imported files are also analysed.
    """
    more: Sequence[Path] | None = None
    cut_off = []
    passed = {(root / step.span.path).resolve() for step in analysis.sites}
    used = {use.file for use in uses(analysis, root)}
    for file in files:
        if file.suffix != ".py" or file.resolve() in passed:
            continue
        unfollowed = _unfollowed(file, files)
        if not unfollowed and file.resolve() in used:
            continue
        if more is None and not unfollowed:
            more = passed_with_imports(files, root)
        if not unfollowed and file in (more or ()):
            cut_off.append(file)
            continue
        yield (
            f"{_shown(file, root)} is named in nodes, but no flow from a subscription to a publish call passes through "
            "it, so nothing in it is recorded or repaired: "
            f"{unfollowed or 'remove it from nodes, or run `tarl-lint` to see the flows'}"
        )
    if cut_off:
        links = [one for one in more or () if one not in files and one not in passed]
        yield (
            f"the flows through {_listed(cut_off, root)} also pass through files that nodes "
            "does not name, so nothing in the former is recorded or repaired: add "
            f"{_listed(links, root)} to nodes and record again"
        )


def _listed(files: Sequence[Path], root: Path) -> str:
    return ", ".join(_shown(one, root) for one in files)


def _shown(file: Path, root: Path) -> str:
    return file.relative_to(root).as_posix() if file.is_relative_to(root) else str(file)


def _unfollowed(file: Path, files: Sequence[Path]) -> str:
    """Return why the analysis does not follow an import of the file, with advice, or an empty text."""
    folder = file.parent
    importing = [one.name for one in files if one != file and f"{folder.name}.{file.stem}" in _imports(one)]
    if importing and not (folder / "__init__.py").exists():
        missing = f"{importing[0]} imports it from {folder.name}, which has no __init__.py"
        return f"{missing}; add an empty one and record again"
    return ""


def _imports(file: Path) -> set[str]:
    """Return the dotted names that a file imports, and the last two parts of each."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{each.name}" for each in node.names)}
        elif isinstance(node, ast.Import):
            found |= {each.name for each in node.names}
    return {".".join(name.split(".")[-2:]) for name in found} | found
