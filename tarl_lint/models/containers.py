"""Models of the standard library's containers."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from tarl_lint import catalog
from tarl_lint.interpret import call_contexts, expressions, generators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY, LENGTH, SENT, item_field
from tarl_lint.memory.values import (
    BOTTOM,
    NONE,
    UNKNOWN,
    Nodes,
    Obj,
    Value,
    const,
    in_order,
    join,
    join_all,
    pointer,
)
from tarl_lint.models import (
    equality,
    iterators,
    launched,
    object_lists,
    ordering,
    removal,
    rows,
    sizes,
    waiting,
)

QUEUES = frozenset(
    f"{module}.{name}"
    for module in ("queue", "Queue", "asyncio", "multiprocessing")
    for name in ("Queue", "LifoQueue", "PriorityQueue", "SimpleQueue", "JoinableQueue")
)
PIPES = ("multiprocessing.Pipe", "trio.open_memory_channel", "anyio.create_memory_object_stream")
PROCESSES = frozenset(["subprocess.Popen", "pexpect.spawn", "pexpect.spawnu"])
STREAMS = frozenset(["stdin", "stdout", "stderr"])
IN_MEMORY = "io."  # beginning of the names of the classes of streams in memory
# beginnings of the names of library classes whose objects record the name of their class
NAMED = (IN_MEMORY, "subprocess.Popen", "pexpect.spawn")
APPENDED = "<appended>"  # field of a list: the length of the list before the first subscriber was appended
MOVING = frozenset(
    ["insert", "appendleft", "extendleft", "sort"]
)  # methods that move the elements of a sequence
# methods that remove every element that is, or is not, in another container
REMOVING_EACH = ("difference_update", "intersection_update")
MISSING = ("ValueError", "KeyError")  # the exceptions of `remove` of a list and a set
FLAGGING = frozenset(["set", "clear"])
IN_ORDER = frozenset(
    ["list", "tuple", "deque", "iter", "reversed"]
)  # functions whose result tracks its elements separately if their argument does
CONTAINERS = frozenset(["list", "tuple", "set", "frozenset", "sorted", "reversed", "iter", "deque"])


def change(ctx: Interpreter, value: Value, news: Value, exprs: Any, frame: Frame) -> None:
    """Add data to an object, or to the variable that holds it if the object is unknown."""
    if value.pts:
        updates.add_element(ctx, value, news)
    elif exprs:
        ctx.ops.assign_fallback(ctx, exprs[0], news, frame)


def mutate(
    ctx: Interpreter, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call
) -> None:
    """Store arguments in the receiver."""
    plain, named = arguments
    if name in FLAGGING and not plain:
        flag(ctx, Invocation(name, base, arguments, frame, call))
    if name in catalog.DEVICE_WRITERS and all(map(is_device, base.pts)):
        _transmit(ctx, base, plain, frame, call)
        return
    _prepare(ctx, base, name, plain, frame, call)
    if name == "clear":
        removal.empty(ctx, base, removal.decision(ctx, frame, call.slot, base=base.deps))
        shorten(ctx, base, frame, call)
    elif name == "setdefault" and len(plain) > 1:
        _set_default(ctx, base, plain[0], through_statement(ctx, plain[1], frame, call))
    elif name == "sort":
        before = heap.elements(ctx, base)
        order = ordering.ordered(ctx, before, Invocation(name, base, arguments, frame, call))
        insert_elements(ctx, base, [order] if order is not before else [], frame, call)
    elif name == "update" and base.pts:
        _update(ctx, base, plain, named, frame, call)
    elif name in ("extend", "extendleft"):
        _extend(ctx, base, name, plain, frame, call)
    elif name == "append":
        _append(ctx, base, plain, frame, call)
    else:
        insert_elements(ctx, base, plain[-1:] if name == "insert" else plain, frame, call)


def _append(ctx: Interpreter, base: Value, plain: list[Value], frame: Frame, call: ir.Call) -> None:
    """Append an element; if the index is known and matters, the element is stored at its own index."""
    place = _next_place(ctx, base, plain, frame)
    if place is not None:
        updates.write_item(ctx, base, const(place), through_statement(ctx, plain[0], frame, call))
    elif not _appended(ctx, base, plain, frame, call):
        if _subscribers(plain):
            _append_subscriber(ctx, base, plain[0], frame, call)
        else:
            insert_elements(ctx, base, plain, frame, call)


def _extend(
    ctx: Interpreter, base: Value, name: str, plain: list[Value], frame: Frame, call: ir.Call
) -> None:
    for obj in base.objects if plain else ():
        sizes.lengthen(ctx, obj, plain[0])
    news = sizes.unpacked(ctx, plain[0]) if plain and name == "extend" else None
    if not news or not _appended(ctx, base, news, frame, call):
        insert_elements(ctx, base, [heap.elements(ctx, v) for v in plain], frame, call)


def _prepare(
    ctx: Interpreter, base: Value, name: str, news: Sequence[Value], frame: Frame, call: ir.Call
) -> None:
    """Prepare containers for a new element: elements of sequences may move, and the length of a set depends on it.

    A set ignores an added element that equals another element.
    """
    decided = removal.decision(ctx, frame, call.slot, base=base.deps) if name in MOVING else None
    added = NONE
    for value in news if name == "add" else ():
        others = join(elements_of_any(ctx, base), value)
        added |= equality.decides(ctx, value, others, frame, call.pos)
    for obj in base.objects if decided is not None or added else ():
        if obj.kind == "sequence" and decided is not None:
            removal.scatter(ctx, obj, decided, shorter=False)
        elif obj.kind == "sequence":
            sizes.decide_length(ctx, obj, added)


def _set_default(ctx: Interpreter, base: Value, index: Value, news: Value) -> None:
    keys = ctx.use(index)
    for obj in base.objects:
        if obj.kind == "mapping" and keys:
            updates.weaken(ctx, obj, heap.KEYS, Value(keys))
        for key in index.item_keys() or (None,):
            field = ANY if key is None else heap.attribute_of_item(obj, key)
            held, field = heap.renamed(ctx, obj, field) if obj.kind in heap.RENAMING else (obj, field)
            updates.weaken(ctx, held, field, news)


def _next_place(ctx: Interpreter, base: Value, values: list[Value], frame: Frame) -> int | None:
    """Return the list index at which an unrolled iteration appends; None if unknown."""
    if len(values) != 1 or frame.statement not in frame.steps:
        return None
    known = sizes.unpacked(ctx, base)
    return len(known) if known is not None and len(known) < sizes.MAX_KNOWN else None


def _appended(ctx: Interpreter, base: Value, news: Sequence[Value], frame: Frame, call: ir.Call) -> bool:
    """Append objects of analysed classes at their own indices. Return whether the indices are known."""
    first = object_lists.place(ctx, base, news)
    if first is None:
        return False
    passed = [through_statement(ctx, value, frame, call, number) for number, value in enumerate(news)]
    object_lists.appended(ctx, base, first, passed)
    return True


def _subscribers(values: list[Value]) -> bool:
    """Return whether the only value is a subscriber of message_filters."""
    return len(values) == 1 and bool(values[0].pts) and all(o.kind == "filter" for o in values[0].pts)


def _append_subscriber(ctx: Interpreter, base: Value, subscriber: Value, frame: Frame, call: ir.Call) -> None:
    """Append a subscriber at its own index.

    The index matters, since a synchroniser passes one message for each subscriber, in this order. If an earlier
    `append` was conditional, its subscriber may be missing; then this subscriber has that index, or a later one.
    """
    known = sizes.unpacked(ctx, base)
    if known is None or len(known) >= sizes.MAX_KNOWN or any(v.pts & subscriber.pts for v in known):
        # the subscriber's index is unknown, for example in a loop
        insert_elements(ctx, base, [subscriber], frame, call)
        return
    (obj,) = base.pts
    news = through_statement(ctx, subscriber, frame, call)
    marked = ctx.store.get((obj, APPENDED))
    lengths = marked.keys() if marked is not None else None
    first = min([length for length in lengths or () if isinstance(length, int)], default=len(known))
    for index in range(first, len(known)):
        updates.weaken(ctx, obj, item_field(index), news)
    updates.weaken(ctx, obj, item_field(len(known)), news)
    ctx.store.put((obj, APPENDED), const(first))


def flag(ctx: Interpreter, it: Invocation) -> None:
    """Set or clear an event, or notify a condition; later queries of the event depend on this call's conditions."""
    events = Value(it.base.deps, frozenset(o for o in it.base.pts if o.kind == "lib"))
    news = through_statement(ctx, const(it.name != "clear"), it.frame, it.call)
    updates.write_field(ctx, events, waiting.FLAG, news)
    if it.name != "clear":
        waiting.note_filling(ctx, events, it.frame, it.call)


def _transmit(ctx: Interpreter, base: Value, plain: list[Value], frame: Frame, call: ir.Call) -> None:
    """Write to a port, file or socket; a read from it does not return this data."""
    news = through_statement(ctx, join_all(plain), frame, call) if plain else BOTTOM
    for obj in base.objects if news is not BOTTOM else ():
        updates.weaken(ctx, obj, SENT, news)


def received(ctx: Interpreter, base: Value, arguments: Arguments) -> Nodes:
    """Return the dependencies of a read from a port, file or socket, without written data."""
    deps = base.deps | call_contexts.all_used(ctx, arguments)
    for obj in base.objects:
        deps |= heap.content(ctx, obj).deps
    return deps


def _update(
    ctx: Interpreter, base: Value, plain: list[Value], named: Mapping[str, Value], frame: Frame, call: ir.Call
) -> None:
    certain = len(base.pts) == 1
    for number, value in enumerate(plain):
        news = through_statement(ctx, value, frame, call, number)
        expr = call.arguments[number] if number < len(call.arguments) else None
        for obj in base.objects:
            if obj.kind == "sequence":
                updates.add_element(ctx, pointer(obj), heap.elements(ctx, news))
            elif obj.kind == "mapping" and certain and isinstance(expr, ir.MappingDisplay):
                sizes.absorb(ctx, obj, news, expr)
            elif obj.kind == "mapping":
                ctx.ops.entries(ctx, obj, news)
            elif obj.kind in ("lib", "instance"):
                sizes.absorb(ctx, obj, news)
    for name, value in named.items():
        news = through_statement(ctx, value, frame, call, name)
        if name != "**":
            updates.write_item(ctx, base, const(name), news)
            continue
        for obj in base.objects:
            sizes.absorb(ctx, obj, news)


def insert_elements(ctx: Interpreter, base: Value, values: list[Value], frame: Frame, call: ir.Call) -> None:
    """Store elements into a container, through a node of the calling statement."""
    news = join_all(values)
    if news is BOTTOM:
        return
    function = call.function
    news = through_statement(ctx, news, frame, call)
    waiting.note_filling(ctx, base, frame, call)
    for obj in news.pts if news.deps else ():
        ctx.inserted.setdefault(obj.site, set()).update(news.deps)
    change(ctx, base, news, [function.base] if isinstance(function, ir.Attribute) else [], frame)


def through_statement(
    ctx: Interpreter, value: Value, frame: Frame, call: ir.Call, number: Hashable = 0
) -> Value:
    """Pass a value through a node of the calling statement, because a call stores the value.

    What decides whether this object is the receiver, or whether the call is reached at all, decides its content.
    """
    if frame.statement is None:
        return value
    node = ctx.node(frame, ("stored", call.slot, number), "call")
    ctx.graph.depend(node, [decision for decision, _ in ctx.guards])
    return ctx.carry(value, node)


def _read_get(ctx: Interpreter, it: Invocation) -> Value:
    plain = it.arguments[0]
    if not plain:
        return elements_of_any(ctx, it.base)
    result = expressions.read_item(ctx, it.base, plain[0])
    if keys := expressions.by_key(ctx, it.base, plain[0], it.frame, it.call.pos):
        result = Value(result.deps | keys, result.pts)
    if ctx.launched is not None and (told := launched.entry(ctx, it.base, plain[0])) is not None:
        return told
    return join(result, plain[1]) if len(plain) > 1 else result


def _from_queue(ctx: Interpreter, it: Invocation) -> Value:
    """Return an element of a queue (for which the call waits), or an entry of a mapping."""
    if not it.base.pts or any(o.kind != "sequence" for o in it.base.pts):
        return _read_get(ctx, it)
    if any(it.arguments):
        waiting.may_be_empty(ctx, it, "")
    else:
        waiting.wait_for_element(ctx, it)
    return _smallest(ctx, elements_of_any(ctx, it.base), it)


def _smallest(ctx: Interpreter, found: Value, it: Invocation) -> Value:
    """Return an element of a queue; a comparison of all elements decides which one a `PriorityQueue` returns."""
    compares = any(o.name == ordering.SORTED for o in it.base.pts)
    return ordering.ordered(ctx, found, replace(it, arguments=([], {}))) if compares else found


def sent(ctx: Interpreter, generator: Obj, it: Invocation) -> None:
    """Send a value to a generator, which may have ended."""
    for value in it.arguments[0][:1]:
        generators.send(ctx, generator, through_statement(ctx, value, it.frame, it.call))
    waiting.may_be_empty(ctx, it, "StopIteration")


def next_element(ctx: Interpreter, it: Invocation) -> Value:
    """Return `next(iterator)` or `iterator.__next__()`; a generator that ends raises an exception without a default."""
    plain = it.arguments[0] if it.base is BOTTOM else [it.base, *it.arguments[0]]
    if not plain:
        return UNKNOWN
    generated = frozenset(o for o in plain[0].pts if o.name == heap.GENERATOR)
    for one in in_order(generated):
        generators.step(ctx, one)
    if generated and len(plain) == 1:
        waiting.may_be_empty(ctx, replace(it, base=Value(plain[0].deps, generated)), "StopIteration")
    return iterators.next_element(ctx, replace(it, arguments=(plain, it.arguments[1])))


def _take_out(ctx: Interpreter, it: Invocation) -> Value:
    """Remove an element and return it."""
    result, given = _smallest(ctx, _read_get(ctx, it), it), it.arguments[0]
    if it.name in waiting.RAISED and len(given) < 2:
        waiting.may_be_empty(ctx, it, waiting.RAISED[it.name])
    index = given[0] if given else const(0) if it.name in ("popleft", "get_nowait") else None
    decides = ctx.use(index) if index is not None else NONE
    finds = len(given) < 2  # with a default, a missing key is no error
    decided = removal.decision(ctx, it.frame, it.call.slot, decides, base=it.base.deps, finds=finds)
    removal.take(ctx, it.base, index, decided)
    shorten(ctx, it.base, it.frame, it.call)
    return result


def _removed(ctx: Interpreter, it: Invocation) -> Value:
    """Remove elements that equal an argument, or an element of it; comparisons decide which elements are left."""
    held, decides = elements_of_any(ctx, it.base), NONE
    for value in it.arguments[0]:
        given = heap.elements(ctx, value) if it.name in REMOVING_EACH else value
        decides |= equality.either_decides(ctx, given, held, it.frame, it.call.pos)
    finds = it.name == "remove"
    decided = removal.decision(ctx, it.frame, it.call.slot, decides, base=it.base.deps, finds=finds)
    take_any(ctx, it.base, decided, it.frame, it.call)
    for raises in MISSING if finds else ():
        ctx.ops.may_fail(ctx, decides, raises, it.frame, named=True)
    return UNKNOWN


def take_any(ctx: Interpreter, base: Value, decided: removal.Decision, frame: Frame, call: ir.Call) -> None:
    """Remove an element at an unknown place of containers."""
    for obj in base.objects:
        if obj.kind in removal.CONTAINERS:
            removal.scatter(ctx, obj, decided)
    shorten(ctx, base, frame, call)


def _reversed(ctx: Interpreter, it: Invocation) -> Value:
    """Reverse a list in place."""
    removal.reverse(ctx, it.base, removal.decision(ctx, it.frame, it.call.slot, it.base.deps))
    return UNKNOWN


def shorten(ctx: Interpreter, base: Value, frame: Frame, call: ir.Call) -> None:
    """Make the length of containers depend on the conditions of a removal."""
    ours = [o for o in base.pts if o.kind in ("sequence", "mapping")]
    kept = ctx.kept(ctx.node(frame, ("taken", call.slot), "call")) if ours else NONE
    for obj in ours if kept else ():
        sizes.decide_length(ctx, obj, kept)


def _write_entry(ctx: Interpreter, it: Invocation) -> Value:
    """Store an element, like `x[key] = value`."""
    plain = it.arguments[0]
    if len(plain) == 2:
        updates.write_item(ctx, it.base, plain[0], through_statement(ctx, plain[1], it.frame, it.call))
    return UNKNOWN


def elements_of_any(ctx: Interpreter, base: Value) -> Value:
    """Return any element of containers; for a mapping, any value."""
    return join_all(heap.arrive(ctx, heap.read_any(ctx, o), base.deps) for o in base.pts)


def _known_entries(ctx: Interpreter, it: Invocation) -> Sequence[tuple[Value, Value]] | None:
    """Return a mapping's certain keys and values in order, for parameters or class bodies; else None."""
    told = launched.entries(ctx, it.base)
    return told if told is not None else rows.attributes(ctx, it.base)


def _read_values(ctx: Interpreter, it: Invocation) -> Value:
    told = _known_entries(ctx, it)
    if told is not None:
        return _in_turn(ctx, [value for _, value in told], it)
    return iterators.listed(ctx, elements_of_any(ctx, it.base), sizes.length(ctx, it.base), it)


def _read_keys(ctx: Interpreter, it: Invocation) -> Value:
    told = _known_entries(ctx, it)
    if told is not None:
        return _in_turn(ctx, [key for key, _ in told], it)
    return iterators.listed(ctx, heap.elements(ctx, it.base), sizes.length(ctx, it.base), it)


def _in_turn(ctx: Interpreter, elements: Sequence[Value], it: Invocation) -> Value:
    """Return a new sequence whose elements are tracked separately."""
    obj = recency.allocate(ctx, "sequence", it.frame, ("values", it.call.slot))
    for number, value in enumerate(elements):
        ctx.store.put((obj, item_field(number)), value)
    return _of_class(it, obj)


def _of_class(it: Invocation, obj: Obj) -> Value:
    """Return a sequence of attributes. A loop over the attributes of a class is executed element by element."""
    if any(o.kind == "class" for o in it.base.pts):
        obj.name = heap.MEMBERS
    return pointer(obj)


def _read_pairs(ctx: Interpreter, it: Invocation) -> Value:
    listed = _pairs(ctx, it)
    for pair in heap.elements(ctx, listed).objects:
        pair.name = ordering.ENTRY
    return listed


def _pairs(ctx: Interpreter, it: Invocation) -> Value:
    told = _known_entries(ctx, it)
    if told is not None:
        (obj,) = iterators.rows_of(ctx, told, it).pts
        return _of_class(it, obj)
    known = rows.entries(ctx, it.base)
    if known is not None:
        return iterators.rows_in_any_order(ctx, known, it, sizes.length(ctx, it.base))
    keys = join_all(heap.elements(ctx, Value(it.base.deps, frozenset([o]))) for o in it.base.pts)
    return iterators.pairs(
        ctx, [keys, elements_of_any(ctx, it.base)], it.frame, it.call, sizes.length(ctx, it.base)
    )


def new_container(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new container with the elements of its argument; `iter(function, end)` has the results of a function."""
    if it.name == "iter" and len(it.arguments[0]) == 2:
        made = ctx.ops.call_value(ctx, it.arguments[0][0], ([], {}), it.frame, it.call)
        obj = recency.allocate(ctx, "sequence", it.frame, ("display", it.call.slot))
        updates.add_element(ctx, pointer(obj), made)
        return pointer(obj)
    given = [v for v in it.arguments[0][:1] if v is not BOTTOM]
    known = sizes.unpacked(ctx, given[0]) if given and it.name in IN_ORDER else None
    known = known[::-1] if known is not None and it.name == "reversed" else known
    element = join_all(heap.elements(ctx, v) for v in given)
    unordered = element
    if it.name == "sorted":
        element = ordering.ordered(ctx, element, it)
    length = sizes.length(ctx, given[0]) if given else NONE
    if it.name in ("set", "frozenset"):
        # a set keeps only one of several equal elements, so its length depends on the elements
        length |= ctx.use(element)
    obj = recency.allocate(ctx, "sequence", it.frame, ("display", it.call.slot))
    if known is not None:
        for number, value in enumerate(known):
            ctx.store.put((obj, item_field(number)), value)
    elif given:
        updates.add_element(ctx, pointer(obj), element)
    if element is not unordered:
        ctx.store.put((obj, ordering.UNORDERED), unordered)
    ctx.store.put((obj, LENGTH), Value(length))
    return pointer(obj)


def counted_elements(ctx: Interpreter, it: Invocation) -> Value:
    """Return `len(x)`, which depends on the length's data and on the conditions of additions."""
    deps = iterators.lengths(ctx, it.arguments[0])
    ours = [o for value in it.arguments[0] for o in value.pts if sizes.sized(ctx, o)]
    node = ctx.node(it.frame, ("length", it.call.slot), "call")
    ctx.graph.choice(sizes.placed(ctx, frozenset(ours)), node, counted=True)
    if ctx.graph.control[node]:
        ctx.graph.counts.setdefault(node, set()).update(made_of(ctx, Value(pts=frozenset(ours))))
    # equal keys count once, so the keys of a mapping decide its length, as the elements of a set do
    keys = [ctx.store.get((o, heap.KEYS)) for o in ours if o.kind == "mapping"]
    deps = deps.union(*(ctx.graph.without_removals(held.deps) for held in keys if held is not None))
    exact = sizes.counts(ctx, it.frame)
    elements = sizes.constants if ctx.exact else sizes.unpacked
    known = [elements(ctx, value) for value in it.arguments[0] if exact]
    numbers = [len(texts) for texts in known if texts is not None]
    return Value(deps | ctx.kept(node), consts=frozenset(numbers) if numbers and len(numbers) == 1 else None)


def made_of(ctx: Interpreter, value: Value) -> Nodes:
    """Return the dependencies of elements, without the contents of objects of the analysed classes."""
    found = elements_of_any(ctx, value)
    return ctx.use(Value(found.deps, frozenset(o for o in found.pts if o.kind != "instance")))


def _read_length(ctx: Interpreter, it: Invocation) -> Value:
    """Return the result of a call that asks a queue for its size."""
    return counted_elements(ctx, replace(it, arguments=([it.base], {})))


def new_queue(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new queue."""
    obj = recency.allocate(ctx, "sequence", it.frame, ("display", it.call.slot))
    if it.name.endswith(ordering.SORTED):
        obj.name = ordering.SORTED
    return pointer(obj)


def new_pipe(ctx: Interpreter, it: Invocation) -> Value:
    """Return both ends of a pipe or channel; one object represents them, so that sent data returns."""
    end = new_queue(ctx, it)
    obj = recency.allocate(ctx, "sequence", it.frame, ("ends", it.call.slot))
    for number in range(2):
        ctx.store.put((obj, item_field(number)), end)
    return pointer(obj)


def is_device(obj: Obj) -> bool:
    """Return whether a read from a library object returns data other than the data written to it."""
    return obj.kind == "lib" and not obj.name.startswith(IN_MEMORY) and obj.name not in PROCESSES


READERS: Mapping[str, Callable[..., Value]] = {
    "get": _from_queue,
    "__getitem__": _read_get,
    "__setitem__": _write_entry,
    **dict.fromkeys(("pop", "popleft", "get_nowait", "popitem"), _take_out),
    **dict.fromkeys(("remove", "discard", *REMOVING_EACH), _removed),
    "reverse": _reversed,
    **dict.fromkeys(("next", "__next__"), next_element),
    **dict.fromkeys(("qsize", "empty", "full"), _read_length),
    "values": _read_values,
    "itervalues": _read_values,
    "keys": _read_keys,
    "iterkeys": _read_keys,
    "items": _read_pairs,
    "iteritems": _read_pairs,
}
