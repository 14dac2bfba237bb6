"""Models of the blackboard of py_trees: clients, and functions that read and write keys."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import blackboards, heap, updates
from tarl_lint.memory.values import UNKNOWN, Obj, Value, join_all, pointer
from tarl_lint.models import containers

CLASSES: Final = ("py_trees.blackboard.Blackboard", "py_trees.Blackboard")
CLIENTS: Final = ("py_trees.blackboard.Client", "py_trees.blackboard.BlackboardClient", *CLASSES)
GETTERS: Final = tuple(f"{cls}.get" for cls in CLASSES)
SETTERS: Final = tuple(f"{cls}.set" for cls in CLASSES)
ATTACHES: Final = "attach_blackboard_client"
READS: Final = "get"
WRITES: Final = "set"
REGISTERS: Final = "register_key"


def new_client(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new client; its namespace is the second argument."""
    names = it.argument((1, "namespace")).texts()
    return blackboards.client(
        ctx, (it.frame.id, it.statement, it.call.slot, *it.frame.turn), names[0] if len(names) == 1 else ""
    )


def any_client(ctx: Interpreter) -> Value:
    """Return the client of the static functions, which has no namespace."""
    return blackboards.client(ctx, (), "")


def read(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of a key, as `Blackboard.get` does."""
    return _read(ctx, any_client(ctx), it)


def write(ctx: Interpreter, it: Invocation) -> Value:
    """Store the value of a key, as `Blackboard.set` does."""
    return _write(ctx, any_client(ctx), it)


def call(ctx: Interpreter, client: Obj, it: Invocation) -> Value:
    """Call a method of a client."""
    if it.name == READS:
        return _read(ctx, pointer(client), it)
    if it.name == WRITES:
        return _write(ctx, pointer(client), it)
    if it.name == REGISTERS:
        for key in it.argument((0, "key")).texts():
            for name in it.argument((3, "remap_to")).texts():
                blackboards.remap(client, key, name)
    return UNKNOWN


def _key(it: Invocation) -> Value:
    """Return the name of the key of a call."""
    plain, named = it.arguments
    return plain[0] if plain else named.get("name", named.get("variable_name", UNKNOWN))


def holder_of(ctx: Interpreter, client: Value, name: str) -> tuple[Value, str]:
    """Return the objects that hold a key or a part of it, and the name of their field."""
    *outer, last = name.split(".")
    return (value_of(ctx, client, ".".join(outer)) if outer else client), last


def value_of(ctx: Interpreter, client: Value, name: str) -> Value:
    """Return the value of a key, or of a part of it (`pose.position.x`)."""
    first, *parts = name.split(".")
    value = heap.read(ctx, client, first)
    for part in parts:
        value = heap.read(ctx, value, part)
    return value


def _read(ctx: Interpreter, client: Value, it: Invocation) -> Value:
    names: Sequence[str] = _key(it).texts()
    if names:
        return join_all(value_of(ctx, client, name) for name in names)
    return heap.read_any(ctx, blackboards.board(ctx))


def _write(ctx: Interpreter, client: Value, it: Invocation) -> Value:
    value = it.argument((1, "value"))
    value = containers.through_statement(ctx, value, it.frame, it.call)
    names: Sequence[str] = _key(it).texts()
    for name in names:
        holder, last = holder_of(ctx, client, name)
        updates.write_field(ctx, holder, last, value)
    if not names:
        updates.add_element(ctx, pointer(blackboards.board(ctx)), value)
    return UNKNOWN
