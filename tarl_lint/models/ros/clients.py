"""Models of clients of services and actions: requests and goals are sinks, responses and results are sources.

Clients are followed in three cases: with the setting `clients`, in runs for launch files (the server is then
another node), and for programs that run the code.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from tarl_lint.catalog import Fact
from tarl_lint.interpret import call_contexts
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import recency
from tarl_lint.memory.values import Obj, Value, pointer
from tarl_lint.models import argument_parsers, launched
from tarl_lint.models.ros import publications, services, subscriptions
from tarl_lint.models.ros.endpoints import Kind, Publisher, SourceRecord
from tarl_lint.models.ros.name_queries import node_name

MADE: Final[Mapping[str, Fact]] = {
    "rospy.ServiceProxy": Fact("client", "rospy.ServiceProxy", (0, "name"), (1, "service_class")),
    "actionlib.SimpleActionClient": Fact(
        "client", "actionlib.SimpleActionClient", (0, "ns"), (1, "ActionSpec")
    ),
    "actionlib.ActionClient": Fact("client", "actionlib.ActionClient", (0, "ns"), (1, "ActionSpec")),
    "rclpy.action.ActionClient": Fact(
        "client", "rclpy.action.ActionClient", (2, "action_name"), (1, "action_type")
    ),
    "rclpy.action.client.ActionClient": Fact(
        "client", "rclpy.action.ActionClient", (2, "action_name"), (1, "action_type")
    ),
}
BY_METHOD: Final[Mapping[str, Fact]] = {
    "create_client": Fact("client", "rclpy.create_client", (1, "srv_name"), (0, "srv_type"))
}
SENDING: Final = frozenset(
    ["__call__", "call", "call_async", "send_goal", "send_goal_and_wait", "send_goal_async"]
)
RESULT, FEEDBACK = "result", "feedback"
# Callbacks of a goal, and the arguments of each: `send_goal` calls `done_cb` with the state and the result
_CALLBACKS: Final[Mapping[str, Mapping[tuple[int, str], tuple[str, ...] | str]]] = {
    "send_goal": {(1, "done_cb"): (RESULT, RESULT), (2, "active_cb"): (), (3, "feedback_cb"): FEEDBACK},
    "send_goal_async": {(1, "feedback_callback"): FEEDBACK},
}
READING: Final = frozenset(["get_result"])


def launched_call(ctx: Interpreter, target: Obj | None, it: Invocation) -> Value | None:
    """Model a call that makes or uses a client, or asks for names of the node.

    Return None for other calls.
    """
    table, name = (MADE, it.name) if target is None else (BY_METHOD, it.name)
    for told in (node_name, launched.asked, argument_parsers.asked) if ctx.launching else ():
        found = told(ctx, it)
        if found is not None:
            return found
    if name in table:
        return _made(ctx, Invocation(name, it.base, it.arguments, it.frame, it.call, table[name]))
    return _used(ctx, target, it) if target is not None else None


def _made(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new client."""
    obj = recency.intern(ctx, "lib", (it.frame.id, it.statement, "client", it.call.slot, *it.frame.turn))
    kind: Kind = "action" if "action" in it.fact.api else "service"
    if not isinstance(obj.info, Publisher):
        obj.info = Publisher(api=it.fact.api, path=it.frame.program.path, pos=it.call.pos)
        obj.info.kind, obj.info.methods = kind, SENDING
    obj.info.topics.update(publications.topics(ctx, it))
    obj.info.types.update(publications.type_names(it.argument(it.fact.type)))
    return pointer(obj)


def _used(ctx: Interpreter, target: Obj, it: Invocation) -> Value | None:
    info = target.info
    if not isinstance(info, Publisher) or info.methods is not SENDING:
        return None
    if it.name in READING:
        return _answer(ctx, info, it)
    if it.name not in SENDING:
        return None
    publications.send(ctx, it, info)
    answer = _answer(ctx, info, it)
    _call_back(ctx, info, it, answer)
    return answer


def _call_back(ctx: Interpreter, info: Publisher, it: Invocation, answer: Value) -> None:
    """Run a goal's callbacks: for the state and result, the feedback, and the action's start."""
    key = (*ctx.end_key(it.frame.program.path, it.call.pos, it.frame), info.api)
    for where, values in _CALLBACKS.get(it.name, {}).items():
        for target in it.argument(where).objects:
            if target.kind not in CALLABLE:
                continue
            if values == FEEDBACK:
                record = _record(ctx, info, it, FEEDBACK)
                given = [] if record is None else [pointer(subscriptions.message(ctx, record, target))]
            else:
                given = [answer] * values.count(RESULT)
            subscriptions.call_when(ctx, (where[1], *key), target, given, "callback")


def _answer(ctx: Interpreter, info: Publisher, it: Invocation) -> Value:
    """Return the response of a service, or the result of an action.

    The analysis of the server's node finds whether the answer depends on the request.
    """
    record = _record(ctx, info, it, "")
    if record is None:
        return Value(call_contexts.all_used(ctx, it.arguments))
    return services.arrived(ctx, record, it)


def _record(ctx: Interpreter, info: Publisher, it: Invocation, channel: str) -> SourceRecord | None:
    """Return the source of the answers to a call, or of the feedback; None outside statements."""
    frame, place = it.frame, (it.frame.program.path, it.call.pos)
    key = (*ctx.end_key(*place, frame), *([channel] if channel else []))
    record = ctx.sources.get(key)
    if record is None and frame.statement is not None:
        module = ctx.modules[place[0]].name
        qualname = publications.qualname(frame)
        api = f"{info.api}.{channel}" if channel else info.api
        record = SourceRecord(*place, key, api, module, qualname, frame.statement, frame)
        record.kind = info.kind
        ctx.sources[key] = record
    if record is not None:
        record.topics.update(info.topics)
        record.types.update(info.types)
        record.registered.add((info.path, info.pos))
    return record
