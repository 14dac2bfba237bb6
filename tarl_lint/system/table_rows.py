"""Table rows and call arguments that contain a topic with its type.

The analysis joins the elements of a table, so a loop over a table gives all topics all types. The rows separate them.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator
from dataclasses import replace

from tarl_lint.evidence import Outline
from tarl_lint.system.model import Endpoint
from tarl_lint.trees import last_name


def rows(topics: Collection[str], outline: Outline) -> Iterator[list[ast.expr]]:
    """Yield the rows of a module that contain one of the topics as a literal."""
    for node in ast.walk(outline.tree):
        for row in _rows(node):
            if any(isinstance(one, ast.Constant) and one.value in topics for one in row):
                yield row


def _rows(node: ast.AST) -> Iterator[list[ast.expr]]:
    """Yield a sequence's elements, a call's arguments, or a mapping's entries and values."""
    if isinstance(node, ast.Tuple | ast.List):
        yield node.elts
    elif isinstance(node, ast.Call):
        yield [*node.args, *(one.value for one in node.keywords)]
    elif isinstance(node, ast.Dict):
        for key, value in zip(node.keys, node.values, strict=True):
            inner = value.elts if isinstance(value, ast.Tuple | ast.List) else [value]
            yield from [[key, *inner]] if key is not None else []
        yield node.values


def separated(end: Endpoint, whole_types: Collection[str], outlines: Collection[Outline]) -> list[Endpoint]:
    """Return one endpoint per topic, if the rows give all types."""
    kinds = end.type.split(" | ")
    if len(end.names) < 2 or len(kinds) < 2:
        return [end]
    found: list[Endpoint] = []
    for name in end.names:
        named = {
            last_name(part)
            for outline in outlines
            for row in rows([name], outline)
            for part in row
            if last_name(part) in kinds
        }
        if len(named) != 1:
            return [end]
        kind = named.pop()
        whole = [one for one in whole_types if one.rpartition("/")[2] == kind]
        found.append(replace(end, names=(name,), type=kind, whole_type=whole[0] if len(whole) == 1 else ""))
    return found
