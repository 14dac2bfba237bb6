"""Scopes: resolve names to locals, names of an enclosing function, or globals."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from tarl_lint.ir.nodes import Scope as ScopeKind
from tarl_lint.trees import children, walk

SIMPLE = frozenset([ast.Expr, ast.Return, ast.Raise, ast.Pass, ast.Break, ast.Continue, ast.Assert])
DEFINING = frozenset([ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef])
COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


@dataclass(slots=True, eq=False)
class Scope:
    """The names that a module, class or function binds; `parent` is the enclosing scope."""

    kind: str
    qualname: str
    parent: Scope | None = None
    bound: set[str] = field(default_factory=set)
    globals: set[str] = field(default_factory=set)
    nonlocals: set[str] = field(default_factory=set)
    counter: int = 0  # number of slots and statement numbers given out so far
    # targets of the comprehensions that are being lowered → their unique names
    renamed: dict[str, str] = field(default_factory=dict)
    # the value that `renamed` had in the parent scope at the place where this scope is defined
    around: dict[str, str] = field(default_factory=dict)
    plain: bool = False  # True if no expression in the file binds a name or contains `yield`
    prints: bool = False  # for a module: whether `print` is Python's built-in function
    exits: bool = False  # for a module: whether `exit` and `quit` are Python's own functions

    def resolve(self, name: str) -> tuple[str, ScopeKind, int]:
        """Return the stored name, its kind, and the number of enclosing functions up to its owner."""
        name = self.renamed.get(name, name)
        if name in self.globals or self.kind == "module":
            return name, "global", 0
        if name in self.bound and name not in self.nonlocals:
            return name, "local", 0
        level, scope = 0, self
        while scope.parent is not None:
            if scope.kind == "function":
                level += 1
            stored = scope.around.get(name, name)
            scope = scope.parent
            if scope.kind == "function" and stored in scope.bound and stored not in scope.nonlocals:
                return stored, "free", level
        return name, "global", 0

    def module(self) -> Scope:
        """Return the scope of the module."""
        return self if self.parent is None else self.parent.module()

    def child(self, name: str) -> str:
        """Return the qualified name of a definition in this scope, without `<locals>`."""
        return f"{self.qualname}.{name}" if self.qualname else name

    def next(self) -> int:
        """Return a number that is unique in this function."""
        self.counter += 1
        return self.counter


def collect(scope: Scope, body: Iterable[ast.AST]) -> bool:
    """Add the names that statements bind to `scope`. Return whether one of the statements contains `yield`."""
    yields = False
    for node in _own_statements(body) if scope.plain else _own_nodes(body):
        if isinstance(node, ast.Name):
            if not isinstance(node.ctx, ast.Load):
                scope.bound.add(node.id)
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            scope.bound.add(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            scope.bound.update((a.asname or a.name.partition(".")[0]) for a in node.names if a.name != "*")
        elif isinstance(node, ast.Global):
            scope.globals.update(node.names)
        elif isinstance(node, ast.Nonlocal):
            scope.nonlocals.update(node.names)
        elif isinstance(node, (ast.ExceptHandler, ast.MatchAs, ast.MatchStar)) and node.name:
            scope.bound.add(node.name)
        elif isinstance(node, ast.MatchMapping) and node.rest:
            scope.bound.add(node.rest)
        elif isinstance(node, (ast.Yield, ast.YieldFrom)):
            yields = True
    return yields


def _own_nodes(body: Iterable[ast.AST]) -> Iterator[ast.AST]:
    """Yield the descendants of nodes, except nested functions, classes and comprehension targets."""
    pending = list(body)
    while pending:
        node = pending.pop()
        yield node
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            pending.extend(node.decorator_list)
        elif isinstance(node, COMPREHENSIONS):
            pending.extend(n for n in walk(node) if isinstance(n, ast.NamedExpr))
        elif not isinstance(node, ast.Lambda):
            pending.extend(children(node))


def plain(text: str) -> bool:
    """Return whether the text of a file shows that its expressions bind no name and contain no `yield`."""
    return ":=" not in text and "yield" not in text


def _own_statements(body: Iterable[ast.AST]) -> Iterator[ast.AST]:
    """Yield the nodes that `_own_nodes` yields, but only the assignment targets among expressions."""
    pending = list(body)
    while pending:
        node = pending.pop()
        kind = type(node)
        if kind in SIMPLE:
            continue
        if kind is ast.Assign:
            for target in node.targets:  # type: ignore[attr-defined]
                yield from (target,) if type(target) is ast.Name else _own_nodes((target,))
        elif kind is ast.If or kind is ast.While:
            pending += node.body  # type: ignore[attr-defined]
            pending += node.orelse  # type: ignore[attr-defined]
        elif kind in DEFINING:
            yield node
        elif isinstance(node, ast.expr):
            yield from _own_nodes((node,))
        else:
            yield node
            pending.extend(children(node))
