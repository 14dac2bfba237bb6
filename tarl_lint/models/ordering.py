"""Models of functions that compare elements to order, choose or group them: `sorted`, `min`, `groupby` and others."""

from __future__ import annotations

from dataclasses import replace

from tarl_lint.interpret import call_contexts, calls, dunder_methods
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import heap, record_fields
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import NONE, UNKNOWN, Nodes, Obj, Value, const, in_order, join_all, pointer
from tarl_lint.models import sizes
from tarl_lint.models.iterators import gate, listed, pairs

# kinds of objects that consist of the compared values
COMPARED = frozenset(["sequence", "mapping", "instance"])
# name of a pair of a key and its value; comparisons of such pairs never use the values, because all keys are
# different
ENTRY = "entry"
MAX_NESTED = 3  # maximum depth of tuples in tuples whose elements are distinguished in comparisons
SORTED = "PriorityQueue"  # name of a queue that returns its smallest element
UNORDERED = "<unordered>"  # field of a sorted list: the elements, without the values that decided the order


def ordered(ctx: Interpreter, elements: Value, it: Invocation) -> Value:
    """Return elements that a call chooses or sorts; the compared values decide the place of each element.

    The call compares the results of `key=`. Without `key=`, it compares the data inside elements that are
    containers or instances. The results of `key=` are not data of the elements, just as the condition of an `if` is
    not data of the value that it chooses.
    """
    key = it.arguments[1].get("key")
    if key is None or key.consts:
        return _decided(ctx, elements, compared(ctx, elements, it), it)
    return _decided(ctx, elements, ctx.use(_key(ctx, key, elements, it)), it)


def compared(ctx: Interpreter, elements: Value, it: Invocation) -> Nodes:
    """Return the data inside elements that a comparison of the elements uses; numbers themselves are left out."""
    found: Nodes = NONE
    plain: list[Obj] = []
    for obj in in_order(frozenset(o for o in elements.pts if o.kind in COMPARED)):
        if obj.name == ENTRY:
            found |= ctx.use(heap.read_field(ctx, obj, item_field(0)))
        elif obj.kind == "instance" and (used := _of_instance(ctx, obj, elements, it)) is not None:
            found |= used
        elif obj.kind == "sequence":
            found |= _inside(ctx, heap.read_any(ctx, obj), it)
        else:
            plain.append(obj)
    return found | ctx.use(Value(pts=frozenset(plain)))


def _inside(ctx: Interpreter, parts: Value, it: Invocation, depth: int = 0) -> Nodes:
    """Return the data that a comparison of tuples uses.

    Python cannot compare messages and instances without `__lt__`. A program that puts these behind other elements
    of a tuple therefore compares only the other ones.
    """
    found = parts.deps
    for obj in parts.objects:
        if obj.kind == "sequence" and depth < MAX_NESTED:
            found |= _inside(ctx, heap.read_any(ctx, obj), it, depth + 1)
        elif obj.kind == "instance":
            found |= _of_instance(ctx, obj, parts, it) or NONE
        elif obj.kind != "message" or obj.parent is not None:
            found |= ctx.use(pointer(obj))
    return found


def _of_instance(ctx: Interpreter, obj: Obj, elements: Value, it: Invocation) -> Nodes | None:
    """Return the data of an instance's comparison: its own `__lt__`, or a dataclass's fields."""
    said = dunder_methods.special(ctx, pointer(obj), "__lt__", [elements], it.frame, it.call.pos)
    if said is not None:
        return ctx.use(said)
    names = record_fields.compared(ctx, obj.info) if isinstance(obj.info, Obj) else None
    return None if names is None else NONE.union(*(ctx.use(heap.read_field(ctx, obj, n)) for n in names))


def _key(ctx: Interpreter, key: Value, elements: Value, it: Invocation) -> Value:
    """Return the result of a key function for an element."""
    if not elements.deps | elements.pts | key.pts:
        return UNKNOWN
    return calls.call_value(ctx, key, ([elements], {}), it.frame, it.call)


def _decided(ctx: Interpreter, elements: Value, compared: Nodes, it: Invocation) -> Value:
    decides = gate(ctx, compared, it.frame, ("ordered", it.call.slot))
    return Value(elements.deps | decides, elements.pts, elements.consts) if decides else elements


def chosen_element(ctx: Interpreter, it: Invocation) -> Value:
    """Return an element of the arguments, chosen by `key=` or by itself, or perhaps the default."""
    plain, named = it.arguments
    several = [*plain, named["*"]] if "*" in named and plain else plain
    values = [heap.elements(ctx, plain[0])] if len(several) == 1 else several
    if len(several) == 1 and "default" in named:
        empty = gate(ctx, sizes.length(ctx, plain[0]), it.frame, ("default", it.call.slot))
        values += [named["default"], Value(empty)]
    result = ordered(ctx, join_all(values), it)
    if "key" in named:
        return Value(result.deps, result.pts)
    if not any(o.kind in COMPARED for o in result.pts):
        return Value(result.deps | call_contexts.all_used(ctx, it.arguments), result.pts)
    numbers = (Value(v.deps, frozenset(o for o in v.pts if o.kind not in COMPARED)) for v in values)
    return Value(result.deps.union(*(ctx.use(value) for value in numbers)), result.pts)


def first_elements(ctx: Interpreter, it: Invocation) -> Value:
    """Return the list that `heapq.nlargest` and `heapq.nsmallest` make."""
    plain = it.arguments[0]
    if len(plain) < 2:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    element = ordered(ctx, heap.elements(ctx, plain[1]), it)
    return listed(ctx, element, sizes.length(ctx, plain[1]) | ctx.use(plain[0]), it)


def grouped(ctx: Interpreter, it: Invocation) -> Value:
    """Return the pairs of `itertools.groupby`: a result of the key function, and the elements with this result."""
    plain, named = it.arguments
    if not plain:
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    element, length = heap.elements(ctx, plain[0]), sizes.length(ctx, plain[0])
    key = plain[1] if len(plain) > 1 else named.get("key", const(None))
    found = element if key.consts else _key(ctx, key, element, it)
    compared = ctx.use(found)
    if (unordered := _unordered(ctx, plain[0], element)) is not None:
        # the list is sorted only for grouping, so its order does not decide the number of groups
        again = replace(it, call=it.call.inner())
        compared = ctx.use(unordered if key.consts else _key(ctx, key, unordered, again))
    group = listed(ctx, _decided(ctx, element, compared, it), length | compared, it)
    return pairs(ctx, [found, group], it.frame, it.call, length | compared)


def _unordered(ctx: Interpreter, value: Value, element: Value) -> Value | None:
    """Return the elements of sorted lists without the values that decided their order.

    Return None if other lists are among them, or if something was added to a list later. In the second case,
    `element` has more data than the node of the decision that each `sorted` adds.
    """
    held = [ctx.store.get((o, UNORDERED)) for o in value.objects]
    known = [heap.arrive(ctx, one, value.deps) for one in held if one is not None]
    if not known or len(known) < len(held):
        return None
    before = join_all(known)
    return before if before.pts == element.pts and len(element.deps - before.deps) == len(known) else None
