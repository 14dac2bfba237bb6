"""Lowering of statements from `ast` to the compact form: one pass per function, on first use."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.context_managers import divided
from tarl_lint.ir.effect_free import OWN_PRINT, only_tells
from tarl_lint.ir.lower_expressions import OPERATORS, Expressions, position
from tarl_lint.ir.match_patterns import captures, conditions
from tarl_lint.ir.number_tests import shown, shown_after
from tarl_lint.ir.program_exits import OWN_EXIT, ends_program, exception
from tarl_lint.ir.scopes import Scope, collect, plain
from tarl_lint.read.source import Module

# subjects of these kinds are first stored in a temporary variable; otherwise each `case` of the `match` would
# evaluate the subject again
MADE = (ir.Call, ir.SequenceDisplay, ir.Walrus, ir.Yield)
NAMED_BELOW = ("KW_ONLY", "dataclasses.KW_ONLY")  # annotations above fields that are passed by name only
NO_FIELDS = ("ClassVar", *NAMED_BELOW)  # annotations that are not dataclass fields
PASSED = "InitVar"  # part of the annotation of a field that a dataclass passes on to `__post_init__`


def lower_module(module: Module) -> ir.Program:
    """Lower the top level of a module."""
    scope = Scope(
        "module",
        "",
        plain=module.answer(plain),
        prints=not module.matches(OWN_PRINT),
        exits=not module.matches(OWN_EXIT),
    )
    lowering = Lowering(module.name)
    package = module.name if module.is_package else module.name.rpartition(".")[0]
    lowering.package = package
    body = lowering.block(module.tree.body, scope)
    node = ast.Lambda(args=_no_arguments(), body=ast.Constant(value=None))
    function = ir.Function("", "", [], [], node, module.name, scope, (1, 0, 1, 0), body)
    return ir.Program(module.name, module.path, body, function, package)


def lower_body(function: ir.Function, package: str) -> Sequence[ir.Stmt]:
    """Return a function's body, lowered on first use."""
    if function.body is None:
        scope = function.scope
        assert isinstance(scope, Scope)  # noqa: S101 - lower_expr stores it
        lowering = Lowering(function.module)
        lowering.package = package
        node = function.node
        if isinstance(node, ast.Lambda):
            function.generator = collect(scope, [node.body])
            function.body = [ir.Return(scope.next(), position(node.body), lowering.expr(node.body, scope))]
        else:
            body = divided(node) if node.decorator_list else node.body
            function.generator = collect(scope, body)
            function.body = lowering.block(body, scope)
    return function.body


def _no_arguments() -> ast.arguments:
    return ast.arguments(posonlyargs=[], args=[], kwonlyargs=[], kw_defaults=[], defaults=[])


class Lowering(Expressions):
    """Lowers the statements of one module or function."""

    package = ""

    def block(self, nodes: Sequence[ast.stmt], scope: Scope) -> list[ir.Stmt]:
        """Lower statements in order."""
        lowered: list[ir.Stmt] = []
        with self.knowing(frozenset()):
            for number, node in enumerate(nodes):
                method = STATEMENTS.get(type(node))
                if method is not None:
                    lowered.extend(method(self, node, scope))
                self.numbers |= shown_after(node, nodes[number + 1 :])
        return lowered

    def _assign(self, node: ast.Assign, scope: Scope) -> list[ir.Stmt]:
        value = self.expr(node.value, scope)
        return [ir.Assign(scope.next(), position(node), self.all(node.targets, scope), value)]

    def _annotated(self, node: ast.AnnAssign, scope: Scope) -> list[ir.Stmt]:
        if node.value is None:
            return []
        value = self.expr(node.value, scope)
        return [ir.Assign(scope.next(), position(node), [self.expr(node.target, scope)], value)]

    def _augmented(self, node: ast.AugAssign, scope: Scope) -> list[ir.Stmt]:
        target = self.expr(node.target, scope)
        operator = f"{OPERATORS[type(node.op)]}="
        value = ir.Operation(operator, [target, self.expr(node.value, scope)], position(node))
        return [ir.Assign(scope.next(), position(node), [target], value, augmented=True)]

    def _evaluate(self, node: ast.Expr, scope: Scope) -> list[ir.Stmt]:
        if isinstance(node.value, ast.Constant) or only_tells(node.value, scope.module().prints):
            return []
        if isinstance(node.value, ast.Call) and ends_program(node.value, builtin=scope.module().exits):
            raised = self.expr(exception(node.value), scope)
            return [ir.Raise(scope.next(), position(node), raised)]
        return [ir.Evaluate(scope.next(), position(node), self.expr(node.value, scope))]

    def _if(self, node: ast.If, scope: Scope) -> list[ir.Stmt]:
        test, number = self.expr(node.test, scope), scope.next()
        with self.knowing(shown(node.test, node.body)):
            body = self.block(node.body, scope)
        return [ir.If(number, position(node), test, body, self.block(node.orelse, scope))]

    def _assert(self, node: ast.Assert, scope: Scope) -> list[ir.Stmt]:
        failed = ir.Raise(scope.next(), position(node), None)
        return [ir.If(scope.next(), position(node), self.expr(node.test, scope), [], [failed])]

    def _while(self, node: ast.While, scope: Scope) -> list[ir.Stmt]:
        test, number = self.expr(node.test, scope), scope.next()
        endless = isinstance(test, ir.Const) and bool(test.value)
        body, orelse = self.block(node.body, scope), self.block(node.orelse, scope)
        return [ir.Loop(number, position(node), test, None, body, orelse, endless)]

    def _for(self, node: ast.For | ast.AsyncFor, scope: Scope) -> list[ir.Stmt]:
        source, target, number = self.expr(node.iter, scope), self.expr(node.target, scope), scope.next()
        body, end = self.block(node.body, scope), scope.next()
        orelse = self.block(node.orelse, scope)
        return [ir.Loop(number, position(node), source, target, body, orelse, nodes=node.body, end=end)]

    def _try(self, node: ast.Try, scope: Scope) -> list[ir.Stmt]:
        number = scope.next()
        handlers: list[tuple[ir.Expr | None, ir.Name | None, Sequence[ir.Stmt]]] = []
        for handler in node.handlers:
            types = self.expr(handler.type, scope) if handler.type is not None else None
            if types is not None and type(node).__name__ == "TryStar":  # `except*`
                types = ir.Starred(types, position(handler))
            name = ir.Name(*scope.resolve(handler.name), position(handler)) if handler.name else None
            handlers.append((types, name, self.block(handler.body, scope)))
        parts = [self.block(b, scope) for b in (node.body, node.orelse, node.finalbody)]
        return [ir.Try(number, position(node), parts[0], handlers, parts[1], parts[2])]

    def _with(self, node: ast.With | ast.AsyncWith, scope: Scope) -> list[ir.Stmt]:
        items = [
            (self.expr(i.context_expr, scope), self.expr(i.optional_vars, scope) if i.optional_vars else None)
            for i in node.items
        ]
        return [ir.With(scope.next(), position(node), items, self.block(node.body, scope))]

    def _return(self, node: ast.Return, scope: Scope) -> list[ir.Stmt]:
        value = self.expr(node.value, scope) if node.value is not None else None
        return [ir.Return(scope.next(), position(node), value)]

    def _raise(self, node: ast.Raise, scope: Scope) -> list[ir.Stmt]:
        value = self.expr(node.exc, scope) if node.exc is not None else None
        return [ir.Raise(scope.next(), position(node), value)]

    def _jump(self, node: ast.Break | ast.Continue, scope: Scope) -> list[ir.Stmt]:
        kind = "break" if isinstance(node, ast.Break) else "continue"
        return [ir.Jump(scope.next(), position(node), "break" if kind == "break" else "continue")]

    def _define(self, node: ast.FunctionDef | ast.AsyncFunctionDef, scope: Scope) -> list[ir.Stmt]:
        target = ir.Name(*scope.resolve(node.name), position(node))
        return [ir.Define(scope.next(), position(node), target, self.function(node, scope))]

    def _class(self, node: ast.ClassDef, scope: Scope) -> list[ir.Stmt]:
        inner = Scope("class", scope.child(node.name), scope, plain=scope.plain)
        collect(inner, node.body)
        target = ir.Name(*scope.resolve(node.name), position(node))
        bases, decorators = self.all(node.bases, scope), self.all(node.decorator_list, scope)
        body = self.block(node.body, inner)
        names, only_named, passed = _annotated(node)
        return [
            ir.Class(
                scope.next(),
                position(node),
                target,
                node.name,
                inner.qualname,
                bases,
                body,
                decorators,
                names,
                only_named,
                [
                    (k.arg, self.expr(k.value, scope))
                    for k in node.keywords
                    if k.arg is not None and k.arg != "metaclass"
                ],
                next((self.expr(k.value, scope) for k in node.keywords if k.arg == "metaclass"), None),
                passed,
            )
        ]

    def _import(self, node: ast.Import, scope: Scope) -> list[ir.Stmt]:
        bindings: list[tuple[ir.Expr | None, str, str | None]] = []
        for alias in node.names:
            bound = alias.asname or alias.name.partition(".")[0]
            module = alias.name if alias.asname else bound
            bindings.append((ir.Name(*scope.resolve(bound), position(node)), module, None))
        return [ir.Import(scope.next(), position(node), bindings)]

    def _import_from(self, node: ast.ImportFrom, scope: Scope) -> list[ir.Stmt]:
        module = node.module or ""
        if node.level:
            parts = self.package.split(".") if self.package else []
            kept = parts[: len(parts) - node.level + 1]
            module = ".".join([*kept, module] if module else kept)
        bindings: list[tuple[ir.Expr | None, str, str | None]] = []
        for alias in node.names:
            bound = (
                ir.Name(*scope.resolve(alias.asname or alias.name), position(node))
                if alias.name != "*"
                else None
            )
            bindings.append((bound, module, alias.name))
        return [ir.Import(scope.next(), position(node), bindings)]

    def _delete(self, node: ast.Delete, scope: Scope) -> list[ir.Stmt]:
        return [ir.Delete(scope.next(), position(node), self.all(node.targets, scope))]

    def match(self, node: ast.Match, scope: Scope) -> list[ir.Stmt]:
        """Lower a `match` to a chain of conditions; captured names are assigned parts of the subject."""
        subject = self.expr(node.subject, scope)
        orelse: list[ir.Stmt] = []
        once: list[ir.Stmt] = []
        if isinstance(subject, MADE):
            scope.bound.add(name := f"<match {scope.next()}>")
            kept = ir.Name(*scope.resolve(name), position(node))
            once, subject = [ir.Assign(scope.next(), position(node), [kept], subject)], kept
        for case in reversed(node.cases):
            bound = self.captures(case, subject, scope)
            body = self.block(case.body, scope)
            if case.guard is None:
                bound, body = [], bound + body
            where = position(node) if case is node.cases[0] else _case_position(case)
            tests = list(conditions(case.pattern, subject, where, lambda n: self.expr(n, scope)))
            if case.guard is not None:
                tests.append(self.expr(case.guard, scope))
            if not tests:
                orelse = body
                continue
            test = ir.Operation("and", tests, where) if len(tests) > 1 else tests[0]
            orelse = [*bound, ir.If(scope.next(), where, test, body, orelse)]
        return once + orelse

    def captures(self, case: ast.match_case, subject: ir.Expr, scope: Scope) -> list[ir.Stmt]:
        """Return assignments of the names that a pattern binds."""
        where = _case_position(case)
        return [
            ir.Assign(scope.next(), where, [ir.Name(*scope.resolve(name), where)], part)
            for name, part in captures(case.pattern, subject, where, lambda node: self.expr(node, scope))
        ]


def _case_position(case: ast.match_case) -> ir.Pos:
    pattern = case.pattern
    return (pattern.lineno, pattern.col_offset, pattern.end_lineno, pattern.end_col_offset)


STATEMENTS: dict[type[ast.AST], Callable[..., list[ir.Stmt]]] = {
    ast.Assign: Lowering._assign,
    ast.AnnAssign: Lowering._annotated,
    ast.AugAssign: Lowering._augmented,
    ast.Expr: Lowering._evaluate,
    ast.If: Lowering._if,
    ast.Assert: Lowering._assert,
    ast.While: Lowering._while,
    ast.For: Lowering._for,
    ast.AsyncFor: Lowering._for,
    ast.Try: Lowering._try,
    ast.With: Lowering._with,
    ast.AsyncWith: Lowering._with,
    ast.Return: Lowering._return,
    ast.Raise: Lowering._raise,
    ast.Break: Lowering._jump,
    ast.Continue: Lowering._jump,
    ast.FunctionDef: Lowering._define,
    ast.AsyncFunctionDef: Lowering._define,
    ast.ClassDef: Lowering._class,
    ast.Import: Lowering._import,
    ast.ImportFrom: Lowering._import_from,
    ast.Delete: Lowering._delete,
    ast.Match: Lowering.match,
}
if hasattr(ast, "TryStar"):
    STATEMENTS[ast.TryStar] = Lowering._try


def _annotated(node: ast.ClassDef) -> tuple[tuple[str, ...], frozenset[str], frozenset[str]]:
    """Return the fields that a class body annotates, those of them below `_: KW_ONLY`, and those with `InitVar`."""
    names: list[str] = []
    passed: list[str] = []
    start: int | None = None
    for part in node.body:
        if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name):
            kind = ast.unparse(part.annotation).strip("'\"").removeprefix("typing.").removeprefix("t.")
            if kind.startswith(NAMED_BELOW):
                start = len(names)
            elif not kind.startswith(NO_FIELDS):
                names.append(part.target.id)
                passed += [part.target.id] if PASSED in kind else []
    return tuple(names), frozenset(names[start:] if start is not None else ()), frozenset(passed)
