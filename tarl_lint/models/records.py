"""Models of dataclasses and named tuples, copies of objects, and mappings with defaults."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Final

from tarl_lint.interpret import call_contexts, calls, expressions
from tarl_lint.interpret.call_contexts import CALLABLE
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Arguments, Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import generations, heap, object_contents, recency, record_fields, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY, KEYS, item_field
from tarl_lint.memory.values import (
    BOTTOM,
    BY_CLASS,
    UNKNOWN,
    ClassInfo,
    Obj,
    Value,
    const,
    in_order,
    join,
    join_all,
    lineage,
    pointer,
)
from tarl_lint.models import sizes
from tarl_lint.models.ros import senders

MAX_COPIED: Final = 3  # maximum depth to which a deep copy copies nested objects
INNER: Final = frozenset(["instance", "sequence", "mapping", "lib"])
MADE_BY: Final = {
    **dict.fromkeys(("list", "set", "deque", "tuple", "frozenset"), "sequence"),
    **dict.fromkeys(("dict", "OrderedDict", "Counter"), "mapping"),
}


# --- fields -------------------------------------------------------------------------------------------


def fill(ctx: Interpreter, obj: Obj, cls: Obj, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
    """Store the arguments in fields, as a dataclass or named tuple does."""
    plain, named = call_contexts.pass_arguments(ctx, arguments, frame, call)
    given = dict(named)
    rest = given.pop("*", None)
    mapping = given.pop("**", None)
    numbered, arriving, passed = record_fields.is_named_tuple(cls), iter(plain), dict[str, Value]()
    for number, (owner, name) in enumerate(record_fields.fields(cls)):
        options = record_fields.options(ctx, owner, name)
        inside = not record_fields.says(options, "init", False)
        value = given.pop(name, None)
        if value is None and inside and not record_fields.only_named(owner, name, options):
            value = next(arriving, None)
        if value is None and mapping is not None and inside:
            value = expressions.read_item(ctx, mapping, const(name))
        if value is None or value is BOTTOM:
            unpacked = rest if inside else None
            value = unpacked if unpacked is not None else _preset(ctx, owner, name, frame, call, number)
        if value is None:
            continue
        if name in record_fields.handed_on(owner):
            passed[name] = value
            continue
        ctx.store.put((obj, name), value)
        if numbered:
            ctx.store.put((obj, item_field(number)), value)
    for name, value in given.items():
        ctx.store.put((obj, name), value)
    external = any(o.info.external for o in lineage(cls) if isinstance(o.info, ClassInfo))
    if plain and external and not numbered:
        updates.add_element(ctx, pointer(obj), Value(call_contexts.all_used(ctx, (plain, {}))))
    senders.inherit(ctx, obj, arguments, frame, call)
    _after(ctx, obj, cls, passed, frame, call)


def _after(
    ctx: Interpreter, obj: Obj, cls: Obj, passed: Mapping[str, Value], frame: Frame, call: ir.Call
) -> None:
    """Call `__post_init__` with the values of the fields with `InitVar`, in the order of the fields."""
    for owner in lineage(cls):
        after = ctx.store.get((owner, "__post_init__"))
        if after is not None:
            given = [
                passed.get(name, UNKNOWN)
                for of, name in record_fields.fields(cls)
                if name in record_fields.handed_on(of)
            ]
            calls.call_value(ctx, heap.bind(ctx, after, obj, owner), (given, {}), frame, call)
            return


def _preset(
    ctx: Interpreter, owner: Obj, name: str, frame: Frame, call: ir.Call, number: int
) -> Value | None:
    """Return a field's default; for `field(default_factory=f)`, the result of f."""
    options = record_fields.options(ctx, owner, name)
    if options is None:
        return ctx.store.get((owner, name))
    if "default_factory" in options:
        made = ir.Call(call.function, (), (), call.pos, -1000 * abs(call.slot) - number)
        return calls.call_value(ctx, options["default_factory"], ([], {}), frame, made)
    return options.get("default", UNKNOWN)


def field_default(ctx: Interpreter, it: Invocation) -> Value:
    """Return an object that holds the options of `field(...)`."""
    obj = recency.intern(ctx, "field", (it.frame.id, it.statement, it.call.slot))
    obj.describe(it.arguments[1])
    return pointer(obj)


def named_tuple_class(ctx: Interpreter, it: Invocation) -> Value:
    """Return the class made by `namedtuple(name, fields)`."""
    plain = it.arguments[0]
    if len(plain) < 2:
        return UNKNOWN
    names: list[str] = []
    for text in plain[1].texts():
        names += text.replace(",", " ").split()
    for element in sizes.unpacked(ctx, plain[1]) or []:
        names += element.texts()
    cls = recency.intern(
        ctx, "class", (it.frame.id, it.statement, it.call.slot), "".join(plain[0].texts()[:1])
    )
    info = ClassInfo(cls.name, cls.name, named=True, module=it.frame.program.name)
    info.fields = tuple(names)
    ctx.shared.edition += isinstance(cls.info, ClassInfo) and cls.info.fields != info.fields
    cls.info = info
    return pointer(cls)


# --- copies -------------------------------------------------------------------------------------------


def replaced_record(ctx: Interpreter, it: Invocation) -> Value:
    """Return a copy with some fields replaced."""
    plain, named = it.arguments
    base = plain[0] if plain and it.base is BOTTOM else it.base
    made = copy_of(ctx, base, it.frame, it.call.slot)
    for obj in made.objects:
        cls = obj.info if obj.kind == "instance" else None
        names = [n for _, n in record_fields.fields(cls)] if isinstance(cls, Obj) else []
        for name, value in named.items():
            _put(ctx, obj, name, value)
            if name in names and record_fields.is_named_tuple(cls):
                _put(ctx, obj, item_field(names.index(name)), value)
    return made


def _put(ctx: Interpreter, obj: Obj, name: str, value: Value) -> None:
    """Store a field of a copy. If the copy stands for several objects, keep the previous value as well."""
    if obj.many:
        updates.weaken(ctx, obj, name, value)
    else:
        ctx.store.put((obj, name), value)


def _made_of(ctx: Interpreter, it: Invocation) -> Value:
    """Return the named tuple made by `cls._make(values)`."""
    given = it.arguments[0][0] if it.arguments[0] else UNKNOWN
    known = calls.one_by_one(ctx, given)
    fields: Arguments = (known, {}) if known is not None else ([], {"*": heap.elements(ctx, given)})
    classes = [o.info if o.kind == "instance" else o for o in it.base.objects]
    return join_all(
        calls.call_value(ctx, pointer(c), fields, it.frame, it.call) for c in classes if isinstance(c, Obj)
    )


def as_mapping(ctx: Interpreter, it: Invocation) -> Value:
    """Return the mapping of field names to values made by `asdict(x)` or a named tuple's `_asdict()`."""
    return _listing(ctx, it, "mapping")


def as_sequence(ctx: Interpreter, it: Invocation) -> Value:
    """Return the tuple of fields that `astuple(x)` makes."""
    return _listing(ctx, it, "sequence")


def described_fields(ctx: Interpreter, it: Invocation) -> Value:
    """Return the fields of a dataclass as objects with names; a loop over them is executed element by element."""
    given = it.arguments[0][0] if it.arguments[0] else UNKNOWN
    classes = {o if o.kind == "class" else o.info for o in given.pts}
    if len(classes) != 1 or not isinstance(cls := classes.pop(), Obj) or cls.kind != "class":
        return ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    listed = recency.allocate(ctx, "sequence", it.frame, ("display", it.call.slot))
    listed.name = heap.MEMBERS
    for number, (owner, name) in enumerate(record_fields.fields(cls)):
        one = recency.intern(ctx, "lib", ("field", owner.key, name), heap.NAMESPACE)
        ctx.store.put((one, "name"), const(name))
        ctx.store.put((one, "type"), UNKNOWN)
        ctx.store.put((listed, item_field(number)), pointer(one))
    return pointer(listed)


def _listing(ctx: Interpreter, it: Invocation, kind: str) -> Value:
    given = it.base if it.base is not BOTTOM else it.arguments[0][0] if it.arguments[0] else UNKNOWN
    ours = {o: o.info for o in given.pts if o.kind == "instance" and isinstance(o.info, Obj)}
    if not ours or len(ours) < len(given.pts):
        return Value(ctx.use(given))
    made = recency.allocate(ctx, kind, it.frame, ("display", it.call.slot))
    for obj, cls in ours.items():
        for number, (_, name) in enumerate(record_fields.fields(cls)):
            field = item_field(name if kind == "mapping" else number)
            updates.weaken(ctx, made, field, heap.arrive(ctx, heap.read_field(ctx, obj, name), given.deps))
    return pointer(made)


def _read_copy(ctx: Interpreter, it: Invocation) -> Value:
    return copy_of(ctx, it.base, it.frame, it.call.slot)


def copy_of(ctx: Interpreter, value: Value, frame: Frame, slot: Hashable) -> Value:
    """Return a new object with the same fields."""
    if not value.pts or any(o.kind in CALLABLE for o in value.pts):
        return value
    obj = _blank(ctx, value, frame, ("copy", slot))
    content = BOTTOM
    for source in value.objects:
        recency.copy_fields(ctx, source, obj)
        content = join(content, heap.content(ctx, source))
    if content is not BOTTOM:
        ctx.store.put((obj, ANY), content)
    return Value(value.deps, frozenset([obj]))


def _blank(ctx: Interpreter, value: Value, frame: Frame, slot: Hashable) -> Obj:
    """Return a new object of the kind to which all copied objects belong."""
    classes = {o.info for o in value.pts if o.kind == "instance"}
    if len(classes) == 1 and all(o.kind == "instance" for o in value.pts):
        cls = classes.pop()
        site = (frame.function, frame.statement, slot, cls)
        last = generations.last_of_line(ctx, site, frame)
        if last is not None:
            return last
        obj = recency.allocate(ctx, "instance", frame, slot)
        obj.describe(cls)
        generations.note(ctx, obj, site, frame)
        return obj
    kinds = {o.kind for o in value.pts} & {"sequence", "mapping"}
    obj = recency.allocate(ctx, kinds.pop() if kinds else "lib", frame, slot)
    if all(o.info is BY_CLASS for o in value.pts):
        obj.describe(BY_CLASS)
    definitions = {object_contents.defined(ctx, o) for o in value.pts}
    defined = definitions.pop() if len(definitions) == 1 else ""
    if defined != obj.defined:
        obj.changed()
    obj.defined = defined
    return obj


def deep_copy(ctx: Interpreter, value: Value, frame: Frame, slot: Hashable, depth: int = 0) -> Value:
    """Return a copy with copies of nested objects."""
    made = copy_of(ctx, value, frame, slot)
    for obj in in_order(made.pts - value.pts) if depth < MAX_COPIED else ():
        ctx.store.reads.look(obj)
        for name in list(obj.fields):
            inner = ctx.store.get((obj, name))
            if inner is not None and any(o.kind in INNER for o in inner.pts):
                ctx.store.put((obj, name), deep_copy(ctx, inner, frame, (slot, name), depth + 1))
    return made


# --- mappings -----------------------------------------------------------------------------------------


def new_mapping(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new mapping with the entries of its arguments."""
    plain, named = it.arguments
    factory = plain[0] if it.name == "defaultdict" and plain else None
    given = plain[1:] if it.name == "defaultdict" else plain
    obj = recency.allocate(ctx, "mapping", it.frame, ("display", it.call.slot))
    for value in given:
        if it.name == "Counter":
            updates.weaken(ctx, obj, KEYS, Value(ctx.use(value)))
            updates.add_element(ctx, pointer(obj), Value(ctx.use(value)))
        elif value.pts:
            entries(ctx, obj, value)
    for key, value in named.items():
        if key == "**":
            entries(ctx, obj, value)
        else:
            ctx.store.put((obj, item_field(key)), value)
    if factory is not None:
        obj.describe(factory)
    return pointer(obj)


def several_mappings(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `ChainMap(first, second)`: each entry may come from any of the mappings."""
    return join_all(it.arguments[0]) if it.arguments[0] else new_mapping(ctx, it)


def entries(ctx: Interpreter, obj: Obj, value: Value) -> None:
    """Copy the entries of a mapping or a sequence of pairs."""
    for source in value.objects:
        if source.kind != "sequence":
            sizes.absorb(ctx, obj, Value(value.deps, frozenset([source])))
            continue
        known = [sizes.unpacked(ctx, p) or [] for p in sizes.unpacked(ctx, pointer(source)) or ()]
        if known and all(len(pair) == 2 for pair in known):
            for key, item in known:
                updates.write_item(
                    ctx, pointer(obj), key, Value(item.deps | value.deps, item.pts, item.consts)
                )
            continue
        pair = heap.elements(ctx, Value(value.deps, frozenset([source])))
        keys = ctx.use(expressions.read_item(ctx, pair, const(0)))
        if keys:
            updates.weaken(ctx, obj, KEYS, Value(keys))
        updates.add_element(ctx, pointer(obj), expressions.read_item(ctx, pair, const(1)))
        sizes.lengthen(ctx, obj, Value(value.deps, frozenset([source])))


def from_keys(ctx: Interpreter, it: Invocation) -> Value:
    """Return the mapping made by `dict.fromkeys(keys, value)`."""
    plain = it.arguments[0]
    obj = recency.allocate(ctx, "mapping", it.frame, ("display", it.call.slot))
    known = sizes.unpacked(ctx, plain[0]) if plain else None
    value = plain[1] if len(plain) > 1 else const(None)
    for key in known or ():
        updates.write_item(ctx, pointer(obj), key, value)
    if known is None:
        keys = ctx.use(heap.elements(ctx, plain[0])) if plain else frozenset()
        updates.weaken(ctx, obj, KEYS, Value(keys)) if keys else None
        updates.add_element(ctx, pointer(obj), value)
    return pointer(obj)


def missing(ctx: Interpreter, mapping: Obj, name: str) -> Value:
    """Return the value that a mapping with a default creates for a missing key."""
    ctx.store.reads.look(mapping)
    factory = mapping.info
    if not isinstance(factory, Value):
        return BOTTOM
    result = BOTTOM
    for maker in factory.objects:
        kind = MADE_BY.get(maker.name.rpartition(".")[2]) if maker.kind == "ext" else None
        if kind is not None:
            result = join(result, pointer(recency.intern(ctx, kind, (mapping.key, "missing", name))))
        elif maker.kind in CALLABLE and ctx.stack:
            result = join(result, calls.call_object(ctx, maker, ([], {}), ctx.stack[-1], _MISSING))
    if result.pts:
        ctx.store.put((mapping, name), result)
    return result


_MISSING: Final = ir.Call(ir.Const(None, (0, 0, 0, 0)), (), (), (0, 0, 0, 0), -1)


def _bound_by_get(ctx: Interpreter, it: Invocation) -> Value:
    """Return `function.__get__(obj)`."""
    receivers = [o for v in it.arguments[0][:1] for o in v.objects if o.kind == "instance"]
    ways = [heap.bind(ctx, it.base, o, o.info) for o in receivers if isinstance(o.info, Obj)]
    return join_all(ways) if ways else it.base


RECORDS: Final = {
    "copy": _read_copy,
    "_replace": replaced_record,
    "_make": _made_of,
    "__get__": _bound_by_get,
    "_asdict": as_mapping,
}
