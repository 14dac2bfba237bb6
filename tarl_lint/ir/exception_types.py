"""Which handlers may catch which exceptions, judged by the last names of their classes.

The builtin classes, the classes of the analysed files and a few classes of libraries are known with their bases. An
unknown class may have any base, and a handler of an unknown class may catch any exception.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from tarl_lint.ir import nodes as ir

Handled = frozenset[str]  # names of the classes that a handler catches; empty if it catches all

UNKNOWN: Final = ""  # name of an exception whose class is not known
OTHER: Final = "?"  # name of a handler's class that is not known
GENERAL: Final = "Exception"
GROUP: Final = "BaseExceptionGroup"
PARTS: Final = "*"  # marks the handlers of `except*`, which may also catch exceptions inside a group
ALL: Final = "BaseException"
# builtin exceptions that no failing call raises
NO_ERRORS: Final = frozenset(["KeyboardInterrupt", "SystemExit", "GeneratorExit"])
BUILTIN: Final[Mapping[str, frozenset[str]]] = {
    name: frozenset(base.__name__ for base in cls.__mro__)
    for name, cls in vars(builtins).items()
    if isinstance(cls, type) and issubclass(cls, BaseException)
}
# classes of ROS and common libraries → their base classes
LISTED: Final[Mapping[str, frozenset[str]]] = {
    name: frozenset(bases.split())
    for name, bases in {
        "ROSException": "Exception",
        "ROSInterruptException": "ROSException KeyboardInterrupt",
        "ROSInitException": "ROSException",
        "ROSSerializationException": "ROSException",
        "ServiceException": "Exception",
        "TransformException": "Exception",
        "LookupException": "TransformException",
        "ConnectivityException": "TransformException",
        "ExtrapolationException": "TransformException",
        "InvalidArgumentException": "TransformException",
        "CvBridgeError": "TypeError",
        "JSONDecodeError": "ValueError",
        "LinAlgError": "ValueError",
        "SerialException": "OSError",
    }.items()
}


_SAME: Final[Mapping[str, str]] = {
    name: cls.__name__ for name, cls in vars(builtins).items() if name in BUILTIN and name != cls.__name__
}  # other names of builtin classes, such as IOError


@dataclass(frozen=True)
class ExceptionTypes:
    """The classes of the analysed files that may be exceptions: name → names of the base classes.

    `several` are the names that refer to more than one class.
    """

    bases: Mapping[str, frozenset[str]] = field(default_factory=dict)
    several: frozenset[str] = frozenset()
    _known: dict[str, tuple[frozenset[str], bool]] = field(default_factory=dict, compare=False)

    def catches(self, handled: Handled, name: str) -> bool | None:
        """Return whether a handler catches an exception: True (certainly), False (certainly not), or None (maybe)."""
        if not handled:
            return True
        above, whole = self._above(name)
        if PARTS in handled:
            return None if GROUP in above else self.catches(handled - {PARTS}, name)
        if not handled.isdisjoint(above):
            return None if above & self.several else True
        if not whole:  # by convention, classes of libraries inherit from Exception
            return True if GENERAL in handled else False if handled <= NO_ERRORS else None
        return None if above & self.several or not all(map(self._is_class, handled)) else False

    def of_libraries(self, handled: Handled) -> list[str]:
        """Return the classes of a handler that belong neither to Python nor to the files, sorted by name."""
        unknown = {UNKNOWN, OTHER, PARTS, *self.bases}
        return sorted(n for n in handled if n not in unknown and n.removeprefix(".") not in BUILTIN)

    def names(self, handled: Handled, name: str) -> bool:
        """Return whether a handler catches a builtin exception by its name, or by the name of a special base class."""
        return GENERAL not in handled and self.catches(handled, name) is True and bool(handled)

    def _above(self, name: str) -> tuple[frozenset[str], bool]:
        """Return the names of a class and its bases, and whether all of them are known."""
        known = self._known.get(name)
        if known is None:
            known = self._known[name] = self._closed(name)
        return known

    def _closed(self, name: str) -> tuple[frozenset[str], bool]:
        found: dict[str, None] = {}
        pending, whole = [name], True
        while pending:
            one = pending.pop()
            if one in found:
                continue
            found[one] = None
            above = self.bases.get(one) or BUILTIN.get(one) or LISTED.get(one)
            if above is not None:
                pending += sorted(above)
            else:
                whole = whole and one == "object"
        return frozenset(found), whole

    def _is_class(self, name: str) -> bool:
        return name in self.bases or name in BUILTIN or name in LISTED


NO_CLASSES: Final = ExceptionTypes()


def exception_types(trees: Iterable[ast.Module]) -> ExceptionTypes:
    """Return the classes that the files define outside functions."""
    bases: dict[str, frozenset[str]] = {}
    several: set[str] = set()
    for tree in trees:
        for node in _classes(tree.body):
            named = frozenset(map(_name, node.bases)) or frozenset(["object"])
            if node.name in bases or node.name in BUILTIN:
                several.add(node.name)
            bases[node.name] = bases.get(node.name, frozenset()) | named
    return ExceptionTypes(bases, frozenset(several))


def raised(expr: ir.Expr | None) -> str:
    """Return the name of the raised class; UNKNOWN if it is not known."""
    if isinstance(expr, ir.Call):
        expr = expr.function
    return _called(expr)


def handled_by(types: ir.Expr | None) -> Handled:
    """Return the names of the classes that a handler catches; empty if it catches all."""
    if isinstance(types, ir.Starred):  # `except*`
        return handled_by(types.value) | {PARTS}
    parts = types.items if isinstance(types, ir.SequenceDisplay) else [types]
    names = frozenset(_called(part) or OTHER for part in parts if part is not None)
    return frozenset() if ALL in names else names


def _called(expr: ir.Expr | None) -> str:
    """Return the name of a class.

    If a class of a library has the name of a builtin class, the result tells the two apart.
    """
    if isinstance(expr, ir.Attribute):
        return f".{expr.name}" if expr.name in BUILTIN else expr.name
    return _SAME.get(expr.name, expr.name) if isinstance(expr, ir.Name) else UNKNOWN


def _classes(body: Iterable[ast.stmt]) -> Iterator[ast.ClassDef]:
    for node in body:
        if isinstance(node, ast.ClassDef):
            yield node
            yield from _classes(node.body)
        elif isinstance(node, (ast.If, ast.Try)):
            yield from _classes([*node.body, *node.orelse, *getattr(node, "finalbody", ())])
            for handler in getattr(node, "handlers", ()):
                yield from _classes(handler.body)


def _name(base: ast.expr) -> str:
    if isinstance(base, ast.Attribute):
        return base.attr
    return base.id if isinstance(base, ast.Name) else UNKNOWN
