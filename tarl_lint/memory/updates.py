"""Store into fields and elements: strong and weak updates."""

from __future__ import annotations

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap, recency
from tarl_lint.memory.heap import ANY, GIVEN_KEYS, HOLLOW, KEYS, RENAMING, item_field
from tarl_lint.memory.values import BOTTOM, MEMBER, Obj, Value, in_order, join

# maximum number of possible keys of one store into a mapping; with more keys, the store may change any element
MAX_KEYS = 8


def write_field(ctx: Interpreter, base: Value, name: str, value: Value) -> None:
    """Store into a field: a strong update if the pointer has one target, else weak updates."""
    _write(ctx, base, name, value, certain=len(base.pts) == 1)


def weaken_field(ctx: Interpreter, base: Value, name: str, value: Value) -> None:
    """Store into a field that is one of several possible ones."""
    _write(ctx, base, name, value, certain=False)


def _write(ctx: Interpreter, base: Value, name: str, value: Value, *, certain: bool) -> None:
    for held in base.objects:
        if held.kind in ("bound", "ext", "method"):
            continue
        obj, field = heap.renamed(ctx, held, name) if held.kind in RENAMING else (held, name)
        for attributes in heap.replaced_attributes(ctx, obj):
            weaken(ctx, attributes, item_field(field), value)
        if field == "__dict__":
            _take_over(ctx, obj, value)
        if certain and recency.single(ctx, obj):
            ctx.store.put((obj, field), value)
        else:
            weaken(ctx, obj, field, value)


def _take_over(ctx: Interpreter, obj: Obj, attributes: Value) -> None:
    """Store the values of a new `__dict__` in attributes that the object has had before."""
    ctx.store.reads.look(obj)
    for name in [n for n in obj.fields if n.isidentifier() and not n.startswith("__")]:
        for mapping in attributes.objects:
            value = ctx.store.get((mapping, heap.attribute_of_item(mapping, name)))
            if value is not None and mapping is not obj:
                weaken(ctx, obj, name, heap.arrive(ctx, value, attributes.deps))


def weaken(ctx: Interpreter, obj: Obj, name: str, value: Value) -> None:
    """Store into a field of an object by a weak update."""
    before = ctx.store.get((obj, name))
    if before is None:
        before = ctx.ops.default(ctx, obj, name)
    ctx.store.put((obj, name), join(before, value))


def add_element(ctx: Interpreter, base: Value, value: Value) -> None:
    """Store into an unknown element."""
    for obj in base.objects:
        if obj.kind in HOLLOW:
            continue
        before = heap.content(ctx, obj)
        ctx.store.put((obj, ANY), join(before, value))
        ctx.store.reads.look(obj)
        for name in list(obj.fields):
            if name.startswith("["):
                known = ctx.store.get((obj, name))
                if known is not None:
                    ctx.store.put((obj, name), join(known, value))


def write_item(ctx: Interpreter, base: Value, index: Value, value: Value) -> None:
    """Store into an element."""
    keys = ctx.use(index)
    classes = frozenset(o for o in index.pts if o.kind == "class" or o.name == MEMBER)
    for obj in base.objects if keys or classes else ():
        if obj.kind == "mapping":
            weaken(ctx, obj, KEYS, Value(keys, classes))
    constants = index.item_keys() or _default_key(ctx, base, index)
    if not constants or len(constants) > 1:
        _write_some(ctx, base, index, value)
        return
    key = next(iter(constants))
    if isinstance(key, int) and key < 0 and any(o.kind == "sequence" for o in base.pts):
        key = from_end(ctx, base, key)
        if key < 0:
            add_element(ctx, base, value)
            return
    fields = {heap.attribute_of_item(obj, key) for obj in base.pts}
    for field in sorted(fields):
        kin = frozenset(o for o in base.pts if heap.attribute_of_item(o, key) == field)
        write_field(ctx, base if kin == base.pts else Value(base.deps, kin), field, value)


def _default_key(ctx: Interpreter, base: Value, index: Value) -> frozenset[str]:
    """Return the default of a key that is known only on the robot.

    Record in the mappings that this default stands for the key.
    """
    defaults = index.default_keys()
    if len(defaults) != 1 or not base.pts or any(o.kind != "mapping" for o in base.pts):
        return frozenset()
    for obj in base.objects:
        before = ctx.store.get((obj, GIVEN_KEYS))
        ctx.store.put((obj, GIVEN_KEYS), Value(consts=join(before or BOTTOM, Value(consts=defaults)).consts))
    return defaults


def _write_some(ctx: Interpreter, base: Value, index: Value, value: Value) -> None:
    """Store into a mapping's element under a known key, else into any of several elements."""
    constants = index.item_keys() or ()
    known = sorted(constants, key=repr) if len(constants) <= MAX_KEYS else []
    mappings = frozenset(o for o in base.pts if o.kind == "mapping" and known)
    for obj in in_order(mappings):
        for key in known:
            weaken(ctx, obj, heap.attribute_of_item(obj, key), value)
    add_element(ctx, Value(base.deps, base.pts - mappings), value)


def from_end(ctx: Interpreter, base: Value, key: int) -> int:
    """Convert a negative index to one from the start, if the length is known."""
    known = ctx.ops.unpacked(ctx, base)
    return key + len(known) if known and -key <= len(known) else key
