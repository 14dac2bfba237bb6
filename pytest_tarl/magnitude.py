"""The flow value of anything: one finite, non-negative number, found without running code of the program.

=============================  =====================================================================
int, float, bool               absolute value; 1 and 0
complex, Fraction, Decimal     absolute value
numpy scalars and arrays       Euclidean norm (real and complex numbers; other kinds 0)
list, tuple, set, dict values  Euclidean norm of all numbers inside, at any depth
ROS message, dataclass         the same, leaving out header, stamp, seq and covariances
NaN, infinity                  0: "no measurement" (REP 117), also as a part of something larger
None, text, bytes, the rest    0
=============================  =====================================================================

Values above `LIMIT` count as `LIMIT`, so that sums and squares of them stay finite. At most `LEAVES` numbers
are looked at: larger arrays are sampled evenly and scaled up, what comes later in other
containers is left out.
"""

from __future__ import annotations

import math
import sys
from array import array
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from itertools import islice
from types import MemberDescriptorType
from typing import Any

LIMIT = 1e100
LEAVES = 4096
_LEFT_OUT = ("header", "stamp", "seq", "covariance")
_PLAIN = frozenset({float, bool})
_CONTAINERS = (list, tuple, deque, set, frozenset)

Reader = Callable[[Any], float]
Parts = Callable[[Any], Iterable[Any]]


def magnitude(value: object) -> float:
    """Return the flow value of anything: finite, at least 0. Never raises, leaves `value` alone."""
    try:
        return _bounded(_norm(value))
    except Exception:  # whatever an object does, the program must not notice
        return 0.0


def _bounded(number: float) -> float:
    size = abs(number)
    if size <= LIMIT:
        return size
    return LIMIT if size < math.inf else 0.0


def _norm(value: object) -> float:
    kind: Any = type(value)
    reader = _reader(kind)
    if reader is not None:
        return reader(value)
    if _parts(kind) is None:
        return 0.0
    if (kind is list or kind is tuple) and _PLAIN.issuperset(map(type, value[:LEAVES])):  # type: ignore[index]
        size = math.hypot(*value[:LEAVES])  # type: ignore[index]
        if size < math.inf:
            return size
    leaves = [_bounded(leaf) for leaf in islice(_leaves(value), LEAVES)]
    return math.hypot(*leaves)


def _leaves(value: object) -> Iterator[float]:
    """Yield the magnitudes of the numbers inside, depth first; what holds itself is entered once."""
    stack = [iter((value,))]
    entered: set[int] = set()
    looked_at = 0
    while stack and looked_at < 2 * LEAVES:
        inner = next(stack[-1], stack)
        if inner is stack:
            stack.pop()
            continue
        looked_at += 1
        kind: Any = type(inner)
        reader, parts = _reader(kind), _parts(kind)
        if reader is not None:
            yield _size(reader, inner)
        elif parts is not None and id(inner) not in entered:
            entered.add(id(inner))
            stack.append(iter(parts(inner)))


def _size(reader: Reader, value: object) -> float:
    try:
        return reader(value)
    except Exception:
        return 0.0


@lru_cache(maxsize=1024)
def _reader(kind: type) -> Reader | None:
    """Return what reads a number or an array of numbers; None for everything else."""
    if issubclass(kind, int):
        return _integer
    if issubclass(kind, float):
        return float.__abs__
    if issubclass(kind, complex):
        return complex.__abs__
    if issubclass(kind, array):
        return _machine_array
    numpy = sys.modules.get("numpy")
    if numpy is not None and issubclass(kind, (numpy.ndarray, numpy.generic)):
        return _numpy
    return _EXACT.get((kind.__module__, kind.__qualname__))


def _integer(value: int) -> float:
    try:
        return abs(int.__float__(value))
    except OverflowError:
        return LIMIT


def _decimal(value: Any) -> float:
    return abs(float(value))


def _fraction(value: Any) -> float:
    try:
        return float(abs(value._numerator / value._denominator))
    except OverflowError:
        return LIMIT


_EXACT: dict[tuple[str, str], Reader] = {
    ("decimal", "Decimal"): _decimal,
    ("fractions", "Fraction"): _fraction,
}


def _machine_array(value: array[Any]) -> float:
    import numpy as np

    return 0.0 if value.typecode in "uw" else _numpy(np.frombuffer(value, value.typecode))


def _numpy(value: Any) -> float:
    """Return the norm of an array or scalar of numpy; evenly sampled where it is large."""
    import numpy as np

    flat = np.asarray(value).reshape(-1)
    if flat.dtype.kind not in "biufc":
        return 0.0
    step = max(1, flat.size // LEAVES)
    with np.errstate(all="ignore"):
        sizes = np.abs(flat[::step].astype(np.complex128 if flat.dtype.kind == "c" else np.float64))
        squares = float(np.dot(sizes, sizes))
        if not math.isfinite(squares):
            sizes = np.minimum(np.where(np.isfinite(sizes), sizes, 0.0), LIMIT)
            squares = float(np.dot(sizes, sizes))
    return math.sqrt(squares * step)


@lru_cache(maxsize=1024)
def _parts(kind: type) -> Parts | None:
    """Return what lists the contents of a container or message; None where there is nothing to look into."""
    for container in _CONTAINERS:
        if issubclass(kind, container):
            return container.__iter__  # not the subclass's own, which may do anything
    if issubclass(kind, dict):
        return dict.values
    names = _fields(kind)
    if not names:
        return None
    return lambda message: [_field(message, kind, name) for name in names]


def _fields(kind: type) -> tuple[str, ...]:
    """Return the fields of a message class or dataclass, without those that are no payload."""
    listed = getattr(kind, "get_fields_and_field_types", None)
    names: list[str] = []
    if callable(listed):
        names = list(listed())
    elif isinstance(kind.__dict__.get("__dataclass_fields__"), dict):
        names = list(kind.__dict__["__dataclass_fields__"])
    else:
        for base in reversed(kind.__mro__):
            slots = base.__dict__.get("__slots__", ())
            names += [slots] if isinstance(slots, str) else list(slots)
    return tuple(name for name in names if not name.strip("_").endswith(_LEFT_OUT))


def _field(message: object, kind: type, name: str) -> object:
    """Read a field where it is stored, so that no property runs."""
    for stored in (name, f"_{name}"):
        for base in kind.__mro__:
            slot = base.__dict__.get(stored)
            if isinstance(slot, MemberDescriptorType):
                return slot.__get__(message, None)
    state: object = getattr(message, "__dict__", None)
    if isinstance(state, dict):
        return state.get(name, state.get(f"_{name}"))
    return None
