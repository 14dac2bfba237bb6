"""Shrink a program while a property holds: remove statements, and replace statements by their bodies."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator

BODIES = ("body", "orelse", "finalbody")


def shrunk(text: str, holds: Callable[[str], bool]) -> str:
    """Return a small program for which the property still holds."""
    text = ast.unparse(ast.parse(text))
    again = True
    while again:
        again = False
        number = 0
        while True:
            smaller = _variant(text, number)
            if smaller is None:
                break
            if smaller and smaller != text and _fulfils(smaller, holds):
                text, again = smaller, True
            else:
                number += 1
    return text


def _fulfils(text: str, holds: Callable[[str], bool]) -> bool:
    try:
        compile(text, "node.py", "exec")
        return holds(text)
    except Exception:  # the program does not run any more
        return False


def _variant(text: str, number: int) -> str | None:
    """Return the program after the edit with this number; None if there is none, "" if it removes a whole body."""
    tree = ast.parse(text)
    for count, (block, place, new) in enumerate(_edits(tree)):
        if count == number:
            block[place : place + 1] = new
            return ast.unparse(ast.fix_missing_locations(tree)) if block else ""
    return None


def _edits(tree: ast.Module) -> Iterator[tuple[list[ast.AST], int, list[ast.AST]]]:
    for node in ast.walk(tree):
        for name in (*BODIES, "handlers"):
            block = getattr(node, name, None)
            if not isinstance(block, list):
                continue
            for place, inner in enumerate(block):
                if _ends_a_loop(inner):
                    continue
                removable = len(block) > 1 or name != "body"
                if removable:
                    yield block, place, []
                elif not isinstance(inner, ast.Pass):
                    yield block, place, [ast.Pass()]
                for part in BODIES if isinstance(inner, (ast.If, ast.For, ast.While, ast.Try)) else ():
                    if getattr(inner, part, []):
                        yield block, place, getattr(inner, part)


def _ends_a_loop(node: ast.AST) -> bool:
    """Return whether a statement counts the iterations of a `while`, which would not end without it."""
    return isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name) and node.target.id[0] == "w"
