"""The contents of values: the elements of a loop, sets, and whether a part of a value is unknown."""

from __future__ import annotations

import datetime
import re
from collections import ChainMap, deque
from collections.abc import Iterable, Iterator, MutableSet
from pathlib import PurePosixPath
from typing import Any, Final

from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.objects import Class, Function, Interpreted
from tarl_lint.workspace.python.values import LARGEST, MANY, Library, OpaqueError, Several, Stream, Unknown

VIEWS: Final = frozenset({
    "dict_items", "dict_keys", "dict_values", "odict_items", "odict_keys", "odict_values", "_PathParents",
    "KeysView", "ItemsView", "ValuesView",
})  # fmt: skip


class Unique(MutableSet[Any]):
    """A set. Its elements have the order in which they were added, so that results are the same in each run.

    Raises OpaqueError for an unknown element, because it may equal another element.
    """

    def __init__(self, values: Iterable[Any] = ()) -> None:
        self._of: dict[Any, Any] = {}
        self.update(values)

    def __contains__(self, value: object) -> bool:
        return _identity(value) in self._of

    def __iter__(self) -> Iterator[Any]:
        values = list(self._of.values())
        return iter(list(set(values)) if all(type(one) is int for one in values) else values)

    def __len__(self) -> int:
        return len(self._of)

    def __hash__(self) -> int:
        return hash(frozenset(self._of))

    def __repr__(self) -> str:
        if len(self) > 1 and not all(type(one) is int for one in self):
            raise OpaqueError("the order of a set is not known")
        return f"{{{', '.join(map(repr, self))}}}" if len(self) else "set()"

    def add(self, value: Any) -> None:
        """Add an element."""
        self._of.setdefault(_identity(value), value)

    def discard(self, value: Any) -> None:
        """Remove an element if the set has it."""
        self._of.pop(_identity(value), None)

    def copy(self) -> Unique:
        """Return a copy."""
        return Unique(self)

    def update(self, *others: Iterable[Any]) -> None:
        """Add the elements of other sets or lists."""
        for one in (each for other in others for each in other):
            self.add(one)

    def union(self, *others: Iterable[Any]) -> Unique:
        """Return the elements of all sets."""
        found = self.copy()
        found.update(*others)
        return found

    def intersection(self, *others: Iterable[Any]) -> Unique:
        """Return the elements that are in all sets."""
        sets = [Unique(one) for one in others]
        return Unique(one for one in self if all(one in other for other in sets))

    def difference(self, *others: Iterable[Any]) -> Unique:
        """Return the elements that are in no other set."""
        gone = Unique().union(*others)
        return Unique(one for one in self if one not in gone)

    def symmetric_difference(self, other: Iterable[Any]) -> Unique:
        """Return the elements that are in exactly one of the two sets."""
        right = Unique(other)
        return self.difference(right).union(right.difference(self))

    def issubset(self, other: Iterable[Any]) -> bool:
        """Return whether another set has all elements of this one."""
        right = Unique(other)
        return all(one in right for one in self)

    def issuperset(self, other: Iterable[Any]) -> bool:
        """Return whether this set has all elements of another one."""
        return all(one in self for one in other)


def _identity(value: Any) -> Any:
    """Return a key that identifies an element of a set; objects such as substitutions are equal only to themselves."""
    if isinstance(value, Unknown | Library):
        raise OpaqueError("an unknown element")
    return value if isinstance(value, Made | Class | Unique) or settled(value) else ("identity", id(value))


def items(value: Any) -> list[Any] | None:
    """Return the elements over which a loop iterates; None if they are not known. This exhausts an iterator."""
    if isinstance(value, list | tuple | dict | str | bytes | Unique | deque | ChainMap):
        return list(value)
    if isinstance(value, Stream):
        return None if value.endless else value.rest()
    if isinstance(value, Made):
        if not value.has("__iter__"):
            plain = value.plain()
            return None if plain is value else items(plain)
        found = value.run("__iter__")
        if isinstance(found, Made) and found.has("__next__"):
            return Stream(found.elements()).rest()
        return items(found)
    if isinstance(value, Class) and value.is_enumeration():
        return value.members()
    if isinstance(value, Interpreted):
        return items(value.of)
    if isinstance(value, range):
        return list(value) if len(value) <= LARGEST else None
    # an iterable model of a library object, such as an open file
    if hasattr(type(value), "looped"):
        return value.looped()  # type: ignore[no-any-return] # a list or None
    return list(value) if type(value).__name__ in VIEWS else None


def listed(value: Any) -> list[Any]:
    """Return the elements over which a loop iterates. Raises OpaqueError if they are not known."""
    found = items(value)
    if found is None:
        raise OpaqueError("unknown elements")
    return found


def whole(value: Any) -> bool:
    """Return whether the number of elements of a value is known."""
    return not isinstance(value, list | tuple) or not any(isinstance(one, Several) for one in value)


def elements_if_known(value: Any) -> list[Any] | None:
    """Return the elements over which a loop iterates; None if they are not known, or if the iteration fails."""
    try:
        return items(value)
    except (ArithmeticError, LookupError, TypeError, ValueError, AttributeError, OSError):
        return None


def plain(value: Any, most: int = LARGEST) -> bool:
    """Return whether a value consists of at most `most` constants and is not nested infinitely."""
    return all(isinstance(one, _CONSTANT) for one in _leaves(value, most))


def settled(value: Any, most: int = LARGEST) -> bool:
    """Return whether a value consists of constants and objects of the file and can be compared and formatted."""
    return all(isinstance(one, _SETTLED) for one in _leaves(value, most))


def known(value: Any) -> bool:
    """Return whether a value contains nothing unknown; models of library values count as known."""
    return not any(isinstance(one, Unknown | Library) for one in _leaves(value, LARGEST))


def bounded(value: Any, most: int = LARGEST) -> bool:
    """Return whether a value has at most about `most` elements, including those of nested lists."""
    return not any(one is MANY for one in _leaves(value, most))


_CONSTANT: Final = (str, int, float, bool, bytes, type(None), PurePosixPath)
_SETTLED: Final = (
    slice,
    *_CONSTANT,
    Made,
    re.Match,
    re.Pattern,
    Class,
    Function,
    type,
    range,
    datetime.date,
    datetime.time,
    datetime.timedelta,
)
_HOLDING: Final = (list, tuple, dict, Unique, deque, ChainMap)


def _leaves(value: Any, most: int) -> Iterator[Any]:
    """Yield the constants in nested lists; after `most` values, yield one Unknown in place of the rest."""
    pending, left = [value], most
    while pending:
        one = pending.pop()
        left -= 1 + (len(one) if isinstance(one, _HOLDING) else 0)
        if left < 0:
            yield MANY
            return
        if isinstance(one, dict | ChainMap):
            pending += [*one, *one.values()]
        elif isinstance(one, list | tuple | Unique | deque):
            pending += one
        elif isinstance(one, BaseException):
            pending += one.args
        elif type(one).__name__ in VIEWS:
            pending += list(one)
        else:
            yield one


def as_data(value: Any, depth: int = 0) -> Any:
    """Convert a value to lists, tuples and dicts, as functions of other libraries expect it.

    A list that needs no conversion is returned as it is, so that the result includes elements that are added later.
    """
    if isinstance(value, Stream | Unique | deque) and not (isinstance(value, Stream) and value.endless):
        return [as_data(one, depth + 1) for one in listed(value)]
    if isinstance(value, ChainMap):
        return as_data(dict(value), depth + 1)
    if isinstance(value, Made):
        return value.plain()
    if isinstance(value, list | tuple | dict) and depth < 20:
        inner = list(value.values()) if isinstance(value, dict) else value
        made = [as_data(one, depth + 1) for one in inner]
        if all(one is other for one, other in zip(inner, made, strict=True)):
            return value
        return dict(zip(value, made, strict=True)) if isinstance(value, dict) else type(value)(made)
    return value
