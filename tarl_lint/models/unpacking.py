"""Unpacking with a star, and iteration over analysed objects."""

from __future__ import annotations

from tarl_lint.interpret import calls, expressions
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, reachable_data, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import BOTTOM, Obj, Value, const, join, join_all, pointer
from tarl_lint.models import library_functions, sizes

ITERATED = -2  # slot of the calls of `__iter__` and `__next__` made by a loop
NEXT = -3
NEXT_METHODS = ("__next__", "__anext__")


ITERATING = frozenset(
    f"builtins.{name}"
    for name in (
        "list", "tuple", "set", "frozenset", "sorted", "iter", "sum", "min", "max", "any", "all", "enumerate", "zip",
        "map", "filter",
    )
) | {"collections.deque", "numpy.array", "numpy.asarray"}  # fmt: skip


def call_library(
    ctx: Interpreter, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> Value:
    """Call a library function or class; a function that iterates over analysed objects calls their iterators."""
    if qualified in ITERATING:
        arguments = [_gone_over(ctx, v, frame, call) for v in arguments[0]], arguments[1]
    return library_functions.call_library(ctx, qualified, arguments, frame, call)


def _gone_over(ctx: Interpreter, value: Value, frame: Frame, call: ir.Call) -> Value:
    if not any(o.kind == "instance" and _iterator(ctx, o) is not BOTTOM for o in value.pts):
        return value
    given = iterated(ctx, value, ir.Const(None, call.pos), frame)
    return listed_parts(ctx, given, frame, f"{call.slot}")


def parts(
    ctx: Interpreter, value: Value, count: int, starred: int | None, frame: Frame, slot: str
) -> list[Value]:
    """Return the values of several targets of an assignment; a target with a star gets a sequence."""
    if any(o.kind == "instance" and _iterator(ctx, o) is not BOTTOM for o in value.pts):
        given = iterated(ctx, value, ir.Const(None, frame.function.pos), frame)
        value = listed_parts(ctx, given, frame, slot)
    if starred is None:
        return [expressions.read_item(ctx, value, const(n)) for n in range(count)]
    after = count - starred - 1
    if ways := sizes.each_unpacked(ctx, value, count - 1):
        middle = {obj: way[starred : len(way) - after] for obj, way in ways.items()}
        places = [*range(starred), *range(starred - count + 1, 0)]
        single = [join_all(way[place] for way in ways.values()) for place in places]
        return [*single[:starred], sizes.rests(ctx, middle, frame, slot), *single[starred:]]
    rest = recency.allocate(ctx, "sequence", frame, ("rest", slot))
    known = sizes.unpacked(ctx, value)
    if known is None or len(known) < count - 1:
        element = heap.elements(ctx, value)
        updates.add_element(ctx, pointer(rest), element)
        first = [expressions.read_item(ctx, value, const(n)) for n in range(starred)]
        return [*first, pointer(rest), *([element] * after)]
    end = len(known) - after
    for number, part in enumerate(known[starred:end]):
        ctx.store.put((rest, item_field(number)), part)
    return [*known[:starred], pointer(rest), *known[end:]]


def place(number: int, count: int, starred: int | None) -> int:
    """Return the index of the element that one of several targets gets; from the end for a target after a star."""
    return number if starred is None or number < starred else number - count


def listed_parts(ctx: Interpreter, element: Value, frame: Frame, slot: str) -> Value:
    """Return a sequence of the values that an analysed object yields."""
    obj = recency.allocate(ctx, "sequence", frame, ("parts", slot))
    updates.add_element(ctx, pointer(obj), element)
    return pointer(obj, element.deps)


def iterated(ctx: Interpreter, source: Value, expr: ir.Expr, frame: Frame) -> Value:
    """Return the value of a loop's target; calls the iterators of analysed objects."""
    ours = {o: m for o in source.pts if o.kind == "instance" and (m := _iterator(ctx, o)) is not BOTTOM}
    if not ours:
        return heap.elements(ctx, source)
    rest = source.pts - frozenset(ours)
    result = heap.elements(ctx, Value(source.deps, rest)) if rest or source.deps else BOTTOM
    for obj, method in sorted(ours.items(), key=lambda item: str(item[0].key)):
        made = calls.call_value(ctx, method, ([], {}), frame, ir.Call(expr, (), (), expr.pos, ITERATED))
        for iterator in sorted(made.pts, key=lambda o: str(o.key)):
            following = BOTTOM
            for name in NEXT_METHODS if iterator.kind == "instance" else ():
                following = join(following, _method(ctx, iterator, name))
            if following is BOTTOM:
                result = join(result, heap.elements(ctx, Value(made.deps, frozenset([iterator]))))
            else:
                call = ir.Call(expr, (), (), expr.pos, NEXT)
                result = join(result, calls.call_value(ctx, following, ([], {}), frame, call))
        if not made.pts:
            result = join(result, Value(reachable_data.deep(ctx, frozenset([obj]))))
    return result


def blocks(ctx: Interpreter, source: Value) -> bool:
    """Return whether iteration may wait for the next element, since an analysed object yields it."""
    return any(o.kind == "instance" and _iterator(ctx, o) is not BOTTOM for o in source.pts)


def _iterator(ctx: Interpreter, obj: Obj) -> Value:
    return join(_method(ctx, obj, "__iter__"), _method(ctx, obj, "__aiter__"))


def _method(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return an analysed method; BOTTOM if there is none."""
    member = heap.read_field(ctx, obj, name)
    callables = frozenset(o for o in member.pts if o.kind in CALLABLE)
    return Value(member.deps, callables) if callables else BOTTOM
