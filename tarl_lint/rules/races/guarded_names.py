"""Find names of state that is used both with and without a lock, by syntax alone. Only such state can be a hazard."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from tarl_lint.evidence import LOCKS, Outline
from tarl_lint.read.source import Module
from tarl_lint.rules.races.accesses import Access, accesses
from tarl_lint.rules.races.held_locks import FUNCTIONS, locks_around
from tarl_lint.trees import last_name, walk


def always_or_never_guarded(modules: Sequence[Module]) -> bool:
    """Return whether no attribute or global is used both under a lock and without one.

    Uses during construction do not count. If code under a lock calls a function of the modules, the result is
    False, since this function may use any state. Methods of the locks themselves use no state.
    """
    outlines = [Outline(module.tree) for module in modules]
    ours = {d.name for outline in outlines for d in outline.definitions}
    if any(last_name(call.func) in ours for outline in outlines for call in _under_locks(outline)):
        return False
    guarded: set[str] = set()
    bare: set[str] = set()
    for outline in outlines:
        for access in _accesses(outline):
            (guarded if access.locks else bare).add(access.name)
        bare |= set(_at_module_level(outline.tree))
    return guarded.isdisjoint(bare)


def _under_locks(outline: Outline) -> Iterator[ast.Call]:
    """Yield the calls that run while a lock is held; calls of methods of locks are left out."""
    return (
        call
        for calls in outline.calls.values()
        for call in calls
        if locks_around(call, outline) and not _of_lock(call, outline)
    )


def _of_lock(call: ast.Call, outline: Outline) -> bool:
    """Return whether a call calls a method of a lock, such as `Condition.wait`."""
    if not isinstance(call.func, ast.Attribute):
        return False
    values = outline.assigned.get(last_name(call.func.value), [])
    return bool(values) and all(isinstance(v, ast.Call) and last_name(v.func) in LOCKS for v in values)


def _accesses(outline: Outline) -> Iterator[Access]:
    """Yield the accesses to attributes of variables with the name of a receiver, in all functions except `__init__`."""
    receivers = {_first(d) for d in outline.definitions if isinstance(d, FUNCTIONS)}
    for function in walk(outline.tree):
        if isinstance(function, FUNCTIONS) and getattr(function, "name", "") != "__init__":
            for receiver in sorted(receivers | {"self"}):
                yield from accesses(function, receiver, outline)


def _at_module_level(tree: ast.Module) -> Iterator[str]:
    """Yield the names that the top level of the module uses; the main program may use them at any time."""
    pending: list[ast.AST] = [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Name):
            yield node.id
        pending += [c for c in ast.iter_child_nodes(node) if not isinstance(c, FUNCTIONS)]


def _first(function: ast.AST) -> str:
    arguments = getattr(function, "args", None)
    return arguments.args[0].arg if arguments is not None and arguments.args else "self"
