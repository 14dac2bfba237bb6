"""Constructors of lists, sets, dicts and `collections`."""

from __future__ import annotations

from collections import ChainMap, Counter, OrderedDict, defaultdict, deque
from collections.abc import Mapping
from typing import Any, Final

from tarl_lint.workspace.python.elements import Unique, listed
from tarl_lint.workspace.python.methods import checked, items_or_mapping, updated
from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.python.values import OpaqueError


def make_list(values: Any = ()) -> list[Any]:
    """Return `list(…)`. Like all functions here, raises OpaqueError if the elements are not known."""
    return listed(values)


def make_tuple(values: Any = ()) -> tuple[Any, ...]:
    """Return `tuple(…)`."""
    return tuple(listed(values))


def make_set(values: Any = ()) -> Unique:
    """Return `set(…)`."""
    return Unique(listed(values))


def make_frozen(values: Any = ()) -> Unique:
    """Return `frozenset(…)`."""
    return Unique(listed(values))


def make_dict(*args: Any, **keywords: Any) -> dict[Any, Any]:
    """Return `dict(…)`."""
    made: dict[Any, Any] = {}
    updated(made, list(args), keywords)
    return made


def make_counter(values: Any = (), **keywords: Any) -> Counter[Any]:
    """Return `Counter(…)`."""
    given = items_or_mapping(values)
    checked(given, keywords)
    return Counter(given, **keywords)


def make_ordered(*args: Any, **keywords: Any) -> OrderedDict[Any, Any]:
    """Return `OrderedDict(…)`."""
    found: OrderedDict[Any, Any] = OrderedDict()
    updated(found, list(args), keywords)
    return found


def make_defaults(factory: Any = None, *args: Any, **keywords: Any) -> defaultdict[Any, Any]:
    """Return `defaultdict(…)`."""
    found: defaultdict[Any, Any] = defaultdict(factory)
    updated(found, list(args), keywords)
    return found


def make_queue(values: Any = (), maxlen: int | None = None) -> deque[Any]:
    """Return `deque(…)`."""
    return deque(listed(values), maxlen)


def make_chain(*maps: Any) -> ChainMap[Any, Any]:
    """Return `ChainMap(…)`. Raise OpaqueError if a mapping is not known."""
    if not all(isinstance(one, dict | ChainMap) for one in maps):
        raise OpaqueError("unknown mappings")
    return ChainMap(*maps)


# value that the name of a type has in interpreted files → the type
TYPES: Final[Mapping[Any, type]] = {
    str: str, int: int, float: float, bool: bool, bytes: bytes, object: object, slice: slice, FilePath: FilePath,
    make_list: list, make_tuple: tuple, make_dict: dict, make_set: Unique, make_frozen: Unique, make_queue: deque,
    make_ordered: OrderedDict, make_defaults: defaultdict, make_counter: Counter, make_chain: ChainMap,
}  # fmt: skip


def type_of(value: Any) -> type | None:
    """Return the type that a name of Python's library refers to; None if it refers to something else."""
    try:
        return TYPES.get(value)
    except TypeError:  # a dict has no hash
        return None
