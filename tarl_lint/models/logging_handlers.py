"""Models of the standard library's loggers: each record reaches `emit` of the handlers from analysed classes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.interpret import call_contexts, calls
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.heap import ANY
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, inherited_from, pointer

LOGGER: Final = "logging.Logger"  # name of the objects that represent loggers
HANDLER: Final = "logging.Handler"
HANDLERS: Final = "<handlers>"  # field of a logger that holds its handlers
LEVEL: Final = "<level>"  # field of a handler that holds the lowest level that the handler accepts
# levels in ascending order, and the methods of a logger that log with them
LEVELS: Final = ("NOTSET", "DEBUG", "INFO", "WARNING", "ERROR", "CRITICAL")
METHODS: Final = {
    **{level.lower(): level for level in LEVELS[1:]},
    "warn": "WARNING",
    "exception": "ERROR",
    "fatal": "CRITICAL",
    "log": "",
}
DESCRIBING: Final = ("levelname", "levelno", "name", "lineno", "pathname", "funcName", "created", "asctime")


def named_logger(ctx: Interpreter, it: Invocation) -> Value:
    """Return the logger with this name (shared by all files), or the root logger without one."""
    given = it.arguments[0][:1]
    texts = given[0].texts() if given else ("",)
    return pointer(_logger(ctx, texts[0] if len(texts) == 1 else "?"))


def _logger(ctx: Interpreter, name: str) -> Obj:
    return recency.intern(ctx, "lib", ("logger", name), LOGGER)


def call(ctx: Interpreter, target: Obj, it: Invocation) -> Value | None:
    """Call a logger's method, or the method that sets a handler's level; None for others."""
    plain = it.arguments[0]
    if it.name == "setLevel" and plain and target.kind == "instance":
        note_level(ctx, target, it.arguments)
    if target.name != LOGGER or target.kind != "lib":
        return None
    if it.name == "addHandler" and plain:
        updates.weaken(ctx, target, HANDLERS, Value(pts=plain[0].pts))
        return UNKNOWN
    return _log(ctx, target, it) if it.name in METHODS else None


def initialised(ctx: Interpreter, it: Invocation) -> Value:
    """Call `logging.Handler.__init__(handler, level)`."""
    plain, named = it.arguments
    for handler in plain[0].objects if plain else ():
        note_level(ctx, handler, (plain[1:], named))
    return UNKNOWN


def note_level(ctx: Interpreter, handler: Obj, arguments: Arguments) -> None:
    """Note the level that a handler's constructor or `setLevel` gets."""
    plain, named = arguments
    level = plain[0] if plain else named.get("level")
    if level is not None and HANDLER in inherited_from(pointer(handler)):
        ctx.store.put((handler, LEVEL), level)


def _log(ctx: Interpreter, target: Obj, it: Invocation) -> Value:
    handlers = {
        o: None for one in _ancestors(ctx, target) for o in _held(ctx, one) if not _ignores(ctx, o, it.name)
    }
    methods = [m for o in handlers for m in heap.read_field(ctx, o, "emit").pts if m.kind == "bound"]
    if methods:
        passed = call_contexts.pass_arguments(ctx, it.arguments, it.frame, it.call)
        record = recency.allocate(ctx, "lib", it.frame, ("record", it.call.slot))
        ctx.store.put((record, ANY), Value(call_contexts.all_used(ctx, passed)))
        for name in DESCRIBING:
            ctx.store.put((record, name), UNKNOWN)
        calls.call_value(ctx, Value(pts=frozenset(methods)), ([pointer(record)], {}), it.frame, it.call)
    return UNKNOWN


def _ancestors(ctx: Interpreter, logger: Obj) -> Iterator[Obj]:
    """Yield a logger and the loggers above it, whose handlers also receive its records."""
    name = logger.key[1] if isinstance(logger.key, tuple) else ""
    while name:
        yield _logger(ctx, name)
        name = name.rpartition(".")[0]
    yield _logger(ctx, "")


def _held(ctx: Interpreter, logger: Obj) -> list[Obj]:
    return [o for o in (ctx.store.get((logger, HANDLERS)) or BOTTOM).objects if o.kind == "instance"]


def _ignores(ctx: Interpreter, handler: Obj, method: str) -> bool:
    """Return whether the level of a handler is certainly above the level with which a method logs."""
    held = ctx.store.get((handler, LEVEL))
    least = [o.name.removeprefix("logging.") for o in held.pts] if held is not None else []
    level = METHODS[method]
    return bool(level and least) and all(
        one in LEVELS and LEVELS.index(one) > LEVELS.index(level) for one in least
    )
