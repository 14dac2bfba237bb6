"""Attributes of functions. Bound methods, and wrappers made with `functools.wraps`, have them as well."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory.values import Obj, Value, const, join, pointer

FUNCTIONS: Final = frozenset(["closure", "bound"])
NAMED: Final = "__name__"
WRAPPED: Final = "__wrapped__"  # attribute of a wrapper that holds the wrapped function
# pseudo-attribute of a function that a library's decorator was applied to, and which may have added attributes
DECORATED: Final = "decorated by a library"
# kinds of callables whose attributes are not followed
OPAQUE: Final = frozenset(["method", "partial", "weak"])
MAX_WRAPPERS: Final = 8  # maximum number of nested wrappers through which an attribute is searched


def attribute_of(name: str) -> str:
    """Return the field of a function that holds an attribute; other fields, without brackets, hold the defaults."""
    return f"<{name}>"


def attribute(ctx: Interpreter, obj: Obj, name: str) -> Value | None:
    """Return an attribute of a function or bound method; None if it has not been set."""
    function = obj
    if obj.kind == "bound" and isinstance(obj.info, tuple):
        function, receiver, _ = obj.info
        if name == "__func__":
            return pointer(function)
        if name == "__self__":
            return pointer(receiver)
    if name == "__dict__":
        return pointer(function)  # the function, as the mapping of its attributes
    for _ in range(MAX_WRAPPERS):
        stored: Value | None = ctx.store.get((function, attribute_of(name)))
        if stored is not None:
            return stored
        wrapped = ctx.store.get((function, attribute_of(WRAPPED)))
        inner = [o for o in wrapped.objects if o.kind == "closure"] if wrapped is not None else []
        if len(inner) != 1 or name == WRAPPED:
            break
        function = inner[0]
    return const(function.name) if name == NAMED and function.kind == "closure" else None


def may_have_more(ctx: Interpreter, value: Value) -> bool:
    """Return whether a callable may have attributes that no analysed code sets."""
    for obj in value.objects:
        if obj.kind in OPAQUE:
            return True
        if obj.kind in FUNCTIONS and attribute(ctx, obj, DECORATED) is not None:
            return True
    return False


def with_default(ctx: Interpreter, base: Value, name: str, found: Value, default: Value) -> Value:
    """Return the attribute that was found, or the default of `getattr`.

    A function with the attribute has no default. If a library may have added an attribute to the callable, an
    attribute that is not set is unknown.
    """
    if not found.pts and found.consts == frozenset() and may_have_more(ctx, base):
        return Value(found.deps | default.deps, default.pts)
    functions = base.pts and all(o.kind in FUNCTIONS for o in base.pts)
    if functions and all(attribute(ctx, o, name) is not None for o in base.pts):
        return found
    return join(found, default)
