"""Callables passed to libraries: their results can be part of the library's results, now or later."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence, Set
from typing import Final

from tarl_lint.interpret import call_contexts, calls
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, joins, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import HELD
from tarl_lint.memory.values import BOTTOM, NONE, ClassInfo, Nodes, Obj, Value, in_order, join
from tarl_lint.models import containers
from tarl_lint.models.smach import LATER
from tarl_lint.trees import walk

# maximum depth to which nested mappings and sequences, such as the constraints of a solver, are searched for callables
MAX_INSIDE: Final = 3
# number of slots for the callables of one call; these slots differ from the slots of calls in the code
KEPT_APART: Final = 500
INSIDE: Final = ("sequence", "mapping")  # kinds of objects in which callables are searched
# attribute of a handler in which libraries store the server that made the handler
SERVER: Final = "server"


def call_back(ctx: Interpreter, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
    """Let a library call a function among its arguments at any time, with the arguments that follow the function."""
    plain, named = arguments
    for number, value in enumerate(plain):
        for target in value.objects if value.pts else ():
            if target.kind == "method":
                calls.call_object(ctx, target, (plain[number + 1 :], {}), frame, call)
            elif target.kind in LATER:
                passed = call_contexts.pass_arguments(ctx, (plain[number + 1 :], {}), frame, call)[0]
                ctx.ops.call_later(ctx, target, passed)
    for value in named.values():
        for target in value.objects:
            if target.kind in LATER:
                opaque = _opaque(ctx, arguments, BOTTOM)
                ctx.ops.call_later(ctx, target, _wanted(ctx, target, opaque)[0] if opaque.deps else ())
    for target in _nested(ctx, (*plain, *named.values())):
        ctx.ops.call_later(ctx, target, ())


def _nested(ctx: Interpreter, values: Iterable[Value]) -> list[Obj]:
    """Return the functions inside containers, such as a list of tools."""
    inner = [
        containers.elements_of_any(ctx, _only(o))
        for v in values
        if v.pts
        for o in v.objects
        if o.kind in INSIDE
    ]
    return [o for o in _callables(ctx, inner, MAX_INSIDE - 1) if o.kind in LATER]


def notify(ctx: Interpreter, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
    """Let a library object call the observers that it gets, with its present and later data.

    The object itself represents this data.
    """
    for target in (o for value in arguments[0] for o in value.objects):
        if target.kind == "method" and (deps := ctx.use(base)):
            calls.call_object(ctx, target, ([Value(deps)], {}), frame, call)
        elif target.kind in LATER:
            ctx.ops.call_later(ctx, target, _wanted(ctx, target, base)[0])


def make_instances(
    ctx: Interpreter, arguments: Arguments, server: Value, frame: Frame, call: ir.Call
) -> None:
    """Let an object of a library make instances of the analysed classes passed to it, as servers make handlers.

    The library calls their methods. The base classes of handlers store the object in the attribute `server`.
    """
    for value in (*arguments[0], *arguments[1].values()):
        for cls in value.objects:
            if cls.kind == "class" and isinstance(cls.info, ClassInfo) and cls.info.opaque:
                inner = call.inner_bare()
                made = calls.call_object(ctx, cls, ([], {}), frame, inner)
                updates.write_field(ctx, made, SERVER, server)


def answering(ctx: Interpreter, arguments: Arguments) -> list[Obj]:
    """Return those callables among the arguments, and in containers among them, that return a value."""
    plain, named = arguments
    return [o for o in _callables(ctx, (*plain, *named.values()), MAX_INSIDE) if _answers(ctx, o)]


def _callables(ctx: Interpreter, values: Iterable[Value], depth: int) -> list[Obj]:
    found: dict[Obj, None] = {}
    for value in values:
        for obj in value.objects if value.pts else ():
            if obj.kind in LATER or (obj.kind == "instance" and _functor(ctx, obj)):
                found[obj] = None
            elif obj.kind in INSIDE and depth:
                found.update(
                    dict.fromkeys(_callables(ctx, [containers.elements_of_any(ctx, _only(obj))], depth - 1))
                )
    return list(found)


def _functor(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether an instance of an analysed class is callable."""
    return any(o.kind in CALLABLE for o in heap.read_field(ctx, obj, "__call__").pts)


def _answers(ctx: Interpreter, obj: Obj) -> bool:
    function, _ = _behind_callable(ctx, obj)
    return function is not None and answers(function)


def _behind_callable(ctx: Interpreter, obj: Obj) -> tuple[ir.Function | None, int]:
    """Return the function of a callable, and the number of its parameters that are bound already."""
    given = 0
    while True:
        if obj.kind == "partial" and isinstance(obj.info, tuple):
            ctx.store.reads.look(obj)
            given += len(obj.info[1])
            inner = obj.info[0].pts
        elif obj.kind == "instance":
            inner = frozenset(o for o in heap.read_field(ctx, obj, "__call__").pts if o.kind in CALLABLE)
        elif obj.kind == "bound" and isinstance(obj.info, tuple):
            given += 1
            inner = frozenset([obj.info[0]])
        elif obj.kind == "closure" and isinstance(obj.info, tuple):
            return obj.info[0], given
        else:
            return None, given
        if len(inner) != 1:
            return None, given
        (obj,) = inner


def returned(
    ctx: Interpreter, targets: Sequence[Obj], arguments: Arguments, base: Value, frame: Frame, call: ir.Call
) -> Nodes:
    """Return the data of the values that callables return when a library calls them.

    The library may pass them anything that it computes from its own arguments.
    """
    found = NONE
    opaque = _opaque(ctx, arguments, base, frozenset(targets)) if targets else BOTTOM
    for number, target in enumerate(targets[:KEPT_APART]):
        inner = call.inner_bare(KEPT_APART + number)
        ctx.store.push()
        said = calls.call_object(ctx, target, _wanted(ctx, target, opaque), frame, inner)
        found |= ctx.use(said)
        joins.merge(ctx, [ctx.store.pop(), {}])
    return found


def _opaque(ctx: Interpreter, arguments: Arguments, base: Value, called: Set[Obj] = frozenset()) -> Value:
    """Return what a library may pass to a callable: all arguments' data and any object in them.

    If the library calls an instance, this instance is left out, since it is the callee and not an argument.
    """
    plain, named = arguments
    objects: set[Obj] = set()
    for value in (*plain, *named.values()):
        for obj in value.objects:
            if obj.kind in ("sequence", "mapping"):
                objects |= containers.elements_of_any(ctx, _only(obj)).pts
            else:
                objects.add(obj)
    parts = frozenset(o for o in objects - called if o.kind in ("message", "instance", "lib"))
    return Value(call_contexts.all_used(ctx, arguments) | ctx.use(base), parts)


def _wanted(ctx: Interpreter, target: Obj, opaque: Value) -> Arguments:
    """Return arguments for the required parameters of a callable."""
    function, given = _behind_callable(ctx, target)
    fixed = target.info[2] if target.kind == "partial" and isinstance(target.info, tuple) else {}
    if function is None:
        return [], {}
    left = [p for p in function.parameters if p.kind == "plain"][given:]
    left += [p for p in function.parameters if p.kind in ("star", "keyword")]
    asked = [p for p in left if p.default is None and p.name not in fixed]
    plain = [opaque for p in asked if p.kind == "plain"]
    if not plain and any(p.kind == "star" for p in asked):
        plain.append(opaque)
    return plain, {p.name: opaque for p in asked if p.kind == "keyword"}


def hold(ctx: Interpreter, objects: Iterable[Obj], targets: Sequence[Obj]) -> None:
    """Record the callables passed to library objects, whose methods may call them."""
    for obj in objects:
        if obj.kind == "lib" and targets:
            before = ctx.store.get((obj, HELD)) or BOTTOM
            ctx.store.put((obj, HELD), join(before, Value(pts=frozenset(targets))))


def held_by(ctx: Interpreter, base: Value) -> list[Obj]:
    """Return the callables that were passed to library objects earlier, or that a decorator of a library replaced."""
    found = [v for o in base.pts if o.kind == "lib" and (v := ctx.store.get((o, HELD))) is not None]
    return in_order(frozenset(o for v in found for o in v.pts) | (base.pts & ctx.handed_over))


def answers(function: ir.Function) -> bool:
    """Return whether a function returns or yields anything but None."""
    if function.answers is None:
        node = function.node
        function.answers = isinstance(node, ast.Lambda) or any(
            isinstance(n, (ast.Yield, ast.YieldFrom)) or (isinstance(n, ast.Return) and _something(n.value))
            for n in walk(node)
        )
    return function.answers


def _something(expr: ast.expr | None) -> bool:
    return expr is not None and not (isinstance(expr, ast.Constant) and expr.value is None)


def _only(obj: Obj) -> Value:
    return Value(pts=frozenset([obj]))
