"""Decide whether an expression can only have values that are made of strings in the program itself.

Names of parameters are often computed: from the keys of a table, in a loop, or by a helper method that receives the
name. If all parts of a name are strings in the program, all names that the program reads can be found in its text.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from functools import cached_property
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.system.bound_values import Function, binds, bound_values, is_empty, parameters, parts
from tarl_lint.trees import last_name

_Scope = Function | ast.Lambda | None
# functions whose result is composed of their arguments or their object
_MADE: Final = frozenset(
    ["sorted", "reversed", "enumerate", "zip", "list", "tuple", "set", "frozenset", "dict", "str", "chain", "product",
     "items", "keys", "values", "format", "join", "get", "copy", "range", "len", "int", "OrderedDict"]
)  # fmt: skip
# functions that list the fields of a class
_FIELDS: Final = frozenset(["fields", "asdict", "vars", "get_type_hints"])
_OF_CLASSES: Final = frozenset(["__annotations__", "model_fields", "__dataclass_fields__", "_fields"])
_CHANGING: Final = frozenset(["update", "append", "extend", "insert", "add", "setdefault"])
_DEEPEST: Final = 30  # maximum number of expressions that are followed from one use


class OwnStrings:
    """Follows variables, tables and arguments of functions by name, in the modules of one program."""

    def __init__(self, outlines: Sequence[Outline]) -> None:
        self._outlines = outlines

    def holds(self, expr: ast.expr, outline: Outline) -> bool:
        """Return whether all strings of an expression are strings of the program."""
        return self._own(expr, outline, frozenset())

    @cached_property
    def _calls(self) -> dict[str, list[tuple[Outline, ast.Call]]]:
        found: dict[str, list[tuple[Outline, ast.Call]]] = {}
        for outline in self._outlines:
            for call in (one for calls in outline.calls.values() for one in calls):
                found.setdefault(last_name(call.func), []).append((outline, call))
        return found

    def _own(self, expr: ast.expr, outline: Outline, seen: frozenset[object]) -> bool:
        if len(seen) > _DEEPEST:
            return False
        match expr:
            case ast.Constant():
                return True
            case ast.Name():
                return self._variable(expr, outline, seen)
            case ast.Attribute():
                return self._attribute(expr, outline, seen)
            case ast.Call():
                return self._call(expr, outline, seen)
            case ast.List(elts=elements) | ast.Tuple(elts=elements) | ast.Set(elts=elements):
                return self._elements(elements, outline, seen)
        found = parts(expr)
        return bool(found) and all(self._own(one, outline, seen) for one in found)

    def _elements(self, elements: Sequence[ast.expr], outline: Outline, seen: frozenset[object]) -> bool:
        """Return whether a list or tuple is made of strings; a default value beside a name is ignored."""
        own = [self._own(one, outline, seen) for one in elements]
        named = any(isinstance(one, ast.Constant) and isinstance(one.value, str) for one in elements)
        strange = [one for one, fine in zip(elements, own, strict=True) if not fine]
        # if a variable holds an empty list, other code fills the list
        return (bool(elements) or not seen) and (
            not strange or (named and not any(isinstance(one, ast.Name | ast.Starred) for one in strange))
        )

    def _call(self, call: ast.Call, outline: Outline, seen: frozenset[object]) -> bool:
        name = last_name(call.func)
        if name in _FIELDS and len(call.args) == 1:
            return True
        if name not in _MADE:
            return self._returned(name, seen)
        parts = [*call.args, *(one.value for one in call.keywords)]
        if name in ("dict", "OrderedDict"):
            parts = list(call.args)  # keywords are names, and count as strings of the program
        if isinstance(call.func, ast.Attribute) and not self._module(call.func.value, outline):
            parts.append(call.func.value)
        if name == "get":
            parts = parts[1:]
        return bool(parts or call.keywords) and all(self._own(one, outline, seen) for one in parts)

    def _returned(self, name: str, seen: frozenset[object]) -> bool:
        """Return whether the function of this name returns only strings of the program, if there is exactly one."""
        found = [
            (one, outline)
            for outline in self._outlines
            for one in outline.definitions
            if isinstance(one, Function) and one.name == name
        ]
        if len(found) != 1 or ("function", name) in seen:
            return False
        function, outline = found[0]
        values = [
            one.value for one in ast.walk(function) if isinstance(one, ast.Return) and one.value is not None
        ]
        after = seen | {("function", name)}
        return bool(values) and all(self._own(one, outline, after) for one in values)

    def _module(self, expr: ast.expr, outline: Outline) -> bool:
        if not isinstance(expr, ast.Name):
            return False
        imported = (alias.asname or alias.name for node in ast.walk(outline.tree) if isinstance(node, ast.Import)
                    for alias in node.names)  # fmt: skip
        return expr.id == "chain" or expr.id in imported

    def _attribute(self, expr: ast.Attribute, outline: Outline, seen: frozenset[object]) -> bool:
        """Return whether an attribute is own: a field of a class, or an attribute whose assigned values are all own."""
        if expr.attr in _OF_CLASSES:
            return True
        if ("attribute", expr.attr) in seen:
            return True
        after = seen | {("attribute", expr.attr)}
        if not isinstance(expr.value, ast.Name):
            return False
        if expr.value.id in ("self", "cls") or expr.value.id in self._classes:
            values = [(one, where) for where in self._outlines for one in where.assigned.get(expr.attr, [])]
            filled = [(one, where) for one, where in values if not is_empty(one)]
            if len(filled) < len(values) and self._changed(expr.attr):
                return False
            return bool(filled) and all(self._own(one, where, after) for one, where in filled)
        return self._own(expr.value, outline, after)  # `field.name` in a loop over the fields of a class

    def _changed(self, name: str) -> bool:
        """Return whether code puts elements into a table or list of this name."""
        return any(
            (
                isinstance(node, ast.Subscript)
                and isinstance(node.ctx, ast.Store)
                and last_name(node.value) == name
            )
            or (isinstance(node, ast.Attribute) and node.attr in _CHANGING and last_name(node.value) == name)
            for outline in self._outlines
            for node in ast.walk(outline.tree)
        )

    @cached_property
    def _texts(self) -> frozenset[str]:
        return frozenset(
            name
            for outline in self._outlines
            for name, values in outline.assigned.items()
            if name and any(isinstance(one, ast.Constant) and isinstance(one.value, str) for one in values)
        )

    @cached_property
    def _classes(self) -> frozenset[str]:
        return frozenset(one.name for outline in self._outlines for one in outline.definitions
                         if isinstance(one, ast.ClassDef))  # fmt: skip

    def _variable(self, name: ast.Name, outline: Outline, seen: frozenset[object]) -> bool:
        """Return whether all values that a variable may have are own."""
        scope: _Scope = next(
            (one for one in outline.around(name) if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
             and binds(one, name.id)), None)  # fmt: skip
        key = (name.id, id(scope))
        if key in seen:
            return True
        after = seen | {key}
        if isinstance(scope, ast.Lambda):
            return False
        if scope is not None and name.id in parameters(scope) and not self._passed(scope, name.id, after):
            return False
        places = [(outline, scope)] if scope is not None else [(one, None) for one in self._outlines]
        bound = [
            (one, where)
            for where, inside in places
            for one in bound_values(where.tree if inside is None else inside, name.id, self._texts)
        ]
        passed = scope is not None and name.id in parameters(scope)
        return (passed or bool(bound)) and all(
            value is not None and self._own(value, where, after) for value, where in bound
        )

    def _passed(self, function: Function, name: str, seen: frozenset[object]) -> bool:
        """Return whether all calls of a function pass own strings for a parameter."""
        plain = [*function.args.posonlyargs, *function.args.args]
        names = [one.arg for one in plain]
        given = dict(
            zip(names[len(names) - len(function.args.defaults) :], function.args.defaults, strict=True)
        )
        given |= {one.arg: value for one, value in zip(function.args.kwonlyargs, function.args.kw_defaults, strict=True)
                  if value is not None}  # fmt: skip
        place = names.index(name) - (names[0] in ("self", "cls")) if name in names else -1
        calls = self._calls.get(function.name, [])
        for outline, call in calls:
            keyword = next((one.value for one in call.keywords if one.arg == name), None)
            spread = any(isinstance(one, ast.Starred) for one in call.args) or any(
                not one.arg for one in call.keywords
            )
            value = keyword or (call.args[place] if 0 <= place < len(call.args) else given.get(name))
            if spread or value is None or not self._own(value, outline, seen):
                return False
        return bool(calls)
