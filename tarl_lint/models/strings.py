"""Constant folding of string methods, for names of topics, parameters and keys."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

from tarl_lint.interpret import call_contexts, operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import MAX_TEXTS, UNKNOWN, Consts, Symbolic, Value, const, pointer
from tarl_lint.models import sizes

TEXT_METHODS: Final = frozenset(
    [
        "format",
        "join",
        "strip",
        "lstrip",
        "rstrip",
        "lower",
        "upper",
        "title",
        "replace",
        "removeprefix",
        "removesuffix",
    ]
)
TESTS: Final = frozenset(["startswith", "endswith"])
MAX_TEXT: Final = 300


def text_of(ctx: Interpreter, base: Value, name: str, arguments: Arguments) -> Consts:
    """Return the results of a string method on constants; None if one of the constants or arguments is unknown."""
    plain, named = arguments
    return _made(
        ctx,
        lambda text, *given: getattr(text, name)(
            *given[: len(plain)], **dict(zip(named, given[len(plain) :], strict=True))
        ),
        [base, *plain, *named.values()],
    )


def tested(base: Value, name: str, arguments: Arguments) -> Value | None:
    """Return whether all texts begin or end with a text; None if unknown or mixed."""
    texts, given = base.texts(), [value.constant() for value in arguments[0]]
    if not texts or base.pts or len(given) != 1 or not isinstance(given[0][1], str):
        return None
    results = {getattr(text, name)(given[0][1]) for text in texts}
    return Value(base.deps, consts=frozenset(results)) if len(results) == 1 else None


def pieces(ctx: Interpreter, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value | None:
    """Return the list that `split` makes of a string; None if the string or an argument is not known."""
    known, text = base.constant()
    given = [value.constant() for value in arguments[0]]
    if not known or not isinstance(text, str) or arguments[1] or not all(found for found, _ in given):
        return None
    try:
        parts = text.split(*(one for _, one in given))  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    obj = recency.allocate(ctx, "sequence", frame, ("pieces", call.slot))
    for number, part in enumerate(parts):
        ctx.store.put((obj, item_field(number)), const(part))
    return pointer(obj, base.deps)


def keys_joined(ctx: Interpreter, arguments: Arguments, frame: Frame, call: ir.Call) -> Arguments:
    """Return the value of `text.join(mapping)`, which joins keys only."""
    plain, named = arguments
    return [_keys(ctx, value, frame, call) for value in plain], named


def _keys(ctx: Interpreter, value: Value, frame: Frame, call: ir.Call) -> Value:
    """Return the keys of a mapping or of `vars(x)`; other values themselves."""
    if any(o.kind == "mapping" for o in value.pts):
        return Value(operators.membership(ctx, value, frame, ("joined", call.slot)))
    if any(heap.attribute_names(ctx, o) is not None for o in value.pts):
        return heap.elements(ctx, value)
    return value


def _made(ctx: Interpreter, function: Callable[..., object], values: Sequence[Value]) -> Consts:
    """Return the results of a function for all combinations of constants.

    The first constant of each combination must be a string.
    """
    ways = [_known(ctx, v) for v in values]
    if not all(ways) or math.prod(len(w) for w in ways) > MAX_TEXTS:
        return None
    try:
        made = [function(*given) for given in itertools.product(*ways) if isinstance(given[0], str)]
    except Exception:  # the program itself would raise this error
        return None
    if not made or not all(isinstance(m, str) and len(m) <= MAX_TEXT for m in made):
        return None
    kind = Symbolic if any(type(one) is Symbolic for way in ways for one in _flat(way)) else str
    return frozenset(kind(one) for one in made)


def _flat(ways: Sequence[Any]) -> Iterator[Any]:
    """Yield constants, including those in lists."""
    for one in ways:
        yield from _flat(one) if isinstance(one, list) else (one,)


def _known(ctx: Interpreter, value: Value) -> list[Any]:
    """Return a value's possible constants, or lists; empty if some are unknown."""
    if value.consts and not value.pts:
        return sorted(value.consts, key=str)
    parts = [_known(ctx, e) for e in sizes.unpacked(ctx, value) or ()]
    if not value.pts or sizes.unpacked(ctx, value) is None or math.prod(map(len, parts)) > MAX_TEXTS:
        return []
    return [list(way) for way in itertools.product(*parts)]


def remainder(ctx: Interpreter, values: list[Value]) -> Consts:
    """Return the constants of `text % values` if all parts are known."""
    return _made(ctx, lambda text, given: text % (tuple(given) if isinstance(given, list) else given), values)


def as_text(ctx: Interpreter, it: Invocation) -> Value:
    """Return `str(x)`."""
    deps = call_contexts.all_used(ctx, it.arguments)
    known, constant = it.arguments[0][0].constant() if len(it.arguments[0]) == 1 else (False, None)
    return Value(deps, consts=frozenset([str(constant)]) if known else None)


def as_number(ctx: Interpreter, it: Invocation) -> Value:
    """Return `int(x)`, a constant for one launched node, where numbers may be in names."""
    known, constant = it.arguments[0][0].constant() if len(it.arguments[0]) == 1 else (False, None)
    if not (ctx.exact and known and isinstance(constant, str | int | float)):
        return ctx.ops.generic(ctx, f"builtins.{it.name}", it.arguments, it.frame, it.call)
    try:
        return Value(it.arguments[0][0].deps, consts=frozenset([int(constant)]))
    except (ValueError, OverflowError):
        return UNKNOWN


def same_text(ctx: Interpreter, it: Invocation) -> Value:  # noqa: ARG001 - shared signature
    """Return a name passed to a resolving function unchanged."""
    return it.arguments[0][0] if it.arguments[0] else UNKNOWN


def joined_path(ctx: Interpreter, it: Invocation) -> Value:
    """Return the names joined by slashes."""
    whole = _made(ctx, lambda *parts: "/".join(str(p).rstrip("/") for p in parts), it.arguments[0])
    return Value(call_contexts.all_used(ctx, it.arguments), consts=whole)
