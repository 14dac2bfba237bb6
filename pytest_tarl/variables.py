"""Expressions that read a node's variables: names, attributes, and subscripts with a constant."""

from __future__ import annotations

import ast


def prefixes(code: str) -> tuple[str, ...]:
    """Return the prefixes of `a.b.c` or `a.b[0].c`, shortest first; none for any other expression."""
    try:
        node = ast.parse(f"({code}\n)", mode="eval").body
    except (SyntaxError, ValueError):
        return ()
    found: list[str] = []
    while isinstance(node, ast.Attribute | ast.Subscript):
        if isinstance(node, ast.Subscript) and not isinstance(node.slice, ast.Constant):
            return ()
        found.append(ast.unparse(node))
        node = node.value
    return (node.id, *reversed(found)) if isinstance(node, ast.Name) else ()
