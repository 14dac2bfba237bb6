"""Models of the catalog's calls: sources, sinks, publishers, timers, parameters."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from functools import partial
from typing import Final

from tarl_lint.interpret import call_contexts, literals
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.symbolic_names import text_of_parameter
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Consts, Value, join, pointer
from tarl_lint.models import containers, default_values, launched, records, sizes, state_callbacks
from tarl_lint.models.ros import behaviour_subscribers, publications, services, subscriptions
from tarl_lint.parameter_names import DEFAULT, ELSEWHERE


def ros_call(ctx: Interpreter, it: Invocation) -> Value:
    """Apply the catalog's entry for a call."""
    if "**" in it.arguments[1]:
        it.arguments = it.arguments[0], _unpacked_keywords(ctx, it)
    if ctx.launching and it.fact.kind in READS_PARAMETERS:
        _note_names(ctx, it)
    action = ACTIONS.get(it.fact.kind)
    return action(ctx, it) if action is not None else UNKNOWN  # UNKNOWN if this kind of call has no model


def _note_names(ctx: Interpreter, it: Invocation) -> None:
    """Record the names of the parameters that a call reads or declares."""
    place = (it.frame.program.path, it.call.pos)
    names: set[str] | None = set(it.argument(it.fact.topic).texts())
    if it.fact.kind == "declare all":
        above, entries = names or {""}, sizes.unpacked(ctx, it.argument(it.fact.extra))
        given = [sizes.unpacked(ctx, entry) or [] for entry in entries or ()]
        texts = [parts[0].texts() if parts else () for parts in given]
        names = {f"{one}.{text}" if one else text for one in above for two in texts for text in two}
        names = names if entries is not None and all(texts) else None
    known = ctx.parameter_reads.get(place, set())
    ctx.parameter_reads[place] = known | names if names and known is not None else None


def _unpacked_keywords(ctx: Interpreter, it: Invocation) -> dict[str, Value]:
    """Return the keywords of a call, including those from `**mapping` that the catalog's entry uses."""
    fact, named = it.fact, dict(it.arguments[1])
    for _, name in (fact.topic, fact.type, fact.callback, fact.extra):
        for obj in named["**"].objects if name and name not in it.arguments[1] else ():
            stored = ctx.store.get((obj, item_field(name)))
            if stored is not None:
                named[name] = join(named.get(name, BOTTOM), stored)
    return named


def _timer(ctx: Interpreter, it: Invocation) -> Value:
    for target in it.argument(it.fact.callback).objects:
        subscriptions.call_when(
            ctx, (it.fact.kind, it.frame.program.path, it.call.pos), target, [], "callback"
        )
    return subscriptions.handle(ctx, it.frame, it.call)


def _done(ctx: Interpreter, it: Invocation) -> Value:
    """Call the done callback of a future with the future."""
    future = containers.through_statement(ctx, it.base, it.frame, it.call, "future")
    for target in it.argument(it.fact.callback).objects:
        subscriptions.call_when(
            ctx, ("done", it.frame.program.path, it.call.pos), target, [future], "callback"
        )
    return UNKNOWN


def _thread(ctx: Interpreter, it: Invocation) -> Value:
    """Run a function in a thread or at a later time; its arguments are in a tuple."""
    given = it.argument(it.fact.extra)
    values = sizes.unpacked(ctx, given) or []
    for target in it.argument(it.fact.callback).objects:
        subscriptions.call_when(
            ctx,
            (it.fact.kind, it.frame.program.path, it.call.pos),
            target,
            values,
            "thread" if it.fact.kind == "thread" else "callback",
        )
    return subscriptions.handle(ctx, it.frame, it.call)


# --- values -------------------------------------------------------------------------------------------


def _partial(ctx: Interpreter, it: Invocation) -> Value:
    obj = recency.intern(ctx, "partial", (it.frame.id, it.statement, it.call.slot, *it.frame.turn))
    plain, named = it.arguments
    if not plain:
        return UNKNOWN
    if ctx.thorough:  # the stored arguments keep their places, so that a repair can change their constants
        stored, named = call_contexts.pass_arguments(ctx, it.arguments, it.frame, it.call)
        plain = [plain[0], *stored[1:]]
    obj.describe((plain[0], plain[1:], named))
    obj.name = next((t.name for t in plain[0].pts), "")
    return pointer(obj)


def _copied(ctx: Interpreter, it: Invocation) -> Value:
    given = [*it.arguments[0], *it.arguments[1].values()]
    if not given:
        return UNKNOWN
    copied = (
        partial(records.deep_copy, ctx) if it.fact.api == "copy.deepcopy" else partial(records.copy_of, ctx)
    )
    return copied(given[0], it.frame, it.call.slot)


def parameter(ctx: Interpreter, it: Invocation) -> Value:
    """Return a parameter's value: its default, if known."""
    default = it.argument(it.fact.extra)
    listed = _listed(ctx, it, it.argument(it.fact.topic), default)
    if listed is not None:
        return listed
    if default is BOTTOM:
        node = ctx.node(it.frame, ("parameter", it.call.slot), "assign")
        ctx.graph.parameters.add(node)
        ctx.graph.literals[node] = (None, it.call.pos, it.frame.program.path)
        return Value(ctx.kept(node), consts=_named(ctx, it, default))
    expr = _default(it)
    return _default_of(
        ctx, default, expr, it.frame, ("parameter", it.call.slot), consts=_named(ctx, it, default)
    )


def _listed(
    ctx: Interpreter, it: Invocation, name: Value, default: Value, slot: Hashable = ()
) -> Value | None:
    """Return a list or mapping parameter's value, from the launch file or its default; else None."""
    names = name.texts()
    given = launched.value_of(ctx, names[0]) if len(names) == 1 else None
    if given is DEFAULT and default.pts and ctx.launched is not None:
        return default
    return (
        launched.made(ctx, given, it.frame, (it.call.slot, slot)) if isinstance(given, list | dict) else None
    )


def _named(ctx: Interpreter, it: Invocation, default: Value) -> Consts:
    """Return the text for a parameter in topic names; None if the call does not name one."""
    names = it.argument(it.fact.topic).texts()
    return _value_of(ctx, names[0], default) if len(names) == 1 else None


def _value_of(ctx: Interpreter, name: str, default: Value) -> Consts:
    """Return the known value of a parameter, or else the text that stands for it in topic names."""
    value = launched.value_of(ctx, name)
    if value is ELSEWHERE:
        return text_of_parameter(ctx.parameter_names, name, default)
    if value is not DEFAULT:
        return None if isinstance(value, list | dict) else frozenset([value])
    return default.consts if default.fixed() else None


def _default_of(
    ctx: Interpreter,
    default: Value,
    expr: ir.Expr | None,
    frame: Frame,
    slot: Hashable,
    *,
    consts: Consts = None,
) -> Value:
    node = ctx.node(frame, slot, "assign")
    ctx.graph.parameters.add(node)
    if expr is not None:
        literals.mark(ctx, node, expr, default, frame)
    ctx.graph.flow(ctx.use(default) if default.pts else default.deps, node)
    if ctx.thorough and default.pts:
        # the default is an object, such as a mapping, and its entries must stay reachable
        return ctx.carry(default, node)
    if (entries := default_values.replaceable(ctx, default, frame, slot)) is not None:
        return Value(ctx.kept(node), entries.pts)
    return Value(ctx.kept(node), consts=consts)


def declare(ctx: Interpreter, it: Invocation) -> Value:
    """Record a declared parameter's default by node and name."""
    default = it.argument(it.fact.extra)
    expr = _default(it)
    name = _named(ctx, it, default)
    value = _listed(ctx, it, it.argument(it.fact.topic), default)
    if value is None:
        value = (
            Value(consts=name)
            if default is BOTTOM
            else _default_of(ctx, default, expr, it.frame, ("parameter", it.call.slot), consts=name)
        )
    found = _parameters(ctx, it.base, it.argument(it.fact.topic))
    for obj in found.objects:
        ctx.store.put((obj, "value"), value)
    return found


def declare_all(ctx: Interpreter, it: Invocation) -> Value:
    """Record the defaults of several parameters declared as (name, default); return all of them."""
    prefix = it.argument(it.fact.topic).texts()
    written = _written_defaults(it)
    declared = recency.allocate(ctx, "sequence", it.frame, ("declared", it.call.slot))
    for number, entry in enumerate(sizes.unpacked(ctx, it.argument(it.fact.extra)) or ()):
        parts = sizes.unpacked(ctx, entry) or []
        names = [f"{p}.{t}" if p else t for p in prefix or ("",) for t in (parts[0].texts() if parts else ())]
        found = _parameters(ctx, it.base, Value(consts=frozenset(names)))
        ctx.store.put((declared, item_field(number)), found)
        if len(parts) < 2:
            continue
        value = _listed(ctx, it, Value(consts=frozenset(names)), parts[1], number) or _default_of(
            ctx,
            parts[1],
            written.get(number),
            it.frame,
            ("parameter", it.call.slot, number),
            consts=_value_of(ctx, names[0], parts[1]) if len(names) == 1 else None,
        )
        for obj in found.objects:
            ctx.store.put((obj, "value"), value)
    return pointer(declared)


def _written_defaults(it: Invocation) -> Mapping[int, ir.Expr]:
    """Return the expressions of the defaults by index, if the list is literal in the call."""
    given = _default(it)
    entries = given.items if isinstance(given, ir.SequenceDisplay) else ()
    return {
        number: entry.items[1]
        for number, entry in enumerate(entries)
        if isinstance(entry, ir.SequenceDisplay) and len(entry.items) > 1
    }


def parameter_or(ctx: Interpreter, it: Invocation) -> Value:
    """Return a parameter, or the alternative that the call passes."""
    found = _parameter_object(ctx, it)
    names = it.argument(it.fact.topic).texts()
    given = launched.value_of(ctx, names[0]) if len(names) == 1 else ELSEWHERE
    alternative = it.argument(it.fact.extra)
    if given is DEFAULT and not any(ctx.store.get((obj, "value")) for obj in found.pts):
        return alternative
    return join(found, alternative) if given is ELSEWHERE else found


def _parameter_object(ctx: Interpreter, it: Invocation) -> Value:
    """Return a parameter.

    A parameter that the code does not declare has the value that the launch gives the node.
    """
    name = it.argument(it.fact.topic)
    found = _parameters(ctx, it.base, name)
    for obj in found.objects if ctx.launched is not None and len(name.texts()) == 1 else ():
        given = launched.value_of(ctx, name.texts()[0])
        if given is not DEFAULT and given is not ELSEWHERE and ctx.store.get((obj, "value")) is None:
            ctx.store.put((obj, "value"), launched.made(ctx, given, it.frame, (it.call.slot, obj.name)))
    return found


def _parameters(ctx: Interpreter, receiver: Value, name: Value) -> Value:
    keys = [(o.key, text) for o in receiver.pts for text in name.texts()]
    return Value(pts=frozenset(recency.intern(ctx, "parameter", key, str(key[1])) for key in keys))


READS_PARAMETERS: Final = frozenset(
    ["parameter", "declare", "declare all", "parameter object", "parameter or"]
)
ACTIONS: Mapping[str, Callable[..., Value]] = {
    "publisher": publications.made_publisher,
    "image publisher": publications.image_publisher,
    "subscribe": subscriptions.subscribe,
    "receive": subscriptions.receive,
    "configured": subscriptions.configured_source,
    "filter": subscriptions.message_filter,
    "behaviour": behaviour_subscribers.behaviour,
    "monitor": state_callbacks.monitor,
    "feedback": subscriptions.feedback,
    "synchronizer": subscriptions.synchronizer,
    "timer": _timer,
    "service": services.service,
    "action": services.action,
    "transform": services.transform_look_up,
    "broadcast": services.transform_broadcast,
    "call later": _timer,
    "done": _done,
    "thread": _thread,
    "scheduled": _thread,
    "partial": _partial,
    "copy": _copied,
    "parameter": parameter,
    "declare": declare,
    "declare all": declare_all,
    "parameter object": _parameter_object,
    "parameter or": parameter_or,
}


def _default(it: Invocation) -> ir.Expr | None:
    """Return the expression of a parameter's default."""
    if len(it.call.arguments) > 1:
        return it.call.arguments[1]
    return next((e for name, e in it.call.keywords if name == it.fact.extra[1]), None)
