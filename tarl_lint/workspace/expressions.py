"""Evaluate constant Python expressions without executing code.

A value is a constant, a list, tuple or dict of values, a `Library` (a name imported from another module), a function,
class or object of the file itself, or a result of the models of library functions. A value that is not constant is an
`Unknown`, never an error.
"""

from __future__ import annotations

import ast
import functools
from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any, Final

from tarl_lint.workspace.python_library import (
    BUILTINS,
    COMPARE,
    LIBRARIES,
    METHODS,
    UNARY,
    binary,
    formatted,
    function,
    is_builtin,
    method,
)
from tarl_lint.workspace.python_values import (
    Above,
    Bound,
    Class,
    FilePath,
    Function,
    Library,
    Made,
    Method,
    Namespace,
    Scope,
    SpentError,
    Unknown,
    items,
    known,
    plain,
)

__all__ = ["Evaluator", "Library", "Unknown", "constant", "unknown"]

STEPS: Final = 300_000  # maximum number of expressions and statements that are evaluated for one file
_FAILURES: Final = (ArithmeticError, LookupError, TypeError, ValueError, AttributeError, StopIteration)


class Evaluator:
    """Evaluates the expressions of one file. `models` holds functions and values of libraries by full name."""

    def __init__(self, models: Mapping[str, Any], steps: int = STEPS) -> None:
        self.models = {**LIBRARIES, **models}
        self.left = [steps]  # shared with the files that this one imports

    def spend(self, steps: int = 1) -> None:
        """Count steps. Raises SpentError if the limit is reached."""
        self.left[0] -= steps
        if self.left[0] < 0:
            raise SpentError("it has too many statements")

    def value(self, node: ast.expr, names: Scope) -> Any:
        """Return the value of an expression; `Unknown` if it is not constant. Raises SpentError."""
        self.spend()
        visit = getattr(self, f"_{type(node).__name__.lower()}", None)
        if visit is None:
            return unknown(node)
        try:
            return visit(node, names)
        except _FAILURES:
            return unknown(node)

    def call(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call. Subclasses handle functions and classes of the file."""
        if not isinstance(called, Bound) and (isinstance(called, Unknown | Library) or not callable(called)):
            return unknown(node)
        if isinstance(called, Bound) or (is_builtin(called) and called is not BUILTINS["isinstance"]):
            args = [self._callable(one, node) for one in args]
            keywords = {key: self._callable(one, node) for key, one in keywords.items()}
        run = method if isinstance(called, Bound) else function
        found = run(called, args, keywords)
        if isinstance(found, str | list | tuple | dict):
            self.spend(len(found) // 50)
        return found

    def imported(self, module: str) -> Namespace | None:  # noqa: ARG002 - for subclasses
        """Return an imported module that is interpreted too; None if it is not."""
        return None

    def kept(self, container: Any, value: Any) -> Any:  # noqa: ARG002 - for subclasses
        """Return the form in which a list or dict keeps a value that is stored in it."""
        return value

    def bind(self, target: ast.expr, value: Any, names: Scope) -> None:
        """Assign a value to a name, an element, an attribute, or several of them."""
        if isinstance(target, ast.Name):
            names.store(target.id, value)
        elif isinstance(target, ast.Tuple | ast.List):
            self._unpack(target, items(value), names)
        elif isinstance(target, ast.Subscript):
            base, key = self.value(target.value, names), self.value(target.slice, names)
            if (isinstance(base, dict) and plain(key, 100)) or (
                isinstance(base, list) and isinstance(key, int)
            ):
                base[key] = self.kept(base, value)
        elif isinstance(target, ast.Attribute):
            base = self.value(target.value, names)
            if isinstance(base, Made):
                base.attributes[target.attr] = value
            elif isinstance(base, Class):
                base.names[target.attr] = value

    def _unpack(self, target: ast.Tuple | ast.List, values: list[Any] | None, names: Scope) -> None:
        starred = next((i for i, one in enumerate(target.elts) if isinstance(one, ast.Starred)), None)
        wanted = len(target.elts)
        if values is not None and starred is not None and len(values) >= wanted - 1:
            end = len(values) - (wanted - starred - 1)
            values = [*values[:starred], values[starred:end], *values[end:]]
        if values is None or len(values) != wanted:
            values = [unknown(target)] * wanted
        for one, item in zip(target.elts, values, strict=True):
            self.bind(one.value if isinstance(one, ast.Starred) else one, item, names)

    def _callable(self, value: Any, node: ast.Call) -> Any:
        """Return a function of the file in a form that built-in functions can call."""
        if isinstance(value, Function | Method | Class | Bound):
            return lambda *args, **keywords: self.call(value, list(args), keywords, node)
        return value

    def _constant(self, node: ast.Constant, _: Scope) -> Any:
        return node.value

    def _name(self, node: ast.Name, names: Scope) -> Any:
        found = names.find(node.id)
        if found is not None:
            return found[0]
        return self.models.get(f"builtins.{node.id}", BUILTINS.get(node.id, unknown(node)))

    def _namedexpr(self, node: ast.NamedExpr, names: Scope) -> Any:
        value = self.value(node.value, names)
        names.outside().store(node.target.id, value)
        return value

    def _attribute(self, node: ast.Attribute, names: Scope) -> Any:
        found = self.attribute(self.value(node.value, names), node.attr, node)
        return unknown(node) if found is None else found[0]

    def attribute(self, base: Any, name: str, node: ast.AST) -> tuple[Any] | None:
        """Return a tuple with an attribute of a value; None if the attribute is not known."""
        if isinstance(base, Library):
            full = f"{base.name}.{name}"
            return (self.models.get(full, Library(full)),)
        if isinstance(base, Namespace):
            inner = base.names[name] if name in base.names else self.imported(f"{base.module}.{name}")
            return None if inner is None else (inner,)
        if isinstance(base, Made | Class | Above):
            return self._of_class(base, name, node)
        if name in METHODS.get(type(base), ()):
            return (Bound(base, name),)
        if isinstance(base, FilePath) and f"pathlib.Path.{name}" in self.models:
            return (functools.partial(self.models[f"pathlib.Path.{name}"], base),)
        if name in getattr(type(base), "readable", ()) or name in getattr(base, "readable", ()):
            found = getattr(base, name)
            return (FilePath(found) if isinstance(found, PurePosixPath) else found,)
        return None

    def _of_class(self, base: Made | Class | Above, name: str, node: ast.AST) -> tuple[Any] | None:
        if isinstance(base, Made) and name in base.attributes:
            return (base.attributes[name],)
        if isinstance(base, Above):
            above = [one.find(name) for one in base.owner.bases if isinstance(one, Class)]
            found = next((one for one in above if one is not None), None)
            instance = base.of
        else:
            found = (base if isinstance(base, Class) else base.kind).find(name)
            instance = None if isinstance(base, Class) else base
        if found is None:
            return None
        value, owner = found
        if isinstance(value, Function):
            if value.kind == "classmethod":
                return (Method(value, instance.kind if isinstance(instance, Made) else base, owner),)
            if instance is not None and value.kind != "staticmethod":
                bound = Method(value, instance, owner)
                call = ast.Call(ast.Name(name, ast.Load()), [], [])
                if value.kind == "property":
                    return (self.call(bound, [], {}, ast.copy_location(call, node)),)
                return (bound,)
        return (value,)

    def _list(self, node: ast.List, names: Scope) -> Any:
        return self._elements(node.elts, names)

    def _tuple(self, node: ast.Tuple, names: Scope) -> Any:
        return tuple(self._elements(node.elts, names))

    def _set(self, node: ast.Set, names: Scope) -> Any:
        found = self._elements(node.elts, names)
        if plain(found) or not known(found):
            return BUILTINS["set"](found)
        return list(
            {id(one): one for one in found}.values()
        )  # objects such as substitutions are equal only to themselves

    def _elements(self, nodes: list[ast.expr], names: Scope) -> list[Any]:
        found: list[Any] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                inner = items(self.value(node.value, names))
                found += inner if inner is not None else [unknown(node.value)]
                self.spend(len(inner or ()))
            else:
                found.append(self.value(node, names))
        return found

    def _dict(self, node: ast.Dict, names: Scope) -> Any:
        found: dict[Any, Any] = {}
        for key, item in zip(node.keys, node.values, strict=True):
            value = self.value(item, names)
            if key is None:
                found.update(value if isinstance(value, dict) else {})
                self.spend(len(value) if isinstance(value, dict) else 0)
            else:
                found[self._key(self.value(key, names))] = value
        return found

    def _key(self, value: Any) -> Any:
        if isinstance(value, list | tuple) and not plain(value, 100):
            return Unknown(0, "a key")
        return value

    def _joinedstr(self, node: ast.JoinedStr, names: Scope) -> Any:
        parts = [
            self._formatted(one, names) if isinstance(one, ast.FormattedValue) else self.value(one, names)
            for one in node.values
        ]
        self.spend(sum(map(len, parts)) // 50)
        return "".join(parts)

    def _formatted(self, node: ast.FormattedValue, names: Scope) -> str:
        spec = self.value(node.format_spec, names) if node.format_spec is not None else ""
        value = self.value(node.value, names)
        if not isinstance(spec, str):
            raise ValueError("not a constant")
        return formatted(value, spec, node.conversion)

    def _binop(self, node: ast.BinOp, names: Scope) -> Any:
        left, right = self.value(node.left, names), self.value(node.right, names)
        return self.operated(type(node.op), left, right)

    def operated(self, kind: type[ast.operator], left: Any, right: Any) -> Any:
        """Return the result of an operator. Raises ValueError if it is not constant."""
        if any(isinstance(one, Unknown | Library) for one in (left, right)):
            raise ValueError("not a constant")
        found = binary(kind, left, right)
        if isinstance(found, str | list | tuple | dict):
            self.spend(len(found) // 50)
        return FilePath(found) if isinstance(found, PurePosixPath) else found

    def _unaryop(self, node: ast.UnaryOp, names: Scope) -> Any:
        value = self.value(node.operand, names)
        return unknown(node) if isinstance(value, Unknown | Library) else UNARY[type(node.op)](value)

    def _compare(self, node: ast.Compare, names: Scope) -> Any:
        left = self.value(node.left, names)
        for kind, other in zip(node.ops, node.comparators, strict=True):
            right = self.value(other, names)
            holds = self.compared(type(kind), left, right)
            if isinstance(holds, Unknown):
                return unknown(node)
            if not holds:
                return False
            left = right
        return True

    def compared(self, kind: type[ast.cmpop], left: Any, right: Any) -> Any:
        """Return the result of a comparison; Unknown if the values do not decide it."""
        if any(isinstance(one, Unknown | Library) for one in (left, right)):
            return MAYBE
        if kind in (ast.Is, ast.IsNot) or any(
            isinstance(one, Made | Class) or callable(one) for one in (left, right)
        ):
            same = left is right
            return same if kind in (ast.Is, ast.Eq) else not same if kind in (ast.IsNot, ast.NotEq) else MAYBE
        many = items(right) if kind in (ast.In, ast.NotIn) and not isinstance(right, str) else None
        if not plain(left) or not plain(right if many is None else many):
            return MAYBE
        return COMPARE[kind](left, right if many is None or isinstance(right, dict) else many)

    def _boolop(self, node: ast.BoolOp, names: Scope) -> Any:
        value: Any = None
        for operand in node.values:
            value = self.value(operand, names)
            if isinstance(value, Unknown | Library):
                return unknown(node)
            if bool(value) == isinstance(node.op, ast.Or):
                return value
        return value

    def _ifexp(self, node: ast.IfExp, names: Scope) -> Any:
        test = self.value(node.test, names)
        if isinstance(test, Unknown | Library):
            return unknown(node)
        return self.value(node.body if test else node.orelse, names)

    def _subscript(self, node: ast.Subscript, names: Scope) -> Any:
        base = self.value(node.value, names)
        if isinstance(base, Made) and base.kind.unpacked:
            base = tuple(items(base) or ())
        if isinstance(base, Class) and base.is_enumeration():
            base = base.names
        if type(base).__name__ == "_PathParents":
            base = [FilePath(one) for one in base]
        if isinstance(node.slice, ast.Slice):
            if not isinstance(base, str | list | tuple):
                return unknown(node)
            parts = (node.slice.lower, node.slice.upper, node.slice.step)
            found = base[slice(*(None if one is None else self.value(one, names) for one in parts))]
            self.spend(len(found) // 50)
            return found
        key = self._key(self.value(node.slice, names))
        return base[key] if isinstance(base, str | list | tuple | dict) else unknown(node)

    def _listcomp(self, node: ast.ListComp | ast.GeneratorExp | ast.SetComp, names: Scope) -> Any:
        return [self.value(node.elt, inner) for inner in self._loops(node.generators, names)]

    _generatorexp = _listcomp

    def _setcomp(self, node: ast.SetComp, names: Scope) -> Any:
        return BUILTINS["set"](self._listcomp(node, names))

    def _dictcomp(self, node: ast.DictComp, names: Scope) -> Any:
        return {
            self._key(self.value(node.key, inner)): self.value(node.value, inner)
            for inner in self._loops(node.generators, names)
        }

    def _loops(self, loops: list[ast.comprehension], names: Scope) -> Any:
        """Yield the names inside a comprehension. Raises ValueError if a list or test is not constant."""
        loop, *rest = loops
        values = items(self.value(loop.iter, names))
        if values is None:
            raise ValueError("unknown elements")
        for item in values:
            self.spend()
            inner = Scope({}, names, inner=True)
            self.bind(loop.target, item, inner)
            tests = [self.value(test, inner) for test in loop.ifs]
            if any(isinstance(test, Unknown | Library) for test in tests):
                raise ValueError("unknown test")
            if all(tests):
                yield from self._loops(rest, inner) if rest else (inner,)

    def _call(self, node: ast.Call, names: Scope) -> Any:
        called = self.value(node.func, names)
        args = self._elements(node.args, names)
        keywords: dict[str, Any] = {}
        for keyword in node.keywords:
            value = self.value(keyword.value, names)
            if keyword.arg is not None:
                keywords[keyword.arg] = value
            elif isinstance(value, dict):
                keywords.update({key: one for key, one in value.items() if isinstance(key, str)})
        return self.call(called, args, keywords, node)


MAYBE: Final = Unknown(0, "a comparison")


def unknown(node: ast.AST) -> Unknown:
    """Return an `Unknown` for an expression."""
    return Unknown(getattr(node, "lineno", 0), ast.unparse(node)[:80])


def constant(text: str, names: Mapping[str, Any] | None = None) -> Any:
    """Return the value of a Python expression; `Unknown` if not constant. Raises ValueError for invalid syntax."""
    try:
        tree = ast.parse(text.strip(), mode="eval")
        return Evaluator({}).value(tree.body, Scope(dict(names or {})))
    except (SyntaxError, MemoryError):
        raise ValueError(f"{text[:80]} is not a Python expression") from None
    except (RecursionError, SpentError):
        return Unknown(0, text[:80])
