"""Functions and classes that an interpreted file defines, and their methods."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.python.values import Library, Partial, Scope

FLAGS: Final = frozenset({"enum.Flag", "enum.IntFlag"})
ENUMERATIONS: Final = frozenset({"enum.Enum", "enum.IntEnum", "enum.StrEnum", *FLAGS})
TUPLES: Final = "typing.NamedTuple"
# modules that define the names of built-in containers and values
_HOMES: Final = frozenset({"tarl_lint.workspace.python.containers", "builtins"})
_MIXED: Final = {"enum.IntEnum": int, "enum.IntFlag": int, "enum.StrEnum": str}


@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """A function of a file, with the scope around it and the values of its defaults."""

    node: ast.FunctionDef
    scope: Scope
    defaults: dict[str, Any]
    file: Path
    # interprets this function, given arguments, keywords and the defining class
    run: Callable[[Function, list[Any], dict[str, Any], Class | None], Any]
    kind: str = ""  # `staticmethod`, `classmethod`, `property`, `cached_property` or `contextmanager`
    setter: Function | None = None  # for a property: the function that sets it
    name: str = ""  # the name that `functools.wraps` gives the function

    def called(self) -> str:
        """Return the name of the function."""
        return self.name or self.node.name


@dataclass(frozen=True, slots=True, eq=False)
class Class:
    """A class of a file, with fields (of a data class) and bases."""

    name: str
    bases: tuple[Any, ...]
    names: dict[str, Any]
    fields: tuple[str, ...] | None = None
    unpacked: bool = False  # whether objects of the class are tuples
    options: dict[str, Any] = field(
        default_factory=dict
    )  # arguments of the decorator `dataclass` and of others

    def find(self, name: str) -> tuple[Any, Class] | None:
        """Return an attribute of the class or its bases, and the class that has it."""
        return next(((one.names[name], one) for one in self.order() if name in one.names), None)

    def order(self) -> list[Class]:
        """Return the class and its bases in the order in which attributes are looked up."""
        above = [base.order() for base in self.bases if isinstance(base, Class)]
        lists = [*above, [base for base in self.bases if isinstance(base, Class)]]
        found = [self]
        while lists := [one for one in lists if one]:
            first = next(
                (one[0] for one in lists if not any(one[0] in other[1:] for other in lists)), lists[0][0]
            )
            found.append(first)
            lists = [[one for one in each if one is not first] for each in lists]
        return found

    def all_fields(self) -> tuple[str, ...] | None:
        """Return the fields of a data class, including the fields of its bases; None for other classes."""
        known = [one.fields for one in reversed(self.order()) if one.fields is not None]
        return tuple(dict.fromkeys(name for one in known for name in one)) if known else None

    def is_a(self, other: object) -> bool:
        """Return whether this is another class, or derived from it."""
        return other in self.order()

    def library_bases(self) -> list[Any]:
        """Return the bases that the file does not define: library names and built-in classes."""
        return [base for one in self.order() for base in one.bases if not isinstance(base, Class)]

    def is_enumeration(self) -> bool:
        """Return whether the class is an enumeration."""
        names = {base.name for base in self.library_bases() if isinstance(base, Library)}
        return bool(names & ENUMERATIONS)

    def is_flag(self) -> bool:
        """Return whether the class is an enumeration of flags."""
        return any(isinstance(base, Library) and base.name in FLAGS for base in self.library_bases())

    def mixed(self) -> type | None:
        """Return the type of an enumeration's members if they are numbers or strings."""
        if not self.is_enumeration():
            return None
        for base in self.library_bases():
            if isinstance(base, Library) and base.name in _MIXED:
                return _MIXED[base.name]
            if base in (int, str, float):
                return base  # type: ignore[no-any-return] # one of three types
        return None

    def members(self) -> list[Any]:
        """Return the members of an enumeration."""
        found = [one for one in self.names.values() if getattr(one, "kind", None) is self]
        if self.is_flag():  # leave out combinations and zero, as Python 3.11 and later do
            found = [one for one in found if _is_single(one.attributes["value"])]
        return list({id(one): one for one in found}.values())

    def with_value(self, value: Any) -> Any:
        """Return the enumeration member or flags with a value, or None."""
        found = [one for one in self.names.values() if getattr(one, "kind", None) is self]
        return next((one for one in found if one.attributes["value"] == value), None)

    def container(self) -> Any:
        """Return the type of the built-in container from which the class is derived; None if there is none."""
        known = [
            one for one in self.library_bases() if callable(one) and getattr(one, "__module__", "") in _HOMES
        ]
        return None if self.is_enumeration() else next(iter(known), None)

    def error(self) -> type[BaseException] | None:
        """Return the built-in exception from which the class is derived; None if it is not an exception."""
        known = [one for one in self.library_bases() if isinstance(one, type)]
        return next((one for one in known if issubclass(one, BaseException)), None)


def _is_single(value: Any) -> bool:
    """Return whether a flag is a single bit."""
    return isinstance(value, int) and value > 0 and not value & (value - 1)


@dataclass(frozen=True, slots=True, eq=False)
class Method:
    """A method of an object or class, or `super().name`; `owner` is the class that defines it."""

    function: Function
    first: Any
    owner: Class


@dataclass(frozen=True, slots=True, eq=False)
class Above:
    """The result of `super()`."""

    of: Any
    owner: Class


@dataclass(frozen=True, slots=True, eq=False)
class Interpreted(Partial):
    """A function or class of the file that built-in functions can call; `of` is the function or class."""

    of: Any
