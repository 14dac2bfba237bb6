"""Compare two texts of a file, but only the parts of the first text that an analysis has read.

If these parts agree, an analysis of the second text has the same result, possibly on other lines.
"""

from __future__ import annotations

import ast
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import lru_cache
from itertools import pairwise

from tarl_lint.read.watched import FUNCTIONS, Reading

DEFINITIONS = (*FUNCTIONS, ast.ClassDef)


class DifferenceError(Exception):
    """The texts differ in something that the analysis has read."""


def moved_lines(old: str, new: str, reading: Reading) -> Mapping[int, int] | None:
    """Return the lines of a new text, from 1, at which the analysed lines are; None if the file must be analysed again.

    These lines have the same characters and the same order as before.
    """
    if reading.whole or any(question(new) is not known for question, known in reading.answers):
        return None
    former, latter = _tree(old), _tree(new)
    if former is None or latter is None:
        return None
    comparison = _Comparison(old.split("\n"), new.split("\n"), reading)
    try:
        comparison.nodes(former, latter)
    except DifferenceError:
        return None
    changed = comparison.changed
    if changed and any(_qualnames(tree)[name] > 1 for tree in (former, latter) for name in changed):
        # if several functions have one name, equal statements are numbered across all of them, so a change to one
        # function affects the other functions
        return None
    places = sorted(comparison.lines.items())
    return dict(places) if all(a < b for (_, a), (_, b) in pairwise(places)) else None


class _Comparison:
    """Walks two trees at once and pairs their lines.

    Raises DifferenceError at the first difference in a part that was read.
    """

    def __init__(self, old: list[str], new: list[str], reading: Reading) -> None:
        self.lines: dict[int, int] = {}
        # changed functions that no analysis has read
        self.changed: set[str] = set()
        self._old = old
        self._new = new
        self._unread = reading.unread

    def nodes(self, former: ast.AST, latter: ast.AST) -> None:
        """Compare two trees, except the bodies of unread functions. Raises DifferenceError if they differ."""
        pending: list[tuple[object, object, str]] = [(former, latter, "")]
        while pending:
            one, other, name = pending.pop()
            if type(one) is not type(other):
                raise DifferenceError
            if isinstance(one, list) and isinstance(other, list):
                if len(one) != len(other):
                    raise DifferenceError
                pending += [(a, b, name) for a, b in zip(one, other, strict=True)]
            elif isinstance(one, ast.AST) and isinstance(other, ast.AST):
                inner = f"{name}.{one.name}" if isinstance(one, DEFINITIONS) else name
                pending += [(a, b, inner) for a, b in self._parts(one, other, inner)]
            elif one != other and repr(one) != repr(other):
                raise DifferenceError

    def _parts(self, one: ast.AST, other: ast.AST, name: str) -> Iterator[tuple[object, object]]:
        self._place(one, other)
        passed = isinstance(one, FUNCTIONS) and (one.lineno, one.col_offset) in self._unread
        if passed and self._text(self._old, one) != self._text(self._new, other):
            self.changed.add(name)
        for part in one._fields:
            if not (passed and part == "body"):
                yield getattr(one, part, None), getattr(other, part, None)

    def _place(self, one: ast.AST, other: ast.AST) -> None:
        """Pair the lines of two nodes; for compound statements, pair only the lines of the headers."""
        first, there = getattr(one, "lineno", None), getattr(other, "lineno", None)
        if first is None or there is None:
            return
        if getattr(one, "col_offset", 0) != getattr(other, "col_offset", 0):
            raise DifferenceError
        body = getattr(one, "body", None)
        if isinstance(body, list):
            self._header(first, there, body[0].lineno)
            return
        last, end = getattr(one, "end_lineno", first), getattr(other, "end_lineno", there)
        if last - first != end - there:
            raise DifferenceError
        for line in range(first, last + 1):
            self._pair(line, there + line - first)

    def _header(self, first: int, there: int, body: int) -> None:
        """Pair the first line of a header, and the following lines as far as they are equal.

        The nodes in a header pair their own lines. A further line may contain the colon of the header.
        """
        self._pair(first, there)
        for line in range(first + 1, body):
            to = there + line - first
            if to > len(self._new) or self._old[line - 1] != self._new[to - 1]:
                break
            self._pair(line, to)

    def _pair(self, line: int, to: int) -> None:
        if self.lines.setdefault(line, to) != to or self._old[line - 1] != self._new[to - 1]:
            raise DifferenceError

    @staticmethod
    def _text(lines: list[str], node: ast.AST) -> list[str]:
        return lines[getattr(node, "lineno", 1) - 1 : getattr(node, "end_lineno", 1)]


@lru_cache(maxsize=16)
def _tree(text: str) -> ast.Module | None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def _qualnames(tree: ast.Module) -> Counter[str]:
    """Return the number of functions and classes for each qualified name; the names begin with a dot."""
    found: Counter[str] = Counter()
    pending: list[tuple[ast.AST, str]] = [(tree, "")]
    while pending:
        node, name = pending.pop()
        for child in ast.iter_child_nodes(node):
            inner = f"{name}.{child.name}" if isinstance(child, DEFINITIONS) else name
            found[inner] += isinstance(child, DEFINITIONS)
            pending.append((child, inner))
    return found
