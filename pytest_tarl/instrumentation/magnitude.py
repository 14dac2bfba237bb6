"""The flow value of any object: a finite, non-negative number, computed without running the program's code.

=============================  =====================================================================
int, float, bool               absolute value; 1 and 0
complex, Fraction, Decimal     absolute value
numpy scalars and arrays       Euclidean norm (real and complex numbers; other kinds 0)
list, tuple, set, dict values  Euclidean norm of all numbers inside, at any depth
ROS message, dataclass         the same, without header, stamp, seq and covariances
NaN, infinity                  0: "no measurement" (REP 117), also as a part of something larger
None, text, bytes, the rest    0
=============================  =====================================================================

Values above `LIMIT` count as `LIMIT`, so that their sums and squares stay finite. To limit the cost, long arrays and
long sequences of plain numbers are sampled in about `SAMPLE` even steps, and the norm is scaled up. In other
containers, at most `SAMPLE` parts are visited.
"""

from __future__ import annotations

import math
import sys
from array import array
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from decimal import Decimal
from itertools import islice
from operator import attrgetter
from types import GetSetDescriptorType, MemberDescriptorType
from typing import Any
from weakref import ref

LIMIT = 1e100
SAMPLE = 512
_LEFT_OUT = ("header", "stamp", "seq", "covariance")
_PLAIN = frozenset(map(id, (float, int, bool)))
_CONTAINERS = (list, tuple, deque, set, frozenset)

Number = Callable[[Any], float]
Parts = Callable[[Any], Iterable[Any]]


def magnitude(value: object) -> float:
    """Return the flow value of any object, finite and at least 0. Never raise, and never change `value`."""
    if value is None or value is True or value is False or type(value) is str:
        return 1.0 if value is True else 0.0
    try:
        number, parts = _kind(type(value))
        if number is not None:
            return _size(number, value)
        return 0.0 if parts is None else _bounded(_norm(value))
    except Exception:  # any exception can come from an object, and none must reach the program
        return 0.0


def _bounded(number: float) -> float:
    size = abs(number)
    if size <= LIMIT:
        return size
    return LIMIT if size < math.inf else 0.0


def _norm(value: object) -> float:
    sizes: list[float] = []
    entered: set[int] = set()  # ids of visited containers, to stop at cycles
    waiting: list[Any] = [value]
    looked_at = 0
    while waiting and looked_at < 2 * SAMPLE:
        looked_at += 1
        inner = waiting.pop()
        kind = type(inner)
        if kind is float:
            sizes.append(inner)
            continue
        number, parts = _kind(kind)
        if number is not None:
            sizes.append(_size(number, inner))
        elif parts is not None and id(inner) not in entered:
            entered.add(id(inner))
            plain = _plain_norm(inner) if kind is list or kind is tuple else None
            if plain is None:
                waiting += islice(parts(inner), SAMPLE)
            else:
                sizes.append(plain)
    size = math.hypot(*sizes)
    return size if size < math.inf else math.hypot(*map(_bounded, sizes))


def _size(number: Number, value: object) -> float:
    try:
        return _bounded(number(value))
    except OverflowError:
        return LIMIT
    except Exception:
        return 0.0


def _plain_norm(sequence: list[Any] | tuple[Any, ...]) -> float | None:
    """Return the norm of a sequence of finite plain numbers, or None if it has anything else."""
    length = sequence.__len__()  # the program may have replaced `len`
    step = length // SAMPLE or 1
    sample = sequence[::step] if step > 1 else sequence
    if not _PLAIN.issuperset(map(id, map(type, sample))):
        return None
    try:
        size = math.hypot(*sample) * math.sqrt(length / (sample.__len__() or 1))
    except OverflowError:
        return None
    return size if size < math.inf else None


def _kind(kind: type) -> tuple[Number | None, Parts | None]:
    """Return the functions that read a number and list the parts of a class's objects; None where not applicable."""
    known = _KINDS.get(id(kind))
    if known is None:
        if len(_KINDS) >= _KINDS_KEPT:
            _KINDS.clear()
        number, key = _number(kind), id(kind)
        gone = ref(kind, lambda _: _KINDS.pop(key, None))
        known = _KINDS[key] = gone, number, None if number is not None else _parts(kind)
    return known[1], known[2]


# keyed by id, because hashing a class can run code of the program; the weak reference removes the entry with its class
_KINDS: dict[int, tuple[ref[type], Number | None, Parts | None]] = {}
_KINDS_KEPT = 1024


def _number(kind: type) -> Number | None:
    for plain, number in _NUMBERS:
        if issubclass(kind, plain):
            return number
    numpy, fractions = sys.modules.get("numpy"), sys.modules.get("fractions")
    if numpy is not None and issubclass(kind, (numpy.ndarray, numpy.generic)):
        return _numpy
    return _fraction if fractions is not None and kind is fractions.Fraction else None


def _fraction(value: Any) -> float:
    return float(value._numerator / value._denominator)


def _machine_array(value: array[Any]) -> float:
    import numpy as np

    return 0.0 if value.typecode in "uw" else _numpy(np.frombuffer(value, value.typecode))


_NUMBERS: tuple[tuple[type, Number], ...] = (
    (int, int.__float__),
    (float, float.__abs__),
    (complex, complex.__abs__),
    (Decimal, float),
    (array, _machine_array),
)


def _numpy(value: Any) -> float:
    """Return the norm of a numpy array or scalar; large arrays are sampled evenly."""
    import numpy as np

    flat = np.asarray(value).reshape(-1)
    if flat.dtype.kind not in "biufc" or not flat.size:
        return 0.0
    sample = flat[:: max(1, flat.size // SAMPLE)]
    with np.errstate(all="ignore"):
        sizes = np.abs(sample.astype(np.complex128 if flat.dtype.kind == "c" else np.float64))
        squares = float(np.dot(sizes, sizes))
        if not math.isfinite(squares):
            sizes = np.minimum(np.where(np.isfinite(sizes), sizes, 0.0), LIMIT)
            squares = float(np.dot(sizes, sizes))
    return math.sqrt(squares * (flat.size / sample.size))


def _parts(kind: type) -> Parts | None:
    """Return a function that lists the contents of a container or message; None for other objects."""
    for container in _CONTAINERS:
        if issubclass(kind, container):
            return container.__iter__  # a subclass's method could run any code
    if issubclass(kind, dict):
        return dict.values
    names = _fields(kind)
    if not names:
        return None
    known = [slot.__name__ for name in names if (slot := _slot(kind, name)) is not None]
    if len(known) == len(names) > 1 and _attribute(kind, "__getattribute__") is object.__getattribute__:
        return attrgetter(*known)
    return lambda message: [_stored(message, name) for name in names]


def _fields(kind: type) -> tuple[str, ...]:
    """Return the payload fields of a message class or dataclass."""
    listed = _attribute(kind, "get_fields_and_field_types")
    dataclass_fields = _attributes(kind).get("__dataclass_fields__")
    names: list[str] = []
    if isinstance(listed, classmethod):
        names = list(listed.__get__(None, kind)())
    elif isinstance(dataclass_fields, dict):
        names = list(dataclass_fields)
    else:
        for base in reversed(_bases(kind)):
            slots = _attributes(base).get("__slots__", ())
            names += [slots] if isinstance(slots, str) else list(slots)
    return tuple(name for name in names if not name.strip("_").endswith(_LEFT_OUT))


def _slot(kind: type, name: str) -> MemberDescriptorType | None:
    """Return the descriptor that stores a field; it is named `_name` if a property checks assignments."""
    found = (_attribute(kind, stored) for stored in (name, f"_{name}"))
    return next((slot for slot in found if isinstance(slot, MemberDescriptorType)), None)


def _stored(message: object, name: str) -> object:
    """Read a field without running a property."""
    kind = type(message)
    slot = _slot(kind, name)  # looked up each time, because storing the slot would keep the class alive
    if slot is not None:
        return slot.__get__(message, kind)
    state = _attribute(kind, "__dict__")
    stored = state.__get__(message, kind) if isinstance(state, GetSetDescriptorType) else {}
    return stored.get(name, stored.get(f"_{name}"))


# reads a class's attribute without its metaclass, which can run code of the program
_bases: Callable[[type], tuple[type, ...]] = type.__dict__["__mro__"].__get__
_attributes: Callable[[type], Mapping[str, Any]] = type.__dict__["__dict__"].__get__


def _attribute(kind: type, name: str) -> object:
    return next((_attributes(base)[name] for base in _bases(kind) if name in _attributes(base)), None)
