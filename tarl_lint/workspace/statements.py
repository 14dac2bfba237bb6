"""Interpret the constant statements of a file: assignments, loops, functions, classes, and `if` with known tests.

Neither the file nor its imports are executed; the caller supplies models of library functions.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.expressions import Evaluator, unknown
from tarl_lint.workspace.jumps import Left, Raised, Returned
from tarl_lint.workspace.match_patterns import fits
from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.python_classes import defined
from tarl_lint.workspace.python_files import parsed
from tarl_lint.workspace.python_functions import arguments, yields
from tarl_lint.workspace.python_values import (
    Above,
    Class,
    Field,
    Function,
    Library,
    Made,
    Method,
    Namespace,
    Scope,
    SpentError,
    Unknown,
    items,
)

DEEPEST: Final = 30  # maximum nesting of calls of the file's own functions
MODULES: Final = 20  # maximum number of imported modules that are interpreted for a file
_OWN: Final = "__class__"  # name under which the class of a method is stored, for `super()`
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
        super().__init__({**models, "functools.partial": self._partial})
        self.file = file
        self.names: dict[str, Any] = {"__file__": str(file), "__name__": "__main__"}
        self.problems: list[Problem] = []
        self.line = 0  # line of the current call in this file
        self._found = found
        self._modelled = {
            ".".join(parts[:n])
            for parts in (one.split(".") for one in self.models)
            for n in range(len(parts))
        }
        self._imported: dict[Path, Namespace] = {}
        self._depth = 0
        self._yielded: list[list[Any]] = []
        self._generators: dict[
            ast.FunctionDef, bool
        ] = {}  # function that was called → whether it contains `yield`
        self._files = [file]  # the files of the functions that are being interpreted

    def run(self) -> dict[str, Any]:
        """Interpret the file and return its global names."""
        tree = parsed(self.file, self.problems)
        self._module(tree.body if tree is not None else (), self.names)
        return self.names

    def _module(self, body: Iterable[ast.stmt], names: dict[str, Any]) -> None:
        try:
            self._body(body, Scope(names))
        except Raised as raised:
            self.problem(raised.line, "it raises an exception here; what follows is not read")
        except (Returned, Left, RecursionError, SpentError):
            self.problem(0, _PARTLY)

    def called(self, name: str, *args: Any) -> Any:
        """Call a function of the file and return its value; `Unknown` if there is no such function."""
        function = self.names.get(name)
        return self.entered(function, list(args), {}) if isinstance(function, Function) else Unknown(0, name)

    def call(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call of one of the file's functions or classes, or of a model."""
        before = self.line
        if self._files[-1] == self.file:
            self.line = node.lineno
        try:
            if isinstance(called, Function | Method | Class):
                return self._run(called, args, keywords, node)
            return super().call(called, args, keywords, node)
        finally:
            self.line = before

    def _run(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call of one of the file's functions or classes."""
        if self._depth >= DEEPEST:
            return unknown(node)
        if isinstance(called, Class):
            return self._made(called, args, keywords, node)
        if isinstance(called, Method):
            return self._enter(called.function, [called.first, *args], keywords, called.owner)
        return self._enter(called, args, keywords)

    def entered(self, function: Any, args: list[Any], keywords: dict[str, Any]) -> Any:
        """Interpret a function of the file and return its value; `Unknown` if it cannot be interpreted."""
        line, name = (function.node.lineno, function.node.name) if isinstance(function, Function) else (0, "")
        call = ast.Call(ast.Name(name or "a function", ast.Load()), [], [], lineno=line)
        try:
            return self.call(function, args, keywords, call)
        except Raised as raised:
            self.problem(raised.line, f"{name or 'a function'} raises an exception here")
        except (RecursionError, SpentError):
            self.problem(line, _PARTLY)
        return Unknown(line, name)

    def problem(self, line: int, reason: str, *, hides: bool = True) -> None:
        """Record a problem, once. `hides` says that nodes may be missing because of it."""
        one = Problem(self._files[-1], line, reason, hides)
        if one not in self.problems:
            self.problems.append(one)

    def _partial(self, function: Any, *args: Any, **keywords: Any) -> Any:
        call = ast.Call(ast.Name("partial", ast.Load()), [], [], lineno=self.line)
        return lambda *more, **others: self.call(function, [*args, *more], {**keywords, **others}, call)

    def _name(self, node: ast.Name, names: Scope) -> Any:
        if node.id == "super" and names.find(_OWN) is not None:
            return lambda *_: self._above(names)
        return super()._name(node, names)

    def _above(self, names: Scope) -> Any:
        owner = names.find(_OWN)
        first = next(iter(names.outside().names.values()), None)
        return Above(first, owner[0]) if owner is not None else Unknown(0, "super()")

    def _lambda(self, node: ast.Lambda, names: Scope) -> Any:
        body: list[ast.stmt] = [ast.copy_location(ast.Return(node.body), node.body)]
        made = ast.FunctionDef(name="lambda", args=node.args, body=body, decorator_list=[])
        return self._function(ast.copy_location(made, node), names)

    def _yield(self, node: ast.Yield, names: Scope) -> Any:
        self._yielded[-1].append(None if node.value is None else self.value(node.value, names))

    def _yieldfrom(self, node: ast.YieldFrom, names: Scope) -> Any:
        self._yielded[-1] += self._elements([ast.Starred(node.value)], names)

    def _function(self, node: ast.FunctionDef, names: Scope) -> Function:
        spec = node.args
        positional = [*spec.posonlyargs, *spec.args]
        last = positional[len(positional) - len(spec.defaults) :]
        pairs = [*zip(last, spec.defaults, strict=True), *zip(spec.kwonlyargs, spec.kw_defaults, strict=True)]
        defaults = {one.arg: self.value(default, names) for one, default in pairs if default is not None}
        kinds = [one.id for one in node.decorator_list if isinstance(one, ast.Name)]
        kind = next((one for one in kinds if one in ("staticmethod", "classmethod", "property")), "")
        return Function(node, names, defaults, self._files[-1], kind)

    def _enter(
        self, function: Function, args: list[Any], keywords: dict[str, Any], owner: Class | None = None
    ) -> Any:
        inside = Scope(arguments(function, args, keywords), function.scope)
        if owner is not None:
            inside.names[_OWN] = owner
        self._depth += 1
        self._files.append(function.file)
        self._yielded.append([])
        returned: Any = None
        try:
            self._body(function.node.body, inside)
        except Returned as found:
            returned = found.value
        except Left:
            pass
        finally:
            self._depth -= 1
            self._files.pop()
            yielded = self._yielded.pop()
        if function.node not in self._generators:
            self._generators[function.node] = yields(function.node)
        return yielded if self._generators[function.node] else returned

    def _made(self, kind: Class, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return a new object of a class of the file."""
        if kind.is_enumeration():
            same = [one for one in kind.members() if [one.attributes["value"]] == args]
            return same[0] if same else unknown(node)
        made, fields = Made(kind, {}), kind.all_fields()
        start = kind.find("__init__")
        if start is not None and isinstance(start[0], Function):
            self._enter(start[0], [made, *args], keywords, start[1])
        elif fields is not None:
            given = {**dict(zip(fields, args, strict=False)), **keywords}
            for name in fields:
                made.attributes[name] = given[name] if name in given else self._default(kind, name, node)
            after = kind.find("__post_init__")
            if after is not None and isinstance(after[0], Function):
                self._enter(after[0], [made], {}, after[1])
        return made

    def _default(self, kind: Class, name: str, node: ast.Call) -> Any:
        found = kind.find(name)
        value = found[0] if found is not None else unknown(node)
        if isinstance(value, Field):
            return value.default if value.factory is None else self.call(value.factory, [], {}, node)
        return value

    def _body(self, statements: Iterable[ast.stmt], names: Scope) -> None:
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
        before, added = self.value(_read(target), names), self.value(statement.value, names)
        try:
            if isinstance(before, list) and isinstance(statement.op, ast.Add):
                more = items(self.kept(before, added))
                before += [unknown(statement.value)] if more is None else more
                self.spend(len(more or ()) // 50)
                return
            self.bind(target, self.operated(type(statement.op), before, added), names)
        except (ArithmeticError, LookupError, TypeError, ValueError, AttributeError):
            self.bind(target, unknown(statement), names)

    def _do_delete(self, statement: ast.Delete, names: Scope) -> None:
        for target in statement.targets:
            if isinstance(target, ast.Subscript):
                base, key = self.value(target.value, names), self.value(target.slice, names)
                if isinstance(base, dict) and isinstance(key, str | int):
                    base.pop(key, None)

    def _do_global(self, statement: ast.Global, names: Scope) -> None:
        names.elsewhere.update(dict.fromkeys(statement.names, names.module()))

    def _do_nonlocal(self, statement: ast.Nonlocal, names: Scope) -> None:
        for name in statement.names:
            scope = names.around
            while scope is not None and name not in scope.names:
                scope = scope.around
            if scope is not None:
                names.elsewhere[name] = scope

    def _do_if(self, statement: ast.If, names: Scope) -> None:
        test = self.value(statement.test, names)
        if isinstance(test, Unknown | Library):
            leaves = isinstance(statement.body[-1], ast.Raise)
            kept, dropped = (statement.orelse, ()) if leaves else (statement.body, statement.orelse)
            also = "; its `else` is not read" if dropped else ""
            self.problem(
                statement.lineno, f"the condition `{ast.unparse(statement.test)[:60]}` is not constant{also}"
            )
            self._body(kept, names)  # take the branch that does not raise, so that the nodes in it are found
        else:
            self._body(statement.body if test else statement.orelse, names)

    def _do_for(self, statement: ast.For, names: Scope) -> None:
        values = items(self.value(statement.iter, names))
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
        self._body(statement.orelse, names)

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
        self._body(statement.orelse, names)

    def _stops(self, body: list[ast.stmt], names: Scope) -> bool:
        """Interpret the body of a loop once, and return whether it ends with `break`."""
        try:
            self._body(body, names)
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
                self._body(case.body, names)
                return

    def _do_with(self, statement: ast.With, names: Scope) -> None:
        for item in statement.items:
            value = self.value(item.context_expr, names)
            if item.optional_vars is not None:
                self.bind(item.optional_vars, value, names)
        self._body(statement.body, names)

    def _do_try(self, statement: ast.Try, names: Scope) -> None:
        try:
            self._body(statement.body, names)
            self._body(statement.orelse, names)
        except Raised as raised:
            if not statement.handlers:
                raise
            handler = statement.handlers[0]
            if handler.name is not None:
                names.store(handler.name, Unknown(raised.line, "an exception"))
            self._body(handler.body, names)
        finally:
            self._body(statement.finalbody, names)

    def _do_raise(self, statement: ast.Raise, _: Scope) -> None:
        raise Raised(statement.lineno)

    def _do_return(self, statement: ast.Return, names: Scope) -> None:
        raise Returned(None if statement.value is None else self.value(statement.value, names))

    def _do_functiondef(self, statement: ast.FunctionDef, names: Scope) -> None:
        names.store(statement.name, self._function(statement, names))

    def _do_classdef(self, statement: ast.ClassDef, names: Scope) -> None:
        bases = tuple(self.value(one, names) for one in statement.bases)
        inside = Scope({}, names)
        self._body(statement.body, inside)
        decorators = [one.func if isinstance(one, ast.Call) else one for one in statement.decorator_list]
        values = [self.value(one, names) for one in decorators]
        names.store(statement.name, defined(statement, bases, values, inside.names))

    def _do_import(self, statement: ast.Import, names: Scope) -> None:
        for alias in statement.names:
            bound = alias.asname or alias.name.partition(".")[0]
            whole = alias.name if alias.asname else bound
            names.store(bound, self.imported(whole) or Library(whole))

    def _do_importfrom(self, statement: ast.ImportFrom, names: Scope) -> None:
        module = statement.module or ""
        read = self.imported(module)
        for alias in statement.names:
            name = f"{module}.{alias.name}"
            if alias.name == "*":
                known = read.names if read is not None else _below(module, self.models)
                for key, one in known.items():
                    names.store(key, one)
            elif name in self.models:
                names.store(alias.asname or alias.name, self.models[name])
            elif read is not None and alias.name in read.names:
                names.store(alias.asname or alias.name, read.names[alias.name])
            else:
                names.store(alias.asname or alias.name, self.imported(name) or Library(name))

    def imported(self, module: str) -> Namespace | None:
        """Return an imported module that is interpreted too; None if it is not."""
        file = None if module in self._modelled else self._found(module)
        if file is None or (file not in self._imported and len(self._imported) >= MODULES):
            return None
        if file not in self._imported:
            names = {"__file__": str(file), "__name__": module}
            self._imported[file] = Namespace(module, names)
            self._files.append(file)
            try:
                tree = parsed(file, self.problems)
                self._module(tree.body if tree is not None else (), names)
            finally:
                self._files.pop()
        return self._imported[file]


def _read(target: ast.expr) -> ast.expr:
    """Return the target of an assignment as an expression that is read."""
    return ast.copy_location(ast.parse(ast.unparse(target), mode="eval").body, target)


def _below(module: str, models: Mapping[str, Any]) -> dict[str, Any]:
    """Return what `from module import *` binds."""
    prefix = f"{module}."
    inside = {key.removeprefix(prefix): one for key, one in models.items() if key.startswith(prefix)}
    return {key: one for key, one in inside.items() if "." not in key}
