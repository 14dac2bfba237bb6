"""Compile a node file or its replacement text, with its sites recorded."""

from __future__ import annotations

import ast
import hashlib
import warnings
from collections.abc import Collection, Mapping
from functools import lru_cache
from importlib.util import decode_source
from pathlib import Path
from types import CodeType

from pytest_tarl.instrumentation import blocks, constants, forms, fusing
from pytest_tarl.instrumentation import instrument as transform
from pytest_tarl.instrumentation.codecache import CodeCache, entry_name
from pytest_tarl.instrumentation.instrument import Offset, compiled, instrument
from pytest_tarl.instrumentation.sites import Position, Positions, relocate


class NodeCode:
    """Compile the files of a plan (sites by file) and of an overlay (replacement texts)."""

    def __init__(
        self,
        plan: Mapping[Path, Positions],
        overlay: Mapping[Path, str],
        publishes: Collection[int],
        *,
        inline: bool,
        cache: CodeCache,
    ) -> None:
        self.unrecorded: dict[Path, tuple[Position, ...]] = {}
        self._plan = {path.resolve(): positions for path, positions in plan.items()}
        self._overlay = {path.resolve(): text for path, text in overlay.items()}
        self._publishes = tuple(sorted(publishes))
        self._inline = inline
        self._cache = cache
        self.files = frozenset({*self._plan, *self._overlay})

    def edited(self, file: Path) -> bytes | None:
        """Return the replacement text of a (resolved) file, or None if it is unchanged."""
        text = self._overlay.get(file)
        return None if text is None else text.encode()

    def recorded(self, file: Path) -> bool:
        """Return whether a (resolved) file has sites."""
        return bool(self._plan.get(file))

    def compile(self, path: Path) -> CodeType:
        """Compile a file that records its sites. Raise SyntaxError or OSError, as an import does."""
        file = path.resolve()
        data, text, positions = self._text(file)
        parts = (data, sorted(positions.items()), self._publishes, self._inline, _transform_digest())
        name = entry_name(path, parts)
        code = self._cache.load(name)
        if code is None:
            code = self._compiled(path, data if text is None else text, positions)
            if path not in self.unrecorded:
                self._cache.store(name, code, keep=text is None)
        return code

    def _text(self, file: Path) -> tuple[bytes, str | None, Positions]:
        """Return the bytes to compile, the replacement text or None, and the sites."""
        positions = self._plan.get(file, {})
        text = self._overlay.get(file)
        if text is None:
            return file.read_bytes(), None, positions
        if positions:
            positions = relocate(positions, decode_source(file.read_bytes()), text)
        return text.encode(), text, positions

    def _compiled(self, path: Path, source: bytes | str, positions: Positions) -> CodeType:
        placed: set[Offset] = set()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # developers see these warnings when they run the node themselves
            tree = ast.parse(source, str(path))
            offsets = _offsets(source if isinstance(source, str) else decode_source(source), positions)
            tree = instrument(
                tree,
                {offset: positions[position] for position, offset in offsets.items()},
                publishes=self._publishes,
                inline=self._inline,
                placed=placed,
            )
        code = compiled(tree, str(path))
        missing = tuple(position for position, offset in offsets.items() if offset not in placed)
        if missing:
            self.unrecorded[path] = missing
        return code


def _offsets(text: str, positions: Positions) -> dict[Position, Offset]:
    """Convert columns in characters (from 1) to columns in UTF-8 bytes (from 0)."""
    lines = text.split("\n")
    offsets = {}
    for line, column in positions:
        before = lines[line - 1][: column - 1] if line <= len(lines) else ""
        offsets[line, column] = (line, len(before.encode()))
    return offsets


@lru_cache(maxsize=1)
def _transform_digest() -> str:
    """Return a digest of the transform's source, so that code cached by another version is not used."""
    texts = [
        Path(module.__file__ or "").read_bytes() for module in (constants, forms, blocks, fusing, transform)
    ]
    return hashlib.sha256(b"".join(texts)).hexdigest()
