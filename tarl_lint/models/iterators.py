"""Models of iterators: zip, enumerate, map, filter and others, and their sequences."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import partial

from tarl_lint.interpret import calls, operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import LENGTH, item_field
from tarl_lint.memory.values import NONE, UNKNOWN, Nodes, Value, const, join_all, pointer
from tarl_lint.models import rows as possible_rows
from tarl_lint.models import sizes

# functions that select elements by a predicate, as `filter` does
SELECTING = ("itertools.takewhile", "itertools.dropwhile", "itertools.filterfalse")
MAX_MAPPED = 8  # maximum number of elements to which `map` is applied one by one


def listed(ctx: Interpreter, element: Value, length: Nodes, it: Invocation) -> Value:
    """Return a new sequence with one summary element."""
    obj = recency.allocate(ctx, "sequence", it.frame, ("values", it.call.slot))
    updates.add_element(ctx, pointer(obj), element)
    ctx.store.put((obj, LENGTH), Value(length))
    return pointer(obj)


def pairs(ctx: Interpreter, parts: list[Value], frame: Frame, call: ir.Call, length: Nodes) -> Value:
    """Return a sequence of tuples."""
    pair = recency.allocate(ctx, "sequence", frame, ("pair", call.slot))
    for number, part in enumerate(parts):
        ctx.store.put((pair, item_field(number)), part)
    obj = recency.allocate(ctx, "sequence", frame, ("pairs", call.slot))
    updates.add_element(ctx, pointer(obj), pointer(pair))
    ctx.store.put((obj, LENGTH), Value(length))
    return pointer(obj)


def zipped_elements(ctx: Interpreter, it: Invocation) -> Value:
    """Return a sequence of tuples with elements of several sequences."""
    if it.name == "zip" and "*" in it.arguments[1] and not it.arguments[0]:
        return _transposed(ctx, it.arguments[1]["*"], it)
    counting = it.name == "enumerate"
    given = it.arguments[0][:1] if counting else it.arguments[0]
    known = [sizes.unpacked(ctx, v) for v in given]
    if counting and known and known[0] is not None:
        known.insert(0, _numbers(it, len(known[0])))
    rows = list(zip(*(k for k in known if k is not None), strict=False)) if None not in known else []
    if rows and len(rows) <= sizes.MAX_KNOWN:
        return rows_of(ctx, rows, it)
    length = lengths(ctx, given)
    if any(k is not None for k in known):
        # the other sequences only end it early
        length = gate(ctx, length, it.frame, ("zipped", it.call.slot))
    if counting and given and (several := possible_rows.of(ctx, given[0])):
        return rows_in_any_order(ctx, [(UNKNOWN, one) for one in several], it, length)
    parts = [heap.elements(ctx, v) for v in given]
    return pairs(ctx, [UNKNOWN, *parts] if counting else parts, it.frame, it.call, length)


def _numbers(it: Invocation, count: int) -> list[Value] | None:
    """Return the numbers that `enumerate` gives to its elements; None if the first number is not known."""
    plain, named = it.arguments
    known, first = plain[1].constant() if len(plain) > 1 else named.get("start", const(0)).constant()
    return [const(first + n) for n in range(count)] if known and isinstance(first, int) else None


def lengths(ctx: Interpreter, values: Sequence[Value]) -> Nodes:
    """Return the nodes on which the lengths of several values depend."""
    return NONE.union(*map(partial(sizes.length, ctx), values))


def _transposed(ctx: Interpreter, row: Value, it: Invocation) -> Value:
    """Return the value of `zip(*rows)`: one sequence per column."""
    places = calls.one_by_one(ctx, row) or [heap.elements(ctx, row)]
    obj = recency.allocate(ctx, "sequence", it.frame, ("pairs", it.call.slot))
    for number, place in enumerate(places):
        column = recency.allocate(ctx, "sequence", it.frame, ("column", it.call.slot, number))
        updates.add_element(ctx, pointer(column), place)
        if len(places) > 1:
            ctx.store.put((obj, item_field(number)), pointer(column))
        else:
            updates.add_element(ctx, pointer(obj), pointer(column))
    return pointer(obj)


def rows_of(ctx: Interpreter, rows: Sequence[Sequence[Value]], it: Invocation) -> Value:
    """Return a sequence of tuples that are tracked separately."""
    obj = recency.allocate(ctx, "sequence", it.frame, ("pairs", it.call.slot))
    for number, row in enumerate(rows):
        pair = recency.allocate(ctx, "sequence", it.frame, ("pair", it.call.slot, number))
        for place, part in enumerate(row):
            ctx.store.put((pair, item_field(place)), part)
        ctx.store.put((obj, item_field(number)), pointer(pair))
    return pointer(obj)


def rows_in_any_order(
    ctx: Interpreter, rows: Sequence[Sequence[Value]], it: Invocation, length: Nodes
) -> Value:
    """Return a sequence of tuples; neither their order nor the presence of each tuple is certain."""
    obj = recency.allocate(ctx, "sequence", it.frame, ("pairs", it.call.slot))
    for number, row in enumerate(rows):
        pair = recency.allocate(ctx, "sequence", it.frame, ("pair", it.call.slot, number))
        for place, part in enumerate(row):
            ctx.store.put((pair, item_field(place)), part)
        updates.add_element(ctx, pointer(obj), pointer(pair))
    ctx.store.put((obj, LENGTH), Value(length))
    return pointer(obj)


def _each(ctx: Interpreter, function: Value, rows: Sequence[Sequence[Value]], it: Invocation) -> Value:
    """Return the results of a function for known elements, one by one."""
    obj = recency.allocate(ctx, "sequence", it.frame, ("values", it.call.slot))
    for number, row in enumerate(rows):
        said = calls.call_value(ctx, function, (list(row), {}), it.frame, it.call.inner(number))
        ctx.store.put((obj, item_field(number)), said)
    return pointer(obj)


def mapped_elements(ctx: Interpreter, it: Invocation) -> Value:
    """Return a sequence of the results of a function for each element."""
    function, *rest = it.arguments[0] or [UNKNOWN]
    known = [sizes.unpacked(ctx, v) for v in rest]
    rows = list(zip(*(k for k in known if k is not None), strict=False)) if None not in known else []
    if it.name == "map" and rows and len(rows) <= MAX_MAPPED:
        return _each(ctx, function, rows, it)
    parts = [heap.elements(ctx, v) for v in rest]
    length = lengths(ctx, rest)
    if it.name == "map":
        return listed(ctx, calls.call_value(ctx, function, (parts, {}), it.frame, it.call), length, it)
    kept = join_all(parts)
    asks = kept if function.consts else calls.call_value(ctx, function, (parts, {}), it.frame, it.call)
    decided = gate(
        ctx, operators.truth(ctx, asks, it.frame, ("filter", it.call.slot)), it.frame, it.call.slot
    )
    return listed(ctx, Value(kept.deps | decided, kept.pts, kept.consts), length | decided, it)


def compressed(ctx: Interpreter, it: Invocation) -> Value:
    """Return the elements of the first argument of `itertools.compress` that the second one selects."""
    if len(it.arguments[0]) != 2:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    kept, selectors = it.arguments[0]
    decides = operators.truth(ctx, heap.elements(ctx, selectors), it.frame, ("filter", it.call.slot))
    decided = gate(ctx, decides, it.frame, it.call.slot)
    element = heap.elements(ctx, kept)
    length = lengths(ctx, [kept, selectors]) | decided
    return listed(ctx, Value(element.deps | decided, element.pts, element.consts), length, it)


def star_mapped(ctx: Interpreter, it: Invocation) -> Value:
    """Return the results of a function for each tuple of arguments."""
    if len(it.arguments[0]) != 2:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    function, rows = it.arguments[0]
    row = heap.elements(ctx, rows)
    known = calls.one_by_one(ctx, row)
    given = (known, {}) if known is not None else ([], {"*": heap.elements(ctx, row)})
    return listed(ctx, calls.call_value(ctx, function, given, it.frame, it.call), sizes.length(ctx, rows), it)


def reduced(ctx: Interpreter, it: Invocation) -> Value:
    """Return the result of `functools.reduce`: the function is applied to known elements one by one."""
    plain = it.arguments[0]
    if len(plain) < 2 or it.arguments[1]:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    function, iterable, *start = plain
    known = sizes.unpacked(ctx, iterable)
    if known is None or len(known) > sizes.MAX_KNOWN:
        element = heap.elements(ctx, iterable)
        known = [element, element, element] if start else [element] * 4
    result, *rest = [*start, *known] or [UNKNOWN]
    for number, part in enumerate(rest):
        call = it.call.inner_bare(number)
        result = calls.call_value(ctx, function, ([result, part], {}), it.frame, call)
    return result


def gate(ctx: Interpreter, decides: Nodes, frame: Frame, slot: Hashable) -> Nodes:
    """Return the node that decides which elements a new container gets; empty if no data decides it."""
    if not decides:
        return NONE
    node = ctx.node(frame, ("filter", slot), "condition")
    ctx.graph.depend(node, decides)
    return frozenset([node])


def next_element(ctx: Interpreter, it: Invocation) -> Value:
    """Return an iterator's element; with a default, the existence of an element decides the result."""
    plain = it.arguments[0]
    element = heap.elements(ctx, plain[0])
    if len(plain) == 1:
        return element
    decides = gate(ctx, sizes.length(ctx, plain[0]), it.frame, ("next", it.call.slot))
    return join_all([element, plain[1], Value(decides)])


def asked(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `bool(x)`, `any(xs)` or `all(xs)`. Whether an object exists does not count as data."""
    if not it.arguments[0]:
        return UNKNOWN
    value = it.arguments[0][0]
    known, constant = value.constant()
    if it.name == "bool" and known:
        return Value(value.deps, consts=frozenset([bool(constant)]))
    parts, deps = [value], NONE
    if it.name != "bool":
        each = sizes.unpacked(ctx, value)
        parts = each if each is not None else [heap.elements(ctx, value)]
        deps = value.deps if each is not None else sizes.length(ctx, value)
    for number, part in enumerate(parts):
        deps |= operators.truth(ctx, part, it.frame, (it.name, it.call.slot, number))
    return Value(deps)
