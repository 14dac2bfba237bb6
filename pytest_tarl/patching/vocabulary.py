"""Find the names that code uses, and unused names similar to them."""

from __future__ import annotations

import ast
import builtins
import keyword
from collections.abc import Set
from functools import cache

from pytest_tarl.patching.document import Document


def free(base: str, taken: Set[str]) -> str:
    """Return an unused name similar to `base`."""
    candidates = (base, f"{base}_reading", *(f"{base}_{i}" for i in range(2, len(taken) + 3)))
    return next(each for each in candidates if each not in taken and not keyword.iskeyword(each))


@cache
def names(source: Document) -> frozenset[str]:
    """Return every name that a module uses, in any scope, and the builtins."""
    found = set(dir(builtins))
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Name):
            found.add(node.id)
        elif isinstance(node, ast.arg):
            found.add(node.arg)
        elif isinstance(node, ast.alias):
            found.add(node.asname or node.name.partition(".")[0])
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Global | ast.Nonlocal):
            found.update(node.names)
    return frozenset(found)


@cache
def class_attributes(source: Document) -> frozenset[str]:
    """Return the attributes that a module's classes define or use."""
    classes = [node for node in ast.walk(source.tree) if isinstance(node, ast.ClassDef)]
    inside = [each for owner in classes for each in ast.walk(owner)]
    used = [each for each in inside if isinstance(each, ast.Attribute) and isinstance(each.value, ast.Name)]
    defined = {str(getattr(each, "name", getattr(each, "id", ""))) for each in inside}
    return frozenset(defined.union(each.attr for each in used))
