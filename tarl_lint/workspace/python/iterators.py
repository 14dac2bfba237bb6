"""`itertools`, `functools.reduce` and `operator` for constant values; endless iterators are read step by step."""

from __future__ import annotations

import ast
import itertools
import math
import operator
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Final

from tarl_lint.workspace.python.builtin_functions import filtered, streamed
from tarl_lint.workspace.python.elements import listed
from tarl_lint.workspace.python.methods import checked
from tarl_lint.workspace.python.operators import BINARY, COMPARE, binary, limited
from tarl_lint.workspace.python.values import LARGEST, OpaqueError, Stream


class _Chain:
    """`itertools.chain`."""

    readable: ClassVar = frozenset({"from_iterable"})

    def __call__(self, *values: Any) -> Stream:
        """Return the elements of all lists."""
        lists = list(map(listed, values))
        limited(sum(map(len, lists)))
        return Stream(itertools.chain(*lists))

    def from_iterable(self, values: Any) -> Stream:
        """Return the elements of all lists in a list."""
        return self(*listed(values))


def _product(*values: Any, repeat: int = 1) -> Stream:
    lists = list(map(listed, values)) * min(repeat, 20)
    limited(math.prod(map(len, lists)))
    return Stream(itertools.product(*lists))


def _chosen(make: Callable[..., Iterator[Any]], ways: Callable[[int, int], int]) -> Callable[..., Stream]:
    def found(values: Any, r: int | None = None) -> Stream:
        given = listed(values)
        count = len(given) if r is None else r
        if len(given) > 1_000:
            raise OpaqueError("too many values")
        limited(ways(len(given), count))
        return Stream(make(given, count))

    return found


def _endless(values: Iterator[Any]) -> Stream:
    """Return an endless iterator. Reading too many of its elements raises OpaqueError."""

    def elements() -> Iterator[Any]:
        yield from itertools.islice(values, LARGEST)
        raise OpaqueError("too many values")

    return Stream(elements(), endless=True)


def _repeated(value: Any, times: int | None = None) -> Stream:
    if times is None:
        return _endless(itertools.repeat(value))
    limited(times)
    return Stream(itertools.repeat(value, times))


def _cycle(values: Any) -> Stream:
    given = listed(values)
    return _endless(itertools.cycle(given)) if given else Stream(iter(()))


def _count(start: Any = 0, step: Any = 1) -> Stream:
    checked([start, step], {})
    return _endless(itertools.count(start, step))


def _sliced(values: Any, *bounds: Any) -> Stream:
    checked(bounds, {})
    stop = bounds[0] if len(bounds) == 1 else bounds[1]
    if stop is None:
        return Stream(itertools.islice(iter(listed(values)), *bounds))
    limited(stop)
    return Stream(iter(list(itertools.islice(streamed(values), *bounds))))


def _accumulated(values: Any, func: Any = None, *, initial: Any = None) -> Stream:
    add = func if func is not None else lambda one, other: binary(ast.Add, one, other)
    return Stream(iter(list(itertools.accumulate(listed(values), add, initial=initial))))


def _grouped(values: Any, key: Any = None) -> Stream:
    given = listed(values)
    keys = given if key is None else [key(one) for one in given]
    checked(keys, {})
    pairs = itertools.groupby(range(len(given)), keys.__getitem__)
    return Stream(iter([(name, Stream(iter([given[one] for one in group]))) for name, group in pairs]))


def _copies(values: Any, n: int = 2) -> tuple[Stream, ...]:
    limited(n * 100)
    return tuple(Stream(one, endless=isinstance(values, Stream) and values.endless)
                 for one in itertools.tee(streamed(values), n))  # fmt: skip


def _batched(values: Any, n: int) -> Stream:
    given = listed(values)
    return Stream(iter([tuple(given[first : first + n]) for first in range(0, len(given), n)]))


def _reduced(function: Any, values: Any, *start: Any) -> Any:
    given = [*start, *listed(values)]
    found = given[0]
    for one in given[1:]:
        found = function(found, one)
    return found


def _while(values: Any, test: Any, *, take: bool) -> Stream:
    make = itertools.takewhile if take else itertools.dropwhile
    endless = isinstance(values, Stream) and values.endless
    return Stream(make(lambda one: _sure(test(one)), streamed(values)), endless=endless and not take)


def _sure(value: Any) -> bool:
    checked(value, {})
    return bool(value)


def _operator(kind: Any) -> Callable[[Any, Any], Any]:
    def run(left: Any, right: Any) -> Any:
        checked([left, right], {})
        return binary(kind, left, right) if issubclass(kind, ast.operator) else COMPARE[kind](left, right)

    return run


_NAMES: Final[dict[Any, str]] = {
    ast.BitOr: "or_", ast.BitAnd: "and_", ast.Div: "truediv", ast.Mult: "mul", ast.BitXor: "xor", ast.Eq: "eq",
    ast.NotEq: "ne", ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge",
}  # fmt: skip
_OPERATORS: Final = {
    f"operator.{_NAMES.get(kind, kind.__name__.lower())}": _operator(kind)
    for kind in (*BINARY, ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE)
}
OF_ITERATORS: Final = {
    "itertools.chain": _Chain(), "itertools.product": _product, "itertools.repeat": _repeated,
    "itertools.combinations": _chosen(itertools.combinations, math.comb),
    "itertools.combinations_with_replacement": _chosen(
        itertools.combinations_with_replacement, lambda n, r: math.comb(n + r, r)),
    "itertools.permutations": _chosen(itertools.permutations, math.perm),
    "itertools.cycle": _cycle, "itertools.count": _count, "itertools.islice": _sliced,
    "itertools.accumulate": _accumulated, "itertools.groupby": _grouped, "itertools.tee": _copies,
    "itertools.batched": _batched,
    "itertools.pairwise": lambda values: Stream(itertools.pairwise(listed(values))),
    "itertools.zip_longest": lambda *values, fillvalue=None: Stream(
        itertools.zip_longest(*map(listed, values), fillvalue=fillvalue)),
    "itertools.starmap": lambda function, values: Stream(iter([function(*listed(one)) for one in listed(values)])),
    "itertools.takewhile": lambda test, values: _while(values, test, take=True),
    "itertools.dropwhile": lambda test, values: _while(values, test, take=False),
    "itertools.filterfalse": lambda test, values: Stream(iter(list(filtered(test, listed(values), wanted=False)))),
    "itertools.compress": lambda values, tests: Stream(itertools.compress(listed(values), map(_sure, listed(tests)))),
    "functools.reduce": _reduced, "operator.not_": operator.not_, "operator.neg": operator.neg,
    **_OPERATORS,
}  # fmt: skip
