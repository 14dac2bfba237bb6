"""Options of the command line: the results of argparse and optparse for the arguments of a launched node.

The analysis of the program collects the declared options; the standard library then parses the known arguments.
Nothing of the program is executed, so `type=` can only be `int`, `float` or `str`.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any, Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import UNKNOWN, Obj, Value, const, pointer
from tarl_lint.models import sizes

PARSERS: Final = frozenset(["argparse.ArgumentParser", "optparse.OptionParser"])
ADDING: Final = frozenset(["add_argument", "add_option"])
PARSING: Final = frozenset(["parse_args", "parse_known_args"])  # methods that parse the command line
GROUPS: Final = frozenset(["add_argument_group", "add_mutually_exclusive_group"])
OPTION_PARSER: Final = "optparse.OptionParser"
CONSTANTS: Final = ("dest", "action", "nargs", "const", "default", "choices")
_OF_ROS: Final = frozenset(["--ros-args", "-r"])
TYPES: Final[Mapping[str, type]] = {"int": int, "float": float, "str": str}

Declared = tuple[tuple[str, ...], tuple[tuple[str, Any], ...]]


class _UnfitError(Exception):
    """Raised if the arguments do not fit the options; the program itself would exit."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> Any:  # exits otherwise
        raise _UnfitError(message)

    exit = error  # type: ignore[assignment]


def asked(ctx: Interpreter, it: Invocation) -> Value | None:
    """Make a parser, declare an option, or parse the command line of the launched node; None for other calls."""
    if it.name in PARSERS and it.base.consts is not None and not it.base.pts:
        obj = recency.intern(ctx, "options", (it.frame.id, it.statement, it.call.slot), it.name)
        obj.info = obj.info or {}
        return pointer(obj)
    parser = next((o for o in it.base.pts if o.kind == "options"), None) if len(it.base.pts) == 1 else None
    if parser is None or not isinstance(parser.info, dict):
        return None
    if it.name in GROUPS:
        return it.base
    if it.name in ADDING:
        parser.info[(it.frame.id, it.call.slot, *it.frame.turn)] = _declared(ctx, it)
        parser.changed()
        return UNKNOWN
    return _parsed(ctx, parser, it) if it.name in PARSING else None


def _declared(ctx: Interpreter, it: Invocation) -> Declared | None:
    """Return the flags and keywords of an option; None if they are not all constants."""
    flags = [value.constant()[1] for value in it.arguments[0]]
    if not all(isinstance(one, str) for one in flags):
        return None
    named: list[tuple[str, Any]] = []
    for name in CONSTANTS:
        if name not in it.arguments[1]:
            continue
        value = it.arguments[1][name]
        found, constant = value.constant()
        several = sizes.constants(ctx, value) if not found else None
        if not found and several is None:
            return None
        named.append((name, constant if several is None else [one.constant()[1] for one in several]))
    kind = next((o.name.rpartition(".")[2] for o in it.arguments[1].get("type", UNKNOWN).pts), "")
    if kind in TYPES:
        named.append(("type", TYPES[kind]))
    return tuple(map(str, flags)), tuple(named)


def _parsed(ctx: Interpreter, parser: Obj, it: Invocation) -> Value | None:
    """Return the namespace of the parsed arguments, or (namespace, remaining arguments) if the call returns both."""
    ctx.store.reads.look(parser)
    texts = _texts(ctx, it)
    declared = list(parser.info.values()) if isinstance(parser.info, dict) else []
    if texts is None or None in declared:
        return None
    try:
        found, rest = _as_the_library(declared, texts)
    except (_UnfitError, TypeError, ValueError, argparse.ArgumentError):
        return None
    space = recency.allocate(ctx, "lib", it.frame, ("options", it.call.slot))
    for name, value in vars(found).items():
        ctx.store.put((space, name), _value(ctx, value, it, name))
    if it.name == "parse_args" and parser.name != OPTION_PARSER:
        return pointer(space)
    pair = recency.allocate(ctx, "sequence", it.frame, ("parsed", it.call.slot))
    ctx.store.put((pair, item_field(0)), pointer(space))
    ctx.store.put((pair, item_field(1)), _value(ctx, rest, it, ""))
    return pointer(pair)


def _as_the_library(declared: list[Declared], texts: list[str]) -> tuple[argparse.Namespace, list[str]]:
    library = _Parser(add_help=False)
    for flags, named in declared:
        library.add_argument(*flags, **dict(named))
    return library.parse_known_args(texts)


def _texts(ctx: Interpreter, it: Invocation) -> list[str] | None:
    """Return the arguments to parse: the call's, else the launched node's without those for ROS."""
    if not ctx.command_line:
        return None
    given = it.arguments[0][:1] or [it.arguments[1][name] for name in ("args",) if name in it.arguments[1]]
    if not given or given[0].constant() == (True, None):
        return [one for one in ctx.command_line[1:] if ":=" not in one and one not in _OF_ROS]
    known = sizes.constants(ctx, given[0])
    return None if known is None else [str(one.constant()[1]) for one in known]


def _value(ctx: Interpreter, value: Any, it: Invocation, name: str) -> Value:
    if not isinstance(value, list):
        return const(value)
    obj = recency.allocate(ctx, "sequence", it.frame, ("option", it.call.slot, name))
    for number, one in enumerate(value):
        ctx.store.put((obj, item_field(number)), const(one))
    return pointer(obj)
