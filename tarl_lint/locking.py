"""Which locks are held where state is read and written, along the chain of calls."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from tarl_lint import catalog
from tarl_lint.evidence import Evidence, Outline
from tarl_lint.threads import EXECUTOR, MAIN, Threads
from tarl_lint.valueflow.ir import Pos
from tarl_lint.valueflow.values import Frame, Obj

MADE: Final = re.compile(r"\b(R?Lock|Condition|(Bounded)?Semaphore)\(")
LOCKISH: Final = re.compile(r"lock|mutex|sem(aphore)?$|cond(ition)?$", re.I)
MUTATORS: Final = catalog.MUTATORS | {"pop", "popleft", "remove", "clear", "sort", "reverse", "discard"}
FUNCTIONS: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
NO_LOCKS: Final[frozenset[str]] = frozenset()


@dataclass(frozen=True)
class Use:
    """One statement's access to shared state in one thread. `constant`: it stores a constant, as flags do."""

    name: str
    path: str
    pos: Pos
    function: str
    thread: object
    locks: frozenset[str]
    writes: bool
    constant: bool = False


@dataclass(frozen=True)
class Access:
    """An access as written: an attribute of the first parameter, with the locks held around it in its function."""

    node: ast.Attribute
    locks: frozenset[str]
    writes: bool
    constant: bool
    repeated: bool


class Locking:
    """Collects the accesses to attributes of objects in modules that make locks."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence = evidence
        modules = evidence.machine.modules.values()
        self.paths = {m.path for m in modules if MADE.search(m.text) or "with self." in m.text}
        self.active = any(MADE.search(m.text) for m in modules)
        self._accesses: dict[tuple[str, Pos], list[Access]] = {}

    def uses(self) -> dict[tuple[Obj, str], list[Use]]:
        """Return every access by object and attribute, except while the object is being made."""
        found: dict[tuple[Obj, str], dict[Use, None]] = {}
        if not self.active:
            return {}
        threads = Threads(self.evidence)
        for frame in list(self.evidence.machine.frames.values()):
            receiver = _receiver(frame) if frame.program.path in self.paths else None
            if receiver is None or _making(frame, receiver):
                continue
            accesses = self.accesses(frame)
            thread = threads.of(frame) if accesses else None
            if thread is None:
                continue
            held, repeated = self._held(frame)
            for access in accesses:
                if thread in (MAIN, EXECUTOR) and _top(frame) and not (repeated or access.repeated):
                    continue  # it may be from before the threads started
                use = self._use(access, frame, thread, held)
                found.setdefault((receiver, use.name), {})[use] = None
        return {key: list(uses) for key, uses in found.items()}

    def _use(self, access: Access, frame: Frame, thread: object, held: frozenset[str]) -> Use:
        node = access.node
        pos = (node.lineno, node.col_offset, node.end_lineno or 0, node.end_col_offset or 0)
        path, function = frame.program.path, frame.function.name
        locks = access.locks | held
        return Use(node.attr, path, pos, function, thread, locks, access.writes, access.constant)

    def _held(self, frame: Frame) -> tuple[frozenset[str], bool]:
        """Return the locks held by the callers, and whether one of them calls again and again."""
        locks, repeated = NO_LOCKS, False
        current: Frame = frame
        while current.caller is not None and current.call_pos is not None:
            path = current.caller.program.path
            outline = self.evidence.outline(path)
            call = outline.call(current.call_pos)
            if call is not None:
                locks |= locks_around(call, outline)
                repeated |= in_loop(call, outline)
            current = current.caller
        return locks, repeated

    def accesses(self, frame: Frame) -> list[Access]:
        """Return the accesses written in a function to attributes of its receiver."""
        key = (frame.program.path, frame.function.pos)
        known = self._accesses.get(key)
        if known is None:
            outline = self.evidence.outline(key[0])
            name = _receiver_name(frame)
            known = self._accesses[key] = list(_accesses(frame.function.node, name, outline)) if name else []
        return known


def _method(frame: Frame) -> Frame | None:
    """Return the method that a function is, or is written inside of."""
    current: Frame | None = frame
    while current is not None and current.owner is None:
        current = current.outer
    return current


def _receiver(frame: Frame) -> Obj | None:
    """Return the object whose method runs."""
    method = _method(frame)
    key = method.key if method is not None else None
    found = key[4] if isinstance(key, tuple) and len(key) == 5 else None
    if not isinstance(found, frozenset) or len(found) != 1:
        return None
    obj = next(iter(found))
    return obj if isinstance(obj, Obj) and obj.kind == "instance" else None


def _receiver_name(frame: Frame) -> str:
    method = _method(frame)
    parameters = method.function.parameters if method is not None else ()
    return parameters[0].name if parameters else ""


def _making(frame: Frame, receiver: Obj) -> bool:
    """Tell whether the object is only being made: no other thread knows it yet."""
    current: Frame | None = frame
    while current is not None:
        if current.function.name == "__init__" and _receiver(current) is receiver:
            return True
        current = current.caller
    return False


def _top(frame: Frame) -> bool:
    """Tell whether the program's own start leads here, not a callback."""
    top = frame
    while top.caller is not None:
        top = top.caller
    key = top.key
    if not isinstance(key, tuple):
        return False
    return key[0] == "module" or (isinstance(key[1], tuple) and key[1][0] in ("main", "node"))


def _accesses(function: ast.AST, receiver: str, outline: Outline) -> Iterator[Access]:
    for node in _own(function):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == receiver:
            writes = _writes(node, outline)
            if writes or not _asks_presence(node, outline):
                constant = writes and _stores_constant(node, outline)
                yield Access(node, locks_around(node, outline), writes, constant, in_loop(node, outline))


def _own(function: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of a function, not of functions inside it."""
    body = getattr(function, "body", [])
    pending: list[ast.AST] = list(body) if isinstance(body, list) else [body]
    while pending:
        node = pending.pop()
        yield node
        pending += [c for c in ast.iter_child_nodes(node) if not isinstance(c, FUNCTIONS)]


def _writes(node: ast.Attribute, outline: Outline) -> bool:
    """Tell whether an attribute, or something inside it, is stored to."""
    current: ast.expr = node
    for outer in outline.around(node):
        if isinstance(getattr(current, "ctx", None), (ast.Store, ast.Del)):
            return True
        if isinstance(outer, ast.Call):
            return isinstance(current, ast.Attribute) and current is not node and current.attr in MUTATORS
        if not isinstance(outer, (ast.Attribute, ast.Subscript)) or outer.value is not current:
            return False
        current = outer
    return False


def _asks_presence(node: ast.Attribute, outline: Outline) -> bool:
    """Tell whether an attribute is only asked whether it is there: `self.x is None`, `if not self.x`."""
    outer = outline.parents.get(node)
    if isinstance(outer, ast.Compare):
        return all(isinstance(o, (ast.Is, ast.IsNot)) for o in outer.ops)
    return isinstance(outer, (ast.If, ast.While, ast.BoolOp)) or (
        isinstance(outer, ast.UnaryOp) and isinstance(outer.op, ast.Not)
    )


def _stores_constant(node: ast.Attribute, outline: Outline) -> bool:
    outer = outline.parents.get(node)
    return isinstance(outer, ast.Assign) and isinstance(outer.value, ast.Constant)


def in_loop(node: ast.AST, outline: Outline) -> bool:
    """Tell whether a `while` repeats a node within its function."""
    for outer in outline.around(node):
        if isinstance(outer, ast.While):
            return True
        if isinstance(outer, FUNCTIONS):
            return False
    return False


def locks_around(node: ast.AST, outline: Outline) -> frozenset[str]:
    """Return the names of the locks that are held at a node, as far as its function tells."""
    found: set[str] = set()
    function: ast.AST | None = None
    for outer in outline.around(node):
        if isinstance(outer, (ast.With, ast.AsyncWith)):
            found |= {n for item in outer.items if (n := lock_name(item.context_expr, outline))}
        if isinstance(outer, (ast.FunctionDef, ast.AsyncFunctionDef)):
            function = outer
            break
    if function is not None:
        found |= _acquired(node, function, outline)
    return frozenset(found)


def _acquired(node: ast.AST, function: ast.AST, outline: Outline) -> set[str]:
    """Return the locks acquired above a node and released below it."""
    line = getattr(node, "lineno", 0)
    above: set[str] = set()
    below: set[str] = set()
    for call in ast.walk(function):
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute):
            name = lock_name(call.func.value, outline)
            if call.func.attr == "acquire" and call.lineno <= line:
                above.add(name)
            elif call.func.attr == "release" and call.lineno >= line:
                below.add(name)
    return (above & below) - {""}


def lock_name(expr: ast.expr, outline: Outline) -> str:
    """Return the last part of a lock's name, of a condition that of its lock; empty for what is no lock."""
    if isinstance(expr, ast.Call):
        expr = expr.func.value if isinstance(expr.func, ast.Attribute) else expr.func
    name = expr.attr if isinstance(expr, ast.Attribute) else expr.id if isinstance(expr, ast.Name) else ""
    made = outline.locks.get(name)
    return made if made is not None else name if LOCKISH.search(name) else ""
