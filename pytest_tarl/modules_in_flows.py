"""Find the project modules that files import, and the modules whose names are used in flows."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from tarl_lint.api import Analysis

INIT: Final = "__init__.py"


@dataclass(frozen=True, slots=True)
class Use:
    """A flow's statement that uses a name from a module: the module's file, and where the statement is."""

    file: Path
    path: str
    line: int


def uses(analysis: Analysis, root: Path) -> Iterator[Use]:
    """Yield the first use of each imported name; the paths of the analysis are relative to `root`."""
    for shown, text in analysis.sources.items():
        for name, file in _imports(ast.parse(text), (root / shown).resolve(), root.resolve()):
            word = re.compile(rf"\b{re.escape(name)}\b")
            passing = (s for s in analysis.sites if s.span.path == shown and word.search(s.code))
            step = next(passing, None)
            if step is not None:
                yield Use(file, shown, step.span.line)


def imported(files: Sequence[Path], root: Path, *, packages: bool = False) -> tuple[Path, ...]:
    """Return the project files that these files import, directly or indirectly, in order of discovery.

    With `packages`, return and follow only `__init__.py` files. Files that are not valid Python are skipped.
    """
    found = dict.fromkeys(files)
    waiting = list(files)
    while waiting:
        file = waiting.pop(0)
        try:
            tree = ast.parse(file.read_bytes())
        except (SyntaxError, ValueError, OSError):
            del found[file]
            continue
        more = [each for _, each in _imports(tree, file, root.resolve(), packages=True) if each not in found]
        more = [each for each in more if each.name == INIT or not packages]
        found.update(dict.fromkeys(more))
        waiting += dict.fromkeys(more)
    return tuple(each for each in found if each not in files)


def _imports(tree: ast.Module, at: Path, root: Path, *, packages: bool = False) -> Iterator[tuple[str, Path]]:
    """Yield each name that a module imports from project files, with the file.

    With `packages`, also yield a package's `__init__.py`.
    """
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for each in node.names:
                name = each.asname or each.name.partition(".")[0]
                yield from ((name, file) for file in _files(each.name, 0, at, root, packages))
        elif isinstance(node, ast.ImportFrom):
            for each in node.names:
                inner = f"{node.module}.{each.name}" if node.module else each.name
                files = [
                    *_files(inner, node.level, at, root, packages),
                    *_files(node.module or "", node.level, at, root, packages),
                ]
                yield from ((each.asname or each.name, file) for file in files[:1])


def _files(module: str, level: int, at: Path, root: Path, packages: bool) -> list[Path]:
    """Return the files of a module, beside the importing file or in a parent folder up to the root."""
    starts = [at.parents[level - 1]] if level else [each for each in at.parents if each.is_relative_to(root)]
    parts = module.split(".")
    wanted = [start.joinpath(*parts).with_suffix(".py") for start in starts if module]
    if packages:
        wanted += [start.joinpath(*filter(None, parts), INIT) for start in starts if module or level]
    return [file for file in wanted if file.is_file() and file.is_relative_to(root)][:1]
