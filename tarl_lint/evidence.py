"""Data for hazard rules: the modules, the value-flow graph and flows of the modules, and the reads of each name."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from tarl_lint.flows.reachability import Tracer
from tarl_lint.ir.nodes import Pos
from tarl_lint.model import Finding, Flow, Span
from tarl_lint.rules.limits.range_checks import limits
from tarl_lint.trees import children, last_name, walk

PROGRAM: Final = re.compile(r"__main__|\bdef main\(|\binit_node\(|\brclpy\.init\(")
Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
DEFINITIONS: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
BY_TEXT: Final = frozenset(["getattr", "hasattr", "vars", "globals", "locals", "eval", "exec"])
# functions that take a name as a string
LOOK_UPS: Final = frozenset(["getattr", "hasattr", "attrgetter", "methodcaller"])
LOCKS: Final = frozenset(["Lock", "RLock", "Condition", "Semaphore", "BoundedSemaphore"])


@dataclass(slots=True)
class Read:
    """One use of a name: the expression, and its enclosing expressions and statements, innermost first."""

    path: str
    node: ast.expr
    around: list[ast.AST]


@dataclass(slots=True)
class Outline:
    """The syntax tree of one module with the parent of each node."""

    tree: ast.Module
    parents: dict[ast.AST, ast.AST] = field(default_factory=dict)
    calls: dict[tuple[int, int], list[ast.Call]] = field(default_factory=dict)
    definitions: list[Definition] = field(default_factory=list)  # sorted by line
    # name of a lock or condition variable → the lock
    locks: dict[str, str] = field(default_factory=dict)
    # last part of a name → values assigned to it
    assigned: dict[str, list[ast.expr]] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)  # names that functions declare global
    shared: frozenset[str] | None = None  # global variables that functions change; None until computed
    # node → names of the locks held there (a cache)
    held: dict[ast.AST, frozenset[str]] = field(default_factory=dict)
    lock_calls: dict[ast.AST, list[tuple[str, str, int]]] = field(
        default_factory=dict
    )  # function → calls made while a lock is held
    # whether the code may use a computed string as the name of an attribute or variable
    by_text: bool = False

    def __post_init__(self) -> None:
        pending: list[ast.AST] = [self.tree]
        while pending:
            node = pending.pop()
            inside = children(node)
            if inside:
                self.parents.update(dict.fromkeys(inside, node))
                inside.reverse()
                pending += inside
            if isinstance(node, DEFINITIONS):
                self.definitions.append(node)
            elif isinstance(node, ast.Call):
                self.calls.setdefault((node.lineno, node.col_offset), []).append(node)
                self.by_text |= _by_text(node)
            elif isinstance(node, ast.Global):
                self.declared.update(node.names)
            elif isinstance(node, ast.Attribute):
                self.by_text |= node.attr == "__dict__"
            elif isinstance(node, ast.Assign):
                self._assigned(node.targets, node.value)
            elif isinstance(node, ast.AnnAssign) and node.value is not None:
                self._assigned([node.target], node.value)

    def _assigned(self, targets: Sequence[ast.expr], value: ast.expr) -> None:
        for target in targets:
            self.assigned.setdefault(last_name(target), []).append(value)
        if isinstance(value, ast.Call):
            self._lock(targets, value)

    def _lock(self, targets: Sequence[ast.expr], call: ast.Call) -> None:
        if last_name(call.func) not in LOCKS:
            return
        shared = last_name(call.args[0]) if call.args else ""
        for target in targets:
            name = last_name(target)
            self.locks[name] = self.locks.get(shared, shared) or name

    def around(self, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the enclosing nodes, innermost first."""
        while (outer := self.parents.get(node)) is not None:
            yield outer
            node = outer

    def call(self, pos: Pos) -> ast.Call | None:
        """Return the call at a position."""
        found = self.calls.get((pos[0], pos[1]), [])
        return next((c for c in found if (c.end_lineno, c.end_col_offset) == (pos[2], pos[3])), None)

    def qualname(self, line: int) -> str:
        """Return the dotted name of the innermost function or class at a line; "" for the module."""
        holding = [d for d in self.definitions if d.lineno <= line <= (d.end_lineno or 0)]
        return ".".join(d.name for d in sorted(holding, key=lambda d: d.lineno))

    def scope(self, node: ast.AST, kinds: tuple[type[ast.AST], ...]) -> ast.AST | None:
        """Return the nearest enclosing function or class."""
        return next((a for a in self.around(node) if isinstance(a, kinds)), None)


class Evidence:
    """The data available to hazard rules."""

    def __init__(self, tracer: Tracer, flows: Sequence[Flow]) -> None:
        self.tracer = tracer  # with it, rules search the value-flow graph
        self.machine = machine = tracer.machine
        self.flows = flows
        self.ours = frozenset(f.function.name for f in machine.frames.values())
        self._outlines: dict[str, Outline] = {}
        self._limited: dict[int, bool] = {}

    def limited(self, statement: ast.AST) -> bool:
        """Return whether the syntax of a statement shows that the statement limits the value it computes."""
        known = self._limited.get(id(statement))
        if known is None:
            known = self._limited[id(statement)] = limits(statement, self.ours)
        return known

    def outline(self, path: str) -> Outline:
        """Return the outline of a module."""
        if path not in self._outlines:
            self._outlines[path] = Outline(self.machine.modules[path].tree)
        return self._outlines[path]

    def assigned(self, name: str) -> list[ast.expr]:
        """Return the values that the modules assign to a name or to an attribute of this name."""
        naming = [m.path for m in self.machine.modules.values() if m.contains(name)]
        return [value for path in naming for value in self.outline(path).assigned.get(name, [])]

    def span(self, path: str, pos: Pos) -> Span:
        """Return a position as a span."""
        return self.tracer.texts[path].stretch(pos)

    def finding(self, code: str, span: Span, message: str, about: str) -> Finding:
        """Return a hazard. `about` identifies the hazard without lines and names of local variables."""
        return Finding(code, span, message, about=about, place=self.outline(span.path).qualname(span.line))

    def complete(self, path: str) -> bool:
        """Return whether a module is part of a complete program, not a library for other programs."""
        module = self.machine.modules[path]
        if module.matches(PROGRAM):
            return True
        last = module.name.rpartition(".")[2]
        return any(m.contains(last) and m.matches(PROGRAM) for m in self.machine.modules.values())

    def reads(self, name: str, *, attribute: bool, path: str = "") -> Iterator[Read]:
        """Yield every place that may read a name, including strings with which code looks up names."""
        for module in self.machine.modules.values():
            if not module.contains(name) or (path and module.path != path):
                continue
            outline = self.outline(module.path)
            for node in walk(module.tree):
                if not isinstance(node, ast.expr) or not _reads(node, name, attribute):
                    continue
                if not isinstance(node, ast.Constant) or self._looked_up(node, outline):
                    yield Read(module.path, node, list(outline.around(node)))

    def _looked_up(self, node: ast.Constant, outline: Outline) -> bool:
        """Return whether a string may be used to look up a name. A string that names a topic does not count."""
        outer = outline.parents.get(node)
        if isinstance(outer, ast.Call) and last_name(outer.func) in LOOK_UPS:
            return True
        return any(self.outline(path).by_text for path in self.machine.modules)

    def imported(self, name: str) -> bool:
        """Return whether any module imports a name from another one."""
        return any(
            alias.name == name
            for module in self.machine.modules.values()
            if module.contains(name)
            for node in walk(module.tree)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        )


def _reads(node: ast.expr, name: str, attribute: bool) -> bool:
    if isinstance(node, ast.Attribute):
        return node.attr == name and not isinstance(node.ctx, ast.Store)
    if isinstance(node, ast.Name):
        return not attribute and node.id == name and not isinstance(node.ctx, ast.Store)
    return isinstance(node, ast.Constant) and node.value == name


def _by_text(call: ast.Call) -> bool:
    """Return whether a call looks up computed names."""
    if not isinstance(call.func, ast.Name) or call.func.id not in BY_TEXT:
        return False
    if call.func.id in ("getattr", "hasattr"):
        return len(call.args) > 1 and not isinstance(call.args[1], ast.Constant)
    return True
