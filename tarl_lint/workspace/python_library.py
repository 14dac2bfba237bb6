"""Python's built-in functions and methods for constant values, within limits on the size of their results."""

from __future__ import annotations

import ast
import itertools
import math
import operator
import posixpath
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar, Final

from tarl_lint.workspace.python_values import (
    LARGEST,
    TUPLES,
    Bound,
    Class,
    Field,
    FilePath,
    Library,
    Made,
    Unknown,
    bounded,
    items,
    normal,
    plain,
)

BITS: Final = 4096  # maximum size of an integer (bits)
_WIDTH: Final = re.compile(r"\d{4,}|\*")  # matches a width in a format that would make a huge text
# matches fields such as `{0.name}`, which read an attribute or element
_INSIDE: Final = re.compile(r"\{[^{}:!]*[.\[]")
BINARY: Final[Mapping[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.BitOr: operator.or_, ast.BitAnd: operator.and_,
    ast.BitXor: operator.xor, ast.Pow: operator.pow,
}  # fmt: skip
COMPARE: Final[Mapping[type[ast.cmpop], Callable[[Any, Any], Any]]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt,
    ast.GtE: operator.ge, ast.In: lambda item, many: item in many, ast.NotIn: lambda item, many: item not in many,
}  # fmt: skip
UNARY: Final[Mapping[type[ast.unaryop], Callable[[Any], Any]]] = {
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_, ast.Invert: operator.invert,
}  # fmt: skip
METHODS: Final[Mapping[type, frozenset[str]]] = {
    str: frozenset(["format", "join", "split", "rsplit", "splitlines", "strip", "lstrip", "rstrip", "lower", "upper",
                    "replace", "startswith", "endswith", "title", "capitalize", "partition", "rpartition", "find",
                    "rfind", "count", "isdigit", "isnumeric", "isalpha", "isalnum", "removeprefix", "removesuffix",
                    "zfill", "ljust", "rjust", "center", "swapcase", "casefold"]),
    list: frozenset(["append", "extend", "insert", "index", "count", "copy", "pop", "remove", "reverse", "clear",
                     "sort"]),
    dict: frozenset(["get", "items", "keys", "values", "update", "copy", "setdefault", "pop", "clear"]),
    tuple: frozenset(["index", "count"]),
}  # fmt: skip
_OF_ELEMENTS: Final = frozenset(["index", "count", "remove"])  # methods that compare elements


def binary(kind: type[ast.operator], left: Any, right: Any) -> Any:
    """Return the result of an operator. Raises ValueError if the result is too large, and what the operator raises."""
    if kind is ast.Mod and isinstance(left, str):
        return left % _for_text(left, left.count("%"), right)
    numbers = isinstance(left, int | float), isinstance(right, int | float)
    if all(numbers):
        if isinstance(left, int) and isinstance(right, int) and left.bit_length() + right.bit_length() > BITS:
            raise ValueError("too large a number")
        if kind is ast.Pow:
            return _power(left, right)
    elif kind is ast.Mult:
        many, times = (right, left) if numbers[0] else (left, right)
        _limited(len(many) * max(times, 0))
    elif kind is ast.Add and isinstance(left, str | list | tuple):
        _limited(len(left) + len(right))
    return BINARY[kind](left, right)


def _power(base: float, exponent: float) -> float:
    """Return a power. Raises ValueError if it is too large or not a real number."""
    if isinstance(base, int) and isinstance(exponent, int) and base.bit_length() * abs(exponent) > BITS:
        raise ValueError("too large a number")
    found: int | float | complex = base**exponent
    if isinstance(found, complex):
        raise ValueError("not a real number")
    return found


def formatted(value: Any, spec: str, conversion: int = -1) -> str:
    """Return a value as an f-string writes it. Raises ValueError if the value is not a constant or too large."""
    if not isinstance(value, str | int | float | bool | FilePath) or _WIDTH.search(spec):
        raise ValueError("not a constant")
    return format(repr(value) if conversion == ord("r") else str(value) if conversion >= 0 else value, spec)


def method(bound: Bound, args: list[Any], keywords: dict[str, Any]) -> Any:
    """Return the result of a method of a text, list, dict or tuple.

    Raises ValueError if the result depends on unknown values or is too large, and what the method raises.
    """
    of, name = bound.of, bound.name
    if isinstance(of, str):
        _of_text(of, name, args, keywords)
    elif name == "sort":
        of[:] = _sorted(of, **keywords)
        return None
    elif name in _OF_ELEMENTS:
        _checked([of, *args], keywords)
    elif isinstance(of, list) and name in ("append", "insert", "extend"):
        added = items(args[0]) if name == "extend" else [0]
        if added is None:
            given = args[0] if isinstance(args[0], Unknown) else Unknown(0, "unknown elements")
            name, args, added = "append", [given], [0]
        _limited(len(of) + len(added))
    elif isinstance(of, dict):
        if name == "update":
            return _updated(of, args, keywords)
        _checked(args[:1], {})
        _limited(len(of))
    return getattr(of, name)(*args, **keywords)


def _of_text(of: str, name: str, args: list[Any], keywords: dict[str, Any]) -> None:
    """Raise ValueError if a method of a text depends on unknown values, or makes a text that is too large."""
    _checked(args, keywords)
    if name == "format":
        if _INSIDE.search(of):
            raise ValueError("it reads an attribute")
        _for_text(of, of.count("{"), [args, keywords])
    elif name == "replace":
        _limited(len(of) + of.count(args[0]) * len(args[1]))
    elif name == "join":
        _limited(sum(len(one) + len(of) for one in items(args[0]) or []))
    elif name in ("zfill", "ljust", "rjust", "center"):
        _limited(args[0])


def _updated(of: dict[Any, Any], args: list[Any], keywords: dict[str, Any]) -> None:
    for one in args:
        pairs = one.items() if isinstance(one, dict) else items(one)
        if pairs is None:
            raise ValueError("unknown elements")
        for key, value in pairs:
            _checked([key], {})
            of[key] = value
    of.update(keywords)
    _limited(len(of))


def _for_text(text: str, places: int, given: Any) -> Any:
    """Return what is inserted into a text at some places. Raises ValueError if that may be too large."""
    if _WIDTH.search(text) or not plain(given, 1_000):
        raise ValueError("not a constant")
    longest = sum(len(one) if isinstance(one, str) else 20 for one in _flat(given))
    _limited(len(text) + places * longest)
    return given


def _flat(value: Any) -> Iterable[Any]:
    if isinstance(value, list | tuple):
        return itertools.chain.from_iterable(map(_flat, value))
    return itertools.chain.from_iterable(map(_flat, value.values())) if isinstance(value, dict) else (value,)


def _checked(args: list[Any], keywords: dict[str, Any]) -> None:
    if not plain([args, keywords]):
        raise ValueError("not a constant")


def _limited(size: float) -> None:
    if size > LARGEST:
        raise ValueError("too large")


def _elements(value: Any) -> list[Any]:
    found = items(value)
    if found is None:
        raise ValueError("unknown elements")
    return found


def _range(*bounds: int) -> list[int]:
    numbers = range(*bounds)
    _limited(len(numbers))
    return list(numbers)


def _sum(values: Any, start: Any = 0) -> Any:
    given = _elements(values)
    if isinstance(start, list | tuple):
        _limited(sum(map(len, given)))
    elif not plain(given):
        raise ValueError("not a constant")
    return sum(given, start)


def _unique(values: Any = ()) -> list[Any]:
    given = _elements(values)
    if not plain(given):
        raise ValueError("not a constant")
    return list(dict.fromkeys(given))


def _dict(*args: Any, **keywords: Any) -> dict[Any, Any]:
    made: dict[Any, Any] = {}
    _updated(made, list(args), keywords)
    return made


def _isinstance(value: Any, kinds: Any) -> bool:
    for one in kinds if isinstance(kinds, tuple | list) else (kinds,):
        if isinstance(one, Class):
            if isinstance(value, Made) and value.kind.is_a(one):
                return True
        elif isinstance(value, next(kind for kind, made in _types() if made is one)):
            return True
    return False


def _type(value: Any) -> Any:
    """Return the class of a value, in the form that its name has in interpreted files."""
    return (
        value.kind
        if isinstance(value, Made)
        else next(made for kind, made in _types() if type(value) is kind)
    )


def _types() -> Iterable[tuple[type, Any]]:
    return (
        (str, str),
        (int, int),
        (float, float),
        (bool, bool),
        (list, _list),
        (tuple, _tuple),
        (dict, _dict),
    )


def _list(values: Any = ()) -> list[Any]:
    return _elements(values)


def _tuple(values: Any = ()) -> tuple[Any, ...]:
    return tuple(_elements(values))


def _map(function: Callable[..., Any], *values: Any) -> list[Any]:
    return [function(*one) for one in zip(*map(_elements, values), strict=False)]


def _filter(function: Any, values: Any) -> list[Any]:
    found = []
    for one in _elements(values):
        kept = one if function is None else function(one)
        if isinstance(kept, Unknown | Library):
            raise ValueError("unknown")
        if kept:
            found.append(one)
    return found


def _sorted(values: Any, *, key: Any = None, reverse: bool = False) -> list[Any]:
    given = _elements(values)
    keys = given if key is None else [key(one) for one in given]
    if not plain(keys):
        raise ValueError("not a constant")
    order = sorted(range(len(given)), key=keys.__getitem__, reverse=bool(reverse))
    return [given[one] for one in order]


class _Chain:
    """`itertools.chain`."""

    readable: ClassVar = frozenset({"from_iterable"})

    def __call__(self, *values: Any) -> list[Any]:
        """Return the elements of all lists."""
        lists = list(map(_elements, values))
        _limited(sum(map(len, lists)))
        return [one for each in lists for one in each]

    def from_iterable(self, values: Any) -> list[Any]:
        """Return the elements of the lists of a list."""
        return self(*_elements(values))


def _product(*values: Any, repeat: int = 1) -> list[Any]:
    lists = list(map(_elements, values)) * min(repeat, 20)
    _limited(math.prod(map(len, lists)))
    return list(itertools.product(*lists))


def _copied(value: Any, depth: int = 0) -> Any:
    if depth > 20 or (not depth and not bounded(value)):
        raise ValueError("too large")
    if isinstance(value, list | tuple):
        return type(value)(_copied(one, depth + 1) for one in value)
    return {key: _copied(one, depth + 1) for key, one in value.items()} if isinstance(value, dict) else value


def _named_tuple(name: Any, fields: Any, **_: Any) -> Class:
    words = fields.replace(",", " ").split() if isinstance(fields, str) else _elements(fields)
    return Class(str(name), (Library(TUPLES),), {}, tuple(map(str, words)), unpacked=True)


def _environment(name: Any, default: Any = None) -> Any:
    return Unknown(0, f"env {name}") if default is None else default


def _absolute(path: Any) -> Any:
    text = str(path)
    return normal(text) if text.startswith("/") else Unknown(0, text)


# Functions that only use the structure of their arguments; elements of the arguments may be unknown
STRUCTURE: Final[Mapping[str, Any]] = {
    "list": _list, "tuple": _tuple, "dict": _dict, "len": lambda one: len(_elements(one)), "map": _map,
    "filter": _filter, "isinstance": _isinstance, "sorted": _sorted, "sum": _sum,
    "enumerate": lambda values, start=0: list(enumerate(_elements(values), start)),
    "zip": lambda *values, **_: list(zip(*map(_elements, values), strict=False)),
    "type": _type, "reversed": lambda one: _elements(one)[::-1], "iter": _list,
    "itertools.chain": _Chain(),
    "itertools.product": _product, "copy.deepcopy": _copied, "copy.copy": _copied,
    "collections.OrderedDict": _dict, "dataclasses.field": lambda default=None, default_factory=None, **_: Field(
        default, default_factory),
}  # fmt: skip
BUILTINS: Final[Mapping[str, Any]] = {
    "str": str, "int": int, "float": float, "bool": bool, "range": _range, "min": min, "max": max, "abs": abs,
    "round": round, "any": any, "all": all, "repr": repr, "set": _unique, "frozenset": _unique, "divmod": divmod,
    "ord": ord, "chr": chr, "print": lambda *_, **__: None,
    **{name: one for name, one in STRUCTURE.items() if "." not in name},
}  # fmt: skip
LIBRARIES: Final[Mapping[str, Any]] = {
    "math.pi": math.pi, "math.e": math.e, "math.inf": math.inf, "math.sqrt": math.sqrt, "math.radians": math.radians,
    "math.degrees": math.degrees, "math.sin": math.sin, "math.cos": math.cos, "math.floor": math.floor,
    "math.ceil": math.ceil,
    "numpy.pi": math.pi, "numpy.inf": math.inf, "os.path.join": posixpath.join, "os.path.basename": posixpath.basename,
    "os.path.dirname": posixpath.dirname, "os.path.splitext": posixpath.splitext, "os.path.normpath": normal,
    "os.path.realpath": _absolute, "os.path.abspath": _absolute, "os.path.isabs": posixpath.isabs, "os.sep": "/",
    "sys.maxsize": 2**63 - 1,
    "os.environ.get": _environment, "os.getenv": _environment,
    "pathlib.Path": FilePath, "pathlib.PurePath": FilePath, "pathlib.PosixPath": FilePath,
    "collections.namedtuple": _named_tuple,
    **{name: one for name, one in STRUCTURE.items() if "." in name},
}  # fmt: skip
_OF_STRUCTURE: Final = frozenset(map(id, STRUCTURE.values()))
_PLAIN: Final = frozenset(map(id, (*BUILTINS.values(), *LIBRARIES.values()))) - _OF_STRUCTURE


def is_builtin(made: Any) -> bool:
    """Return whether a callable is one of this module."""
    return id(made) in _PLAIN or id(made) in _OF_STRUCTURE


def function(made: Any, args: list[Any], keywords: dict[str, Any]) -> Any:
    """Return the result of a built-in function, or of another callable, which may receive unknown values.

    Raises ValueError if the result is not constant or too large, and what the function raises.
    """
    if id(made) in _PLAIN:
        _checked(list(map(_listed, args)), {key: one for key, one in keywords.items() if key != "key"})
    elif id(made) in _OF_STRUCTURE and any(isinstance(one, Unknown | Library) for one in args):
        raise ValueError("not a constant")
    return made(*args, **keywords)


def _listed(value: Any) -> Any:
    found = items(value)
    return value if found is None else found
