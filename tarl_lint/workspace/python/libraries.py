"""Functions and constants of Python's standard library that interpreted files may use, by full name.

None of them reads files or the environment, and the size of their results is limited.
"""

from __future__ import annotations

import ast
import copy
import math
import shlex
import string
import textwrap
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Final

from tarl_lint.workspace.python.builtin_functions import BUILTINS, PLAIN, STRUCTURE, limits
from tarl_lint.workspace.python.containers import (
    make_chain,
    make_counter,
    make_defaults,
    make_dict,
    make_ordered,
    make_queue,
)
from tarl_lint.workspace.python.elements import as_data, bounded, items, listed, settled
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.iterators import OF_ITERATORS
from tarl_lint.workspace.python.methods import checked
from tarl_lint.workspace.python.objects import TUPLES, Class
from tarl_lint.workspace.python.operators import format_text, limited, written
from tarl_lint.workspace.python.paths import OF_PATHS, FilePath
from tarl_lint.workspace.python.regular_expressions import OF_EXPRESSIONS
from tarl_lint.workspace.python.values import (
    Field,
    Library,
    OpaqueError,
    Partial,
    Stream,
    Suppressed,
    Unknown,
)

_NOTHING: Final = Unknown(0, "a field")


def _copied(value: Any) -> Any:
    if not bounded(value):
        raise OpaqueError("too large")
    return _copy(value, {}, 0)


def _copy(value: Any, made: dict[int, Any], depth: int) -> Any:
    """Return a deep copy that keeps shared values shared."""
    if depth > 50:
        raise OpaqueError("too deep")
    if id(value) in made:
        return made[id(value)]
    if isinstance(value, list | deque):
        found: Any = made.setdefault(id(value), type(value)())
        found.extend(_copy(one, made, depth + 1) for one in value)
    elif isinstance(value, tuple):
        found = tuple(_copy(one, made, depth + 1) for one in value)
    elif isinstance(value, dict):
        found = made.setdefault(id(value), copy.copy(value))
        found.update({key: _copy(one, made, depth + 1) for key, one in value.items()})
    elif isinstance(value, Made) and not value.kind.is_enumeration():
        found = made.setdefault(id(value), Made(value.kind, {}))
        found.attributes.update({key: _copy(one, made, depth + 1) for key, one in value.attributes.items()})
    else:
        return value
    return found


def _shallow(value: Any) -> Any:
    if isinstance(value, Made):
        return Made(value.kind, dict(value.attributes)) if not value.kind.is_enumeration() else value
    return copy.copy(value) if isinstance(value, list | dict | deque) else value


def _named_tuple(name: Any, fields: Any, defaults: Any = (), **_: Any) -> Class:
    words = fields.replace(",", " ").split() if isinstance(fields, str) else listed(fields)
    stated = tuple(map(str, words))
    last = stated[len(stated) - len(listed(defaults)) :]
    return Class(
        str(name), (Library(TUPLES),), dict(zip(last, listed(defaults), strict=True)), stated, unpacked=True
    )


def _environment(name: Any, default: Any = None) -> Any:
    return Unknown(0, f"env {name}") if default is None else default


def _field(default: Any = _NOTHING, default_factory: Any = None, **given: Any) -> Field:
    flags = [bool(given.get(key, key != "kw_only")) for key in ("init", "repr", "kw_only", "compare")]
    return Field(default, default_factory, *flags)


def _space(*_: Any, **given: Any) -> Made:
    return Made(Class("SimpleNamespace", (), {}, tuple(given), options={"eq": True}), dict(given))


def _written(value: Any, **given: Any) -> str:
    import json

    checked(value, {key: one for key, one in given.items() if key != "default"})
    if given.get("default") is not None or (isinstance(given.get("indent"), int) and given["indent"] > 20):
        raise OpaqueError("not a constant")
    given.pop("default", None)
    return json.dumps(as_data(value), **given)


def _loaded(text: Any, **given: Any) -> Any:
    import json

    if given or not isinstance(text, str):
        raise OpaqueError("not a constant")
    found = json.loads(text)
    if not bounded(found):
        raise OpaqueError("too large")
    return found


def _words(text: Any, **given: Any) -> list[str]:
    """Return the result of `shlex.split`; refuse None."""
    if not isinstance(text, str):
        raise OpaqueError("not a text")
    return shlex.split(text, **given)


def _literal(text: Any) -> Any:
    limited(len(text) * 10)
    try:
        found = ast.literal_eval(text)
    except (SyntaxError, MemoryError) as error:
        raise OpaqueError(str(error)) from None
    if not settled(found):
        raise OpaqueError("not a constant")
    return found


class Formatter:
    """`string.Formatter`: the fields of a format."""

    readable: ClassVar = frozenset({"parse", "format"})

    @staticmethod
    def parse(text: Any) -> Stream:
        """Return the parts of a format."""
        limited(len(text) * 10)
        return Stream(iter(list(string.Formatter().parse(text))))

    @staticmethod
    def format(text: str, *args: Any, **keywords: Any) -> str:
        """Return a format string with its fields replaced."""
        return format_text(text, list(args), keywords)


def _factorial(number: int) -> int:
    if number > 300:
        raise OpaqueError("too large a number")
    return math.factorial(number)


def _close(left: float, right: float, **given: float) -> bool:
    return math.isclose(left, right, **given)


def _prod(values: Any) -> Any:
    given = listed(values)
    checked(given, {})
    if not all(isinstance(one, int | float) for one in given) or len(given) > 1_000:
        raise OpaqueError("not a number")
    return (
        math.prod(map(float, given)) if any(isinstance(one, float) for one in given) else _product_of(given)
    )


def _product_of(numbers: list[int]) -> int:
    found = 1
    for one in numbers:
        found *= one
        if found.bit_length() > 4_096:
            raise OpaqueError("too large a number")
    return found


def _statistic(name: str) -> Callable[..., Any]:
    def found(values: Any) -> Any:
        import statistics

        given = listed(values)
        checked(given, {})
        return getattr(statistics, name)(given)

    return found


def _matching(name: str) -> Callable[..., Any]:
    def found(value: Any, pattern: str) -> Any:
        import fnmatch

        limited(len(pattern) * 100)
        if pattern.count("*") > 4:
            raise OpaqueError("it might take long")
        return getattr(fnmatch, name)(listed(value) if name == "filter" else str(value), pattern)

    return found


def _toml(text: Any) -> Any:
    import sys

    if sys.version_info < (3, 11):
        raise OpaqueError("no tomllib")
    import tomllib

    return tomllib.loads(text)


def _wrapped(name: str) -> Callable[..., Any]:
    run = getattr(textwrap, name)

    def found(text: str, *args: Any, **given: Any) -> Any:
        limited(
            sum(len(one) if isinstance(one, str) else 0 for one in (*args, *given.values())) * (len(text) + 1)
        )
        return run(text, *args, **given)

    return found


_MATH: Final = (
    "sqrt", "radians", "degrees", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "floor",
    "ceil", "trunc", "fabs", "fmod", "hypot", "exp", "log", "log2", "log10", "copysign", "isnan", "isinf", "isfinite",
    "gcd", "dist", "fsum", "modf",
)  # fmt: skip
_NUMPY: Final = {"deg2rad": math.radians, "rad2deg": math.degrees, "radians": math.radians, "degrees": math.degrees,
                 "sqrt": math.sqrt, "sin": math.sin, "cos": math.cos, "tan": math.tan, "hypot": math.hypot,
                 "arctan2": math.atan2}  # fmt: skip
_STRUCTURE: Final[Mapping[str, Any]] = {
    **OF_ITERATORS, **OF_EXPRESSIONS, "copy.deepcopy": _copied, "copy.copy": _shallow,
    "collections.OrderedDict": make_ordered,
    "collections.defaultdict": make_defaults, "collections.deque": make_queue, "collections.ChainMap": make_chain,
    "dataclasses.field": _field, "types.SimpleNamespace": _space, "argparse.Namespace": _space,
    "contextlib.suppress": lambda *kinds: Suppressed(kinds), "contextlib.nullcontext": lambda value=None: value,
    "types.MappingProxyType": lambda value: value, "typing.cast": lambda _, value: value,
    "contextlib.closing": lambda value: value, "collections.UserDict": make_dict,
}  # fmt: skip
_OF_DATA: Final[Mapping[str, Any]] = {
    **{f"math.{name}": getattr(math, name) for name in _MATH},
    **{f"numpy.{name}": one for name, one in _NUMPY.items()},
    "math.factorial": _factorial, "math.prod": _prod, "math.isclose": _close, "math.pow": math.pow,
    **{f"statistics.{name}": _statistic(name) for name in ("mean", "median", "fmean", "stdev", "pstdev")},
    **OF_PATHS,
    "os.environ.get": _environment, "os.getenv": _environment,
    "pathlib.Path": FilePath, "pathlib.PurePath": FilePath, "pathlib.PosixPath": FilePath,
    "pathlib.PurePosixPath": FilePath,
    "collections.namedtuple": _named_tuple, "collections.Counter": make_counter,
    "string.Template": string.Template,
    "string.Formatter": Formatter, "string.capwords": lambda text, sep=None: string.capwords(text, sep),
    **{f"textwrap.{name}": _wrapped(name) for name in ("dedent", "indent", "fill", "shorten", "wrap")},
    "json.dumps": _written, "json.loads": _loaded, "shlex.split": _words, "shlex.quote": shlex.quote,
    "shlex.join": lambda words: shlex.join(listed(words)), "ast.literal_eval": _literal, "tomllib.loads": _toml,
    "fnmatch.fnmatch": _matching("fnmatch"), "fnmatch.fnmatchcase": _matching("fnmatchcase"),
    "fnmatch.filter": _matching("filter"),
}  # fmt: skip
CONSTANTS: Final[Mapping[str, Any]] = {
    "sys.version_info.major": 3, "sys.version_info[0]": 3,
    "math.pi": math.pi, "math.e": math.e, "math.inf": math.inf, "math.nan": math.nan, "math.tau": math.tau,
    "numpy.pi": math.pi, "numpy.inf": math.inf, "os.sep": "/", "os.path.sep": "/", "os.linesep": "\n",
    "sys.maxsize": 2**63 - 1, "os.pathsep": ":", "os.curdir": ".", "os.pardir": "..", "os.extsep": ".",
    "typing.TYPE_CHECKING": False, "collections.abc.TYPE_CHECKING": False,
    **{f"string.{name}": getattr(string, name) for name in (
        "ascii_letters", "ascii_lowercase", "ascii_uppercase", "digits", "hexdigits", "octdigits", "punctuation",
        "whitespace", "printable")},
}  # fmt: skip
LIBRARIES: Final[Mapping[str, Any]] = {**_STRUCTURE, **_OF_DATA, **CONSTANTS}
_OF_STRUCTURE: Final = frozenset(map(id, (*STRUCTURE.values(), *_STRUCTURE.values())))
_PLAIN: Final = frozenset(map(id, (*PLAIN.values(), *_OF_DATA.values())))
# functions that take functions of the file as arguments and check them
_TESTING: Final = frozenset(map(id, (BUILTINS["isinstance"], BUILTINS["issubclass"], BUILTINS["type"],
                                     _STRUCTURE["contextlib.suppress"], BUILTINS["callable"])))  # fmt: skip
_OF_OBJECTS: Final = frozenset(map(id, (copy.copy, _copied, _shallow)))


def is_builtin(made: Any) -> bool:
    """Return whether a callable of Python's library calls the functions that it receives."""
    return (id(made) in _PLAIN or id(made) in _OF_STRUCTURE) and id(made) not in _TESTING | _OF_OBJECTS


def function(made: Any, args: list[Any], keywords: dict[str, Any]) -> Any:
    """Return the result of a built-in function, or of another callable, which may receive unknown values.

    Raises OpaqueError if the result is not constant or is too large, and any exception of the function.
    """
    if id(made) in _PLAIN:
        args = [_listed(one) for one in args]
        checked(args, {key: one for key, one in keywords.items() if key != "key"})
        limits(made, args)
        if made is str:
            return written(args[0]) if args else ""
    elif id(made) in _OF_STRUCTURE:
        if any(isinstance(one, Unknown | Library) for one in args):
            raise OpaqueError("not a constant")
    elif not isinstance(made, Partial) and not (isinstance(made, type) and issubclass(made, BaseException)):
        args = [as_data(one) for one in args]
        keywords = {key: as_data(one) for key, one in keywords.items()}
    return made(*args, **keywords)


def _listed(value: Any) -> Any:
    """Return an argument for the library: iterators and sets as lists."""
    found = items(value) if not isinstance(value, str | dict | tuple | Made | deque) else None
    return value if found is None else found
