"""Which modules can matter: those that subscribe or publish, what they import, and what imports them."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence

from tarl_lint import catalog
from tarl_lint.config import Config
from tarl_lint.names import Index
from tarl_lint.source import Module


def concerned(modules: Sequence[Module], config: Config) -> bool:
    """Tell whether any module subscribes or publishes, as far as words tell: if none does, nothing is found."""
    sources, sinks = _words(config)
    return any(_mentions(module, (*sources, *sinks)) for module in modules)


def _words(config: Config) -> tuple[list[str], list[str]]:
    """Return words without which a module neither subscribes nor publishes. A wrapper may do either."""
    wrappers = [w.name.rpartition(".")[2] for w in config.wrappers]
    sources = [*catalog.SOURCE_WORDS, *wrappers, *(s.rpartition(".")[2] for s in config.sources)]
    sources += sorted(catalog.LOOKUPS) if config.tf2 else []
    sinks = [*catalog.SINK_WORDS, *wrappers, *(s.rpartition(".")[2] for s in config.sinks)]
    return sources, sinks


def relevant(modules: Sequence[Module], config: Config) -> list[Module]:
    """Return the modules that a flow may pass through, or a subscription or publisher that leads nowhere."""
    sources, sinks = _words(config)
    receiving = [m for m in modules if _mentions(m, sources)]
    sending = [m for m in modules if _mentions(m, sinks)]
    if not receiving and not sending:
        return []
    index = Index(modules)
    imports = {m.path: [i for i in _imports(m, index) if i is not m] for m in modules}
    importers: dict[str, list[Module]] = {m.path: [] for m in modules}
    for module in modules:
        for imported in imports[module.path]:
            importers[imported.path].append(module)
    above = _closure([*receiving, *sending], importers)
    kept = {m.path for m in _closure(above, imports)}
    return [m for m in modules if m.path in kept]


def _mentions(module: Module, words: Iterable[str]) -> bool:
    return any(word in module.text for word in words)


def _closure(start: Iterable[Module], edges: dict[str, list[Module]]) -> list[Module]:
    found = {m.path: m for m in start}
    pending = list(found.values())
    while pending:
        for module in edges[pending.pop().path]:
            if module.path not in found:
                found[module.path] = module
                pending.append(module)
    return list(found.values())


def _imports(module: Module, index: Index) -> Iterator[Module]:
    """Yield the modules of the set that a module imports anywhere."""
    if not any(name.rpartition(".")[2] in module.text for name in index.names):
        return
    for node in ast.walk(module.tree):
        for name in _imported_names(node, module):
            found = index.find(name, module)
            if found is not None:
                yield found


def _imported_names(node: ast.AST, module: Module) -> list[str]:
    if isinstance(node, ast.Import):
        return [a.name for a in node.names]
    if not isinstance(node, ast.ImportFrom):
        return []
    base = node.module or ""
    if node.level:
        parts = module.name.split(".") if module.is_package else module.name.split(".")[:-1]
        kept = parts[: len(parts) - node.level + 1]
        base = ".".join([*kept, base] if base else kept)
    return [base, *(f"{base}.{a.name}" if base else a.name for a in node.names)]
