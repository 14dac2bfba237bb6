"""Transfer functions of calls: find the callees, evaluate arguments, join results."""

from __future__ import annotations

from tarl_lint.interpret import call_contexts, descriptors, expressions, literals, operators, single_dispatch
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import enumerations, heap, joins
from tarl_lint.memory.frames import Frame, Spared
from tarl_lint.memory.values import (
    BOTTOM,
    NO_CONSTANTS,
    NONE,
    Nodes,
    Obj,
    Value,
    in_order,
    join,
    join_all,
    pointer,
)
from tarl_lint.models import sizes

OURS = frozenset(["closure", "bound", "class"])  # kinds of callables of the analysed files
# maximum number of library objects whose method is called for each object; more objects count as one receiver
MAX_ALIKE = 12


def call(ctx: Interpreter, expr: ir.Call, frame: Frame) -> Value:
    """Evaluate a call expression."""
    if isinstance(expr.function, ir.Attribute):
        base = expressions.evaluate(ctx, expr.function.base, frame)
        spreads = _ends_with_star(expr) and _has_methods(ctx, base, expr.function.name)
        return _call_attribute(ctx, expr, expr.function, base, arguments(ctx, expr, frame, spreads), frame)
    function = expressions.evaluate(ctx, expr.function, frame)
    spreads = _ends_with_star(expr) and bool(function.pts) and all(o.kind in OURS for o in function.pts)
    return call_value(ctx, function, arguments(ctx, expr, frame, spreads), frame, expr)


def _ends_with_star(expr: ir.Call) -> bool:
    return bool(expr.arguments) and isinstance(expr.arguments[-1], ir.Starred)


def _has_methods(ctx: Interpreter, base: Value, name: str) -> bool:
    """Return whether all possible objects have an analysed method of this name."""
    held = [heap.read_field(ctx, obj, name) for obj in base.objects if obj.kind != "ext"]
    return len(held) == len(base.pts) > 0 and all(v.pts and all(o.kind in OURS for o in v.pts) for v in held)


def arguments(ctx: Interpreter, expr: ir.Call, frame: Frame, spreads: bool = False) -> Arguments:
    """Evaluate arguments. The keywords `*` and `**` hold unpacked arguments whose number or names are unknown.

    If `spreads` is True, an analysed function gets `*values` as last argument. If this is one of several sequences,
    the first arguments are known, and only the rest is under `*`.
    """
    plain: list[Value] = []
    named: dict[str, Value] = {}
    for argument in expr.arguments:
        value = expressions.evaluate(ctx, argument, frame)
        if isinstance(argument, ir.Starred):
            known = one_by_one(ctx, value)
            if len(value.pts) > 1 or frame.spread:
                frame.spread[expr.slot] = value
            last = spreads and known is None and argument is expr.arguments[-1]
            if last and (ways := sizes.each_unpacked(ctx, value)):
                least = min(map(len, ways.values()))
                plain.extend(join_all(way[n] for way in ways.values()) for n in range(least))
                more = join_all(one for way in ways.values() for one in way[least:])
                named["*"] = join(named.get("*", BOTTOM), more)
            elif known is None:
                named["*"] = join(named.get("*", BOTTOM), heap.elements(ctx, value))
            else:
                plain.extend(known)
        else:
            plain.append(value)
    for name, argument in expr.keywords:
        value = expressions.evaluate(ctx, argument, frame)
        if name is None:
            named["**"] = join(named.get("**", BOTTOM), value)
        else:
            named[name] = _noted(ctx, expr, name, argument, value, frame)
    return plain, named


def _noted(
    ctx: Interpreter, expr: ir.Call, name: str, argument: ir.Expr, value: Value, frame: Frame
) -> Value:
    """Give a number passed by keyword its own node, so that queries find it in the new object."""
    if not ctx.thorough:
        return value
    return literals.entry(ctx, argument, value, frame, ("keyword", expr.slot, name))


def one_by_one(ctx: Interpreter, value: Value) -> list[Value] | None:
    """Return the arguments of `*value`, joined over the possible sequences; None if these have different lengths."""
    ways = [sizes.unpacked(ctx, Value(value.deps, frozenset([o]))) for o in value.objects]
    lengths = {-1 if way is None else len(way) for way in ways}
    if -1 in lengths or len(lengths) != 1:
        return None
    return [join_all(parts) for parts in zip(*(way for way in ways if way is not None), strict=True)]


def _call_attribute(
    ctx: Interpreter, expr: ir.Call, function: ir.Attribute, base: Value, arguments: Arguments, frame: Frame
) -> Value:
    """Call a method of every possible receiver."""
    if ctx.nothing_yet(base):
        return BOTTOM
    if function.name in heap.METHODS_OF["publisher"]:
        base = ctx.ops.receiver(ctx, base)
    if not base.pts:
        return ctx.ops.call_method(ctx, base, None, function.name, arguments, frame, expr)
    targets: list[tuple[Obj, Value]] = []
    for obj in base.objects:
        member = heap.read_field(ctx, obj, function.name) if obj.kind != "ext" else BOTTOM
        targets.append((obj, member))
    if len(targets) == 1:
        return _call_member(ctx, base, *targets[0], function.name, arguments, frame, expr)
    result, deltas = BOTTOM, []
    guard = operators.guard(ctx, base.deps, frame, ("dispatch", expr.slot))
    alike = frozenset(o for o, m in targets if o.kind == "lib" and not _held_by(ctx, o, m, function.name))
    if len(alike) > MAX_ALIKE:
        targets = [(o, m) for o, m in targets if o not in alike]
    for number, (obj, member) in enumerate(targets):
        ctx.store.push()
        ctx.guards.append((guard, str(number)))
        ctx.spared = _spared(function.base, base, obj, frame)
        value = _call_member(ctx, base, obj, member, function.name, arguments, frame, expr)
        ctx.spared = frozenset()
        ctx.guards.pop()
        result = join(result, value)
        deltas.append(ctx.store.pop())
    if len(alike) > MAX_ALIKE:
        ctx.store.push()
        receivers = Value(base.deps, alike)
        first = in_order(alike)[0]
        result = join(
            result, ctx.ops.call_method(ctx, receivers, first, function.name, arguments, frame, expr)
        )
        deltas.append(ctx.store.pop())
    joins.merge(ctx, deltas)
    return result


def _spared(receiver: ir.Expr, value: Value, obj: Obj, frame: Frame) -> Spared:
    """Return the decisions about a call that are none if the receiver, a variable, is a certain object."""
    if not isinstance(receiver, ir.Name) or not frame.settled:
        return frozenset()
    known = frame.settled.get((expressions.holder(receiver, frame), receiver.name), ())
    found = (one.spared for one in known if one.value is value and obj in one.objects)
    return frozenset[tuple[int, bool]]().union(*found)


def _call_member(
    ctx: Interpreter,
    base: Value,
    obj: Obj,
    member: Value,
    name: str,
    arguments: Arguments,
    frame: Frame,
    expr: ir.Call,
) -> Value:
    if obj.kind == "ext":
        return ctx.ops.call_library(ctx, f"{obj.name}.{name}", arguments, frame, expr)
    callables = _held_by(ctx, obj, member, name)
    if obj.kind == "instance" and not member.pts and not _of_namespace(expr.function):
        found = descriptors.computed(ctx, Value(base.deps, frozenset([obj])), name, frame, expr.function.pos)
        if found is not None:
            return call_value(ctx, found, arguments, frame, expr)
    if len(callables) == 1 and (method := next(iter(callables))).kind == "bound":
        return call_object(ctx, method, arguments, frame, expr, base.deps)
    if callables:
        return call_value(ctx, Value(member.deps, callables), arguments, frame, expr)
    if obj.kind == "instance" and (made := made_by_library(ctx, obj, name)).pts:
        return call_value(ctx, heap.arrive(ctx, made, base.deps), arguments, frame, expr)
    return ctx.ops.call_method(ctx, Value(base.deps, frozenset([obj])), obj, name, arguments, frame, expr)


def _of_namespace(method: ir.Expr) -> bool:
    """Return whether an expression is a method of `x.__dict__` or `vars(x)`, which the object itself represents."""
    base = method.base if isinstance(method, ir.Attribute) else method
    if isinstance(base, ir.Call):
        return isinstance(base.function, ir.Name) and base.function.name == "vars"
    return isinstance(base, ir.Attribute) and base.name == "__dict__"


def made_by_library(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return the library objects stored in an attribute; calling the attribute calls these objects."""
    stored = ctx.store.get((obj, name))
    pts = frozenset(o for o in stored.pts if o.kind == "lib") if stored is not None else frozenset[Obj]()
    return Value(stored.deps if stored is not None else NONE, pts)


def _held_by(ctx: Interpreter, obj: Obj, member: Value, name: str) -> frozenset[Obj]:
    """Return the callables stored in an attribute. The object's own library methods are left out."""
    return frozenset(o for o in member.pts if callable_held(ctx, o) and o.info != (obj, name))


def callable_held(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether an attribute's object is callable: a function, or an instance with `__call__`."""
    if obj.kind == "instance":
        return any(o.kind in CALLABLE for o in heap.read_field(ctx, obj, "__call__").pts)
    return obj.kind in CALLABLE


def call_value(
    ctx: Interpreter,
    function: Value,
    arguments: Arguments,
    frame: Frame,
    call: ir.Call,
    carriers: Nodes = NONE,
) -> Value:
    """Call every object that a value may be. The result of an unknown callee depends on its arguments.

    `carriers` are the nodes through which the receiver of a method arrived.
    """
    targets = function.objects
    if ctx.nothing_yet(function):
        return BOTTOM
    if not targets:
        return Value(function.deps | call_contexts.all_used(ctx, arguments))
    decides = function.deps
    if len(targets) > 1 and ctx.dispatches:
        targets = single_dispatch.chosen(ctx, targets, arguments)
        decides |= single_dispatch.decides(ctx, targets, arguments)
    if len(targets) == 1:
        return call_object(ctx, targets[0], arguments, frame, call, carriers)
    result, deltas = BOTTOM, []
    guard = operators.guard(ctx, decides, frame, ("dispatch", call.slot))
    for number, target in enumerate(targets):
        ctx.store.push()
        ctx.guards.append((guard, str(number)))
        result = join(result, call_object(ctx, target, arguments, frame, call, carriers))
        ctx.guards.pop()
        deltas.append(ctx.store.pop())
    joins.merge(ctx, deltas)
    return result


def _converted(ctx: Interpreter, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
    """Return the result of `Phase(msg.data)`, a call of an enumeration.

    The data decide which member the result is, and whether there is one.
    """
    given = arguments[0]
    if len(given) == 1 and (known := enumerations.with_value(ctx, cls, given[0])) is not None:
        return known
    made = call_contexts.instantiate(ctx, cls, arguments, frame, call)
    decides = call_contexts.all_used(ctx, arguments)
    if decides:
        ctx.ops.may_fail(ctx, decides, "ValueError", frame)
    return Value(made.deps | decides, made.pts, made.consts)


def call_object(
    ctx: Interpreter, target: Obj, arguments: Arguments, frame: Frame, call: ir.Call, carriers: Nodes = NONE
) -> Value:
    """Call one object; `carriers` are the nodes through which a method's receiver arrived."""
    kind = target.kind
    if kind in ("partial", "weak"):
        ctx.store.reads.look(target)
    if qualified := ctx.ops.named_by_settings(ctx, target):
        return ctx.ops.call_library(ctx, qualified, arguments, frame, call)
    if kind == "closure":
        return call_contexts.invoke(ctx, target, arguments, frame, call)
    if kind == "bound" and isinstance(target.info, tuple):
        closure, receiver, owner = target.info
        plain, named = arguments
        return call_contexts.invoke(
            ctx,
            closure,
            ([Value(carriers, frozenset([receiver]), NO_CONSTANTS), *plain], named),
            frame,
            call,
            owner,
        )
    if kind == "class":
        make = _converted if enumerations.enumerates(target) else call_contexts.instantiate
        return make(ctx, target, arguments, frame, call)
    if kind == "ext":
        return ctx.ops.call_library(ctx, target.name, arguments, frame, call)
    if kind == "partial" and isinstance(target.info, tuple):
        function, plain, named = target.info[:3]
        return call_value(ctx, function, ([*plain, *arguments[0]], {**named, **arguments[1]}), frame, call)
    if kind == "method" and isinstance(target.info, tuple):
        owner, name = target.info
        return ctx.ops.call_method(ctx, pointer(owner), owner, name, arguments, frame, call)
    if kind == "weak" and isinstance(target.info, Value):
        return target.info
    if kind == "instance":
        member = heap.read_field(ctx, target, "__call__")
        if any(o.kind in CALLABLE for o in member.pts):
            return call_value(ctx, member, arguments, frame, call)
    return ctx.ops.call_method(ctx, pointer(target), target, "__call__", arguments, frame, call)
