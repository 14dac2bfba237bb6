"""Accesses of a function to state that outlives the call: attributes of its object, globals of its module."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from tarl_lint import catalog
from tarl_lint.evidence import Outline
from tarl_lint.rules.races.held_locks import FUNCTIONS, in_loop, locks_around
from tarl_lint.trees import children, walk

MUTATORS: Final = catalog.MUTATORS | {"pop", "popleft", "remove", "clear", "sort", "reverse", "discard"}
# returns all values that the program assigns to a name
Assigned = Callable[[str], list[ast.expr]]
How = Literal["replaces", "adds", "inside", "reads", "length"]  # effect of an access on the value of a name
CONTAINERS: Final = frozenset(["OrderedDict", "Counter", "ChainMap", "UserDict", "UserList"])


@dataclass(frozen=True)
class Access:
    """An access in the source, with the locks held around it in its function.

    `constant` means that the access stores a constant, for example in a flag.
    """

    node: ast.Attribute | ast.Name
    locks: frozenset[str]
    writes: bool
    constant: bool
    repeated: bool
    how: How = "reads"

    @property
    def name(self) -> str:
        """Return the name of the attribute or global."""
        return self.node.attr if isinstance(self.node, ast.Attribute) else self.node.id

    @property
    def is_global(self) -> bool:
        """Return whether the access is to a global, not to an attribute."""
        return isinstance(self.node, ast.Name)


def accesses(
    function: ast.AST, receiver: str, outline: Outline, elsewhere: Assigned | None = None
) -> Iterator[Access]:
    """Yield the accesses of a function to globals and to attributes of its receiver. `receiver` is its name, or "".

    `elsewhere` is used for names to which the module itself assigns no value.
    """
    shared = _globals(outline) - _locals(function)
    for node in _own(function):
        if isinstance(node, ast.Attribute):
            if not (isinstance(node.value, ast.Name) and node.value.id == receiver):
                continue
        elif not (isinstance(node, ast.Name) and node.id in shared):
            continue
        writes = _writes(node, outline, elsewhere)
        if writes or not _asks_presence(node, outline):
            constant = writes and _stores_constant(node, outline)
            how = _changes(node, outline) if writes else _looks(node, outline)
            yield Access(node, locks_around(node, outline), writes, constant, in_loop(node, outline), how)


def _globals(outline: Outline) -> frozenset[str]:
    """Return the globals that functions of the module assign, and those initialised with containers."""
    if outline.shared is None:
        outline.shared = frozenset(outline.declared | _containers(outline))
    return outline.shared


def _containers(outline: Outline) -> set[str]:
    """Return the globals that are initialised with containers."""
    return {
        target.id
        for node in outline.tree.body
        if isinstance(node, ast.Assign) and isinstance(node.value, (ast.List, ast.Dict, ast.Set, ast.Call))
        for target in node.targets
        if isinstance(target, ast.Name) and not _foreign(outline.assigned.get(target.id, []))
    }


def _locals(function: ast.AST) -> set[str]:
    """Return the local names of a function."""
    arguments = getattr(function, "args", None)
    names = {a.arg for a in walk(arguments) if isinstance(a, ast.arg)} if arguments is not None else set()
    shared: set[str] = set()
    for node in _own(function):
        if isinstance(node, ast.Global):
            shared |= set(node.names)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
    return names - shared


def _own(function: ast.AST) -> Iterator[ast.AST]:
    """Yield the syntax nodes of a function, except the nodes of nested functions."""
    body = getattr(function, "body", [])
    pending: list[ast.AST] = list(body) if isinstance(body, list) else [body]
    while pending:
        node = pending.pop()
        if not isinstance(node, FUNCTIONS):
            yield node
            pending += children(node)


def _writes(node: ast.Attribute | ast.Name, outline: Outline, elsewhere: Assigned | None) -> bool:
    """Return whether a name, or a part of its value, is assigned."""
    current: ast.expr = node
    for outer in outline.around(node):
        if isinstance(getattr(current, "ctx", None), (ast.Store, ast.Del)):
            return True
        if isinstance(outer, ast.Call):
            return current is not node and _mutates(current, node, outline, elsewhere)
        if not isinstance(outer, (ast.Attribute, ast.Subscript)) or outer.value is not current:
            return False
        current = outer
    return False


def _changes(node: ast.Attribute | ast.Name, outline: Outline) -> How:
    """Return whether an access replaces the value of a name or changes it in place."""
    if isinstance(node.ctx, ast.Load):
        return "inside"
    return "adds" if isinstance(outline.parents.get(node), ast.AugAssign) else "replaces"


def _looks(node: ast.expr, outline: Outline) -> How:
    outer = outline.parents.get(node)
    asks = isinstance(outer, ast.Call) and isinstance(outer.func, ast.Name) and outer.func.id == "len"
    return "length" if asks else "reads"


def _mutates(
    method: ast.expr, node: ast.Attribute | ast.Name, outline: Outline, elsewhere: Assigned | None
) -> bool:
    """Return whether a method call changes a container.

    Other objects do not count, since they may do their own locking.
    """
    if not isinstance(method, ast.Attribute) or method.attr not in MUTATORS:
        return False
    name = node.attr if isinstance(node, ast.Attribute) else node.id
    own = outline.assigned.get(name, [])
    assigned = own if own or elsewhere is None else elsewhere(name)
    return method.value is not node or not _foreign(assigned)


def _foreign(assigned: Sequence[ast.expr]) -> bool:
    """Return whether every value of a name, except None, is an argument or an instance of a class."""
    values = [v for v in assigned if not (isinstance(v, ast.Constant) and v.value is None)]
    return bool(values) and all(_handed(value) for value in values)


def _handed(value: ast.expr) -> bool:
    if isinstance(value, ast.Call):
        function = value.func
        made = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
        return made.lstrip("_")[:1].isupper() and made not in CONTAINERS
    return isinstance(value, ast.Name)


def _asks_presence(node: ast.expr, outline: Outline) -> bool:
    """Return whether an expression only checks that a value exists: `self.x is None`, `if not self.x`."""
    outer = outline.parents.get(node)
    if isinstance(outer, ast.Compare):
        return all(isinstance(o, (ast.Is, ast.IsNot)) for o in outer.ops)
    return isinstance(outer, (ast.If, ast.While, ast.BoolOp)) or (
        isinstance(outer, ast.UnaryOp) and isinstance(outer.op, ast.Not)
    )


def _stores_constant(node: ast.expr, outline: Outline) -> bool:
    outer = outline.parents.get(node)
    return isinstance(outer, ast.Assign) and isinstance(outer.value, ast.Constant)
