"""Find the test files nearest to a module by imports, to choose tests without measuring coverage."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

FARTHEST = 3  # maximum length of a chain of imports from a test file to a module


@dataclass(frozen=True)
class Nearest:
    """Ranks test files for the modules of a package in `root`; `tests` are files or folders of tests."""

    root: Path
    package: str
    tests: tuple[str, ...]

    def files(self, path: str, most: int) -> list[str]:
        """Return at most `most` test files for the module at a path relative to `root`.

        Files named after the module come first. The others are sorted by the number of imports between file and module,
        then by whether their folder is named after the module's package, then by size.
        """
        parts = Path(path).parts
        home = parts[1] if len(parts) > 2 else ""
        distances = self._distances(_dotted(Path(path)))
        ranked = []
        for file, imported in self._tested.items():
            steps = [distances[one] for one in imported if one in distances]
            named = Path(file).stem in (f"test_{Path(path).stem}", f"test_{Path(path).stem}_by_hand")
            if steps or named:
                size = (self.root / file).stat().st_size
                ranked.append(
                    (not named, min(steps, default=FARTHEST), home not in Path(file).parts, size, file)
                )
        return [file for *_, file in sorted(ranked)[:most]]

    def _distances(self, module: str) -> dict[str, int]:
        """Return the number of imports from each module to this one, up to `FARTHEST`."""
        found, layer = {module: 0}, {module}
        for distance in range(1, FARTHEST + 1):
            layer = {name for name, imported in self._graph.items() if imported & layer and name not in found}
            found |= dict.fromkeys(layer, distance)
        return found

    @cached_property
    def _graph(self) -> dict[str, frozenset[str]]:
        files = {
            _dotted(file.relative_to(self.root)): file for file in (self.root / self.package).rglob("*.py")
        }
        return {name: _imports(file) & files.keys() for name, file in files.items()}

    @cached_property
    def _tested(self) -> dict[str, frozenset[str]]:
        return {file.relative_to(self.root).as_posix(): _imports(file) for file in self._test_files()}

    def _test_files(self) -> Iterable[Path]:
        for one in self.tests:
            path = self.root / one
            yield from sorted(path.rglob("test_*.py")) if path.is_dir() else [path]


def _dotted(path: Path) -> str:
    """Return the name of the module in a file."""
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


def _imports(file: Path) -> frozenset[str]:
    """Return the names in a file's absolute imports, as modules and as members of modules."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
        elif isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
    return frozenset(found)
