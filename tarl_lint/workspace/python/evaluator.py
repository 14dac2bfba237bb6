"""Evaluate constant Python expressions without executing code.

A value is a constant, a list, tuple, set or dict of values, a `Library` (a name imported from another module), a
function, class or object of the file itself, or a result of the models of library functions. A value that is not
constant is an `Unknown`, never an error.
"""

from __future__ import annotations

import ast
import re
from collections import ChainMap, deque
from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any, Final

from tarl_lint.workspace.python.assignment_targets import bind
from tarl_lint.workspace.python.attributes import attribute
from tarl_lint.workspace.python.builtin_functions import BUILTINS
from tarl_lint.workspace.python.displays import DISPLAYS, elements, key_of
from tarl_lint.workspace.python.elements import items, settled, whole
from tarl_lint.workspace.python.evaluation import call_of, unknown
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.jumps import Raised
from tarl_lint.workspace.python.libraries import LIBRARIES, function, is_builtin
from tarl_lint.workspace.python.methods import method
from tarl_lint.workspace.python.objects import Class, Function, Interpreted, Method
from tarl_lint.workspace.python.operators import COMPARE, UNARY, binary
from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.python.values import (
    Bound,
    Library,
    Namespace,
    OpaqueError,
    Scope,
    Several,
    SpentError,
    Unknown,
)

__all__ = ["Evaluator", "Library", "Unknown", "constant", "unknown"]

STEPS: Final = 300_000  # maximum number of expressions and statements that are evaluated for one file
FAILURES: Final = (ArithmeticError, LookupError, TypeError, ValueError, AttributeError, StopIteration)
# exceptions of constant operations that a `try` in the file may catch
_CAUGHT: Final = (KeyError, IndexError, ZeroDivisionError, ValueError, StopIteration, AttributeError, OSError)


class Evaluator:
    """Evaluates the expressions of one file. `models` holds functions and values of libraries by full name."""

    def __init__(self, models: Mapping[str, Any], steps: int = STEPS) -> None:
        self.models = {**LIBRARIES, **models}
        self.left = [steps]  # number of steps left; shared with the files that this file imports
        self.trying = 0

    def spend(self, steps: int = 1) -> None:
        """Count steps. Raises SpentError if the limit is reached."""
        self.left[0] -= steps
        if self.left[0] < 0:
            raise SpentError("it has too many statements")

    def value(self, node: ast.expr, names: Scope) -> Any:
        """Return the value of an expression; `Unknown` if it is not constant. Raises SpentError.

        Inside a `try` statement, raises Raised if a constant operation raises an exception.
        """
        self.spend()
        display = DISPLAYS.get(type(node))
        visit = getattr(self, f"_{type(node).__name__.lower()}", None)
        try:
            if display is not None:
                return display(self, node, names)
            return unknown(node) if visit is None else visit(node, names)
        except (OpaqueError, RuntimeError) as reason:
            if isinstance(reason, RecursionError):
                raise
            return unknown(node)
        except (*FAILURES, OSError) as error:
            if self.trying and isinstance(error, _CAUGHT):
                raise Raised(getattr(node, "lineno", 0), error) from None
            return unknown(node)

    def call(self, called: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call. Subclasses handle functions and classes of the file."""
        if isinstance(called, Interpreted):
            return self.call(called.of, args, keywords, node)
        bound = isinstance(called, Bound)
        if not bound and (isinstance(called, Unknown | Library) or not callable(called)):
            return unknown(node)
        if bound or is_builtin(called):
            args = [self.callable(one, node) for one in args]
            keywords = {key: self.callable(one, node) for key, one in keywords.items()}
        found = (method if bound else function)(called, args, keywords)
        if isinstance(found, str | list | tuple | dict):
            self.spend(len(found) // 50)
        return FilePath(found) if isinstance(found, PurePosixPath) else found

    def imported(self, module: str) -> Namespace | None:  # noqa: ARG002 - for subclasses
        """Return an imported module if it is interpreted, too; otherwise None."""
        return None

    def kept(self, container: Any, value: Any) -> Any:  # noqa: ARG002 - for subclasses
        """Return the form in which a list or dict stores a value."""
        return value

    def bind(self, target: ast.expr, value: Any, names: Scope) -> None:
        """Assign a value to a name, an element, an attribute, or several of them."""
        bind(self, target, value, names)

    def callable(self, value: Any, node: ast.Call) -> Any:
        """Return a function of the file in a form that built-in functions can call."""
        if isinstance(value, Function | Method | Class | Bound):
            return Interpreted(lambda *args, **keywords: self.call(value, list(args), keywords, node), value)
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
        base = self.value(node.value, names)
        found = self.attribute(base, node.attr, node)
        if found is None and self.trying and (base is None or isinstance(base, Made | Class)):
            raise AttributeError(node.attr)
        return unknown(node) if found is None else found[0]

    def attribute(self, base: Any, name: str, node: ast.AST) -> tuple[Any] | None:
        """Return a tuple with an attribute of a value; None if the attribute is not known."""
        return attribute(self, base, name, node)

    def _elements(self, nodes: list[ast.expr], names: Scope) -> list[Any]:
        return elements(self, nodes, names)

    def _binop(self, node: ast.BinOp, names: Scope) -> Any:
        left, right = self.value(node.left, names), self.value(node.right, names)
        return self.operated(type(node.op), left, right)

    def operated(self, kind: type[ast.operator], left: Any, right: Any) -> Any:
        """Return the result of an operator. Raises OpaqueError if it is not constant."""
        if kind is ast.Add and (isinstance(left, list) or isinstance(right, list)):
            left, right = (
                [Several(one.line, one.text)] if isinstance(one, Unknown) else one for one in (left, right)
            )
        if any(isinstance(one, Unknown | Library) for one in (left, right)):
            raise OpaqueError("not a constant")
        found = binary(kind, left, right)
        if isinstance(found, str | list | tuple | dict):
            self.spend(len(found) // 50)
        return FilePath(found) if isinstance(found, PurePosixPath) else found

    def _unaryop(self, node: ast.UnaryOp, names: Scope) -> Any:
        value = self.value(node.operand, names)
        if isinstance(value, Unknown | Library):
            return unknown(node)
        if isinstance(value, Made) and not isinstance(node.op, ast.Not):
            special = {ast.USub: "__neg__", ast.UAdd: "__pos__", ast.Invert: "__invert__"}[type(node.op)]
            if value.has(special):
                return value.run(special)
            value = value.plain()
        return UNARY[type(node.op)](value)

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
        membership = kind in (ast.In, ast.NotIn)
        if kind in (ast.Is, ast.IsNot) or (
            not membership and any(not isinstance(one, Made) and callable(one) for one in (left, right))
        ):
            same = left is right
            return same if kind in (ast.Is, ast.Eq) else not same if kind in (ast.IsNot, ast.NotEq) else MAYBE
        if membership and isinstance(right, Made) and (right.has("__contains__") or right.kind.is_flag()):
            return (left in right) is (kind is ast.In)
        if membership and isinstance(right, dict | ChainMap) and settled([left, *right]):
            return COMPARE[kind](left, right)
        many = items(right) if membership and not isinstance(right, str) else None
        if not settled(left) or not settled(right if many is None else many):
            return self._unsure(kind, left, many)
        return COMPARE[kind](left, right if many is None or isinstance(right, dict) else many)

    def _unsure(self, kind: type[ast.cmpop], left: Any, many: list[Any] | None) -> Any:
        """Return the result of `in`; Unknown if it is not certain."""
        for one in many or ():
            if one is left or (settled([left, one]) and one == left):
                return kind is ast.In
        return MAYBE

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
        if isinstance(base, Made) and not base.has("__getitem__") and not base.has("__missing__"):
            base = base.plain()
        if type(base).__name__ == "_PathParents":
            base = [FilePath(one) for one in base]
        if isinstance(node.slice, ast.Slice):
            if not isinstance(base, str | list | tuple | range | bytes | Made) or not whole(base):
                return unknown(node)
            parts = (node.slice.lower, node.slice.upper, node.slice.step)
            found = base[slice(*(None if one is None else self.value(one, names) for one in parts))]
            if isinstance(base, Made):
                return found
            self.spend(len(found) // 50)
            return found
        key = key_of(self.value(node.slice, names))
        if isinstance(base, Class):
            return self._of_class(base, key, node)
        if isinstance(base, re.Match):
            return base[key]
        if hasattr(type(base), "section"):  # a model of a library whose elements have names
            return base.section(key)
        if isinstance(base, Library):
            return self.models.get(f"{base.name}[{key!r}]", unknown(node))
        known = isinstance(base, str | list | tuple | dict | range | bytes | deque | ChainMap | Made)
        known = known and whole(base) and not isinstance(key, Unknown | Library)
        return base[key] if known else unknown(node)

    def _of_class(self, base: Class, key: Any, node: ast.Subscript) -> Any:
        """Return a member of an enumeration by name, or a generic class itself."""
        if base.is_enumeration():
            return base.names[key]
        found = base.find("__class_getitem__")
        return base if found is None else self.call(self.attribute(base, "__class_getitem__", node), [key], {}, call_of(
            "__class_getitem__", node.lineno))  # fmt: skip

    def _call(self, node: ast.Call, names: Scope) -> Any:
        called = self.value(node.func, names)
        args = self._elements(node.args, names)
        keywords: dict[str, Any] = {}
        for keyword in node.keywords:
            value = self.value(keyword.value, names)
            if keyword.arg is not None:
                keywords[keyword.arg] = value
            elif isinstance(value, dict | ChainMap):
                keywords.update({key: one for key, one in value.items() if isinstance(key, str)})
        return self.call(called, args, keywords, node)


MAYBE: Final = Unknown(0, "a comparison")


def constant(text: str, names: Mapping[str, Any] | None = None) -> Any:
    """Return an expression's value, or `Unknown`. Raises ValueError for invalid syntax."""
    try:
        tree = ast.parse(text.strip(), mode="eval")
        return Evaluator({}).value(tree.body, Scope(dict(names or {})))
    except (SyntaxError, MemoryError):
        raise ValueError(f"{text[:80]} is not a Python expression") from None
    except (RecursionError, SpentError):
        return Unknown(0, text[:80])
