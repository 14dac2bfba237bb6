"""The values that a launch file gives to one node: its names and its parameters, including lists and mappings."""

from __future__ import annotations

import ast
import json
from collections.abc import Hashable
from typing import Any, Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import UNKNOWN, Value, const, pointer
from tarl_lint.parameter_names import DEFAULT, ELSEWHERE

# name of the mapping objects whose entries are all known from the launch file
GIVEN: Final = "given by the launch"
MAX_TEXT: Final = 10_000
PARSERS: Final = frozenset(
    ["ast.literal_eval", "builtins.eval", "json.loads", "yaml.load", "yaml.safe_load", "yaml.full_load"]
)
_NOTHING: Final = object()


def value_of(ctx: Interpreter, name: str) -> object:
    """Return the value that the launch gives a parameter; DEFAULT if it gives none, ELSEWHERE if it is unknown."""
    if name in ctx.fixed:
        given = ctx.fixed[name]
        return list(given) if isinstance(given, tuple) else given
    return ctx.launched.value(name) if ctx.launched is not None else ELSEWHERE


def made(ctx: Interpreter, value: Any, frame: Frame, slot: Hashable) -> Value:
    """Convert a value that the launch gives to an abstract value: a constant, or a container of constants."""
    if value is ELSEWHERE:
        return UNKNOWN
    if isinstance(value, list):
        obj = recency.allocate(ctx, "sequence", frame, ("listed", slot))
        entries = list(enumerate(value))
    elif isinstance(value, dict):
        obj = recency.allocate(ctx, "mapping", frame, ("listed", slot))
        obj.name = GIVEN
        entries = list(value.items())
    else:
        return const(value)
    for key, inner in entries:
        ctx.store.put((obj, item_field(key)), made(ctx, inner, frame, (slot, key)))
    return pointer(obj)


def asked(ctx: Interpreter, it: Invocation) -> Value | None:
    """Model a call that asks for a parameter's presence or parses a known text; else None."""
    given = it.arguments[0]
    if ctx.launched is None or not given:
        return None
    known, text = given[0].constant()
    if not known or not isinstance(text, str):
        return None
    if it.name == "rospy.has_param":
        value = value_of(ctx, text)
        return None if value is ELSEWHERE else const(value is not DEFAULT)
    if it.name in PARSERS:
        found = _parsed(text)
        return None if found is _NOTHING else made(ctx, found, it.frame, ("parsed", it.call.slot))
    return None


def _parsed(text: str) -> object:
    """Parse a string as lists, mappings, strings and numbers; nothing is executed."""
    for read in (ast.literal_eval, json.loads) if len(text) <= MAX_TEXT else ():
        try:
            found = read(text)
        except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
            continue
        if isinstance(found, list | tuple | dict | str | bool | int | float):
            return list(found) if isinstance(found, tuple) else found
    return _NOTHING


def entries(ctx: Interpreter, base: Value) -> list[tuple[Value, Value]] | None:
    """Return the keys and values of a mapping that the launch gives; None for other objects."""
    obj = next(iter(base.pts)) if len(base.pts) == 1 else None
    if obj is None or obj.kind != "mapping" or obj.name != GIVEN:
        return None
    found = ((name, ctx.store.get((obj, name))) for name in list(obj.fields) if name.startswith("["))
    return [(const(ast.literal_eval(name[1:-1])), value) for name, value in found if value is not None]


def entry(ctx: Interpreter, base: Value, key: Value) -> Value | None:
    """Return an entry of a mapping from the launch; None for other objects or without entry."""
    known, constant = key.constant()
    obj = next(iter(base.pts)) if len(base.pts) == 1 else None
    if not known or obj is None or obj.kind != "mapping" or obj.name != GIVEN:
        return None
    return ctx.store.get((obj, item_field(constant)))
