"""Combine two changes of the same lines, if possible."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from pytest_tarl.patching.changes import Lines, Replacement

Imports = dict[
    tuple[str, int] | None, dict[str, None]
]  # (module, level), or None for `import …` → names as written


def agreed(one: Replacement, other: Replacement) -> Replacement | None:
    """Return one replacement with the effect of both, or None if they conflict."""
    if one.start != other.start or one.old != other.old:
        return None
    for wide, narrow in ((one, other), (other, one)):
        if _within(narrow.new, wide.new) and not one.old:
            return wide
    imports = _imported([one.old, one.new, other.new])
    if imports is None or not one.old:
        return None
    before, first, second = imports
    if not (_added(before, first) and _added(before, second)):
        return None
    ending = b"\r\n" if one.old[0].endswith(b"\r\n") else b"\n"
    return Replacement(one.start, one.old, tuple(_written(first, second, ending)))


def _within(narrow: Lines, wide: Lines) -> bool:
    size = len(narrow)
    return any(wide[at : at + size] == narrow for at in range(len(wide) - size + 1))


def _imported(texts: Sequence[Lines]) -> list[Imports] | None:
    """Return the imports of each text, or None if a text contains anything else."""
    found = []
    for lines in texts:
        imports: Imports = {}
        for line in lines:
            try:
                text = line.decode("utf-8").strip()
                (node,) = ast.parse(text).body
            except (UnicodeDecodeError, SyntaxError, ValueError):
                return None
            if (
                not isinstance(node, ast.Import | ast.ImportFrom)
                or ast.unparse(node) != text
                or line[:1].isspace()
            ):
                return None
            where = (node.module or "", node.level) if isinstance(node, ast.ImportFrom) else None
            imports.setdefault(where, {}).update(dict.fromkeys(ast.unparse(alias) for alias in node.names))
        found.append(imports)
    return found


def _added(before: Imports, after: Imports) -> bool:
    """Return whether all earlier imports are still there."""
    return all(names.keys() <= after.get(where, {}).keys() for where, names in before.items())


def _written(first: Imports, second: Imports, ending: bytes) -> list[bytes]:
    """Return the imports of both texts; sorted if both texts are."""
    lines = []
    for where in {**first, **second}:
        mine, theirs = list(first.get(where, ())), list(second.get(where, ()))
        names = list(dict.fromkeys([*mine, *theirs]))
        if mine == sorted(mine) and theirs == sorted(theirs):
            names.sort()
        if where is None:
            lines += [f"import {name}" for name in names]
        else:
            lines.append(f"from {'.' * where[1]}{where[0]} import {', '.join(names)}")
    return [line.encode() + ending for line in lines]
