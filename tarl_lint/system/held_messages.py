"""Infer which expressions of a module hold messages, or parts of them.

Variables, attributes of `self`, elements of lists, arguments of callbacks, annotations and responses of services
are followed. A variable holds a message only if every value assigned to it is a message of the same type; None is
ignored.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from tarl_lint.evidence import Outline
from tarl_lint.system.imported_types import ImportedTypes, short
from tarl_lint.system.message_callbacks import HANDLE, received, received_by_lambdas
from tarl_lint.trees import argument, children, last_name

Heard = Mapping[str, frozenset[str]]
_DEEPEST: Final = 12  # maximum number of variables in a chain
_SAME: Final = frozenset(["copy", "deepcopy", "list", "tuple", "reversed", "sorted"])
_CLIENTS: Final[Mapping[str, tuple[int, str]]] = {
    "ServiceProxy": (1, "service_class"),
    "create_client": (0, "srv_type"),
}
_Function = ast.FunctionDef | ast.AsyncFunctionDef
_Scope = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda | ast.Module
_ANY: Final = "*"  # stands for every attribute
_ELEMENT: Final = "[]"  # end of a path that stands for a list element


class Held(NamedTuple):
    """A message, or a part of a message that the path names; `poses[]` is an element of `poses`."""

    type: str
    path: tuple[str, ...] = ()


class _Value(NamedTuple):
    """The expression of a name, or one of its list elements; None if unknown."""

    expr: ast.expr | None
    element: bool = False


_UNKNOWN: Final = _Value(None)


class HeldMessages:
    """The messages of a module. `heard` are the types of messages that the analysis passes to functions, by name."""

    def __init__(self, tree: ast.Module, outline: Outline, types: ImportedTypes, heard: Heard) -> None:
        self._types, self._outline = types, outline
        self._bound: dict[_Scope, dict[str, list[_Value]]] = {}
        self._known: dict[_Scope, dict[str, Held]] = {}  # types of arguments
        self._attributes: dict[tuple[ast.ClassDef, str], list[_Value]] = {}
        self._foreign: set[str] = set()  # attributes that code sets on objects other than `self`
        self._scopes: dict[ast.AST, _Scope] = {}
        self._tested: dict[_Scope, set[str]] = {}  # variables whose class the code tests
        self._functions: dict[str, list[_Function]] = {}
        # (scope or class, name) → what the variable or attribute holds
        self._found: dict[tuple[ast.AST, str], Held | None] = {}
        self._read(tree)
        by_name = received(tree, types)
        lambdas = received_by_lambdas(tree, types)
        for scope in self._bound:
            if isinstance(scope, ast.Lambda):
                self._known[scope] = _numbered(scope, dict(enumerate(lambdas.get(scope, ()))))
            elif not isinstance(scope, ast.Module):
                self._functions.setdefault(scope.name, []).append(scope)
        for name, functions in self._functions.items():
            for function in functions:
                unique = len(functions) == 1
                self._known[function] = self._arguments(
                    function, by_name.get(name, set()) if unique else set(), heard if unique else {}
                )

    def of(self, expr: ast.expr, depth: int = _DEEPEST) -> Held | None:
        """Return the message that an expression holds; None if it is unknown."""
        if depth <= 0:
            return None
        match expr:
            case ast.Name(id=name):
                return self._named(name, self._scopes.get(expr), depth)
            case ast.Attribute(value=value, attr=name):
                held = self.of(value, depth - 1)
                if held is None:
                    return self._attribute(expr, depth)
                if held.type.endswith(HANDLE):
                    kind = held.type.removesuffix(HANDLE)
                    return Held(f"{kind}.Goal") if name == "request" and not held.path else None
                return Held(held.type, (*held.path, name))
            case ast.Subscript(value=value, slice=place):
                held = self.of(value, depth - 1)
                return held if held is None or isinstance(place, ast.Slice) else _element(held)
            case ast.Call():
                return self._called(expr, depth)
            case ast.IfExp(body=one, orelse=other) | ast.BoolOp(values=[one, other]):
                found = self.of(one, depth - 1)
                return found if found == self.of(other, depth - 1) else None
            case ast.NamedExpr(value=value):
                return self.of(value, depth - 1)
        return None

    def _called(self, call: ast.Call, depth: int) -> Held | None:
        kind = self._types.of(call.func)
        if kind and (not isinstance(call.func, ast.Name) or not self._rebound(call.func)):
            return Held(kind)
        name = last_name(call.func)
        if name in _SAME and len(call.args) == 1:
            return self.of(call.args[0], depth - 1)
        if name == "wait_for_message" and len(call.args) > 1:
            kind = self._types.of(call.args[1])
            return Held(kind) if kind else None
        functions = self._functions.get(name, [])
        if len(functions) == 1 and functions[0].returns is not None:
            return self._annotated(functions[0].returns)
        client = (
            call.func.value
            if isinstance(call.func, ast.Attribute) and name in ("call", "__call__")
            else call.func
        )
        return self._response(client)

    def _response(self, client: ast.expr) -> Held | None:
        """Return the response that a client of a service returns."""
        made = [one.expr for one in self._values(client)]
        if len(made) != 1 or not isinstance(made[0], ast.Call) or last_name(made[0].func) not in _CLIENTS:
            return None
        kind = argument(made[0], *_CLIENTS[last_name(made[0].func)])
        found = self._types.of(kind) if kind is not None else ""
        return Held(short(f"{found}.Response")) if found else None

    def _values(self, expr: ast.expr) -> list[_Value]:
        if isinstance(expr, ast.Name):
            scope = self._scopes.get(expr)
            while scope is not None:
                if expr.id in self._bound[scope]:
                    return self._bound[scope][expr.id]
                scope = self._outer(scope)
        elif isinstance(expr, ast.Attribute):
            return self._attributes.get((owner, expr.attr), []) if (owner := self._class_of(expr)) else []
        return []

    def _rebound(self, name: ast.Name) -> bool:
        """Return whether an imported name is also a variable."""
        return bool(self._values(name)) or name.id in self._functions

    def _named(self, name: str, scope: _Scope | None, depth: int) -> Held | None:
        while scope is not None:
            if name in self._tested.get(scope, ()):
                return None
            values = self._bound[scope].get(name, [])
            known = self._known.get(scope, {}).get(name)
            if known is not None:
                return None if values else known
            if values or name in _argument_names(scope):
                return self._common((scope, name), values, depth)
            scope = self._outer(scope)
        return None

    def _outer(self, scope: _Scope) -> _Scope | None:
        around = self._outline.around(scope)
        return next((one for one in around if isinstance(one, _Scope)), None)

    def _common(self, key: tuple[ast.AST, str], values: list[_Value], depth: int) -> Held | None:
        """Return the message that all values of a variable or attribute hold; None if they differ, or one is unknown.

        Each variable is examined once. If its values depend on the variable itself, the message is unknown.
        """
        if key in self._found:
            return self._found[key]
        self._found[key] = None
        found: set[Held] = set()
        for value in values:
            if isinstance(value.expr, ast.Constant) and value.expr.value is None:
                continue
            held = self.of(value.expr, depth - 1) if value.expr is not None else None
            held = _element(held) if held is not None and value.element else held
            if held is None:
                return None
            found.add(held)
        self._found[key] = found.pop() if len(found) == 1 else None
        return self._found[key]

    def _class_of(self, expr: ast.Attribute) -> ast.ClassDef | None:
        """Return the class of an attribute of `self` that only this class sets."""
        own = isinstance(expr.value, ast.Name) and expr.value.id == "self"
        if not own or not self._foreign.isdisjoint((expr.attr, _ANY)):
            return None
        return next((one for one in self._outline.around(expr) if isinstance(one, ast.ClassDef)), None)

    def _attribute(self, expr: ast.Attribute, depth: int) -> Held | None:
        owner = self._class_of(expr)
        key = (owner, expr.attr) if owner is not None else None
        return None if key is None else self._common(key, self._attributes.get(key, []), depth)

    def _arguments(self, function: _Function, given: set[tuple[str, int]], heard: Heard) -> dict[str, Held]:
        """Return the messages among a function's arguments."""
        by_number: dict[int, set[str]] = {}
        for kind, number in given:
            by_number.setdefault(number, set()).add(kind)
        plain = [one.arg for one in function.args.args if one.arg not in ("self", "cls")]
        kinds = heard.get(function.name, frozenset())
        if not given and kinds and len(plain) == 1:
            by_number[0] = {short(one) for one in kinds}
        single = {number: next(iter(several)) for number, several in by_number.items() if len(several) == 1}
        found = _numbered(function, single)
        several = {
            plain[number] for number, kinds in by_number.items() if len(kinds) > 1 and number < len(plain)
        }
        for one in function.args.args:
            if one.annotation is not None and one.arg not in found and one.arg not in several:
                held = self._annotated(one.annotation)
                found |= {one.arg: held} if held is not None else {}
        return found

    def _annotated(self, expr: ast.expr) -> Held | None:
        if isinstance(expr, ast.Constant) and isinstance(expr.value, str):
            try:
                expr = ast.parse(expr.value, mode="eval").body
            except SyntaxError:
                return None
        kind = self._types.of(expr)
        return Held(kind) if kind else None

    def _read(self, tree: ast.Module) -> None:
        """Collect the scopes, and the values to which names are bound in each."""
        pending: list[tuple[ast.AST, _Scope]] = [(tree, tree)]
        self._bound[tree] = {}
        declared: dict[_Scope, set[str]] = {}
        while pending:
            node, scope = pending.pop()
            if isinstance(node, _Function | ast.Lambda):
                self._bound[node] = {}
                inside: _Scope = node
            else:
                inside = scope
            if isinstance(node, ast.Name):
                self._scopes[node] = scope
            elif isinstance(node, ast.Global):
                declared.setdefault(scope, set()).update(node.names)
            elif isinstance(node, ast.Call) and last_name(node.func) in ("isinstance", "type") and node.args:
                self._tested.setdefault(scope, set()).add(last_name(node.args[0]))
            elif isinstance(node, ast.Call) and last_name(node.func) in ("setattr", "vars"):
                self._foreign.update(_literal(node))
            for target, value in _bindings(node):
                self._bind(target, value, scope, node)
            pending += [(child, inside) for child in reversed(children(node))]
        for scope, names in declared.items():
            for name in names:
                self._bound[tree].setdefault(name, []).extend(self._bound[scope].pop(name, []))

    def _bind(self, target: ast.expr, value: _Value, scope: _Scope, node: ast.AST) -> None:
        if isinstance(target, ast.Name):
            self._bound[scope].setdefault(target.id, []).append(value)
        elif isinstance(target, ast.Attribute):
            owner = next((one for one in self._outline.around(node) if isinstance(one, ast.ClassDef)), None)
            if owner is None or not isinstance(target.value, ast.Name) or target.value.id != "self":
                self._foreign.add(target.attr)
            else:
                self._attributes.setdefault((owner, target.attr), []).append(value)
        elif isinstance(target, ast.Tuple | ast.List):
            for one in target.elts:
                self._bind(one, _UNKNOWN, scope, node)
        elif isinstance(target, ast.Starred):
            self._bind(target.value, _UNKNOWN, scope, node)


def _literal(call: ast.Call) -> list[str]:
    """Return the literal name that `setattr` sets, or ANY."""
    texts = [one.value for one in call.args if isinstance(one, ast.Constant) and isinstance(one.value, str)]
    return texts or [_ANY]


def _element(held: Held) -> Held | None:
    if not held.path or held.path[-1].endswith(_ELEMENT):
        return None
    return Held(held.type, (*held.path[:-1], held.path[-1] + _ELEMENT))


def _argument_names(scope: _Scope) -> list[str]:
    if isinstance(scope, ast.Module):
        return []
    given = scope.args
    named = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return [one.arg for one in named if one is not None]


def _numbered(function: _Function | ast.Lambda, kinds: Mapping[int, str]) -> dict[str, Held]:
    names = [one.arg for one in function.args.args if one.arg not in ("self", "cls")]
    return {names[number]: Held(kind) for number, kind in kinds.items() if kind and number < len(names)}


def _bindings(node: ast.AST) -> Iterator[tuple[ast.expr, _Value]]:
    """Yield the targets that a node assigns, with their values."""
    match node:
        case ast.Assign(targets=targets, value=value):
            for target in targets:
                yield from _paired(target, value)
        case (
            ast.AnnAssign(target=target, value=ast.expr() as value)
            | ast.NamedExpr(target=target, value=value)
        ):
            yield target, _Value(value)
        case ast.AugAssign(target=target):
            yield target, _UNKNOWN
        case ast.For(target=target, iter=values) | ast.AsyncFor(target=target, iter=values):
            yield from _each(target, values)
        case ast.comprehension(target=target, iter=values):
            yield from _each(target, values)
        case ast.withitem(optional_vars=ast.expr() as target):
            yield target, _UNKNOWN
        case ast.ExceptHandler(name=str(name)):
            yield ast.Name(name, ast.Store()), _UNKNOWN


def _paired(target: ast.expr, value: ast.expr) -> Iterator[tuple[ast.expr, _Value]]:
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and len(target.elts) == len(value.elts):
        yield from ((one, _Value(part)) for one, part in zip(target.elts, value.elts, strict=True))
    else:
        yield target, _Value(value)


def _each(target: ast.expr, values: ast.expr) -> Iterator[tuple[ast.expr, _Value]]:
    match target, values:
        case ast.Tuple(elts=[number, one]), ast.Call(func=ast.Name(id="enumerate"), args=[inner, *_]):
            yield number, _UNKNOWN
            yield one, _Value(inner, element=True)
        case _:
            yield target, _Value(values, element=True)
