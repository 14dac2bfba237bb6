"""Python's built-in functions for constant values, within limits on the size of their results.

Functions in `STRUCTURE` use only the structure of their arguments, so elements may be unknown; all other
functions need constants.
"""

from __future__ import annotations

import builtins
from collections import ChainMap, deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Final

from tarl_lint.workspace.python.containers import (
    TYPES,
    make_dict,
    make_frozen,
    make_list,
    make_set,
    make_tuple,
    type_of,
)
from tarl_lint.workspace.python.elements import Unique, listed, whole
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.methods import checked, ordered
from tarl_lint.workspace.python.objects import Class
from tarl_lint.workspace.python.operators import formatted, limited, power, written
from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.python.values import Library, OpaqueError, Stream, Unknown


def _range(*bounds: Any) -> Any:
    numbers = range(*bounds)
    limited(len(numbers))
    return numbers


def _sum(values: Any, start: Any = 0) -> Any:
    given = listed(values)
    if isinstance(start, list | tuple):
        limited(sum(map(len, given)))
    else:
        checked(given, {})
    total = start
    for one in given:
        total = _added(total, one)
    return total


def _added(left: Any, right: Any) -> Any:
    import ast

    from tarl_lint.workspace.python.operators import binary

    return binary(ast.Add, left, right)


def _extreme(name: str) -> Callable[..., Any]:
    choose = getattr(builtins, name)

    def found(*values: Any, key: Any = None, **keywords: Any) -> Any:
        given = listed(values[0]) if len(values) == 1 else list(values)
        if not given and "default" in keywords:
            return keywords["default"]
        keys = given if key is None else [key(one) for one in given]
        checked(keys, {})
        return given[choose(range(len(given)), key=keys.__getitem__)]

    return found


def _tested(name: str) -> Callable[..., Any]:
    stops = name == "any"

    def found(values: Any) -> Any:
        unsure = False
        for one in streamed(values):
            if isinstance(one, Unknown | Library):
                unsure = True
            elif bool(one) is stops:
                return stops
        if unsure:
            raise OpaqueError("unknown")
        return not stops

    return found


def streamed(value: Any) -> Iterator[Any]:
    """Return an iterator over a value; a stream is read step by step. Raises OpaqueError."""
    if not whole(value):
        raise OpaqueError("an unknown number of elements")
    return value.values if isinstance(value, Stream) else iter(listed(value))


def _combined(make: Callable[..., Iterator[Any]], *values: Any) -> Stream:
    """Return an iterator that combines other iterators, such as `zip`; it is endless if all of these are endless."""
    parts = [streamed(one) for one in values]
    endless = bool(values) and all(isinstance(one, Stream) and one.endless for one in values)
    return Stream(make(*parts), endless=endless)


def _map(function: Callable[..., Any], *values: Any) -> Stream:
    return _combined(lambda *parts: map(function, *parts), *values)


def _zip(*values: Any, strict: Any = False) -> Stream:
    return _combined(lambda *parts: zip(*parts, strict=bool(strict)), *values)


def _enumerate(values: Any, start: int = 0) -> Stream:
    return _combined(lambda part: enumerate(part, start), values)


def _filter(function: Any, values: Any) -> Stream:
    return _combined(lambda part: filtered(function, part), values)


def filtered(function: Any, values: Iterable[Any], *, wanted: bool = True) -> Iterator[Any]:
    """Yield the elements for which a function is true. Raises OpaqueError if its result is not known."""
    for one in values:
        kept = one if function is None else function(one)
        if isinstance(kept, Unknown | Library):
            raise OpaqueError("unknown")
        if bool(kept) is wanted:
            yield one


def _iter(value: Any) -> Any:
    if isinstance(value, Made) and value.has("__iter__"):
        found = value.run("__iter__")
        return found if isinstance(found, Made | Stream) else Stream(iter(listed(found)))
    return value if isinstance(value, Stream) else Stream(iter(listed(value)))


def _next(stream: Any, *default: Any) -> Any:
    if isinstance(stream, Made) and stream.has("__next__"):
        return next(stream.elements(), *default)
    if not isinstance(stream, Stream):
        raise OpaqueError("no iterator")
    return next(stream.values, *default)


def _len(value: Any) -> int:
    if isinstance(value, Made):
        return len(value)
    if isinstance(value, bytes):
        return len(value)
    if isinstance(value, Stream):
        raise OpaqueError("an iterator has no length")
    if not whole(value):
        raise OpaqueError("an unknown number of elements")
    return len(listed(value))


def _reversed(value: Any) -> Stream:
    return Stream(iter(listed(value)[::-1]))


def _isinstance(value: Any, kinds: Any) -> bool:
    for one in kinds if isinstance(kinds, tuple | list) else (kinds,):
        if isinstance(one, Class):
            if isinstance(value, Made) and value.kind.is_a(one):
                return True
            continue
        kind = type_of(one) or _ABSTRACT.get(getattr(one, "name", None), one if _is_error(one) else None)
        if kind is None:
            raise OpaqueError("an unknown class")
        if isinstance(value.plain() if isinstance(value, Made) else value, kind):
            return True
    return False


_ABSTRACT: Final[Mapping[Any, Any]] = {
    **{f"{home}.{name}": (dict, ChainMap) for home in ("collections.abc", "typing")
       for name in ("Mapping", "MutableMapping")},
    **{f"{home}.Sequence": (str, list, tuple, range, deque) for home in ("collections.abc", "typing")},
    **{f"{home}.Iterable": (str, list, tuple, range, deque, dict, Unique, Stream)
       for home in ("collections.abc", "typing")},
    "numbers.Number": (int, float), "numbers.Real": (int, float), "numbers.Integral": int,
    "pathlib.PurePosixPath": FilePath,
}  # fmt: skip


def _is_error(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseException)


def _issubclass(kind: Any, kinds: Any) -> bool:
    others = kinds if isinstance(kinds, tuple | list) else (kinds,)
    if not isinstance(kind, Class):
        raise OpaqueError("an unknown class")
    return any(kind.is_a(one) or one in kind.library_bases() for one in others)


def _type(value: Any, *more: Any) -> Any:
    """Return the class of a value, in the form that its name has in interpreted files."""
    if more:
        raise OpaqueError("a class is made")
    if isinstance(value, Made):
        return value.kind
    if isinstance(value, BaseException):
        return type(value)
    if value is None:
        return type(None)
    return next(made for made, kind in TYPES.items() if type(value) is kind)


def _print(*_: Any, **__: Any) -> None:
    """Do nothing."""


def _str(value: Any = "", *_: Any) -> str:
    return written(value)


def _callable(value: Any) -> bool:
    return isinstance(value, Class) or (
        callable(value) if not isinstance(value, Made) else value.has("__call__")
    )


def _number(kind: type, special: str) -> Callable[..., Any]:
    def number(value: Any = 0, *args: Any) -> Any:
        if isinstance(value, Made) and value.plain() is value and not value.has(special):
            raise OpaqueError("not a number")
        return kind(value, *args)

    return number


# Functions that only use the structure of their arguments; elements of the arguments may be unknown
STRUCTURE: Final[Mapping[str, Any]] = {
    "list": make_list, "tuple": make_tuple, "dict": make_dict, "len": _len, "map": _map, "set": make_set,
    "frozenset": make_frozen,
    "filter": _filter, "isinstance": _isinstance, "sorted": ordered, "sum": _sum, "enumerate": _enumerate,
    "zip": _zip, "type": _type, "reversed": _reversed, "iter": _iter, "next": _next, "any": _tested("any"),
    "all": _tested("all"), "min": _extreme("min"), "max": _extreme("max"), "range": _range, "callable": _callable,
    "issubclass": _issubclass,
}  # fmt: skip
ERRORS: Final[Mapping[str, Any]] = {
    name: one
    for name, one in vars(builtins).items()
    if isinstance(one, type) and issubclass(one, BaseException)
}
PLAIN: Final[Mapping[str, Any]] = {
    "str": str, "int": int, "float": float, "bool": bool, "abs": abs, "round": round, "repr": repr,
    "divmod": divmod, "ord": ord, "chr": chr, "hex": hex, "bin": bin, "oct": oct, "print": _print, "slice": slice,
    "bytes": bytes, "pow": power, "format": lambda value, spec="": formatted(value, spec), "ascii": ascii,
}  # fmt: skip
BUILTINS: Final[Mapping[str, Any]] = {
    **PLAIN,
    **STRUCTURE,
    **ERRORS,
    "object": object,
    "NotImplemented": None,
}


def limits(made: Any, args: list[Any]) -> None:
    """Raise OpaqueError if the result of a built-in function would be too large."""
    if made is bytes and args and isinstance(args[0], int):
        raise OpaqueError("bytes")
    if made in (int, float) and args and isinstance(args[0], str):
        limited(len(args[0]) * 100)
