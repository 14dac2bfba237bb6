"""Lowering of expressions from `ast` to the compact form."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.number_tests import shown
from tarl_lint.ir.scopes import Scope

OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Mod: "%",
    ast.FloorDiv: "//",
    ast.Pow: "**",
    ast.MatMult: "@",
    ast.LShift: "<<",
    ast.RShift: ">>",
    ast.BitXor: "^",
    ast.BitOr: "|",
    ast.BitAnd: "&",
    ast.USub: "neg",
    ast.UAdd: "pos",
    ast.Invert: "invert",
    ast.Not: "not",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Is: "is",
    ast.IsNot: "is not",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.In: "in",
    ast.NotIn: "not in",
    ast.And: "and",
    ast.Or: "or",
}

SHORT_CIRCUITS = frozenset(["any", "all", "next"])  # functions that may stop before the end of their argument
AS_TEXT = (-1, ord("s"))  # f-string conversions equivalent to `str`


def position(node: ast.expr | ast.stmt | ast.excepthandler) -> ir.Pos:
    """Return the position of a node."""
    return (
        node.lineno,
        node.col_offset,
        node.end_lineno or node.lineno,
        node.end_col_offset or node.col_offset,
    )


class Expressions:
    """Lowers the expressions of one scope."""

    def __init__(self, module: str) -> None:
        self.module = module
        # first argument of the latest call of a function that may stop before the end of this argument
        self.lazy: ast.expr | None = None
        self.numbers = frozenset[
            str
        ]()  # variables that a test around the current expression has shown to be numbers

    @contextmanager
    def knowing(self, numbers: frozenset[str]) -> Iterator[None]:
        """Lower a part of the program in which further variables are known to be numbers."""
        before, self.numbers = self.numbers, self.numbers | numbers
        yield
        self.numbers = before

    def expr(self, node: ast.expr, scope: Scope) -> ir.Expr:
        """Lower one expression; an expression without a form of its own becomes an operation on its parts."""
        method = LOWER.get(type(node))
        if method is not None:
            return method(self, node, scope)
        parts = [self.expr(n, scope) for n in ast.iter_child_nodes(node) if isinstance(n, ast.expr)]
        return ir.Operation("", parts, position(node))

    def all(self, nodes: Sequence[ast.expr], scope: Scope) -> list[ir.Expr]:
        """Lower several expressions."""
        return [self.expr(n, scope) for n in nodes]

    def _constant(self, node: ast.Constant, scope: Scope) -> ir.Expr:  # noqa: ARG002 - shared signature
        return ir.Const(node.value, position(node))

    def _name(self, node: ast.Name, scope: Scope) -> ir.Name:
        return ir.Name(*scope.resolve(node.id), position(node))

    def _attribute(self, node: ast.Attribute, scope: Scope) -> ir.Expr:
        return ir.Attribute(self.expr(node.value, scope), node.attr, position(node), scope.next())

    def _subscript(self, node: ast.Subscript, scope: Scope) -> ir.Expr:
        return ir.Item(self.expr(node.value, scope), self.expr(node.slice, scope), position(node))

    def _slice(self, node: ast.Slice, scope: Scope) -> ir.Expr:
        bounds = [self.expr(n, scope) if n is not None else None for n in (node.lower, node.upper, node.step)]
        return ir.Slice([one for one in bounds if one is not None], position(node), bounds)

    def _call(self, node: ast.Call, scope: Scope) -> ir.Expr:
        function = self.expr(node.func, scope)
        if isinstance(node.func, ast.Name) and node.func.id in SHORT_CIRCUITS and node.args:
            self.lazy = node.args[0]
        keywords = [(k.arg, self.expr(k.value, scope)) for k in node.keywords]
        arguments, certain = self.all(node.args, scope), self._certain(node)
        return ir.Call(function, arguments, keywords, position(node), scope.next(), certain)

    def _certain(self, node: ast.Call) -> bool:
        """Return whether a call converts a number into a number."""
        one = node.args[0] if len(node.args) == 1 else None
        plain = isinstance(node.func, ast.Name) and node.func.id == "float" and not node.keywords
        return plain and isinstance(one, ast.Name) and one.id in self.numbers

    def _binary(self, node: ast.BinOp, scope: Scope) -> ir.Expr:
        parts = [self.expr(node.left, scope), self.expr(node.right, scope)]
        return ir.Operation(OPERATORS.get(type(node.op), ""), parts, position(node))

    def _unary(self, node: ast.UnaryOp, scope: Scope) -> ir.Expr:
        if isinstance(node.operand, ast.Constant) and isinstance(node.operand.value, (int, float)):
            if isinstance(node.op, ast.USub):
                return ir.Const(-node.operand.value, position(node))
            if isinstance(node.op, ast.UAdd):
                return ir.Const(node.operand.value, position(node))
        return ir.Operation(
            OPERATORS.get(type(node.op), ""), [self.expr(node.operand, scope)], position(node)
        )

    def _boolean(self, node: ast.BoolOp, scope: Scope) -> ir.Expr:
        before, parts = self.numbers, list[ir.Expr]()
        for value in node.values:
            parts.append(self.expr(value, scope))
            if isinstance(node.op, ast.And):
                self.numbers |= shown(value)
        self.numbers = before
        return ir.Operation(OPERATORS[type(node.op)], parts, position(node))

    def _compare(self, node: ast.Compare, scope: Scope) -> ir.Expr:
        operator = OPERATORS.get(type(node.ops[0]), "") if len(node.ops) == 1 else ""
        return ir.Operation(operator, self.all([node.left, *node.comparators], scope), position(node))

    def _choice(self, node: ast.IfExp, scope: Scope) -> ir.Expr:
        test = self.expr(node.test, scope)
        with self.knowing(shown(node.test)):
            then = self.expr(node.body, scope)
        return ir.Choice(test, then, self.expr(node.orelse, scope), position(node), scope.next())

    def _sequence(self, node: ast.Tuple | ast.List | ast.Set, scope: Scope) -> ir.Expr:
        return ir.SequenceDisplay(self.all(node.elts, scope), position(node), scope.next())

    def _mapping(self, node: ast.Dict, scope: Scope) -> ir.Expr:
        items = [
            (self.expr(k, scope) if k is not None else None, self.expr(v, scope))
            for k, v in zip(node.keys, node.values, strict=True)
        ]
        return ir.MappingDisplay(items, position(node), scope.next())

    def _text(self, node: ast.JoinedStr, scope: Scope) -> ir.Expr:
        return ir.Operation("text", self.all(node.values, scope), position(node))

    def _formatted(self, node: ast.FormattedValue, scope: Scope) -> ir.Expr:
        inner = self.expr(node.value, scope)
        if node.format_spec is None and node.conversion in AS_TEXT:
            return inner
        spec = [self.expr(node.format_spec, scope)] if node.format_spec is not None else []
        name = "formatted" if spec and node.conversion in AS_TEXT else ""
        return ir.Operation(name, [inner, *spec], position(node))

    def _comprehension(
        self, node: ast.ListComp | ast.SetComp | ast.GeneratorExp | ast.DictComp, scope: Scope
    ) -> ir.Expr:
        """Lower a comprehension in place: its targets become locals of the function, under unique names."""
        before, slot, numbers = dict(scope.renamed), scope.next(), self.numbers
        lazy = isinstance(node, ast.GeneratorExp) and node is self.lazy
        loops: list[tuple[ir.Expr, ir.Expr, Sequence[ir.Expr]]] = []
        for generator in node.generators:
            source = self.expr(generator.iter, scope)
            for name in ast.walk(generator.target):
                if isinstance(name, ast.Name):
                    self.numbers -= {name.id}
                    scope.renamed[name.id] = f"{name.id}<{slot}>"
                    scope.bound.add(f"{name.id}<{slot}>")
            loops.append((self.expr(generator.target, scope), source, self.all(generator.ifs, scope)))
        tests = [test for generator in node.generators for test in generator.ifs]
        made = node.value if isinstance(node, ast.DictComp) else node.elt
        with self.knowing(frozenset[str]().union(*map(shown, tests))):
            key = self.expr(node.key, scope) if isinstance(node, ast.DictComp) else None
            element = self.expr(made, scope)
        scope.renamed, self.numbers = before, numbers
        return ir.Comprehension(loops, key, element, position(node), slot, made, tests, lazy)

    def _starred(self, node: ast.Starred, scope: Scope) -> ir.Expr:
        return ir.Starred(self.expr(node.value, scope), position(node))

    def _walrus(self, node: ast.NamedExpr, scope: Scope) -> ir.Expr:
        target, value = self.all([node.target, node.value], scope)
        return ir.Walrus(target, value, position(node), scope.next())

    def _await(self, node: ast.Await, scope: Scope) -> ir.Expr:
        return ir.Yield(self.expr(node.value, scope), "await", position(node))

    def _yield(self, node: ast.Yield | ast.YieldFrom, scope: Scope) -> ir.Expr:
        value = self.expr(node.value, scope) if node.value is not None else ir.Const(None, position(node))
        return ir.Yield(value, "from" if isinstance(node, ast.YieldFrom) else "yield", position(node))

    def _lambda(self, node: ast.Lambda, scope: Scope) -> ir.Expr:
        return ir.Lambda(self.function(node, scope), position(node), scope.next())

    def function(self, node: ir.FunctionNode, scope: Scope) -> ir.Function:
        """Lower a function's header; its body is lowered at the first call."""
        name = node.name if not isinstance(node, ast.Lambda) else "<lambda>"
        inner = Scope("function", scope.child(name), scope, around=dict(scope.renamed), plain=scope.plain)
        inner.bound.update(p.arg for p in _arguments(node.args))
        decorators = [] if isinstance(node, ast.Lambda) else self.all(node.decorator_list, scope)
        return ir.Function(
            name, inner.qualname, self.parameters(node.args, scope), decorators, node, self.module, inner,
            position(node),
        )  # fmt: skip

    def parameters(self, arguments: ast.arguments, scope: Scope) -> list[ir.Parameter]:
        """Return the parameters in order, with their defaults."""
        plain = [*arguments.posonlyargs, *arguments.args]
        defaults: list[ast.expr | None] = [
            *([None] * (len(plain) - len(arguments.defaults))),
            *arguments.defaults,
        ]
        found = [
            ir.Parameter(a.arg, "plain", self.expr(d, scope) if d is not None else None)
            for a, d in zip(plain, defaults, strict=True)
        ]
        if arguments.vararg:
            found.append(ir.Parameter(arguments.vararg.arg, "star"))
        found.extend(
            ir.Parameter(a.arg, "keyword", self.expr(d, scope) if d is not None else None)
            for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
        )
        if arguments.kwarg:
            found.append(ir.Parameter(arguments.kwarg.arg, "mapping"))
        return found


def _arguments(arguments: ast.arguments) -> list[ast.arg]:
    extra = [a for a in (arguments.vararg, arguments.kwarg) if a is not None]
    return [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs, *extra]


LOWER: dict[type[ast.AST], Callable[..., ir.Expr]] = {
    ast.Constant: Expressions._constant,
    ast.Name: Expressions._name,
    ast.Attribute: Expressions._attribute,
    ast.Subscript: Expressions._subscript,
    ast.Slice: Expressions._slice,
    ast.Call: Expressions._call,
    ast.BinOp: Expressions._binary,
    ast.UnaryOp: Expressions._unary,
    ast.BoolOp: Expressions._boolean,
    ast.Compare: Expressions._compare,
    ast.IfExp: Expressions._choice,
    ast.Tuple: Expressions._sequence,
    ast.List: Expressions._sequence,
    ast.Set: Expressions._sequence,
    ast.Dict: Expressions._mapping,
    ast.JoinedStr: Expressions._text,
    ast.FormattedValue: Expressions._formatted,
    ast.ListComp: Expressions._comprehension,
    ast.SetComp: Expressions._comprehension,
    ast.GeneratorExp: Expressions._comprehension,
    ast.DictComp: Expressions._comprehension,
    ast.Starred: Expressions._starred,
    ast.NamedExpr: Expressions._walrus,
    ast.Await: Expressions._await,
    ast.Yield: Expressions._yield,
    ast.YieldFrom: Expressions._yield,
    ast.Lambda: Expressions._lambda,
}
