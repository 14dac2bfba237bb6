"""Methods of Python's own types, for values whose elements are constant or unknown."""

from __future__ import annotations

import re
import string
from collections import ChainMap, Counter, OrderedDict, defaultdict, deque
from collections.abc import Mapping
from typing import Any, Final

from tarl_lint.workspace.python import regular_expressions
from tarl_lint.workspace.python.elements import Unique, elements_if_known, listed, settled
from tarl_lint.workspace.python.operators import format_text, limited
from tarl_lint.workspace.python.values import Bound, OpaqueError, Several, Stream, Unknown

_LIST: Final = frozenset(
    ["append", "extend", "insert", "index", "count", "copy", "pop", "remove", "reverse", "clear"]
)
_DICT: Final = frozenset(
    ["get", "items", "keys", "values", "update", "copy", "setdefault", "pop", "popitem", "clear"]
)
METHODS: Final[Mapping[type, frozenset[str]]] = {
    str: frozenset(["format", "join", "split", "rsplit", "splitlines", "strip", "lstrip", "rstrip", "lower", "upper",
                    "replace", "startswith", "endswith", "title", "capitalize", "partition", "rpartition", "find",
                    "rfind", "index", "rindex", "count", "isdigit", "isnumeric", "isdecimal", "isalpha", "isalnum",
                    "isupper", "islower", "isspace", "istitle", "isidentifier", "isascii", "removeprefix",
                    "removesuffix", "zfill", "ljust", "rjust", "center", "swapcase", "casefold", "expandtabs",
                    "translate", "format_map", "encode"]),
    bytes: frozenset(["decode", "hex"]),
    int: frozenset(["bit_length", "bit_count", "conjugate"]),
    float: frozenset(["is_integer"]),
    list: _LIST | {"sort"},
    tuple: frozenset(["index", "count"]),
    deque: _LIST | {"appendleft", "extendleft", "popleft", "rotate"},
    dict: _DICT,
    OrderedDict: _DICT | {"move_to_end"},
    defaultdict: _DICT,
    Counter: _DICT | {"most_common", "elements", "subtract", "total"},
    ChainMap: frozenset(["get", "items", "keys", "values", "new_child", "pop", "update", "setdefault"]),
    Unique: frozenset(["add", "discard", "remove", "pop", "clear", "update", "copy", "union", "intersection",
                       "difference", "symmetric_difference", "issubset", "issuperset", "isdisjoint"]),
    re.Pattern: frozenset(["match", "search", "fullmatch", "findall", "finditer", "sub", "subn", "split"]),
    re.Match: frozenset(["group", "groups", "groupdict", "start", "end", "span", "expand"]),
    string.Template: frozenset(["substitute", "safe_substitute"]),
    range: frozenset(["index", "count"]),
}  # fmt: skip
READ: Final[Mapping[type, frozenset[str]]] = {
    re.Match: frozenset(["string", "lastgroup", "lastindex", "re", "pos", "endpos"]),
    re.Pattern: frozenset(["pattern", "groups", "groupindex"]),
    string.Template: frozenset(["template"]),
    deque: frozenset(["maxlen"]),
    ChainMap: frozenset(["maps", "parents"]),
    int: frozenset(["real", "imag", "numerator", "denominator"]),
    float: frozenset(["real", "imag"]),
    range: frozenset(["start", "stop", "step"]),
}  # fmt: skip
_OF_ELEMENTS: Final = frozenset(["index", "count", "remove"])  # methods that compare elements
_OF_ONE: Final = frozenset(
    ["add", "copy", "clear", "pop", "discard", "remove"]
)  # methods of sets that take one element
_ADDING: Final = frozenset(["append", "appendleft", "insert", "extend", "extendleft"])


def method(bound: Bound, args: list[Any], keywords: dict[str, Any]) -> Any:
    """Return the result of a method of a string, list, dict or other value of Python's library.

    Raises OpaqueError if the result depends on unknown values or is too large, and any exception of the
    method.
    """
    of, name = bound.of, bound.name
    if isinstance(of, str):
        return _of_text(of, name, args, keywords)
    if isinstance(of, re.Pattern):
        return regular_expressions.of_pattern(of, name, args, keywords)
    if isinstance(of, string.Template):
        return _substituted(of, name, args, keywords)
    if isinstance(of, list | deque):
        return _of_list(of, name, args, keywords)
    if isinstance(of, Counter) and name in ("update", "subtract"):
        args = [items_or_mapping(one) for one in args]
        checked(args, keywords)
        return getattr(of, name)(*args, **keywords)
    if isinstance(of, dict | ChainMap):
        return _of_mapping(of, name, args, keywords)
    if isinstance(of, Unique):
        if name not in _OF_ONE:
            args = [listed(one) for one in args]
            limited(len(of) + sum(map(len, args)))
    else:
        checked(args, keywords)
    found = getattr(of, name)(*args, **keywords)
    return Stream(found) if type(found).__name__ == "callable_iterator" else found


def items_or_mapping(value: Any) -> Any:
    """Return a mapping unchanged, or the elements of another value."""
    return value if isinstance(value, dict) else listed(value)


def checked(args: Any, keywords: Any) -> None:
    """Raise OpaqueError if arguments contain unknown values."""
    if not settled([args, keywords]):
        raise OpaqueError("not a constant")


def _of_list(of: Any, name: str, args: list[Any], keywords: dict[str, Any]) -> Any:
    if name == "sort":
        of[:] = ordered(of, **keywords)
        return None
    if name in _OF_ELEMENTS:
        checked([list(of), *args], keywords)
    elif name in _ADDING:
        added = elements_if_known(args[0]) if name in ("extend", "extendleft") else [0]
        if added is None:
            text = args[0].text if isinstance(args[0], Unknown) else "unknown elements"
            given = Several(args[0].line if isinstance(args[0], Unknown) else 0, text)
            name, args, added = "append", [given], [0]
        elif name in ("extend", "extendleft"):
            args = [added]
        limited(len(of) + len(added))
    return getattr(of, name)(*args, **keywords)


def _of_mapping(of: Any, name: str, args: list[Any], keywords: dict[str, Any]) -> Any:
    if name == "update":
        return updated(of, args, keywords)
    checked(args[:1], {})
    limited(len(of))
    if name == "elements":
        limited(sum(of.values()))
        return Stream(of.elements())
    if name == "new_child":
        return of.new_child(*args, **keywords)
    return getattr(of, name)(*args, **keywords)


def ordered(values: Any, *, key: Any = None, reverse: Any = False) -> list[Any]:
    """Return the sorted elements. Raises OpaqueError if their order is not known."""
    given = listed(values)
    keys = given if key is None else [key(one) for one in given]
    checked(keys, reverse)
    order = sorted(range(len(given)), key=keys.__getitem__, reverse=bool(reverse))
    return [given[one] for one in order]


def _of_text(of: str, name: str, args: list[Any], keywords: dict[str, Any]) -> Any:
    """Return the result of a method of a string."""
    if name == "join":
        parts = listed(args[0])
        checked(parts, {})
        limited(sum(len(one) + len(of) for one in parts))
        return of.join(str(one.plain()) if hasattr(one, "kind") else one for one in parts)
    checked(args, keywords)
    if name == "format":
        return format_text(of, args, keywords)
    if name == "format_map":
        return format_text(of, [], dict(args[0]))
    if name == "replace":
        limited(len(of) + of.count(args[0]) * len(args[1]))
    elif name in ("zfill", "ljust", "rjust", "center"):
        limited(args[0])
    elif name == "expandtabs":
        limited(len(of) * (args[0] if args else 8))
    elif name == "translate":
        limited(len(of) * max((len(one) for one in args[0].values() if isinstance(one, str)), default=1))
    return getattr(of, name)(*args, **keywords)


def _substituted(of: string.Template, name: str, args: list[Any], keywords: dict[str, Any]) -> str:
    """Return the text of a template."""
    values = {**(dict(args[0]) if args else {}), **keywords}
    checked(values, {})
    texts = {key: str(one) for key, one in values.items()}
    limited(len(of.template) + of.template.count("$") * max(map(len, texts.values()), default=0))
    text: str = getattr(of, name)(texts)
    return text


def updated(of: Any, args: list[Any], keywords: dict[str, Any]) -> None:
    """Add the elements of mappings or of lists of pairs to a mapping."""
    for one in args:
        pairs = one.items() if isinstance(one, dict | ChainMap) else listed(one)
        for key, value in pairs:
            checked([key], {})
            of[key] = value
    of.update(keywords)
    limited(len(of))
