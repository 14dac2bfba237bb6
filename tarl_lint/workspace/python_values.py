"""Values of interpreted Python files: functions, classes, objects and paths. None of them runs code of a file."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any, ClassVar, Final

LARGEST: Final = 100_000  # maximum size of a value: characters of a text, elements of nested lists
ENUMERATIONS: Final = frozenset({"enum.Enum", "enum.IntEnum", "enum.StrEnum"})
TUPLES: Final = "typing.NamedTuple"
DATA: Final = "dataclasses.dataclass"


class SpentError(Exception):
    """An interpretation has used up its limit of steps. The message says so."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that is not constant: its line and its text."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Library:
    """A name of another module: `os.path`, `launch_ros.actions.Node`."""

    name: str


MANY: Final = Unknown(0, "too many values")


class Scope:
    """The names of a module, class, function or comprehension, within those of the scopes around it."""

    __slots__ = ("around", "elsewhere", "inner", "names")

    def __init__(self, names: dict[str, Any], around: Scope | None = None, *, inner: bool = False) -> None:
        self.names, self.around = names, around
        self.elsewhere: dict[str, Scope] = {}  # names that `global` and `nonlocal` bind in another scope
        self.inner = inner  # whether the scope is that of a comprehension

    def find(self, name: str) -> tuple[Any] | None:
        """Return a tuple with the value of a name; None if no scope has the name."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.names:
                return (scope.names[name],)
            scope = scope.around
        return None

    def store(self, name: str, value: Any) -> None:
        """Bind a name in this scope, or in the one that a `global` or `nonlocal` statement refers to."""
        self.elsewhere.get(name, self).names[name] = value

    def outside(self) -> Scope:
        """Return the scope around comprehensions, where `:=` binds."""
        scope = self
        while scope.inner and scope.around is not None:
            scope = scope.around
        return scope

    def module(self) -> Scope:
        """Return the outermost scope."""
        scope = self
        while scope.around is not None:
            scope = scope.around
        return scope


@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """A function of a file, with the scope around it and the values of its defaults."""

    node: ast.FunctionDef
    scope: Scope
    defaults: dict[str, Any]
    file: Path
    kind: str = ""  # `staticmethod`, `classmethod` or `property`


@dataclass(frozen=True, slots=True, eq=False)
class Class:
    """A class of a file. `fields` are those of a data class, in order; `bases` are classes and library names."""

    name: str
    bases: tuple[Any, ...]
    names: dict[str, Any]
    fields: tuple[str, ...] | None = None
    unpacked: bool = False  # whether objects of the class are tuples

    def find(self, name: str) -> tuple[Any, Class] | None:
        """Return an attribute of the class or its bases, and the class that has it."""
        if name in self.names:
            return self.names[name], self
        for base in self.bases:
            found = base.find(name) if isinstance(base, Class) else None
            if found is not None:
                return found
        return None

    def all_fields(self) -> tuple[str, ...] | None:
        """Return the fields of a data class with those of its bases; None for other classes."""
        above = [base.all_fields() for base in self.bases if isinstance(base, Class)]
        known = [one for one in (*above, self.fields) if one is not None]
        return tuple(dict.fromkeys(name for one in known for name in one)) if known else None

    def is_a(self, other: object) -> bool:
        """Return whether this is another class, or derived from it."""
        return self is other or any(isinstance(base, Class) and base.is_a(other) for base in self.bases)

    def is_enumeration(self) -> bool:
        """Return whether the class is an enumeration."""
        names = {base.name for base in self.bases if isinstance(base, Library)}
        return bool(names & ENUMERATIONS)

    def members(self) -> list[Any]:
        """Return the members of an enumeration."""
        return [one for one in self.names.values() if isinstance(one, Made) and one.kind is self]


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """An object of a class of the file."""

    kind: Class
    attributes: dict[str, Any]


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
class Bound:
    """A method of a text, list, dict or tuple."""

    of: Any
    name: str


@dataclass(frozen=True, slots=True, eq=False)
class Namespace:
    """An imported module of the workspace, by its full name."""

    module: str
    names: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Field:
    """The result of `dataclasses.field`."""

    default: Any = field(default_factory=lambda: Unknown(0, "a field"))
    factory: Any = None


class FilePath(PurePosixPath):
    """A `pathlib.Path` without access to files."""

    readable: ClassVar = frozenset({
        "parent", "parents", "name", "stem", "suffix", "suffixes", "parts", "joinpath", "as_posix", "with_name",
        "with_suffix", "is_absolute", "relative_to", "is_relative_to", "resolve", "absolute", "expanduser",
    })  # fmt: skip

    def resolve(self, *_: Any, **__: Any) -> FilePath:
        """Return the path without `..`."""
        return FilePath(normal(str(self)))

    absolute = resolve

    def expanduser(self) -> FilePath | Unknown:
        """Return the path; Unknown if it begins with a user's home."""
        return Unknown(0, str(self)) if str(self).startswith("~") else self


def normal(path: str) -> str:
    """Return a path without `..` and double slashes."""
    import posixpath

    return posixpath.normpath(path)


def items(value: Any) -> list[Any] | None:
    """Return what a loop over a value yields; None if it is not known."""
    if isinstance(value, list | tuple | dict | str):
        return list(value)
    if isinstance(value, Made) and value.kind.unpacked:
        return [value.attributes.get(name) for name in value.kind.all_fields() or ()]
    if isinstance(value, Class) and value.is_enumeration():
        return value.members()
    if type(value).__name__ in ("dict_items", "dict_keys", "dict_values", "_PathParents"):
        return list(value)
    return None


def plain(value: Any, most: int = LARGEST) -> bool:
    """Return whether a value consists of at most `most` constants and is not nested infinitely."""
    return all(isinstance(one, _CONSTANT) for one in _leaves(value, most))


def known(value: Any) -> bool:
    """Return whether a value contains nothing unknown; models of library values count as known."""
    return not any(isinstance(one, Unknown | Library) for one in _leaves(value, LARGEST))


def bounded(value: Any, most: int = LARGEST) -> bool:
    """Return whether a value has at most about `most` elements, those of nested lists included."""
    return not any(one is MANY for one in _leaves(value, most))


_CONSTANT: Final = (str, int, float, bool, bytes, type(None), PurePosixPath)


def _leaves(value: Any, most: int) -> Iterator[Any]:
    """Yield the constants in nested lists; an Unknown in place of the rest if there are more than `most` values."""
    pending, left = [value], most
    while pending:
        one = pending.pop()
        left -= 1 + (len(one) if isinstance(one, list | tuple | dict) else 0)
        if left < 0:
            yield MANY
            return
        if isinstance(one, list | tuple):
            pending += one
        elif isinstance(one, dict):
            pending += [*one, *one.values()]
        else:
            yield one
