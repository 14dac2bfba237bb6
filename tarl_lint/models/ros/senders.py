"""Library objects that probably publish: their class was called with a topic name and has a `publish` method."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import ClassInfo, Obj, Value, pointer
from tarl_lint.models.ros.endpoints import Publisher

SIGNS: Final = ("~", "/")  # prefixes of topic names


def note(
    ctx: Interpreter, qualified: str, made: Value, arguments: Arguments, frame: Frame, call: ir.Call
) -> None:
    """Record an object whose maker's first argument is a topic, on which its `publish` publishes."""
    names = sorted(t for t in arguments[0][0].texts() if t.startswith(SIGNS)) if arguments[0] else []
    if names:
        launched = ctx.config.launched
        topics = {launched.get(name.lstrip("/"), name) for name in names}
        for obj in made.objects:
            ctx.senders[obj] = Publisher(topics=topics, api=qualified, path=frame.program.path, pos=call.pos)


def inherit(ctx: Interpreter, obj: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
    """Record an instance whose base class, which is outside the files, got a topic name as its first argument."""
    if isinstance(obj.info, Obj) and isinstance(obj.info.info, ClassInfo) and obj.info.info.opaque:
        note(ctx, f"{obj.name}.publish", pointer(obj), arguments, frame, call)


def sender(ctx: Interpreter, obj: Obj) -> Publisher | None:
    """Return the publisher of an object: its own, a recorded one, or one held by a base class."""
    if isinstance(obj.info, Publisher):
        return obj.info
    found = ctx.senders.get(obj)
    if found is None and obj.kind == "lib" and isinstance(obj.key, tuple) and obj.key[:1] == ("inherited",):
        holder = ctx.objects.get(("instance", obj.key[1]))
        held = ctx.senders.get(holder) if holder is not None else None
        found = held if isinstance(held, Publisher) else Publisher(api=f"{obj.name}.publish")
        ctx.senders[obj] = found
    return found if isinstance(found, Publisher) else None
