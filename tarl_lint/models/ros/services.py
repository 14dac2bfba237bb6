"""Models of services, actions and transforms: requests are sources; responses, feedback and results are sinks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from tarl_lint import catalog
from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import heap, recency
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, pointer
from tarl_lint.models import library_functions
from tarl_lint.models.ros import publications, subscriptions
from tarl_lint.models.ros.endpoints import Acceptance, Publisher, SourceRecord

RUN: Final = frozenset([*CALLABLE, "instance"])


@dataclass(slots=True, eq=False)
class Server:
    """An action server or goal handle, with the source of goals and the sink of results.

    `started` is the node of the decision of `handle_accepted_callback` to execute a goal; None without this callback.
    """

    record: SourceRecord
    sends: Publisher
    handle: bool = False
    started: int | None = None


def service(ctx: Interpreter, it: Invocation) -> Value:
    """Run a handler for requests; its result is the response."""
    callback = it.argument(it.fact.callback)
    record = subscriptions.source(ctx, it, callback)
    answer = _sender(it, record, "service")
    for target in callback.objects:
        if target.kind not in RUN:
            continue
        values = [pointer(subscriptions.message(ctx, record, target))]
        response = recency.intern(ctx, "lib", ("response", *record.key, target.key))
        if it.fact.api in catalog.FILLS_RESPONSE:
            values.append(pointer(response))
        key = ("service", *record.key)
        subscriptions.call_when(ctx, key, target, values, "callback", [(response, "<new>", BOTTOM)], answer)
    return subscriptions.handle(ctx, it.frame, it.call)


def _sender(it: Invocation, record: SourceRecord, kind: str) -> Publisher:
    sends = Publisher(api=it.fact.api, path=record.path, pos=record.pos)
    sends.topics, sends.types = record.topics, record.types
    sends.kind = "service" if kind == "service" else "action"
    sends.methods = catalog.ACTION_SENDERS
    return sends


# --- actions ------------------------------------------------------------------------------------------


def action(ctx: Interpreter, it: Invocation) -> Value:
    """Run the callbacks of an action server."""
    callbacks = {name: it.argument(where) for name, where in catalog.ACTION_CALLBACKS[it.fact.api].items()}
    supplied = frozenset(o for v in callbacks.values() for o in v.pts if o.kind in RUN)
    record = subscriptions.source(ctx, it, Value(pts=supplied))
    server = Server(record, _sender(it, record, "action"))
    given = {way: [one for one in callback.objects if one.kind in RUN] for way, callback in callbacks.items()}
    executes = bool(given.get("execute"))
    acceptance = Acceptance(_decision(ctx, record, "accepted")) if executes and given["goal"] else None
    server.started = _decision(ctx, record, "started") if executes and given["accepted"] else None
    for way, targets in given.items():
        for target in targets:
            _goal_callback(ctx, server, way, target, acceptance)
    obj = recency.intern(ctx, "server", record.key)
    obj.info = server
    return pointer(obj)


def _decision(ctx: Interpreter, record: SourceRecord, what: str) -> int:
    """Return the node of a decision about the goals of an action server."""
    place = Place(record.frame, record.statement, "condition", record.pos)
    return ctx.graph.node((what, *record.key), place, frozenset())


def _goal_callback(
    ctx: Interpreter, server: Server, way: str, target: Obj, acceptance: Acceptance | None
) -> None:
    record = server.record
    message = pointer(subscriptions.message(ctx, record, target))
    key = ("action", way, *record.key)
    if way == "goal":
        subscriptions.call_when(ctx, key, target, [message], "callback", answer=acceptance)
        return
    handle = recency.intern(ctx, "goal", (*record.key, target.key))
    handle.info = Server(record, server.sends, handle=True, started=server.started)
    guards = [acceptance.node] if acceptance is not None and way in ("accepted", "execute") else []
    if way == "execute" and server.started is not None:
        guards.append(server.started)
    fresh = [(handle, catalog.GOAL_FIELD, message)]
    answer = server.sends if way == "execute" else None
    subscriptions.call_when(ctx, key, target, [pointer(handle)], "callback", fresh, answer, guards=guards)


def serve(ctx: Interpreter, target: Obj, it: Invocation) -> Value:
    """Call a method of an action server or goal handle."""
    ctx.store.reads.look(target)
    server = target.info
    if not isinstance(server, Server):
        return UNKNOWN
    if it.name in server.sends.methods:
        given = bool(it.arguments[0] or it.arguments[1])  # without arguments, there is no result to send
        return publications.send(ctx, it, server.sends) if given else UNKNOWN
    if it.name == "execute" and server.started is not None:
        node = ctx.node(it.frame, ("execute", it.call.slot), "condition")
        ctx.graph.depend(node, [n for n, _ in ctx.guards])
        if it.frame.statement is not None:
            publications.under(ctx, it.frame, it.frame.statement, node)
        ctx.graph.depend(server.started, (node,))
    if it.name in catalog.GOAL_READERS:
        if server.handle:
            return heap.read(ctx, pointer(target), catalog.GOAL_FIELD)
        return arrived(ctx, server.record, it)
    if it.name in catalog.GOAL_REGISTERS:
        for callback in (*it.arguments[0], *it.arguments[1].values()):
            for function in callback.objects:
                if function.kind in RUN:
                    key = (it.name, *server.record.key, it.call.pos)
                    subscriptions.call_when(ctx, key, function, [], "callback")
    return UNKNOWN


def arrived(ctx: Interpreter, record: SourceRecord, it: Invocation) -> Value:
    """Return the message that a call returns, such as the goal from `accept_new_goal`."""
    key = (it.frame.id, it.call.slot)
    obj = record.messages.get(key)
    if obj is None:
        obj = record.messages[key] = Obj("message", (*record.key, key))
        obj.info = ctx.node(it.frame, ("receive", it.call.slot), "receive")
        record.nodes.add(obj.info)
        ctx.graph.begin(obj.info)
    return pointer(obj)


# --- transforms ---------------------------------------------------------------------------------------


def transform_look_up(ctx: Interpreter, it: Invocation) -> Value:
    """Return the result of a transform look-up, which is a source if the setting `tf2` is on."""
    if not ctx.config.tf2:
        return library_functions.generic(ctx, it.fact.api, it.arguments, it.frame, it.call)
    record = subscriptions.source(ctx, it, BOTTOM)
    record.topics.add("/tf")
    message, given = arrived(ctx, record, it), call_contexts.all_used(ctx, it.arguments)
    told = given | ctx.use(message)
    if it.name in catalog.ASKING_TRANSFORMS:
        return Value(told)
    ctx.ops.may_fail(ctx, told, "", it.frame)
    return UNKNOWN if it.name in catalog.WAITING_TRANSFORMS else Value(message.deps | given, message.pts)


def transform_broadcast(ctx: Interpreter, it: Invocation) -> Value:
    """Broadcast a transform. The call is a sink only in a thorough analysis with the setting `tf2`.

    Reports have no flows into transforms: code that reads a transform can check its age, and a transform alone does
    not move a robot.
    """
    if not (ctx.config.tf2 and ctx.thorough):
        return library_functions.generic(ctx, it.fact.api, it.arguments, it.frame, it.call)
    obj = recency.intern(ctx, "broadcaster", (it.fact.api,))
    if not isinstance(obj.info, Publisher):
        topic = "/tf_static" if "StaticTransform" in it.fact.api else "/tf"
        owner = it.fact.api.removesuffix(f".{it.name}")
        obj.info = Publisher({topic}, {"TFMessage"}, kind="transform", api=owner)
    return publications.send(ctx, it, obj.info)
