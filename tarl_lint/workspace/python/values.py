"""Values of interpreted files that are not data."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Final

LARGEST: Final = 100_000  # maximum size of a value: characters of a text, elements of nested lists


class SpentError(Exception):
    """An interpretation has reached its limit of steps. The message says so."""


class OpaqueError(ValueError):
    """The result of an operation is not constant, or too large."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that is not constant: its line and its text."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Several(Unknown):
    """An unknown number of unknown elements of a list."""


@dataclass(frozen=True, slots=True)
class Library:
    """A name of another module: `os.path`, `launch_ros.actions.Node`."""

    name: str


MANY: Final = Unknown(0, "too many values")


class Scope:
    """The names of a module, class, function or comprehension, inside the scopes around it."""

    __slots__ = ("around", "elsewhere", "inner", "names", "of_class")

    def __init__(
        self,
        names: dict[str, Any],
        around: Scope | None = None,
        *,
        inner: bool = False,
        of_class: bool = False,
    ) -> None:
        self.names, self.around = names, around
        self.elsewhere: dict[str, Scope] = {}  # names that `global` and `nonlocal` bind in another scope
        self.inner = inner  # whether this is the scope of a comprehension
        # whether this is a class scope, whose names inner functions do not see
        self.of_class = of_class

    def find(self, name: str) -> tuple[Any] | None:
        """Return a tuple with the value of a name; None if no scope has the name."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.names:
                return (scope.names[name],)
            scope = scope.around
        return None

    def store(self, name: str, value: Any) -> None:
        """Bind a name in this scope, or in its `global` or `nonlocal` scope."""
        self.elsewhere.get(name, self).names[name] = value

    def outside(self) -> Scope:
        """Return the scope around comprehensions, where `:=` binds."""
        scope = self
        while scope.inner and scope.around is not None:
            scope = scope.around
        return scope

    def seen(self) -> Scope:
        """Return the scope that encloses functions defined here; a class is skipped."""
        scope = self
        while scope.of_class and scope.around is not None:
            scope = scope.around
        return scope

    def module(self) -> Scope:
        """Return the outermost scope."""
        scope = self
        while scope.around is not None:
            scope = scope.around
        return scope


@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """A method of a string, list, dict, match or other value of Python's library."""

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
    init: bool = True
    shown: bool = True  # whether `repr` shows the field
    keyword: bool = False  # whether `__init__` takes the field only as a keyword
    compared: bool = True  # whether comparisons use the field


class Stream:
    """An iterator, whose elements are read once."""

    __slots__ = ("endless", "values")

    def __init__(self, values: Iterator[Any], *, endless: bool = False) -> None:
        self.values, self.endless = values, endless

    def __iter__(self) -> Iterator[Any]:
        return self.values

    def __next__(self) -> Any:
        return next(self.values)

    def rest(self) -> list[Any]:
        """Return the elements that are left. Raises OpaqueError if there are too many."""
        found = list(itertools.islice(self.values, 0 if self.endless else LARGEST + 1))
        if self.endless or len(found) > LARGEST:
            raise OpaqueError("too many values")
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Suppressed:
    """The result of `contextlib.suppress`: a block that ends with one of these exceptions."""

    kinds: tuple[Any, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Suspended:
    """A call of a generator function that `contextlib.contextmanager` decorates.

    `run` interprets the function, and calls the argument of `run` with the value that the function yields.
    """

    run: Callable[[Callable[[Any], None]], Any]


@dataclass(frozen=True, slots=True, eq=False)
class Partial:
    """The result of `functools.partial` and of similar functions: a callable with arguments."""

    run: Callable[..., Any]

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        """Call the callable with its stored arguments."""
        return self.run(*args, **keywords)
