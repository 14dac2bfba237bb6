"""Models of publishers and publish calls."""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.interpret import call_contexts, shared_contexts
from tarl_lint.interpret.budget import MAX_APART
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.interpret.run_order import Part
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import BLOCKED
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame, Spared, Turns, inside
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.memory.values import NONE, UNKNOWN, Nodes, Value, pointer
from tarl_lint.models.ros.endpoints import Acceptance, DefaultName, Publisher, SinkRecord

# values of a variable that holds a topic's name, while the variable is not set
NO_NAMES = frozenset([None, ""])


def made_publisher(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new publisher."""
    obj = recency.intern(ctx, "publisher", (it.frame.id, it.statement, it.call.slot, *it.frame.turn))
    info = obj.info
    if not isinstance(info, Publisher):
        info = Publisher(api=it.fact.api, path=it.frame.program.path, pos=it.call.pos)
    obj.info = info
    info.topics.update(topics(ctx, it))
    info.nodes |= it.base.pts
    info.types.update(type_names(it.argument(it.fact.type)))
    info.whole_types.update(whole_type_names(it.argument(it.fact.type)))
    return pointer(obj, _named_by_data(ctx, it))


def _named_by_data(ctx: Interpreter, it: Invocation) -> Nodes:
    """Return the node that decides which topic a publisher gets, because data names the topic; empty without data."""
    decides = NONE if ctx.thorough else ctx.use(it.argument(it.fact.topic))
    if not decides:
        return NONE
    node = ctx.node(it.frame, ("topic", it.call.slot), "condition")
    ctx.graph.depend(node, decides)
    return ctx.kept(node)


def image_publisher(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new publisher of image_transport; it also publishes images on topics below its own topic."""
    made = made_publisher(ctx, it)
    for obj in made.objects:
        if isinstance(obj.info, Publisher):
            obj.info.topics.update(f"{name}/compressed" for name in topics(ctx, it))
            obj.info.types.add("Image")
            obj.info.whole_types.add("sensor_msgs/Image")
    return made


def topics(ctx: Interpreter, it: Invocation) -> list[str]:
    """Return the possible topic names of a registration, after remapping."""
    names, given = ctx.config.launched, it.argument(it.fact.topic)
    # the variable with the topic's name is not set yet, so the call would fail
    if named := (given.consts or NO_NAMES) - NO_NAMES:
        given = Value(given.deps, given.pts, named)
    kind = DefaultName if given.replaceable() else str
    return [kind(names.get(text.lstrip("/"), text)) for text in given.names()]


def names_of(info: Publisher) -> tuple[int, int, int]:
    """Return the numbers of a publisher's possible topics, types and nodes. These numbers never decrease."""
    return len(info.topics), len(info.types), len(info.nodes)


def receiver(ctx: Interpreter, base: Value) -> Value:
    """Return the receiver of a publish call. Decisions between publishers that are all alike are left out.

    Publishers of one topic and one node are alike, such as publishers that a program makes when it first needs one.
    """
    infos = [o.info for o in base.pts if o.kind == "publisher" and isinstance(o.info, Publisher)]
    if not base.deps or not infos or len(infos) < len(base.pts) or _expects_none(ctx):
        return base
    for info in infos:
        ctx.store.reads.ask(names_of, info)
    names = {topic for info in infos for topic in info.topics}
    nodes = {node for info in infos for node in info.nodes}
    known = all(info.topics for info in infos) and not any(isinstance(name, DefaultName) for name in names)
    alike = known and len(names) == 1 and len(nodes) < 2 and all(recency.single(ctx, one) for one in nodes)
    return Value(pts=base.pts, consts=base.consts) if alike else base


def _expects_none(ctx: Interpreter) -> bool:
    """Return whether a handler names the exception of a call on None, so that the existence of a publisher decides."""
    return any(t.names("AttributeError", ctx.exception_types) for f in ctx.stack for t in f.tries)


def send(ctx: Interpreter, it: Invocation, info: Publisher) -> Value:
    """Record a sink, which depends on everything inside the message and on the conditions of the call."""
    frame, call = it.frame, it.call
    place = (frame.program.path, call.pos)
    key, slot = _keys(ctx, it, info)
    record = ctx.sinks.get(key)
    if record is None:
        record = SinkRecord(*place, _api(info, it), ctx.modules[place[0]].name, qualname(frame))
        record.kind = info.kind
        ctx.sinks[key] = record
    ctx.store.reads.ask(names_of, info)
    record.topics |= info.topics
    record.types |= info.types
    record.publishers.add((info.path, info.pos))
    record.contexts.add((frame.id, *frame.turn))
    info.used = True
    node = ctx.node(frame, slot, "publish")
    ctx.graph.flow(call_contexts.all_used(ctx, it.arguments), node)
    ctx.graph.choice(it.base.deps, node)
    ctx.graph.depend(node, it.base.deps)  # the conditions that choose the publisher decide what is published
    ctx.graph.depend(node, [n for n, _ in ctx.guards])
    if frame.statement is not None:
        under(ctx, frame, frame.statement, node)
        if BLOCKED in frame.function.raising.get(frame.statement.id, ()):
            # the arguments were evaluated before, as in `publish(queue.get())`
            ctx.graph.depend(node, (ctx.condition(frame, frame.statement),))
    record.nodes.add(node)
    return UNKNOWN


def _keys(ctx: Interpreter, it: Invocation, info: Publisher) -> tuple[Hashable, Hashable]:
    """Return the keys of a publish call: one per publisher, at most MAX_APART for one call."""
    place, slot = (it.frame.program.path, it.call.pos), ("publish", it.call.slot)
    if ctx.launching:
        return ctx.end_key(*place, it.frame), slot
    key = (*place, info)
    if key not in ctx.sinks:
        known = ctx.sent.setdefault(place, 0)
        if known >= MAX_APART:
            return place, slot
        ctx.sent[place] = known + 1
    return key, (*slot, info)


def accept(ctx: Interpreter, it: Invocation, value: Value, acceptance: Acceptance) -> None:
    """Let the decision about a goal depend on a returned value and its conditions, unless all values are the same."""
    node = _answer(ctx, it, value)
    known, constant = value.constant()
    names = {o.name for o in value.pts}
    only = next(iter(names)) if len(names) == 1 else None
    acceptance.answers[node] = only if value.pts else repr(constant) if known else None
    if len(set(acceptance.answers.values())) > 1 or None in acceptance.answers.values():
        ctx.graph.depend(acceptance.node, acceptance.answers)


def end(ctx: Interpreter, it: Invocation, value: Value, part: Part) -> None:
    """Record the outcome with which a state or behaviour ends, with its conditions."""
    kinds = {one.kind for one in value.pts}
    names = [one.name.rpartition(".")[2] for one in value.pts]
    part.answers[_answer(ctx, it, value)] = frozenset(names if kinds == {"ext"} else value.texts()) or None


def _answer(ctx: Interpreter, it: Invocation, value: Value) -> int:
    """Return the node of a returned value, which depends on its data and its conditions."""
    node = ctx.node(it.frame, ("accept", it.call.pos), "condition")
    ctx.graph.flow(value.deps, node)
    ctx.graph.depend(node, [n for n, _ in ctx.guards])
    if it.frame.statement is not None:
        under(ctx, it.frame, it.frame.statement, node)
    return node


def under(
    ctx: Interpreter,
    frame: Frame,
    statement: ir.Stmt,
    node: int,
    turns: Turns | None = None,
    but: ir.Loop | None = None,
    spared: Spared = frozenset(),
) -> None:
    """Make a node depend on the conditions of a statement, including those in callers.

    `turns` are the iterations of unrolled loops in which the statement runs; they default to the current
    iterations. Conditions inside the loop `but`, and those in `spared`, are left out.
    """
    turns = inside(statement, frame.turns if turns is None else turns)
    whole = ctx.control(frame)
    control = whole.iteration(turns[-1][0]) if turns else whole
    # a `for` evaluates its iterable before it decides whether there is an element
    own = statement.id if isinstance(statement, ir.Loop) and statement.target is not None else None
    for branch in control.direct.get(statement.id, ()):
        if (branch[0], True) in spared:
            continue
        if branch[0] != own and (but is None or not but.has(branch[0])):
            decision, _ = ctx.branch(frame, branch, turns)
            if (branch[0], False) not in spared:
                ctx.graph.depend(node, (decision,))
            _reached(ctx, frame, whole.statements[branch[0]], node, turns)
    if turns:
        loop, _ = turns[-1]
        ctx.graph.depend(node, [decision for decision, _ in ctx.beginning(frame, turns)])
        under(ctx, frame, loop, node, turns[:-1], loop)
    elif statement.id in whole.always:
        _entered(ctx, frame, node)


def _reached(ctx: Interpreter, frame: Frame, statement: ir.Stmt, node: int, turns: Turns) -> None:
    """Make a node depend on the conditions under which a condition is evaluated, now or later."""
    turns = inside(statement, turns)
    decision = ctx.condition(frame, statement, turns)
    key = (frame.id, statement.id, "reached", *((loop.id, turn) for loop, turn in turns))
    waypoint = ctx.graph.node(key, ctx.graph.places[decision], frozenset())
    if (statement.id, turns) not in frame.waypoints:
        frame.waypoints.add((statement.id, turns))
        under(ctx, frame, statement, waypoint, turns)
    if waypoint != node:
        ctx.graph.depend(node, (waypoint,))


def _entered(ctx: Interpreter, frame: Frame, node: int) -> None:
    """Make a node depend on the conditions under which its function is called."""
    caller, call = frame.caller, frame.call
    if caller is None or call is None:
        ctx.graph.depend(node, [n for n, _ in frame.guards])
        registered = ctx.registered.get(ctx.store.root.key)
        if registered is not None and registered.node is not None:
            ctx.graph.depend(node, (registered.node,))
        return
    if frame.shared:
        ctx.graph.depend(node, [n for n, _ in shared_contexts.conditions(ctx, frame)])
        return
    waypoint = ctx.graph.node((frame.id, "entered"), Place(caller, call, "call", call.pos), frozenset())
    control = ctx.control(caller)
    if frame.entered is not control:
        frame.entered = control
        under(ctx, caller, call, waypoint, frame.called_in, spared=frame.spared or frozenset())
        ctx.graph.depend(waypoint, [n for n, _ in frame.guards])
    ctx.graph.depend(node, (waypoint,))


def qualname(frame: Frame) -> str:
    """Return the qualified name of the function (or class body) that a frame runs."""
    return frame.function.qualname


def type_names(value: Value) -> list[str]:
    """Return the last parts of message types' names."""
    return [o.name.rpartition(".")[2] for o in value.pts if o.kind in ("ext", "class")]


def whole_type_names(value: Value) -> list[str]:
    """Return message types as `package/Name`; "" for a type whose package is unknown."""
    names = [o.name.split(".") if o.kind == "ext" else [] for o in value.pts if o.kind in ("ext", "class")]
    return [f"{parts[0]}/{parts[-1]}" if parts[1:2] == ["msg"] else "" for parts in names]


def _api(info: Publisher, it: Invocation) -> str:
    """Return the name of the API that sends a message; the call that created the sender determines it."""
    if info.kind != "topic":
        return f"{info.api}.{it.name}"
    library = info.api.partition(".")[0]
    return f"{library}.Publisher.publish" if library in ("rospy", "rclpy") else info.api
