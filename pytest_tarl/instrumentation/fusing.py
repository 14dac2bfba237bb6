"""Record sequences ("runs") of plain arithmetic on local floats with one call.

If all names that a run reads hold floats at its start, its statements cannot fail, call no code of the program, and
produce only floats. A single call at its end can then record all its events, with the same result at a lower cost. As
types are known only at run time, the instrumented program contains each run twice: a copy for floats, and a copy for
other types that records after each statement.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from pytest_tarl.instrumentation.blocks import Function, parameters

Offset = tuple[int, int]

FEWEST = 3  # minimum number of events in a run; below it, the type checks cost more than they save
_EXACT = 2**53  # smaller integers convert to float exactly
_SAFE = (ast.Add, ast.Sub, ast.Mult)
_DIVIDING = (ast.Div, ast.FloorDiv, ast.Mod)
_SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
_NOTHING: frozenset[str] = frozenset()


class Run(ast.Interactive):
    """A placeholder for a run's statements while a function is transformed."""

    inputs: tuple[str, ...] = ()  # names whose values must be floats


@dataclass
class _Open:
    """A run that may still grow."""

    body: list[ast.stmt] = field(default_factory=list)
    inputs: dict[str, None] = field(default_factory=dict)
    made: set[str] = field(default_factory=set)


def gather(function: Function, sites: Collection[Offset]) -> None:
    """Replace each run with at least FEWEST events by a `Run`, except in nested functions."""
    _Gathering(function, sites).block(function.body, {one.arg for one in parameters(function.args)})


def target_of(statement: ast.stmt) -> ast.Name:
    """Return the target of an assignment in a run."""
    target = statement.targets[0] if isinstance(statement, ast.Assign) else getattr(statement, "target", None)
    assert isinstance(target, ast.Name)  # noqa: S101 - for the type checker
    return target


class _Gathering:
    """One pass over a function that tracks which names are certain to be bound."""

    def __init__(self, function: Function, sites: Collection[Offset]) -> None:
        self._sites = sites
        self._unsure = frozenset(_unsure(function))

    def block(self, statements: list[ast.stmt], bound: set[str]) -> None:
        """Replace the runs in a list of statements and in nested lists; add newly bound names to `bound`."""
        result: list[ast.AST] = []
        run = _Open()
        for statement in statements:
            if not self._grows(run, statement, bound):
                result += self._closed(run)
                run = _Open()
                if not self._grows(run, statement, bound):
                    self._inside(statement, bound)
                    result.append(statement)
            bound |= _given(statement) - self._unsure
        statements[:] = [*result, *self._closed(run)]  # type: ignore[list-item]  # a Run is replaced at once

    def _grows(self, run: _Open, statement: ast.stmt, bound: set[str]) -> bool:
        """Add the statement to the open run if it fits; return whether it does."""
        reads = _arithmetic(statement)
        if reads is None or not reads <= (bound | run.made) - self._unsure:
            return False
        target = target_of(statement).id
        if target in run.made or target in self._unsure:
            return False
        run.body.append(statement)
        run.inputs |= dict.fromkeys(sorted(reads - run.made))
        run.made.add(target)
        return True

    def _closed(self, run: _Open) -> list[ast.AST]:
        events = sum((statement.lineno, statement.col_offset) in self._sites for statement in run.body)
        if events < FEWEST or not 0 < len(run.inputs) <= events:
            return [*run.body]
        fused = Run(body=run.body)
        fused.inputs = tuple(run.inputs)
        return [fused]

    def _inside(self, statement: ast.stmt, bound: set[str]) -> None:
        if isinstance(statement, _SCOPES):
            return
        entered = bound | _entered(statement) - self._unsure
        for part in ("body", "orelse", "finalbody"):
            self.block(getattr(statement, part, []), set(entered if part == "body" else bound))
        for part in (*getattr(statement, "handlers", ()), *getattr(statement, "cases", ())):
            self.block(part.body, set(bound))


def _arithmetic(statement: ast.stmt) -> frozenset[str] | None:
    """Return the names a statement reads; None if it may assign a non-float although they all hold floats."""
    if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
        return _float(statement.value) if isinstance(statement.targets[0], ast.Name) else None
    if isinstance(statement, ast.AugAssign) and isinstance(statement.target, ast.Name):
        at = ast.Name(statement.target.id, ast.Load())
        return _float(ast.BinOp(at, statement.op, statement.value))
    return None


def _float(node: ast.expr) -> frozenset[str] | None:
    """Return the names in an expression; None if its value may be a non-float although they all hold floats."""
    if isinstance(node, ast.Name):
        return frozenset((node.id,))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        return _float(node.operand)
    if isinstance(node, ast.BinOp) and isinstance(node.op, _SAFE):
        whole = next((one for one in (node.left, node.right) if _whole(one)), None)
        if whole is not None:
            return _float(node.left if whole is node.right else node.right)
        left, right = _float(node.left), _float(node.right)
        return None if left is None or right is None else left | right
    if isinstance(node, ast.BinOp) and isinstance(node.op, _DIVIDING):
        return _float(node.left) if _divides(node.right) else None
    return _NOTHING if isinstance(node, ast.Constant) and type(node.value) is float else None


def _whole(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) is int and node.value < _EXACT


def _divides(node: ast.expr) -> bool:
    """Return whether an expression is a nonzero constant, so that dividing by it cannot fail."""
    return isinstance(node, ast.Constant) and bool(node.value) and (_whole(node) or _float(node) is not None)


def _given(statement: ast.stmt) -> set[str]:
    """Return the names that a simple statement is certain to bind."""
    if isinstance(statement, ast.Assign):
        return _stored(statement.targets)
    given = isinstance(statement, ast.AugAssign) or getattr(statement, "value", None) is not None
    return (
        _stored([statement.target])
        if given and isinstance(statement, (ast.AugAssign, ast.AnnAssign))
        else set()
    )


def _entered(statement: ast.stmt) -> set[str]:
    """Return the names bound in the body of a loop or `with`."""
    if isinstance(statement, (ast.For, ast.AsyncFor)):
        return _stored([statement.target])
    if isinstance(statement, (ast.With, ast.AsyncWith)):
        return _stored([item.optional_vars for item in statement.items if item.optional_vars is not None])
    return set()


def _stored(targets: Iterable[ast.expr]) -> set[str]:
    return {
        node.id
        for target in targets
        for node in ast.walk(target)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }


def _unsure(function: Function) -> Iterable[str]:
    """Yield the names that may be unbound, or assigned by other scopes."""
    for node in ast.walk(function):
        if isinstance(node, (ast.Global, ast.Nonlocal)):
            yield from node.names
        elif isinstance(node, ast.ExceptHandler) and node.name is not None:
            yield node.name
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Del):
            yield node.id
