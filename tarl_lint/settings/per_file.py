"""Rules that are disabled in some files: `per-file-ignores`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from tarl_lint.model import Finding
from tarl_lint.read import gitignore


class FileIgnores:
    """Decides which findings are disabled in their files. Patterns are as in .gitignore, relative to `root`."""

    def __init__(self, root: Path, table: Sequence[tuple[str, tuple[str, ...]]]) -> None:
        top = os.path.abspath(root)  # noqa: PTH100 - the path need not exist
        self._top = top.rstrip("/") + "/"
        self._rules = [(gitignore.parse(top, [pattern]), codes) for pattern, codes in table]
        self._codes: dict[str, tuple[str, ...]] = {}

    def silences(self, finding: Finding) -> bool:
        """Return whether a finding's rule is disabled in its file."""
        if not self._rules:
            return False
        path = finding.span.path
        if path not in self._codes:
            self._codes[path] = self._ask(os.path.abspath(path))  # noqa: PTH100
        codes = self._codes[path]
        return bool(codes) and finding.code.startswith(codes)

    def _ask(self, path: str) -> tuple[str, ...]:
        """Return the codes that are disabled in a file, by patterns that match the file or one of its directories."""
        return tuple(code for ignore, codes in self._rules if self._matches(ignore, path) for code in codes)

    def _matches(self, ignore: gitignore.Ignore, path: str) -> bool:
        if not path.startswith(self._top):
            return False
        parts = path[len(self._top) :].split("/")
        places = [self._top + "/".join(parts[:depth]) for depth in range(1, len(parts) + 1)]
        return any(bool(ignore.verdict(place, is_directory=place != path)) for place in places)
