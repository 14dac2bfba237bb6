"""Models of iterators: zip, enumerate, map, filter and others, and their sequences."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace
from functools import partial

from tarl_lint.interpret import calls, operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import LENGTH, item_field
from tarl_lint.memory.values import NONE, UNKNOWN, Nodes, Value, const, in_order, join_all, pointer
from tarl_lint.models import rows as possible_rows
from tarl_lint.models import sizes

COMPARED = frozenset(["sequence", "mapping", "instance"])  # kinds of objects that consist of what is compared
ENTRY = (
    "entry"  # name of the pair of a key and its value; keys differ, so comparisons do not reach the values
)
UNORDERED = "<unordered>"  # field of a sorted list: its elements without what decided their order
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
        length = gate(
            ctx, length, it.frame, ("zipped", it.call.slot)
        )  # the other sequence only ends it early
    if counting and given and (several := possible_rows.of(ctx, given[0])):
        return rows_in_any_order(ctx, [(UNKNOWN, one) for one in several], it, length)
    parts = [heap.elements(ctx, v) for v in given]
    return pairs(ctx, [UNKNOWN, *parts] if counting else parts, it.frame, it.call, length)


def _numbers(it: Invocation, count: int) -> list[Value] | None:
    """Return the numbers of the elements of `enumerate`; None if the first one is not known."""
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
    """Return a sequence of tuples of which neither the order nor the presence of each is certain."""
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
    """Return an element of an iterator; with a default, whether there is one decides."""
    plain = it.arguments[0]
    element = heap.elements(ctx, plain[0])
    if len(plain) == 1:
        return element
    decides = gate(ctx, sizes.length(ctx, plain[0]), it.frame, ("next", it.call.slot))
    return join_all([element, plain[1], Value(decides)])


def ordered(ctx: Interpreter, elements: Value, it: Invocation) -> Value:
    """Return elements that a call chooses or sorts: what it compares decides which one is where.

    What it compares are the results of `key=`, or else the data inside elements that are containers or instances. The
    results are not data of the elements, just as the condition of an `if` is not data of what it chooses.
    """
    key = it.arguments[1].get("key")
    if key is None or key.consts:
        inside = frozenset(o for o in elements.pts if o.kind in COMPARED)
        entries = [o for o in in_order(inside) if o.name == ENTRY]
        keys = (ctx.use(heap.read_field(ctx, o, item_field(0))) for o in entries)
        compared = ctx.use(Value(pts=inside.difference(entries))).union(*keys)
        return _decided(ctx, elements, compared, it)
    return _decided(ctx, elements, ctx.use(_key(ctx, key, elements, it)), it)


def _key(ctx: Interpreter, key: Value, elements: Value, it: Invocation) -> Value:
    """Return what a key function returns for an element."""
    if not elements.deps | elements.pts | key.pts:
        return UNKNOWN
    return calls.call_value(ctx, key, ([elements], {}), it.frame, it.call)


def _decided(ctx: Interpreter, elements: Value, compared: Nodes, it: Invocation) -> Value:
    decides = gate(ctx, compared, it.frame, ("ordered", it.call.slot))
    return Value(elements.deps | decides, elements.pts, elements.consts) if decides else elements


def first_elements(ctx: Interpreter, it: Invocation) -> Value:
    """Return the list that `heapq.nlargest` and `heapq.nsmallest` make."""
    plain = it.arguments[0]
    if len(plain) < 2:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    element = ordered(ctx, heap.elements(ctx, plain[1]), it)
    return listed(ctx, element, sizes.length(ctx, plain[1]) | ctx.use(plain[0]), it)


def grouped(ctx: Interpreter, it: Invocation) -> Value:
    """Return the pairs of `itertools.groupby`: what the key function returns, and the elements that it selects."""
    plain, named = it.arguments
    if not plain:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    element, length = heap.elements(ctx, plain[0]), sizes.length(ctx, plain[0])
    key = plain[1] if len(plain) > 1 else named.get("key", const(None))
    found = element if key.consts else _key(ctx, key, element, it)
    compared = ctx.use(found)
    if (unordered := _unordered(ctx, plain[0], element)) is not None:
        # a list that is sorted for the groups: its order does not decide how many there are
        again = replace(it, call=it.call.inner())
        compared = ctx.use(unordered if key.consts else _key(ctx, key, unordered, again))
    group = listed(ctx, _decided(ctx, element, compared, it), length | compared, it)
    return pairs(ctx, [found, group], it.frame, it.call, length | compared)


def _unordered(ctx: Interpreter, value: Value, element: Value) -> Value | None:
    """Return the elements of sorted lists without what decided their order; None if other lists are among them.

    The elements differ from these by the node of this decision only, unless something was added to a list later.
    """
    held = [ctx.store.get((o, UNORDERED)) for o in value.objects]
    known = [heap.arrive(ctx, one, value.deps) for one in held if one is not None]
    if not known or len(known) < len(held):
        return None
    before = join_all(known)
    return before if before.pts == element.pts and len(element.deps - before.deps) == len(known) else None


def asked(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `bool(x)`, `any(xs)` or `all(xs)`; whether an object exists is not data."""
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
