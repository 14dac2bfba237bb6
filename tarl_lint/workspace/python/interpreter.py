"""Interpret the constant statements of a file.

Neither the file nor its imports are executed; the caller supplies models of library functions.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.python import classes
from tarl_lint.workspace.python.assignment_targets import delete, read_target
from tarl_lint.workspace.python.call_stack import OWN, CallStack
from tarl_lint.workspace.python.elements import elements_if_known, items
from tarl_lint.workspace.python.evaluation import call_of, unknown
from tarl_lint.workspace.python.evaluator import FAILURES, Evaluator
from tarl_lint.workspace.python.exceptions import raised, run_try, run_with
from tarl_lint.workspace.python.functions import decorated, lambda_of, made_function
from tarl_lint.workspace.python.importing import Modules, bind_modules, bind_names, bind_outside
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.jumps import Left, Raised, Returned
from tarl_lint.workspace.python.match_patterns import fits
from tarl_lint.workspace.python.objects import Above, Class, Function, Interpreted, Method
from tarl_lint.workspace.python.operators import in_place
from tarl_lint.workspace.python.reflection import reflection
from tarl_lint.workspace.python.source_files import parsed
from tarl_lint.workspace.python.values import (
    Library,
    Namespace,
    Partial,
    Scope,
    Several,
    SpentError,
    Stream,
    Unknown,
)

MODULES: Final = 20  # maximum number of imported modules that are interpreted for a file
_PARTLY: Final = "it was read in part: it has too many statements, or nests too deeply"


class Interpreter(Evaluator):
    """Interprets one file. `models` holds functions and values of libraries by full name; collects `problems`.

    `found` returns the file of an imported module that is to be interpreted too, or None.
    """

    def __init__(
        self,
        file: Path,
        models: Mapping[str, Any],
        found: Callable[[str], Path | None] = lambda _: None,
    ) -> None:
        super().__init__({**reflection(self), **models, "functools.partial": self._partial})
        self.file = file
        self.names: dict[str, Any] = {"__file__": str(file), "__name__": "__main__"}
        self.problems: list[Problem] = []
        self.line = 0  # line of the current call in this file
        self._modules = Modules(self.models, found)
        self._imported: dict[Path, Namespace] = {}
        self._calls = CallStack(file)
        self._handled: list[Raised] = []  # the exceptions whose handlers are being interpreted

    def run(self) -> dict[str, Any]:
        """Interpret the file and return its global names."""
        tree = parsed(self.file, self.problems)
        self._module(tree.body if tree is not None else (), self.names)
        return self.names

    def _module(self, body: Iterable[ast.stmt], names: dict[str, Any]) -> None:
        try:
            self.body(body, Scope(names))
        except Raised as left:
            self.problem(left.line, "it raises an exception here; what follows is not read")
        except (Returned, Left, RecursionError, SpentError):
            self.problem(0, _PARTLY)

    def called(self, name: str, *args: Any) -> Any:
        """Call a function of the file and return its value; `Unknown` if there is no such function."""
        function = self.names.get(name)
        return self.entered(function, list(args), {}) if isinstance(function, Function) else Unknown(0, name)

    def call(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Call a function, a class or a model."""
        before = self.line
        if self._calls.file == self.file:
            self.line = node.lineno
        try:
            if isinstance(called, Function | Method | Class):
                return self._run(called, args, keywords, node)
            if isinstance(called, Made) and called.has("__call__"):
                method = self.attribute(called, "__call__", node)
                return unknown(node) if method is None else self._run(method[0], args, keywords, node)
            return super().call(called, args, keywords, node)
        finally:
            self.line = before

    def _run(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Call a function or class of the file."""
        if self._calls.is_full():
            return unknown(node)
        if isinstance(called, Class):
            return classes.instance(self, called, args, keywords, node)
        if isinstance(called, Method):
            return self._enter(called.function, [called.first, *args], keywords, called.owner)
        return self._enter(called, args, keywords)

    def entered(self, function: Any, args: list[Any], keywords: dict[str, Any]) -> Any:
        """Interpret a function of the file and return its value; `Unknown` if it cannot be interpreted."""
        line, name = (function.node.lineno, function.node.name) if isinstance(function, Function) else (0, "")
        call = ast.Call(ast.Name(name or "a function", ast.Load()), [], [], lineno=line)
        try:
            found = self.call(function, args, keywords, call)
            return elements_if_known(found) if isinstance(found, Stream) else found
        except Raised as left:
            self.problem(left.line, f"{name or 'a function'} raises an exception here")
        except (RecursionError, SpentError):
            self.problem(line, _PARTLY)
        return Unknown(line, name)

    def problem(self, line: int, reason: str, *, hides: bool = True) -> None:
        """Record a problem, once. `hides` means that nodes may be missing because of the problem."""
        one = Problem(self._calls.file, line, reason, hides)
        if one not in self.problems:
            self.problems.append(one)

    def _partial(self, function: Any, *args: Any, **keywords: Any) -> Any:
        call = call_of("partial", self.line)
        called = function.of if isinstance(function, Interpreted) else function
        return Partial(
            lambda *more, **others: self.call(called, [*args, *more], {**keywords, **others}, call)
        )

    def _name(self, node: ast.Name, names: Scope) -> Any:
        if node.id == "super" and names.find(OWN) is not None:
            return lambda *_: self._above(names)
        return super()._name(node, names)

    def _above(self, names: Scope) -> Any:
        owner = names.find(OWN)
        first = next(iter(names.outside().names.values()), None)
        return Above(first, owner[0]) if owner is not None else Unknown(0, "super()")

    def _lambda(self, node: ast.Lambda, names: Scope) -> Any:
        return made_function(self, lambda_of(node), names, self._calls.file, self._enter)

    def _yield(self, node: ast.Yield, names: Scope) -> Any:
        self._calls.give([None if node.value is None else self.value(node.value, names)])

    def _yieldfrom(self, node: ast.YieldFrom, names: Scope) -> Any:
        self._calls.give(self._elements([ast.Starred(node.value)], names))

    def _enter(
        self, function: Function, args: list[Any], keywords: dict[str, Any], owner: Class | None = None
    ) -> Any:
        return self._calls.enter(self, function, args, keywords, owner)

    def body(self, statements: Iterable[ast.stmt], names: Scope) -> None:
        """Interpret statements in order."""
        for statement in statements:
            self.spend()
            run = getattr(self, f"_do_{type(statement).__name__.lower()}", None)
            if run is not None:
                run(statement, names)

    def _do_expr(self, statement: ast.Expr, names: Scope) -> None:
        self.value(statement.value, names)

    def _do_assign(self, statement: ast.Assign, names: Scope) -> None:
        value = self.value(statement.value, names)
        for target in statement.targets:
            self.bind(target, value, names)

    def _do_annassign(self, statement: ast.AnnAssign, names: Scope) -> None:
        if statement.value is not None:
            self.bind(statement.target, self.value(statement.value, names), names)

    def _do_augassign(self, statement: ast.AugAssign, names: Scope) -> None:
        target = statement.target
        before, added = self.value(read_target(target), names), self.value(statement.value, names)
        try:
            if isinstance(before, list) and isinstance(statement.op, ast.Add):
                more = items(self.kept(before, items(added) if isinstance(added, Stream) else added))
                before += [Several(statement.lineno, unknown(statement.value).text)] if more is None else more
                self.spend(len(more or ()) // 50)
            elif isinstance(before, Made) and before.has(in_place(statement.op)):
                self.bind(target, before.run(in_place(statement.op), added), names)
            else:
                self.bind(target, self.operated(type(statement.op), before, added), names)
        except FAILURES:
            self.bind(target, unknown(statement), names)

    def _do_delete(self, statement: ast.Delete, names: Scope) -> None:
        for target in statement.targets:
            delete(self, target, names)

    def _do_global(self, statement: ast.Global, names: Scope) -> None:
        names.elsewhere.update(dict.fromkeys(statement.names, names.module()))

    def _do_nonlocal(self, statement: ast.Nonlocal, names: Scope) -> None:
        bind_outside(statement, names)

    def _do_if(self, statement: ast.If, names: Scope) -> None:
        test = self.value(statement.test, names)
        if isinstance(test, Unknown | Library):
            leaves = isinstance(statement.body[-1], ast.Raise)
            kept, dropped = (statement.orelse, ()) if leaves else (statement.body, statement.orelse)
            also = "; its `else` is not read" if dropped else ""
            self.problem(
                statement.lineno, f"the condition `{ast.unparse(statement.test)[:60]}` is not constant{also}"
            )
            # take the branch that does not raise, so that the nodes in this branch are found
            self.body(kept, names)
        else:
            self.body(statement.body if test else statement.orelse, names)

    def _do_for(self, statement: ast.For, names: Scope) -> None:
        source = self.value(statement.iter, names)
        values: Iterable[Any] | None = (
            source if isinstance(source, Stream) and source.endless else elements_if_known(source)
        )
        if values is None:
            self.problem(
                statement.lineno, f"the loop over `{ast.unparse(statement.iter)[:60]}` is not constant"
            )
            return
        for item in values:
            self.spend()
            self.bind(statement.target, item, names)
            if self._stops(statement.body, names):
                return
        self.body(statement.orelse, names)

    def _do_while(self, statement: ast.While, names: Scope) -> None:
        while True:
            test = self.value(statement.test, names)
            if isinstance(test, Unknown | Library):
                reason = f"the condition `{ast.unparse(statement.test)[:60]}` of a loop is not constant"
                self.problem(statement.lineno, reason)
                return
            if not test:
                break
            if self._stops(statement.body, names):
                return
        self.body(statement.orelse, names)

    def _stops(self, body: list[ast.stmt], names: Scope) -> bool:
        """Interpret the body of a loop once, and return whether it ends with `break`."""
        try:
            self.body(body, names)
        except Left as left:
            return left.whole
        return False

    def _do_break(self, _: ast.Break, __: Scope) -> None:
        raise Left(whole=True)

    def _do_continue(self, _: ast.Continue, __: Scope) -> None:
        raise Left(whole=False)

    def _do_match(self, statement: ast.Match, names: Scope) -> None:
        subject = self.value(statement.subject, names)
        for case in statement.cases:
            fit = fits(self, case.pattern, subject, names)
            if fit and case.guard is not None:
                fit = self.value(case.guard, names)
            if isinstance(fit, Unknown | Library):
                self.problem(
                    case.pattern.lineno, f"the case `{ast.unparse(case.pattern)[:60]}` is not constant"
                )
            elif fit:
                self.body(case.body, names)
                return

    def _do_with(self, statement: ast.With, names: Scope) -> None:
        run_with(self, statement, names)

    def _do_try(self, statement: ast.Try, names: Scope) -> None:
        run_try(self, self._handled, statement, names)

    def _do_raise(self, statement: ast.Raise, names: Scope) -> None:
        if statement.exc is None and self._handled:
            raise self._handled[-1]
        raise raised(self, statement, names)

    def _do_return(self, statement: ast.Return, names: Scope) -> None:
        raise Returned(None if statement.value is None else self.value(statement.value, names))

    def _do_functiondef(self, statement: ast.FunctionDef, names: Scope) -> None:
        made = made_function(self, statement, names, self._calls.file, self._enter)
        names.store(statement.name, decorated(self, made, names))

    def _do_classdef(self, statement: ast.ClassDef, names: Scope) -> None:
        names.store(statement.name, classes.of_statement(self, statement, names))

    def _do_import(self, statement: ast.Import, names: Scope) -> None:
        bind_modules(self, statement, names)

    def _do_importfrom(self, statement: ast.ImportFrom, names: Scope) -> None:
        bind_names(self, statement, names)

    def imported(self, module: str) -> Namespace | None:
        """Return an imported module if it is interpreted, too; otherwise None."""
        file = self._modules.file(module)
        if file is None or (file not in self._imported and len(self._imported) >= MODULES):
            return None
        if file not in self._imported:
            names = {"__file__": str(file), "__name__": module}
            self._imported[file] = Namespace(module, names)
            self._calls.push(file)
            try:
                tree = parsed(file, self.problems)
                self._module(tree.body if tree is not None else (), names)
            finally:
                self._calls.pop()
        return self._imported[file]
