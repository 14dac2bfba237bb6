"""Groups of modules that only hear or only say something, told by words and syntax: most need not be run.

A flow needs both. Hazards of one side alone are a publisher that never publishes, a callback that does nothing, a
lock that is left out; where the syntax does not rule them out, the group is run like any other.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint import catalog
from tarl_lint.config import Config
from tarl_lint.locking import MADE
from tarl_lint.relevance import code, whole
from tarl_lint.rules import tarl201, tarl203, tarl204
from tarl_lint.source import Module
from tarl_lint.trees import walk

HEARS: Final = re.compile("|".join(whole(w) for w in (*catalog.SOURCE_WORDS, *sorted(catalog.LOOKUPS))))
ANSWERS: Final = re.compile(r"Service\(|create_service|ActionServer")  # sources that are sinks, too
SAYS: Final = re.compile("|".join(map(whole, catalog.SINK_WORDS)))
FACTS: Final = {**catalog.FUNCTIONS, **catalog.METHODS}
MAKERS: Final = frozenset(n.rpartition(".")[2] for n, f in FACTS.items() if f.kind == "publisher")


def one_sided(modules: Sequence[Module], config: Config) -> bool:
    """Tell whether nothing can be found in modules that belong together: no flow, and none of the wanted hazards."""
    if config.named:
        return False
    texts = [code(m.text) for m in modules]
    hears, says, answers = (any(map(words.search, texts)) for words in (HEARS, SAYS, ANSWERS))
    if answers or (hears and says):
        return False
    if config.enabled(tarl201.CODE) and any(map(MADE.search, texts)):
        return False
    if hears and config.enabled(tarl203.CODE) and not all(_all_act(m.tree) for m in modules):
        return False
    return not config.enabled(tarl204.CODE) or all(map(_all_publish, modules, texts))


def _all_act(tree: ast.Module) -> bool:
    """Tell whether every function does something that tells it from an idle callback."""
    return all(tarl203.acting(f) for f in _functions(tree.body))


def _functions(body: Sequence[ast.stmt]) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Yield the functions with parameters among statements, at any depth."""
    for statement in body:
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)) and statement.args.args:
            yield statement
        for name in ("body", "orelse", "finalbody"):
            yield from _functions(getattr(statement, name, ()))
        for part in (*getattr(statement, "handlers", ()), *getattr(statement, "cases", ())):
            yield from _functions(part.body)


def _all_publish(module: Module, text: str) -> bool:
    """Tell whether every publisher is kept under a name of its own, on which something is published."""
    if not any(maker in text for maker in MAKERS):
        return True
    mentioned, names = 0, list[str]()
    for node in walk(module.tree):
        if isinstance(node, (ast.Name, ast.Attribute)) and _last(node) in MAKERS:
            mentioned += 1
        elif isinstance(node, ast.ImportFrom) and any(a.name in MAKERS and a.asname for a in node.names):
            return False
        elif isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            made = _last(node.value.func) in MAKERS
            names += [_last(target) for target in node.targets if made]
    apart = mentioned == len(names) == len(set(names))
    return apart and all(n and re.search(rf"\b{n}\s*\.\s*publish\b", text) for n in names)


def _last(expr: ast.expr) -> str:
    """Return the last part of a dotted name."""
    return expr.attr if isinstance(expr, ast.Attribute) else expr.id if isinstance(expr, ast.Name) else ""
