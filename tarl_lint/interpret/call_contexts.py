"""Call analysed functions and classes in their call contexts."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.interpret import (
    annotated,
    call_replay,
    context_selection,
    generators,
    literals,
    nullness,
    shared_contexts,
)
from tarl_lint.interpret.budget import IRRELEVANT_CALL_LIMIT, IRRELEVANT_CALLS_LIMIT
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import generations, heap, joins, library_instances, recency, updates
from tarl_lint.memory.abstract_gc import lasting
from tarl_lint.memory.frames import Frame, Origin, Spared
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import (
    BOTTOM,
    NONE,
    UNKNOWN,
    Branches,
    Nodes,
    Obj,
    Value,
    certain_pointer,
    join,
    lineage,
    pointer,
)
from tarl_lint.models import sizes

CALLABLE = frozenset(["closure", "bound", "class", "ext", "partial", "method", "weak"])
ROOT_CALL = ir.Call(ir.Const(None, (0, 0, 0, 0)), (), (), (0, 0, 0, 0), 0)


def all_used(ctx: Interpreter, arguments: Arguments) -> Nodes:
    """Return the nodes of all data among the arguments."""
    plain, named = arguments
    deps = NONE
    for value in (*plain, *named.values()) if named else plain:
        if value.pts or value.deps:
            used = ctx.use(value)
            deps = deps | used if deps else used
    return deps


def invoke(
    ctx: Interpreter,
    closure: Obj,
    arguments: Arguments,
    caller: Frame,
    call: ir.Call,
    owner: Obj | None = None,
) -> Value:
    """Call a function; limit the budget if neither data nor the module's topics matter."""
    before, start = ctx.work.call_limit, ctx.work.spent
    matters = not isinstance(closure.info, tuple) or closure.info[2].takes_part or carries(ctx, arguments)
    if not matters and before is not None and start > before:
        ctx.store.reads.whole = False
        return _again(ctx, closure, arguments)
    if matters:
        ctx.work.call_limit = None
    elif before is None:
        ctx.work.call_limit = start + max(
            0, min(IRRELEVANT_CALL_LIMIT, IRRELEVANT_CALLS_LIMIT - ctx.work.idled)
        )
    result = _invoke(ctx, closure, arguments, caller, call, owner)
    if not matters and before is None:
        ctx.work.idled += ctx.work.spent - start
    ctx.work.call_limit = before + ctx.work.spent - start if matters and before is not None else before
    return result


def _invoke(
    ctx: Interpreter, closure: Obj, arguments: Arguments, caller: Frame, call: ir.Call, owner: Obj | None
) -> Value:
    spared, ctx.spared = ctx.spared, frozenset()
    frame = context_selection.make_frame(ctx, closure, arguments, caller, call, owner)
    if frame is None:
        return _again(ctx, closure, arguments)
    ctx.called.add((frame.function.module, frame.function.pos[0]))
    passed = pass_arguments(ctx, arguments, caller, call)
    if frame.shared:
        passed = shared_contexts.enter(ctx, frame, caller, passed)
    _note_arguments(ctx, frame, arguments, caller, call)
    if not frame.guards.issuperset(ctx.guards):
        _decide_call(frame, frozenset(ctx.guards))
    _spare(frame, spared)
    frame.root_waits = caller.root_waits
    parts: tuple[Origin, ...] = ()
    if (
        (caller.taken or caller.spread or "**" in passed[1])
        and not frame.shared
        and caller.statement is not None
    ):
        parts = ctx.ops.origins(ctx, caller, call, passed)
    run = call_replay.run(ctx, frame, passed, parts, lambda: _execute(ctx, frame, closure, passed, parts))
    result = shared_contexts.leave(ctx, frame, run.result) if frame.shared else run.result
    nullness.note_result(ctx, call, run.returned, frame)
    if ctx.thorough:
        ctx.unchanged.add(call)
    if run.escapes:
        ctx.ops.escaped(ctx, frame, caller)
    # no statement follows the call, so the states of a return and of an exception are joined
    if run.thrown is not None and caller.statement is None:
        joins.merge(ctx, [run.delta, run.thrown])
    elif run.noted:
        ctx.store.absorb(run.delta)
    else:
        for key, value in run.delta.items():
            ctx.store.put(key, value)
        run.noted = True
    if frame.function.generator:
        return _generator(ctx, frame, run, caller, call, result)
    if run.blocked:
        ctx.ops.may_wait(ctx, frozenset(run.blocked), caller)
    return result


def _generator(
    ctx: Interpreter, frame: Frame, run: call_replay.Run, caller: Frame, call: ir.Call, result: Value
) -> Value:
    """Return the generator that a call makes: a sequence of the values that it yields.

    The length of the sequence depends on the events for which the generator waits.
    """
    collected = recency.allocate(ctx, "sequence", caller, ("generator", call.slot))
    collected.name = heap.GENERATOR
    collected.describe(generators.mailbox(ctx, frame))
    updates.add_element(ctx, pointer(collected), frame.yielded)
    if run.blocked:
        sizes.decide_length(ctx, collected, frozenset(run.blocked))
    ctx.store.put((collected, heap.RESULT), result)
    return pointer(collected)


def _decide_call(frame: Frame, guards: Branches) -> None:
    """Let decisions inside the calling expression decide about a call, even if an earlier call was made without them.

    For example, `handlers[self.state]()` may call several functions once a later state is known.
    """
    frame.guards |= guards
    frame.recorded = frame.entered = None
    frame.waypoints = set()
    if not frame.shared and not guards <= frame.base:
        frame.base |= guards
        frame.closures = {}


def _spare(frame: Frame, spared: Spared) -> None:
    """Leave out decisions that decide no call of a function for its receiver."""
    if frame.spared is None:
        frame.spared = spared
    elif not frame.spared <= spared:
        frame.spared &= spared
        frame.recorded = frame.entered = None


def _execute(
    ctx: Interpreter, frame: Frame, closure: Obj, passed: Arguments, parts: tuple[Origin, ...]
) -> Delta:
    """Execute a function's body in its own layer; return the changes that outlive the call."""
    function = frame.function
    ctx.work.activations[function] = ctx.work.activations.get(function, 0) + 1
    ctx.store.push()
    depth = len(ctx.store.layers) - 1
    frame.depth_of_layers = depth
    frame.jumps, frame.tries, frame.escapes, frame.statement = [], [], [], None
    frame.blocked = {}
    bind_parameters(ctx, frame, closure, passed)
    if parts:
        ctx.ops.note_origins(ctx, frame, parts)
    ctx.guards, guards = [], ctx.guards
    ctx.stack.append(frame)
    if function.generator:
        generators.begin(ctx, frame)
    ctx.ops.run(ctx, frame)
    ctx.stack.pop()
    ctx.guards = guards
    ctx.store.cut(depth)
    reads = ctx.store.reads
    handed = _handed(frame)
    ends = [lasting(d, frame, [*v.pts, *handed], ctx.given, reads) for d, v in frame.returns]
    frame.thrown = None
    if frame.escapes:
        # exceptions that one statement raises share a state
        raising = {id(e.state): e.state for e in frame.escapes}
        frame.thrown = joins.joined(
            ctx, [lasting(d, frame, handed, ctx.given, reads) for d in raising.values()]
        )
        for escape in frame.escapes:
            escape.state = {}
    return joins.joined(ctx, ends or [{}])


def _again(ctx: Interpreter, closure: Obj, arguments: Arguments) -> Value:
    """Return the known results of a call that is not executed, with the data of its arguments."""
    known = BOTTOM
    for frame in ctx.stack:
        if frame.key[3] == closure.key if isinstance(frame.key, tuple) and len(frame.key) > 3 else False:
            ctx.store.reads.ask(_result, frame)
            known = join(known, frame.result)
    return join(known, Value(all_used(ctx, arguments)))


def _result(frame: Frame) -> Value:
    """Return the result so far of a function in a call context."""
    return frame.result


def pass_arguments(ctx: Interpreter, arguments: Arguments, caller: Frame, call: ir.Call) -> Arguments:
    """Give each argument a node of the calling statement."""
    plain, named = arguments
    exprs = written(call, plain)
    passed: list[Value] = []
    for number, value in enumerate(plain):
        if _receiver(value) or caller.statement is None:
            passed.append(value)
            continue
        node = ctx.node(caller, ("argument", call.slot, number), "call")
        expr = exprs[number]
        if isinstance(expr, ir.Starred) and (len(value.deps) == 1 or not value.constant()[0]):
            ctx.graph.copies.add(node)  # an element of `*values` is passed on unchanged
        elif expr is not None:
            literals.mark(ctx, node, expr, value, caller)
        elif value.pts:
            # an implicit receiver (`self`): the node passes on an object, not data
            ctx.graph.held.setdefault(node, set())
        elif ctx.thorough and not any(isinstance(one, ir.Starred) for one in call.arguments):
            ctx.graph.copies.add(node)  # a `functools.partial` has stored this argument
        passed.append(ctx.carry(value, node))
    keywords = dict(call.keywords)
    renamed: dict[str, Value] = {}
    for name, value in named.items():
        if caller.statement is None:
            renamed[name] = value
            continue
        node = ctx.node(caller, ("argument", call.slot, name), "call")
        if name in keywords:
            literals.mark(ctx, node, keywords[name], value, caller)
        elif ctx.thorough and None not in keywords and not value.pts:
            ctx.graph.copies.add(node)  # a `functools.partial` has stored this argument
        renamed[name] = ctx.carry(value, node)
    return passed, renamed


def written(call: ir.Call, plain: Sequence[Value]) -> list[ir.Expr | None]:
    """Return the expression of each positional argument: `*values` for each of its elements, None for a receiver."""
    given: list[ir.Expr | None] = [*call.arguments]
    stars = [number for number, one in enumerate(given) if isinstance(one, ir.Starred)]
    unknown: list[ir.Expr | None] = [None] * len(plain)
    if len(stars) > 1:
        return unknown
    if stars:
        receivers = sum(1 for value in plain[:1] if _receiver(value))
        elements = len(plain) - receivers - (len(given) - 1)
        given[stars[0] : stars[0] + 1] = [given[stars[0]]] * elements
    shift = len(plain) - len(given)
    return [*unknown[: max(shift, 0)], *given[max(-shift, 0) :]]


def _note_arguments(
    ctx: Interpreter, frame: Frame, arguments: Arguments, caller: Frame, call: ir.Call
) -> None:
    """Note the parameters whose value is None only before the first message."""
    plain, named = arguments
    if caller.statement is None or any(isinstance(a, ir.Starred) for a in call.arguments):
        return
    shift = len(plain) - len(call.arguments)
    for parameter, value, expr in zip(
        frame.function.parameters[shift:], plain[shift:], call.arguments, strict=False
    ):
        nullness.note_passed(ctx, (frame, parameter.name), expr, value, caller)
    for name, expr in call.keywords:
        if name is not None and name in named:
            nullness.note_passed(ctx, (frame, name), expr, named[name], caller)


def bind_parameters(ctx: Interpreter, frame: Frame, closure: Obj, arguments: Arguments) -> None:
    """Bind arguments to parameters."""
    plain, named = list(arguments[0]), dict(arguments[1])
    rest, mapping = named.pop("*", None), named.pop("**", None)
    frame.arguments = [*plain, *named.values()]
    for parameter in frame.function.parameters:
        if parameter.kind == "star":
            obj = recency.allocate(ctx, "sequence", frame, ("rest", parameter.name))
            for number, value in enumerate(plain):
                ctx.store.put((obj, item_field(number)), value)
            if rest is not None:
                updates.add_element(ctx, pointer(obj), rest)
            value, plain = pointer(obj), []
        elif parameter.kind == "mapping":
            obj = recency.allocate(ctx, "mapping", frame, ("rest", parameter.name))
            for name, value in named.items():
                ctx.store.put((obj, item_field(name)), value)
            if mapping is not None:
                sizes.absorb(ctx, obj, mapping)
            value, named = pointer(obj), {}
        elif parameter.kind == "plain" and plain:
            value = plain.pop(0)
        elif parameter.name in named:
            value = named.pop(parameter.name)
        else:
            value = _missing(ctx, parameter, closure, rest, mapping)
            if value is UNKNOWN and frame.caller is not None and frame.caller.statement is None:
                value = annotated.handed(ctx, frame, parameter.name)
        ctx.store.put((frame, parameter.name), value)


def _missing(
    ctx: Interpreter, parameter: ir.Parameter, closure: Obj, rest: Value | None, mapping: Value | None
) -> Value:
    """Return the value of a parameter without a named argument: its default, or from `*` or `**`."""
    value = ctx.store.get((closure, parameter.name)) if parameter.default is not None else None
    result = BOTTOM if value is None else value
    if rest is not None and parameter.kind == "plain":
        result = join(result, rest)
    if mapping is not None:
        for obj in mapping.objects:
            stored = ctx.store.get((obj, item_field(parameter.name)))
            result = join(result, heap.arrive(ctx, stored or heap.content(ctx, obj), mapping.deps))
    return result if result is not BOTTOM else UNKNOWN


def instantiate(ctx: Interpreter, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
    """Create an instance, by `__new__` if the class has one, and call its `__init__`."""
    ctx.made.add(cls.key)
    for owner in lineage(cls):
        new = ctx.store.get((owner, "__new__"))
        if new is not None:
            plain, named = arguments
            made = ctx.ops.call_value(ctx, new, ([pointer(cls), *plain], named), frame, call)
            for obj in made.objects:
                if obj.kind == "instance" and obj.info is cls:
                    _initialise(ctx, obj, cls, arguments, frame, call)
            return made
    obj = blank_instance(ctx, cls, frame, call)
    _initialise(ctx, obj, cls, arguments, frame, call)
    return certain_pointer(obj)


def blank_instance(ctx: Interpreter, cls: Obj, frame: Frame, call: ir.Call) -> Obj:
    """Return a new instance without fields, like `object.__new__`."""
    statement = frame.statement.id if frame.statement is not None else -1
    site = generations.site_of(cls, frame, call)
    former = generations.last_of_line(ctx, site, frame)
    if former is not None:
        return former
    obj = recency.intern(ctx, "instance", (frame.id, statement, call.slot, cls.key, *frame.turn), cls.name)
    obj.info = cls
    generations.note(ctx, obj, site, frame)
    recency.renew(ctx, obj, frame)
    if ctx.looked_up:
        library_instances.note(ctx, obj, cls)
    return obj


def _initialise(
    ctx: Interpreter, obj: Obj, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call
) -> None:
    init = heap.through_class(ctx, obj, cls, "__init__")
    if init is None:
        ctx.ops.fill(ctx, obj, cls, arguments, frame, call)
        return
    ctx.building.append((obj, len(ctx.stack)))
    ctx.ops.call_value(ctx, init, arguments, frame, call)
    ctx.building.pop()


def _handed(frame: Frame) -> list[Obj]:
    """Return the objects that a function hands to its caller: those that it yields or raises."""
    raised = (o for escape in frame.escapes for o in escape.value.pts)
    return [*frame.yielded.pts, *raised]


def carries(ctx: Interpreter, arguments: Arguments) -> bool:
    """Return whether any argument carries data."""
    plain, named = arguments
    for value in (*plain, *named.values()):
        ctx.look(value.pts)
    return any(v.deps or any(o.laden for o in v.pts) for v in (*plain, *named.values()))


def _receiver(value: Value) -> bool:
    """Return whether an argument is an instance or class of the analysed files, and therefore needs no node."""
    return bool(value.pts) and not value.deps and all(o.kind in ("instance", "class") for o in value.pts)
