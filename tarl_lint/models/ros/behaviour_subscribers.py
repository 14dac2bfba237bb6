"""Models of behaviours of py_trees_ros that subscribe: messages fill the blackboard, or decide the status."""

from __future__ import annotations

from ast import literal_eval
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from tarl_lint import catalog
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import blackboards, recency, updates
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, inherited_from, join_all, pointer
from tarl_lint.models import containers, states_and_behaviours
from tarl_lint.models.blackboards import any_client, holder_of, value_of
from tarl_lint.models.ros import subscriptions

BATTERY: Final = "py_trees_ros.battery.ToBlackboard"
# second key that the battery behaviour writes, in addition to "battery"
WARNING: Final = "battery_low_warning"
CHECKS: Final = "py_trees_ros.subscribers.CheckData"
HANDLER: Final = "py_trees_ros.subscribers.Handler"  # base class whose objects keep the last message in `msg`


def behaviour(ctx: Interpreter, it: Invocation) -> Value:
    """Return a behaviour that subscribes, and note how the behaviour uses the messages."""
    made = recency.allocate(ctx, "lib", it.frame, ("made", it.call.slot))
    part = states_and_behaviours.part_of(ctx, made, it.frame)
    arriving = subscriptions.receive(ctx, it)
    if it.fact.api == CHECKS:
        node = ctx.node(it.frame, ("status", it.call.slot), "condition")
        ctx.graph.flow(ctx.use(_field(ctx, arriving, it.argument((4, "variable_name")))), node)
        ctx.graph.depend(node, [part.runs])
        part.answers[node] = None
        return pointer(made)
    for key, value in _entries(ctx, it, arriving):
        passed = containers.through_statement(ctx, value, it.frame, it.call, key)
        holder, last = holder_of(ctx, any_client(ctx), key)
        for obj in holder.objects:
            held, field = (
                blackboards.seen_through(ctx, obj, last) if obj.kind == blackboards.CLIENT else (obj, last)
            )
            updates.weaken(ctx, held, field, passed)
    return pointer(made)


def _entries(ctx: Interpreter, it: Invocation, arriving: Value) -> Iterator[tuple[str, Value]]:
    """Yield the keys of the blackboard that the behaviour fills, with parts of the message."""
    if it.fact.api == BATTERY:
        yield "battery", arriving
        yield WARNING, Value(ctx.use(arriving))
        return
    plain, named = it.arguments
    given = named.get(it.fact.extra[1], join_all(plain[3:5]))
    for text in given.texts():
        yield text, arriving
    ctx.look(given.pts)
    for table in given.objects if all(o.kind == "mapping" for o in given.pts) else ():
        for name in list(table.fields):
            held = ctx.store.get((table, name)) if name.startswith("['") else None
            if held is not None:
                yield literal_eval(name[1:-1]), _field(ctx, arriving, held)


def _field(ctx: Interpreter, message: Value, path: Value) -> Value:
    """Return a message's field by its path, such as `pose.position`; without one, the message."""
    names = path.texts()
    return value_of(ctx, message, names[0]) if len(names) == 1 and names[0] else message


def inherit(ctx: Interpreter, target: Obj, it: Invocation) -> None:
    """Let an instance of a class that inherits from a subscriber keep the message that the base class receives."""
    if target.kind != "instance" or HANDLER not in inherited_from(pointer(target)):
        return
    subscribed = replace(it, fact=catalog.FUNCTIONS[HANDLER])
    if subscribed.argument(subscribed.fact.topic) is BOTTOM:
        return
    arriving = subscriptions.receive(ctx, subscribed)
    updates.weaken(ctx, target, "msg", arriving if arriving.pts else UNKNOWN)
