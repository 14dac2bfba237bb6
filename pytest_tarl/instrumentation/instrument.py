"""Transform an ast so that the program records values, and otherwise behaves as before."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Collection, Mapping
from types import CodeType
from typing import Literal, TypeVar

from pytest_tarl.instrumentation.blocks import (
    enter,
    entry_of,
    first_evaluated_in,
    message_parameter,
    parameters,
)
from pytest_tarl.instrumentation.forms import (
    Where,
    all_floats,
    note,
    note_all,
    note_constant,
    reached,
    recorded,
    start_of,
    truth,
    where,
)
from pytest_tarl.instrumentation.fusing import Run, gather, target_of
from pytest_tarl.instrumentation.magnitude import magnitude

Offset = tuple[int, int]  # line (from 1) and column in UTF-8 bytes (from 0), as in `ast`
Scope = Literal["module", "class", "function"]

# these statements only declare names or do nothing, so they have no value to record
_SILENT = (ast.ClassDef, ast.Import, ast.ImportFrom, ast.Global, ast.Nonlocal)
Function = TypeVar("Function", ast.FunctionDef, ast.AsyncFunctionDef)
Loop = TypeVar("Loop", ast.For, ast.AsyncFor)
Block = TypeVar("Block", ast.With, ast.AsyncWith)


def instrument(
    tree: ast.Module,
    sites: Mapping[Offset, int],
    *,
    publishes: Collection[int] = (),
    inline: bool = False,
    placed: set[Offset] | None = None,
) -> ast.Module:
    """Return the module, with recording of each statement or lambda body that starts at a position in `sites`.

    Compile the result with `compiled`, and insert a hook and a buffer with `constants.bound`. A site records the value
    of its statement, except:

    - Sites in `publishes` and calls of methods named publish record 0.
    - A condition records 1 or 0.
    - The `def` of a function records its message parameter.
    - A loop records its target in each iteration.

    With `inline`, code appends plain floats to the buffer without a call. This function modifies `tree` and adds the
    positions that it records to `placed`.
    """
    found: set[Offset] = set() if placed is None else placed
    changed = _Recording(sites, frozenset(publishes), found, inline=inline).visit(tree)
    assert isinstance(changed, ast.Module)  # noqa: S101 - for the type checker
    return changed


def compiled(tree: ast.Module, path: str) -> CodeType:
    """Compile an instrumented module, without compiler warnings, which would be about the inserted marks."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        code: CodeType = compile(tree, path, "exec", dont_inherit=True)
    return code


class _Recording(ast.NodeTransformer):
    """The ast transformer behind `instrument`."""

    def __init__(
        self, sites: Mapping[Offset, int], publishes: frozenset[int], placed: set[Offset], *, inline: bool
    ) -> None:
        self._sites = sites
        self._inline = inline
        self._publishes = publishes
        self._placed = placed
        self._scope: list[Scope] = ["module"]

    def visit(self, node: ast.AST) -> ast.AST | list[ast.stmt]:
        """Transform nested nodes first, then the statement itself."""
        number = self._number(node) if isinstance(node, ast.stmt) else None
        inner: ast.AST = super().visit(node)
        if number is None or not isinstance(inner, ast.stmt):
            return inner
        change = getattr(self, f"_record_{type(inner).__name__.lower()}", None)
        if change is not None:
            changed: list[ast.stmt] = change(inner, number)
            return changed
        return inner if isinstance(inner, _SILENT) else [*self._nothing(inner, number), inner]

    def _number(self, node: ast.expr | ast.stmt | ast.arg | ast.excepthandler | ast.pattern) -> int | None:
        offset = (node.lineno, node.col_offset)
        number = self._sites.get(offset)
        if number is not None:
            self._placed.add(offset)
        return number

    # Scopes, and recording inside them

    def _inside(self, node: ast.AST, scope: Scope) -> None:
        self._scope.append(scope)
        self.generic_visit(node)
        self._scope.pop()

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.ClassDef:
        """Transform a class."""
        self._inside(node, "class")
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        """Transform a function; sites at its parameters are recorded at its entry."""
        return self._function(node)

    def visit_AsyncFunctionDef(self, node: ast.AsyncFunctionDef) -> ast.AsyncFunctionDef:
        """Transform a coroutine."""
        return self._function(node)

    def _function(self, node: Function) -> Function:
        numbers = [(self._number(parameter), parameter) for parameter in parameters(node.args)]
        at = entry_of(node)
        if self._inline:
            gather(node, self._sites)
        self._inside(node, "function")
        for number, parameter in reversed(numbers):
            if number is not None:
                enter(node, self._note(parameter.arg, number, at))
        return node

    def visit_Run(self, node: Run) -> ast.If:
        """Record a run of arithmetic with one call if its inputs are floats; otherwise record each statement."""
        begins = start_of(first_evaluated_in(node.body))
        numbers = [(target_of(statement).id, self._number(statement)) for statement in node.body]
        events = [(name, number) for name, number in numbers if number is not None]
        fused = [*node.body, note_all(events, where(target_of(node.body[-1])))]
        self.generic_visit(node)
        return ast.If(all_floats(node.inputs, begins), fused, node.body, **begins)

    def visit_Lambda(self, node: ast.Lambda) -> ast.Lambda:
        """Record the body and, if the site is the lambda itself, the message."""
        body, receives = self._number(node.body), self._number(node)
        same = (node.lineno, node.col_offset) == (node.body.lineno, node.body.col_offset)
        publish = self._publishing(node.body, body)
        self._inside(node, "function")
        if body is not None:
            node.body = self._value(node.body, body, where(node.body), publish=publish)
        received = parameters(node.args)
        if receives is not None and received and not same:
            at = start_of(node.body)
            message = recorded(ast.Name(received[0].arg, ast.Load(), **at), receives)
            pair = ast.Tuple([message, node.body], ast.Load(), **at)
            node.body = ast.Subscript(pair, ast.Constant(1, **at), ast.Load(), **at)
        return node

    def visit_ExceptHandler(self, node: ast.ExceptHandler) -> ast.ExceptHandler:
        """Record that an exception was caught."""
        number = self._number(node)
        self.generic_visit(node)
        if number is not None:
            node.body[:0] = self._note_constant(0.0, number, start_of(first_evaluated_in(node.body)))
        return node

    def visit_match_case(self, node: ast.match_case) -> ast.match_case:
        """Record the guard of a case, at the position of its pattern."""
        number = self._number(node.pattern)
        self.generic_visit(node)
        if number is not None and node.guard is not None:
            node.guard = recorded(truth(node.guard), number)
        return node

    # Statements

    def _record_functiondef(self, node: Function, number: int) -> list[ast.stmt]:
        at = entry_of(node)
        message = message_parameter(node, in_class=self._scope[-1] == "class")
        if message is None:
            for statement in reversed(self._note_constant(0.0, number, at)):
                enter(node, statement)
        else:
            enter(node, self._note(message, number, at))
        return [node]

    _record_asyncfunctiondef = _record_functiondef

    def _record_assign(self, node: ast.Assign, number: int) -> list[ast.stmt]:
        if isinstance(node.value, ast.Constant):
            return self._before_or_around(node, node.value, number)
        target = node.targets[0]
        plain = len(node.targets) == 1 and isinstance(target, ast.Name) and self._rereadable()
        if plain and isinstance(target, ast.Name) and not self._publishing(node.value, number):
            return [node, self._note(target.id, number, where(target))]
        return self._before_or_around(node, node.value, number)

    def _record_annassign(self, node: ast.AnnAssign, number: int) -> list[ast.stmt]:
        if node.value is None:
            return [node]
        node.value = self._value(node.value, number, where(node))
        return [node]

    def _record_augassign(self, node: ast.AugAssign, number: int) -> list[ast.stmt]:
        if isinstance(node.target, ast.Name):
            return [node, self._note(node.target.id, number, where(node.target))]
        return self._before_or_around(node, node.value, number)

    def _record_return(self, node: ast.Return, number: int) -> list[ast.stmt]:
        if node.value is None:
            return [*self._nothing(node, number), node]
        return self._before_or_around(node, node.value, number)

    def _record_expr(self, node: ast.Expr, number: int) -> list[ast.stmt]:
        value = node.value
        if isinstance(value, ast.Constant):
            # nothing to record: `...`, or a docstring, which must stay first
            return [node]
        if isinstance(value, ast.Yield):
            if value.value is None:
                return [*self._nothing(node, number), node]
            value.value = recorded(value.value, number, where(value))
            return [node]
        return self._before_or_around(node, value, number)

    def _record_raise(self, node: ast.Raise, number: int) -> list[ast.stmt]:
        return [*self._nothing(node, number), node]

    def _record_assert(self, node: ast.Assert, number: int) -> list[ast.stmt]:
        # record after the assertion: wrapping the condition would move the carets in the traceback of a failure
        return [node, *self._note_constant(1.0, number, start_of(node.test))]

    def _record_if(self, node: ast.If | ast.While, number: int) -> list[ast.stmt]:
        if isinstance(node.test, ast.Constant):
            return [node]  # a constant condition, as in `while True`, is not evaluated at run time
        true = start_of(first_evaluated_in(node.body))
        false = start_of(first_evaluated_in(node.orelse) if node.orelse else node.test)
        node.body[:0] = self._note_constant(1.0, number, true)
        node.orelse[:0] = self._note_constant(0.0, number, false)
        return [node]

    _record_while = _record_if

    def _record_for(self, node: Loop, number: int) -> list[ast.stmt]:
        if isinstance(node.target, ast.Name) and self._rereadable():
            node.body.insert(0, self._note(node.target.id, number, where(node.target)))
        else:
            node.iter = recorded(node.iter, number, where(node.iter))
        return [node]

    _record_asyncfor = _record_for

    def _record_with(self, node: Block, number: int) -> list[ast.stmt]:
        last = node.items[-1]
        if isinstance(last.optional_vars, ast.Name) and self._rereadable():
            node.body.insert(0, self._note(last.optional_vars.id, number, where(last.optional_vars)))
        else:
            last.context_expr = recorded(last.context_expr, number)
        return [node]

    _record_asyncwith = _record_with

    def _record_match(self, node: ast.Match, number: int) -> list[ast.stmt]:
        node.subject = recorded(node.subject, number)
        return [node]

    # Values

    def _note(self, name: str, number: int, at: Where) -> ast.stmt:
        return note(name, number, at, inline=self._inline)

    def _note_constant(self, value: float, number: int, at: Where) -> list[ast.stmt]:
        return note_constant(value, number, at, inline=self._inline)

    def _rereadable(self) -> bool:
        """Return whether reading a name again is certain to run no code; False in a class body."""
        return self._scope[-1] != "class"

    def _before_or_around(
        self, node: ast.Assign | ast.AugAssign | ast.Return | ast.Expr, value: ast.expr, number: int
    ) -> list[ast.stmt]:
        if isinstance(value, ast.Name) and self._rereadable() and not isinstance(node, ast.AugAssign):
            return [self._note(value.id, number, where(value)), node]
        if isinstance(value, ast.Constant):
            return [*self._note_constant(magnitude(value.value), number, start_of(value)), node]
        publish = self._publishing(value, number)
        if publish and isinstance(value, ast.Call) and not (value.args or value.keywords):
            return [*self._nothing(node, number), node]
        node.value = self._value(value, number, where(node), publish=publish)
        return [node]

    def _publishing(self, value: ast.expr, number: int | None) -> bool:
        if not isinstance(value, ast.Call):
            return False
        named = isinstance(value.func, ast.Attribute) and value.func.attr == "publish"
        return named or number in self._publishes

    def _value(self, value: ast.expr, number: int, then: Where, *, publish: bool = False) -> ast.expr:
        if publish and isinstance(value, ast.Call) and (value.args or value.keywords):
            return reached(value, number)
        return recorded(value, number, then)

    def _nothing(self, node: ast.stmt, number: int) -> list[ast.stmt]:
        return self._note_constant(0.0, number, start_of(first_evaluated_in([node])))
