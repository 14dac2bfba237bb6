"""Models of subscriptions and their callbacks."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import Final

from tarl_lint import catalog
from tarl_lint.interpret import call_contexts, calls, single_dispatch
from tarl_lint.interpret.budget import MAX_ALIKE, MAX_GENERATIONS
from tarl_lint.interpret.call_contexts import CALLABLE, ROOT_CALL
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.interpret.run_order import Part
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.abstract_gc import together
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.shared import Root
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, function_of, join, join_all, pointer
from tarl_lint.models import context_managers, sizes
from tarl_lint.models.ros import publications, registered_roots
from tarl_lint.models.ros.endpoints import NAMESPACE, Acceptance, Kind, Publisher, SourceRecord
from tarl_lint.models.ros.publications import type_names, whole_type_names
from tarl_lint.models.smach import LATER

KINDS: Final[Mapping[str, Kind]] = {"service": "service", "action": "action", "transform": "transform"}
NOTHING: Final[Mapping[str, Value]] = {}
# triples of the object that each call creates, the name of a field of the object, and the value of the field
Fresh = Sequence[tuple[Obj, str, Value]]


def source(ctx: Interpreter, it: Invocation, callback: Value) -> SourceRecord:
    """Record a subscription. Its place is the outermost call that supplies the callback."""
    place, pos, statement, via = it.frame, it.call.pos, it.frame.statement, []
    while place.caller is not None and place.call is not None and _supplied(place, callback):
        via.append((place.program.path, pos))
        statement = place.call
        pos = call_position(place)
        place = place.caller
    path = place.program.path
    topics = publications.topics(ctx, it)
    key = ctx.source_key(path, pos, place, topics)
    record = ctx.sources.get(key)
    if record is None:
        assert statement is not None  # noqa: S101 - a call stands in a statement
        module = ctx.modules[path].name
        qualname = publications.qualname(place)
        record = SourceRecord(path, pos, key, it.fact.api, module, qualname, statement, place)
        record.kind = KINDS.get(it.fact.kind, "topic")
        ctx.sources[key] = record
    record.via.update(via)
    record.contexts.add((place.id, *place.turn))
    record.topics.update(topics)
    record.types.update(type_names(it.argument(it.fact.type)))
    record.whole_types.update(whole_type_names(it.argument(it.fact.type)))
    return record


def call_position(frame: Frame) -> ir.Pos:
    """Return the position of the call that entered a frame."""
    assert frame.call is not None  # noqa: S101 - the callers check this
    return frame.call_pos or frame.call.pos


def subscribe(ctx: Interpreter, it: Invocation) -> Value:
    """Record a source, and run its callback with messages."""
    callback = it.argument(it.fact.callback)
    record = source(ctx, it, callback)
    extra = it.argument(it.fact.extra)
    passed = [extra] if extra is not BOTTOM else []
    connect(ctx, record, callback, passed, it)
    return handle(ctx, it.frame, it.call)


def _of_library(ctx: Interpreter, target: Obj) -> bool:
    """Return whether a callback is a library's method, such as `other.publish`, even inside a `functools.partial`."""
    if target.kind == "partial" and isinstance(target.info, tuple):
        ctx.store.reads.look(target)
        inner: frozenset[Obj] = target.info[0].pts
        return bool(inner) and all(one is not target and _of_library(ctx, one) for one in inner)
    return target.kind == "method"


def _received(ctx: Interpreter, record: SourceRecord, frame: Frame, slot: Hashable) -> Obj:
    """Return the message object that arrives at a frame's current statement."""
    obj = record.messages.get((frame.id, slot))
    if obj is None:
        obj = record.messages[frame.id, slot] = Obj("message", (*record.key, frame.id, slot))
        obj.info = ctx.node(frame, ("receive", slot), "receive")
        record.nodes.add(obj.info)
        ctx.graph.begin(obj.info)
    return obj


def configured_source(ctx: Interpreter, it: Invocation) -> Value:
    """Subscribe if one of the arguments is a function, else return the message."""
    given = [*it.arguments[0], *it.arguments[1].values()]
    callbacks = [v for v in given if any(o.kind in ("closure", "bound", "partial") for o in v.pts)]
    if not callbacks:
        return receive(ctx, it)
    connect(ctx, source(ctx, it, callbacks[0]), callbacks[0], [], it)
    return handle(ctx, it.frame, it.call)


def feedback(ctx: Interpreter, it: Invocation) -> Value:
    """Subscribe marker or menu callbacks to the server's feedback topic, if the server is known."""
    spaces = [heap.read_field(ctx, obj, NAMESPACE) for obj in it.base.objects if obj.kind == "lib"]
    topics = frozenset(f"{name}/feedback" for space in spaces for name in space.names())
    for given in (*it.arguments[0], *it.arguments[1].values()):
        if any(one.kind in ("closure", "bound", "partial") for one in given.pts):
            record = source(ctx, replace(it, arguments=([Value(consts=topics)], {})), given)
            record.types.add("InteractiveMarkerFeedback")
            record.whole_types.add("visualization_msgs/InteractiveMarkerFeedback")
            connect(ctx, record, given, [], it)
    return handle(ctx, it.frame, it.call)


def handle(ctx: Interpreter, frame: Frame, call: ir.Call) -> Value:
    """Return the object that a registration returns."""
    return pointer(recency.allocate(ctx, "lib", frame, ("made", call.slot)))


def connect(
    ctx: Interpreter, record: SourceRecord, callback: Value, extra: Sequence[Value], it: Invocation
) -> None:
    """Run a callback whenever a message of the source arrives.

    A callback of a library is called in the place where it is registered.
    """
    targets = callback.objects
    if len(targets) > 1 and ctx.dispatches and len(record.types) == 1:
        targets = single_dispatch.for_types(ctx, targets, [sorted(record.types)])
    for target in targets:
        if _of_library(ctx, target):
            obj = _received(ctx, record, it.frame, ("forward", it.call.slot, target.key))
            calls.call_object(ctx, target, ([pointer(obj)], {}), it.frame, it.call)
        elif target.kind == "lib" and target.parent is not None and target.name.isidentifier():
            # an attribute of a library's object, such as `subject.on_next`, is one of its methods
            obj = _received(ctx, record, it.frame, ("forward", it.call.slot, target.key))
            owner, given = target.parent, pointer(obj)
            ctx.ops.call_method(ctx, pointer(owner), owner, target.name, ([given], {}), it.frame, it.call)
        elif target.kind in CALLABLE or target.kind == "instance":
            arriving = message(ctx, record, target)
            call_when(ctx, ("callback", *record.key), target, [pointer(arriving), *extra], "callback")


def message(ctx: Interpreter, record: SourceRecord, target: Obj) -> Obj:
    """Return the message object that a source passes to a callback."""
    obj = record.messages.get(target.key)
    if obj is None:
        obj = record.messages[target.key] = Obj("message", (*record.key, target.key))
        obj.defined = next(iter(record.types)) if len(record.types) == 1 else ""
        frame = described(ctx, target)
        place = Place(frame or record.frame, None, "receive", (frame or record.frame).function.pos)
        node = ctx.graph.node(("receive", obj.key), place, frozenset())
        obj.info = node
        record.nodes.add(node)
        ctx.graph.begin(node)
        record.callbacks.add(frame.function.qualname if frame is not None else target.name)
    # the same object is registered again with another type
    elif obj.defined and record.types != {obj.defined}:
        obj.defined = ""
        obj.changed(None)
    return obj


def described(ctx: Interpreter, target: Obj) -> Frame | None:
    """Return a frame that represents a callback's function, independent of its callers."""
    while target.kind in ("bound", "partial", "instance"):
        if target.kind == "bound" and isinstance(target.info, tuple):
            target = target.info[0]
            continue
        if target.kind == "partial" and isinstance(target.info, tuple):
            inner: frozenset[Obj] = target.info[0].pts
        else:
            inner = heap.read_field(ctx, target, "__call__").pts
        ctx.store.reads.look(target)
        if len(inner) != 1:
            return None
        target = next(iter(inner))
    if target.kind != "closure" or not isinstance(target.info, tuple):
        return None
    function, _, program, _ = target.info
    return Frame(("described", target.key), -1, function, program, ctx.module_objects[program.name])


def receive(ctx: Interpreter, it: Invocation) -> Value:
    """Return the message from a call that waits for one."""
    obj = _received(ctx, source(ctx, it, BOTTOM), it.frame, it.call.slot)
    recency.clear_fields(ctx, obj)
    return pointer(obj)


def message_filter(ctx: Interpreter, it: Invocation) -> Value:
    """Return a subscriber of message_filters.

    The first argument of the call is the topic in rospy and the node in rclpy.
    """
    first = it.arguments[0][0] if it.arguments[0] else BOTTOM
    if len(it.arguments[0]) > 2 and not first.texts() and not it.argument(it.fact.type).texts():
        it.fact = catalog.FILTER_WITH_NODE
    record = source(ctx, it, BOTTOM)
    obj = recency.intern(ctx, "filter", record.key)
    obj.describe(record)
    return pointer(obj)


def synchronizer(ctx: Interpreter, it: Invocation) -> Value:
    """Return a synchroniser of several subscribers."""
    given = it.argument(it.fact.topic)
    obj = recency.intern(ctx, "synchronizer", (it.frame.id, it.statement, it.call.slot, *it.frame.turn))
    parts = sizes.unpacked(ctx, given)
    several = parts is None and all(o.kind == "sequence" for o in given.pts)
    if parts is None:
        parts = [heap.elements(ctx, given)] if several else [given]
    obj.describe((parts, (it.frame.program.path, it.call.pos), several))
    return pointer(obj)


def register_filter(ctx: Interpreter, target: Obj | None, it: Invocation) -> Value:
    """Register a callback that gets one message of each subscriber, or read messages from a cache."""
    if target is None:
        return UNKNOWN
    ctx.store.reads.look(target)
    if it.name in catalog.CACHE_READERS:
        return _cached(ctx, target, it)
    places = {(it.frame.program.path, it.call.pos)}
    parts: Sequence[Value] = [pointer(target)]
    several = False
    if target.kind == "synchronizer" and isinstance(target.info, tuple):
        parts = target.info[0]
        places.add(target.info[1])
        several = target.info[2]
    callback = it.argument((0, "cb"))
    extra = it.arguments[0][1:]
    for function in callback.objects:
        if function.kind in CALLABLE:
            messages = [_filtered(ctx, part, function, places) for part in parts]
            key = ("filter", *ctx.end_key(it.frame.program.path, it.call.pos, it.frame))
            named = {"*": join_all([*messages, *extra])} if several else {}
            values = [] if several else [*messages, *extra]
            call_when(ctx, key, function, values, "callback", named=named)
    return UNKNOWN


def _cached(ctx: Interpreter, target: Obj, it: Invocation) -> Value:
    """Return a message, or a list of messages, from a `message_filters.Cache`; the arguments choose which."""
    parts = target.info[0] if isinstance(target.info, tuple) else ()
    records = [o.info for part in parts for o in part.objects if isinstance(o.info, SourceRecord)]
    kept = [_received(ctx, record, it.frame, ("cached", it.call.slot)) for record in records]
    message_of = Value(call_contexts.all_used(ctx, it.arguments), frozenset(kept))
    if "Interval" not in it.name:
        return message_of
    listed = recency.allocate(ctx, "sequence", it.frame, ("cached", it.call.slot))
    updates.add_element(ctx, pointer(listed), message_of)
    return pointer(listed)


def _filtered(ctx: Interpreter, part: Value, function: Obj, places: set[tuple[str, ir.Pos]]) -> Value:
    """Return the message that a subscriber of message_filters forwards."""
    arriving = BOTTOM
    ctx.look(part.pts)
    for subscriber in part.objects:
        if isinstance(subscriber.info, SourceRecord):
            subscriber.info.registered |= places
            arriving = join(arriving, pointer(message(ctx, subscriber.info, function)))
    return arriving


def call_when(
    ctx: Interpreter,
    key: Hashable,
    target: Obj,
    values: Sequence[Value],
    kind: str,
    fresh: Fresh = (),
    answer: Publisher | Acceptance | Part | None = None,
    named: Mapping[str, Value] = NOTHING,
    program: str = "",
    guards: Sequence[int] = (),
) -> None:
    """Queue a function as root with these arguments; `answer` receives the function's result.

    `guards` are the nodes of the decisions that determine whether ROS calls the function.
    """
    root = Root((key, target.kind, target.key), kind, target.name, kind == "thread", function_of(target))
    registered_roots.note(ctx, root.key)
    root.maker = ctx.store.root
    root.program = program or root.maker.program
    if root.key not in ctx.roots and _too_many(ctx, root):
        return
    before = ctx.passed.get(root.key, [])
    values = [join(a, b) for a, b in zip_longest(before, values, fillvalue=BOTTOM)]
    news = bool(before) and values != before
    ctx.passed[root.key] = values
    ctx.given |= together([target, *(o for v in (*values, *named.values()) for o in v.pts)])

    def run(root: Root) -> None:
        frame = ctx.ops.root_frame(ctx, root)
        frame.answer = answer
        ctx.delivered = frozenset(o for v in (*values, *named.values()) for o in v.pts if o.kind == "message")
        for obj, name, value in fresh:
            recency.clear_fields(ctx, obj)
            ctx.store.put((obj, name), value)
        received = (o.info for v in values for o in v.objects if o.parent is None and ctx.config.arrivals)
        decides = [*guards, *(node for node in received if isinstance(node, int))]
        ctx.guards += [(node, "called") for node in decides]
        result = calls.call_object(ctx, target, (list(values), dict(named)), frame, ROOT_CALL)
        for rest in context_managers.rest_of(ctx, result).objects:
            call_later(ctx, rest, ())
        del ctx.guards[len(ctx.guards) - len(decides) :]

    ctx.ops.add_root(ctx, root, run, news=news)


def _too_many(ctx: Interpreter, root: Root) -> bool:
    """Return whether a function has enough roots already: restarts of itself, or other objects of its class."""
    if root.function is None:
        return False
    if root.generations() > MAX_GENERATIONS:
        return True
    if not _for_each_object(root):
        return False
    alike = [r for r, _ in ctx.roots.values() if r.function is root.function and _for_each_object(r)]
    return len(alike) >= MAX_ALIKE


def call_later(ctx: Interpreter, target: Obj, values: Sequence[Value]) -> None:
    """Queue a function as root; its other arguments are unknown."""
    call_when(ctx, "later", target, values, "callback")


def _for_each_object(root: Root) -> bool:
    """Return whether a thread or framework runs a method, and therefore runs it for each object of the class."""
    return root.kind == "thread" or (isinstance(root.key, tuple) and root.key[0] == "framework")


def _supplied(frame: Frame, callback: Value) -> bool:
    """Return whether a function's caller supplies the callback."""
    wanted = {o for o in callback.pts if o.kind in CALLABLE}
    for target in tuple(wanted):
        wanted |= _wrapped(target, frame)
    return bool(wanted) and any(wanted & v.pts for v in frame.arguments)


def _wrapped(target: Obj, frame: Frame) -> set[Obj]:
    """Return the functions passed, perhaps in nested calls, to a helper that wraps them."""
    if target.kind == "partial" and isinstance(target.info, tuple):
        return {o for o in target.info[0].pts if o.kind in CALLABLE}
    maker = target.info[1] if target.kind == "closure" and isinstance(target.info, tuple) else None
    if not isinstance(maker, Frame) or frame not in (maker, maker.caller):
        return set()
    return {o for value in maker.arguments for o in value.pts if o.kind in LATER}
