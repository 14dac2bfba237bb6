"""Uses of the constants in a table of settings, such as `self.p["speed"]` for `{"speed": 0.4}`.

Many nodes keep their parameters in a dictionary that a loop fills. The analysis then knows only that some statement
reads the table. The key determines the constant that the statement reads. The statement is then ranked for this
constant alone, and the constant counts as named. It can be changed under a condition at its use.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator, Sequence

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import Document, document
from tarl_lint.api import Analysis
from tarl_lint.model import Operand, SiteId, Span


def entry_uses(analysis: Analysis, literals: Sequence[Operand]) -> dict[Operand, tuple[Operand, ...]]:
    """Map each literal in a table to its uses: the expressions in flows that read it by its key.

    Keys that several tables have are left out, because a use does not say which table it reads.
    """
    sources = [source for path in analysis.sources if (source := _opened(analysis, path)) is not None]
    often = Counter(
        key for source in sources for node in ast.walk(source.tree) for key in _keys_of_table(node)
    )
    steps = {
        source.path: [(one.span, one.site) for one in analysis.sites if one.span.path == source.path]
        for source in sources
    }
    reads: dict[str, list[tuple[Document, ast.expr, SiteId]]] = {}
    for source in sources:
        for node in ast.walk(source.tree):
            if not isinstance(node, ast.expr) or (key := _key_read(node)) not in often:
                continue
            site = _site(steps[source.path], node)
            if site is not None:
                reads.setdefault(key, []).append((source, node, site))
    found: dict[Operand, tuple[Operand, ...]] = {}
    for literal in literals:
        key = _key(analysis, literal)
        if key and often[key] == 1 and key in reads:
            found[literal] = tuple(_uses(literal, reads[key]))
    return found


def _uses(literal: Operand, reads: Sequence[tuple[Document, ast.expr, SiteId]]) -> Iterator[Operand]:
    for source, node, site in reads:
        yield Operand(site, source.span(node), source.source(node), literal.value, literal.definition)


def _opened(analysis: Analysis, path: str) -> Document | None:
    try:
        return document(path, analysis.sources[path])
    except RepairError:
        return None


def _key(analysis: Analysis, literal: Operand) -> str:
    """Return the key of a literal in a table, or ""."""
    source = _opened(analysis, literal.span.path) if literal.literal else None
    node = source.at(literal.span) if source is not None else None
    if source is None or node is None:
        return ""
    around = source.parents.get(node)
    while isinstance(around, ast.UnaryOp):
        node, around = around, source.parents.get(around)
    pairs = zip(around.keys, around.values, strict=True) if isinstance(around, ast.Dict) else ()
    return next((_text(key) for key, value in pairs if value is node), "")


def _keys_of_table(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Dict):
        yield from (text for key in node.keys if (text := _text(key)))


def _key_read(node: ast.expr) -> str:
    """Return the key with which an expression reads a table: `p["speed"]`, `p.get("speed", 0.4)`; else ""."""
    if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load):
        return _text(node.slice)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "get":
        return _text(node.args[0]) if node.args else ""
    return ""


def _text(node: ast.expr | None) -> str:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def _site(steps: Sequence[tuple[Span, SiteId]], node: ast.expr) -> SiteId | None:
    """Return the innermost statement of a flow whose own lines contain an expression."""
    around = [(span.line, site) for span, site in steps if span.line <= node.lineno <= span.end_line]
    return max(around, key=lambda one: one[0])[1] if around else None
