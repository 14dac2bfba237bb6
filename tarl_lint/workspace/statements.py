"""Interpret the constant statements of a file: assignments, loops, functions, and `if` with known tests.

Neither the file nor its imports are executed; the caller supplies models of library functions.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_bytes
from tarl_lint.workspace.expressions import Evaluator, Library, Unknown, unknown
from tarl_lint.workspace.model import Problem

BUDGET: Final = 50_000  # limit on interpreted statements per file
DEEPEST: Final = 30  # limit on nested calls of the file's own functions
LARGEST: Final = 1_000_000  # bytes, limit on a file


class _Returned(Exception):  # noqa: N818 - control flow, never an error
    def __init__(self, value: Any) -> None:
        self.value = value


class _Left(Exception):  # noqa: N818 - `break` or `continue`
    def __init__(self, *, whole: bool) -> None:
        self.whole = whole


@dataclass(frozen=True, slots=True)
class Function:
    """A function of the file."""

    node: ast.FunctionDef
    names: dict[str, Any]


class Interpreter(Evaluator):
    """Interprets one file. `models` holds functions and values of libraries by full name; collects `problems`."""

    def __init__(self, file: Path, models: Mapping[str, Any]) -> None:
        super().__init__(models)
        self.file = file
        self.names: dict[str, Any] = {"__file__": str(file), "__name__": "__main__"}
        self.problems: list[Problem] = []
        self.line = 0  # line of the current call
        self._budget = BUDGET
        self._depth = 0

    def run(self) -> dict[str, Any]:
        """Interpret the file and return its global names."""
        tree = parsed(self.file, self.problems)
        try:
            self._body(tree.body if tree is not None else (), self.names)
        except (_Returned, _Left, RecursionError):
            self.problem(0, "it was read in part: it has too many statements, or nests too deeply")
        return self.names

    def called(self, name: str, *args: Any) -> Any:
        """Call a function of the file and return its value; `Unknown` if there is no such function."""
        function = self.names.get(name)
        if not isinstance(function, Function):
            return Unknown(0, name)
        return self._enter(function, list(args), {})

    def call(self, function: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call of one of the file's functions or of a model."""
        if isinstance(function, Function):
            return self._enter(function, args, keywords) if self._depth < DEEPEST else unknown(node)
        before, self.line = self.line, node.lineno
        try:
            return super().call(function, args, keywords, node)
        finally:
            self.line = before

    def entered(self, function: Function, args: list[Any], keywords: dict[str, Any]) -> Any:
        """Interpret a function of the file and return its value; `Unknown` if it cannot be interpreted."""
        try:
            return self._enter(function, args, keywords)
        except (_Left, RecursionError):
            return Unknown(function.node.lineno, function.node.name)

    def problem(self, line: int, reason: str) -> None:
        """Record a problem."""
        self.problems.append(Problem(self.file, line, reason))

    def _lambda(self, node: ast.Lambda, names: Mapping[str, Any]) -> Any:
        body: list[ast.stmt] = [ast.copy_location(ast.Return(node.body), node.body)]
        made = ast.FunctionDef(name="lambda", args=node.args, body=body, decorator_list=[])
        return Function(ast.copy_location(made, node), dict(names))

    def _enter(self, function: Function, args: list[Any], keywords: dict[str, Any]) -> Any:
        parameters = function.node.args
        names = [one.arg for one in (*parameters.posonlyargs, *parameters.args)]
        inside = {**function.names, **dict.fromkeys(names, Unknown(function.node.lineno, "an argument"))}
        first = len(names) - len(parameters.defaults)
        for name, default in zip(names[first:], parameters.defaults, strict=True):
            inside[name] = self.value(default, function.names)
        inside |= {**dict(zip(names, args, strict=False)), **keywords}
        self._depth += 1
        try:
            self._body(function.node.body, inside)
        except _Returned as returned:
            return returned.value
        finally:
            self._depth -= 1
        return None

    def _body(self, statements: Iterable[ast.stmt], names: dict[str, Any]) -> None:
        for statement in statements:
            self._budget -= 1
            if self._budget < 0:
                raise _Returned(Unknown(statement.lineno, "too many statements"))
            run = getattr(self, f"_do_{type(statement).__name__.lower()}", None)
            if run is not None:
                run(statement, names)

    def _do_expr(self, statement: ast.Expr, names: dict[str, Any]) -> None:
        self.value(statement.value, names)

    def _do_assign(self, statement: ast.Assign, names: dict[str, Any]) -> None:
        value = self.value(statement.value, names)
        for target in statement.targets:
            self._bind(target, value, names)

    def _do_annassign(self, statement: ast.AnnAssign, names: dict[str, Any]) -> None:
        if statement.value is not None:
            self._bind(statement.target, self.value(statement.value, names), names)

    def _do_augassign(self, statement: ast.AugAssign, names: dict[str, Any]) -> None:
        if isinstance(statement.target, ast.Name):
            both = ast.BinOp(ast.Name(statement.target.id, ast.Load()), statement.op, statement.value)
            names[statement.target.id] = self.value(
                ast.fix_missing_locations(ast.copy_location(both, statement)), names
            )

    def _bind(self, target: ast.expr, value: Any, names: dict[str, Any]) -> None:
        if isinstance(target, ast.Name):
            names[target.id] = value
        elif isinstance(target, ast.Tuple | ast.List):
            fits = isinstance(value, list | tuple) and len(value) == len(target.elts)
            for one, item in zip(
                target.elts, value if fits else [unknown(target)] * len(target.elts), strict=True
            ):
                self._bind(one, item, names)
        elif isinstance(target, ast.Subscript):
            base, key = self.value(target.value, names), self.value(target.slice, names)
            if isinstance(base, dict) and isinstance(key, str | int):
                base[key] = value

    def _do_if(self, statement: ast.If, names: dict[str, Any]) -> None:
        test = self.value(statement.test, names)
        if isinstance(test, Unknown | Library):
            self.problem(
                statement.lineno, f"the condition `{ast.unparse(statement.test)[:60]}` is not constant"
            )
            self._body(statement.body, names)  # if the test is unknown, keep the node instead of losing it
        else:
            self._body(statement.body if test else statement.orelse, names)

    def _do_for(self, statement: ast.For, names: dict[str, Any]) -> None:
        items = self.value(statement.iter, names)
        if not isinstance(items, list | tuple | dict | str) and type(items).__name__ not in ("dict_items", "dict_keys",
                                                                                            "dict_values"):  # fmt: skip
            self.problem(
                statement.lineno, f"the loop over `{ast.unparse(statement.iter)[:60]}` is not constant"
            )
            return
        for item in list(items):
            self._bind(statement.target, item, names)
            try:
                self._body(statement.body, names)
            except _Left as left:
                if left.whole:
                    return

    def _do_break(self, _: ast.Break, __: dict[str, Any]) -> None:
        raise _Left(whole=True)

    def _do_continue(self, _: ast.Continue, __: dict[str, Any]) -> None:
        raise _Left(whole=False)

    def _do_with(self, statement: ast.With, names: dict[str, Any]) -> None:
        for item in statement.items:
            if item.optional_vars is not None:
                self._bind(item.optional_vars, self.value(item.context_expr, names), names)
        self._body(statement.body, names)

    def _do_try(self, statement: ast.Try, names: dict[str, Any]) -> None:
        self._body([*statement.body, *statement.orelse, *statement.finalbody], names)

    def _do_return(self, statement: ast.Return, names: dict[str, Any]) -> None:
        raise _Returned(None if statement.value is None else self.value(statement.value, names))

    def _do_functiondef(self, statement: ast.FunctionDef, names: dict[str, Any]) -> None:
        names[statement.name] = Function(statement, names)

    def _do_import(self, statement: ast.Import, names: dict[str, Any]) -> None:
        for alias in statement.names:
            bound = alias.asname or alias.name.partition(".")[0]
            names[bound] = Library(alias.name if alias.asname else bound)

    def _do_importfrom(self, statement: ast.ImportFrom, names: dict[str, Any]) -> None:
        for alias in statement.names:
            name = f"{statement.module}.{alias.name}"
            if alias.name == "*":
                prefix = f"{statement.module}."
                inside = {
                    key.removeprefix(prefix): one
                    for key, one in self.models.items()
                    if key.startswith(prefix)
                }
                names.update({key: one for key, one in inside.items() if "." not in key})
            else:
                names[alias.asname or alias.name] = self.models.get(name, Library(name))


def parsed(file: Path, problems: list[Problem]) -> ast.Module | None:
    """Return the syntax tree of a file; if it cannot be read or parsed, record a problem and return None."""
    try:
        return ast.parse(read_bytes(file, LARGEST))
    except UnreadableError as reason:
        problems.append(Problem(file, 0, str(reason)))
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = getattr(error, "lineno", 0) or 0
        problems.append(Problem(file, line, f"it is not Python 3: {getattr(error, 'msg', error)}"))
    return None
