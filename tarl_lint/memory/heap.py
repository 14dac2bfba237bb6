"""Read fields and elements of abstract objects."""

from __future__ import annotations

from ast import literal_eval
from functools import lru_cache

from tarl_lint.catalog import ENDPOINT_METHODS, MEASURES, METHODS
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import blackboards, function_attributes, message_types, properties, recency, userdata
from tarl_lint.memory.blackboards import CLIENT
from tarl_lint.memory.function_attributes import FUNCTIONS, attribute_of
from tarl_lint.memory.properties import PARTS
from tarl_lint.memory.userdata import VIEW
from tarl_lint.memory.values import (
    BOTTOM,
    BY_CLASS,
    MAX_TEXTS,
    MEMBER,
    NONE,
    UNKNOWN,
    ClassInfo,
    Nodes,
    Obj,
    Value,
    join,
    lineage,
    pointer,
)

ANY = "*"  # summary field: the join of all elements
KEYS = "<keys>"  # field of a mapping: dependencies of its keys
GIVEN_KEYS = "<given>"  # field of a mapping: the defaults that stand for keys that only the robot knows
LENGTH = "<length>"  # field of a container: dependencies of its length
HELD = "<callables>"  # field of a library object: callables that were passed to it
RESULT = "<result>"  # field of a future that holds its result
SENT = "<sent>"  # field of a port, file or socket: data written to it
STREAM = "<stream>"  # field of a library object: the streams in memory into which it writes
SHAPE = "<shape>"  # field of an array that the program made without data: the data that decides its shape
# name of a sequence that holds the known attribute names of an object, or (name, value) pairs
MEMBERS = "members"
GENERATOR = "generator"  # name of a sequence that represents a generator
METHODS_OF = {
    "publisher": frozenset(["publish"]),
    "sequence": frozenset(
        ["append", "appendleft", "extend", "insert", "add", "put", "put_nowait", "send", "send_nowait", "pop",
         "popleft", "get"]
    ),
    "mapping": frozenset(["update", "get", "pop", "setdefault", "__getitem__", "__setitem__"]),
    "lib": frozenset(["put", "put_nowait", "set_result"]),
    "goal": frozenset(["publish_feedback"]),
    "server": frozenset(["publish_feedback", "set_succeeded", "set_aborted"]),
}  # fmt: skip
DICTIONARIES = frozenset(["dict", "OrderedDict", "defaultdict", "UserDict", "Counter", "TypedDict", "?"])
HOLLOW = frozenset(
    [
        "closure",
        "bound",
        "class",
        "module",
        "ext",
        "publisher",
        "partial",
        "property",
        "method",
        "frame",
        "super",
        VIEW,
        CLIENT,
    ]
)
INNER = frozenset(["queue", "_queue"])  # attributes of a queue: the list of its elements
NAMESPACE = "types.SimpleNamespace"  # name of an object whose attributes are also the items of its `vars()`
# kinds of objects whose attributes are stored elsewhere or under other names
RENAMING = frozenset(["closure", VIEW, CLIENT])


def item_field(constant: object) -> str:
    """Return the field name of a constant index or key."""
    return f"[{constant!r}]"


# --- reading ------------------------------------------------------------------------------------------


def content(ctx: Interpreter, obj: Obj) -> Value:
    """Return the join of all elements of an object and of its unknown fields."""
    own = ctx.store.get((obj, ANY))
    if own is not None:
        return own
    if obj.parent is not None:
        outer = content(ctx, obj.parent)
        return Value(outer.deps) if outer is not BOTTOM else BOTTOM
    if obj.kind == "message" and isinstance(obj.info, int):
        return Value(frozenset([obj.info]))
    return UNKNOWN if obj.kind == "ext" else BOTTOM


def read_field(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return the value of a field of one object."""
    if obj.kind in FUNCTIONS:
        if obj.kind == "closure" and name in PARTS and (part := properties.part(ctx, obj, name)) is not None:
            return part
        found = function_attributes.attribute(ctx, obj, name)
        return BOTTOM if found is None else found
    if obj.kind in (VIEW, CLIENT):
        obj, name = renamed(ctx, obj, name)
    stored = ctx.store.get((obj, name))
    if stored is not None:
        if obj.kind == "class":
            return bind_class(ctx, stored, obj)
        if obj.whole.kind == "message" and not written_here(ctx, obj, name):
            # a message that this run has not written to may still have the value with which it arrived
            return join(stored, pointer(obj.sub(name)))
        return stored
    return ctx.ops.default(ctx, obj, name)


def renamed(ctx: Interpreter, obj: Obj, name: str) -> tuple[Obj, str]:
    """Return the object that stores an attribute, and the name of the attribute there.

    A function's attributes are stored together with its defaults.
    """
    if obj.kind == "closure":
        return obj, attribute_of(name)
    if obj.kind == CLIENT:
        return blackboards.seen_through(ctx, obj, name)
    return userdata.seen_through(ctx, obj, name)


def written_here(ctx: Interpreter, obj: Obj, name: str) -> bool:
    """Return whether this run has stored to a field."""
    return ctx.store.stored((obj, name))


def default(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return the value of an unset field."""
    kind = obj.kind
    if name in METHODS_OF.get(kind, ()) or (kind == "lib" and name in ENDPOINT_METHODS):
        return held_method(ctx, obj, name)
    if kind in ("message", "lib", "goal"):
        return _part(ctx, obj, name)
    if kind == "sequence" and name in INNER:
        return pointer(obj)
    if kind in ("sequence", "mapping"):
        return content(ctx, obj) if name.startswith("[") else BOTTOM
    if name == "__class__" and kind == "instance" and isinstance(obj.info, Obj):
        return pointer(obj.info)
    if name == "__dict__":
        return pointer(obj)
    if kind == "instance" and isinstance(obj.info, Obj):
        return _inherited(ctx, obj, obj.info, name)
    if kind == "class":
        return _class_field(ctx, obj, name)
    if kind == "ext" and name in message_types.DESCRIPTIONS and message_types.type_of(ctx, obj):
        return message_types.description(ctx, obj, name, MEMBERS)
    if kind == "ext":
        return pointer(recency.intern(ctx, "ext", f"{obj.name}.{name}", f"{obj.name}.{name}"))
    if kind == "module":
        return opened(ctx, obj, name)
    return BOTTOM


def _part(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return what an unset field of a library object holds: a part of the object, or BOTTOM for pseudo-fields."""
    if name == ANY or name.startswith("<"):
        return BOTTOM
    if obj.name == NAMESPACE:
        return pointer(obj) if name == "__dict__" else content(ctx, obj)
    if name.startswith("[") and (held := content(ctx, obj)).pts:
        return held
    if name in message_types.DESCRIPTIONS:
        return message_types.description(ctx, obj, name, MEMBERS)
    if obj.kind == "lib" and obj.info is not BY_CLASS and name in MEASURES:
        return shape(ctx, obj) or Value(ctx.ops.deep(ctx, frozenset([obj])))
    ctx.store.reads.look(obj)
    any_of_them = obj.subs.get("[]") if name.startswith("[") else None
    return Value(pts=frozenset([obj.sub(name)] if any_of_them is None else [obj.sub(name), any_of_them]))


def shape(ctx: Interpreter, obj: Obj) -> Value | None:
    """Return the data that decides the shape of an array without data in its elements; None for other objects."""
    return ctx.store.get((obj, SHAPE)) if obj.kind == "lib" else None


def _inherited(ctx: Interpreter, obj: Obj, cls: Obj, name: str) -> Value:
    """Return a class attribute seen through an instance, or else the content of the instance."""
    found = through_class(ctx, obj, cls, name)
    if found is not None:
        return found
    if isinstance(cls.info, ClassInfo) and cls.info.opaque and not name.startswith("["):
        if name in METHODS:
            return held_method(ctx, obj, name)
        holder = recency.intern(ctx, "lib", ("inherited", obj.key, name), name)
        return pointer(holder)
    # `content` covers both the elements and the attributes with computed names
    result = content(ctx, obj)
    for attributes in replaced_attributes(ctx, obj):
        result = join(result, read_field(ctx, attributes, item_field(name)))
    return result


def through_class(ctx: Interpreter, obj: Obj, cls: Obj, name: str) -> Value | None:
    """Return an attribute of a class or base class, with functions bound to `obj`, else None."""
    for owner in lineage(cls):
        value = ctx.store.get((owner, name))
        if value is not None:
            return bind(ctx, value, obj, owner)
    return None


def replaced_attributes(ctx: Interpreter, obj: Obj) -> frozenset[Obj]:
    """Return the mappings stored as an object's `__dict__`; several objects can share one."""
    held = ctx.store.get((obj, "__dict__")) if "__dict__" in obj.fields else None
    return held.pts - {obj} if held is not None else frozenset()


def bind(ctx: Interpreter, value: Value, receiver: Obj, owner: Obj) -> Value:
    """Return a value with its functions bound to a receiver."""
    if not any(o.kind in ("closure", "partial") for o in value.pts):
        return value
    bound = []
    for target in value.objects:
        if target.kind == "partial":
            bound.append(_bound_partial(ctx, target, receiver, owner))
            continue
        way = _binding(target)
        if way == "staticmethod":
            bound.append(target)
            continue
        to = receiver.info if way == "classmethod" and isinstance(receiver.info, Obj) else receiver
        bound.append(method(ctx, target, to, owner))
    return Value(value.deps, frozenset(bound), value.consts)


def _bound_partial(ctx: Interpreter, target: Obj, receiver: Obj, owner: Obj) -> Obj:
    """Return a `partialmethod` bound to a receiver. A plain `partial` in a class stays unbound."""
    if not isinstance(target.info, tuple) or not target.info[3:]:
        return target
    function, plain, named, _ = target.info
    bound = recency.intern(ctx, "partial", ("bound", target.key, receiver), target.name)
    bound.describe((bind(ctx, function, receiver, owner), plain, named))
    return bound


def bind_class(ctx: Interpreter, value: Value, cls: Obj, owner: Obj | None = None) -> Value:
    """Return an attribute of a class, with its class methods bound to the class. `owner` defines these methods."""
    if not any(_binding(o) == "classmethod" for o in value.pts):
        return value
    bound = [method(ctx, o, cls, owner or cls) if _binding(o) == "classmethod" else o for o in value.pts]
    return Value(value.deps, frozenset(bound), value.consts)


def read_or_hold(ctx: Interpreter, base: Value, name: str) -> Value:
    """Return an attribute; for an unknown object, also a method that registers something, such as a subscription."""
    if base.pts or name not in ENDPOINT_METHODS:
        return read(ctx, base, name)
    return Value(base.deps, held_method(ctx, recency.intern(ctx, "lib", ("unknown",)), name).pts)


def held_method(ctx: Interpreter, owner: Obj, name: str) -> Value:
    """Return a bound method of a library object."""
    method = recency.intern(ctx, "method", (owner, name), name)
    method.info = (owner, name)
    return pointer(method)


def method(ctx: Interpreter, closure: Obj, receiver: Obj, owner: Obj) -> Obj:
    """Return a function bound to a receiver."""
    method = recency.intern(ctx, "bound", (closure.key, receiver), closure.name)
    method.info = (closure, receiver, owner)
    return method


def _class_field(ctx: Interpreter, cls: Obj, name: str) -> Value:
    if name == "__mro__":
        return bases(ctx, cls)
    for owner in lineage(cls)[1:]:
        value = ctx.store.get((owner, name))
        if value is not None:
            return bind_class(ctx, value, cls)
    return BOTTOM


def bases(ctx: Interpreter, cls: Obj) -> Value:
    """Return the sequence of a class and its base classes; a loop over it is executed element by element."""
    listed = recency.intern(ctx, "sequence", ("bases", cls.key), MEMBERS)
    for number, one in enumerate(lineage(cls)):
        ctx.store.put((listed, item_field(number)), pointer(one))
    return pointer(listed)


def opened(ctx: Interpreter, module: Obj, name: str) -> Value:
    """Return the value of a name that a module got through `import *`."""
    result = BOTTOM
    for star in opened_by(ctx, module):
        target = ctx.module_objects.get(star)
        value = ctx.store.get((target, name)) if target is not None else None
        if value is not None:
            result = join(result, value)
    return result


def opened_by(ctx: Interpreter, module: Obj) -> list[str]:
    """Return the modules that a module imports by `import *`, directly or indirectly."""
    found: dict[str, None] = {}
    pending = [module.name]
    while pending:
        program = ctx.programs.get(pending.pop())
        for star in program.stars if program is not None else ():
            if star not in found and star != module.name:
                found[star] = None
                pending.append(star)
    return list(found)


def read_any(ctx: Interpreter, obj: Obj) -> Value:
    """Return the join of all elements of an object."""
    result = content(ctx, obj)
    ctx.store.look(obj)
    ctx.graph.asked += len(obj.fields)
    for name in list(obj.fields):
        if name.startswith("["):
            value = ctx.store.get((obj, name))
            if value is not None:
                result = join(result, value)
    if obj.kind in ("message", "lib") and not result.pts:
        parts = [obj.sub("[]"), *(sub for name, sub in obj.subs.items() if name.startswith("["))]
        result = join(result, Value(pts=frozenset(parts)))
        result = Value(NONE, result.pts) if result.deps == content(ctx, obj).deps else result
    return result


def read(ctx: Interpreter, base: Value, name: str) -> Value:
    """Return a field read through a pointer, after the carriers of the pointer have passed it on."""
    if len(base.pts) == 1:
        (obj,) = base.pts
        return arrive(ctx, read_field(ctx, obj, name), base.deps)
    result = Value(base.deps, consts=frozenset())
    for obj in base.objects:
        value = read_field(ctx, obj, name)
        result = join(result, arrive(ctx, value, base.deps))
    return result if base.pts else Value(base.deps)


def elements(ctx: Interpreter, value: Value) -> Value:
    """Return the join of the values that iteration over a value yields."""
    if not value.pts:
        return Value(value.deps)
    result = Value(value.deps, consts=frozenset())
    ctx.graph.asked += len(value.pts)
    for obj in value.objects:
        if obj.kind == "instance":
            names = attribute_names(ctx, obj)
            result = join(result, Value(ctx.ops.deep(ctx, frozenset([obj]))) if names is None else names)
        elif obj.kind == "mapping":
            result = join(result, keys(ctx, obj, value.deps))
        elif obj.kind == "class":
            for one in ctx.ops.unpacked(ctx, pointer(obj)) or ():
                result = join(result, one)
        else:
            result = join(result, arrive(ctx, read_any(ctx, obj), value.deps))
    return result


def attribute_names(ctx: Interpreter, obj: Obj) -> Value | None:
    """Return the names of a loop over `vars(obj)`; None if a loop over `obj` has other elements.

    `vars(obj)` and `obj.__dict__` are represented by the object itself. If a class or base class of the object is
    not analysed, or the object has attributes with computed names, it may iterate in another way.
    """
    if not is_namespace(ctx, obj) or content(ctx, obj) is not BOTTOM:
        return None
    ctx.store.look(obj)
    names = [n for n in list(obj.fields) if n.isidentifier() and ctx.store.get((obj, n)) is not None]
    return Value(consts=frozenset(names)) if 0 < len(names) <= MAX_TEXTS else UNKNOWN


def is_namespace(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether an object that is used as a container is certainly the `__dict__` of an instance."""
    cls = obj.info if obj.kind == "instance" and obj.name != MEMBER else None
    if not isinstance(cls, Obj) or any(_iterates(one.info) for one in lineage(cls)):
        return False
    if not items_are_attributes(obj):
        return False
    return all(through_class(ctx, obj, cls, name) is None for name in ("__iter__", "__getitem__"))


def _iterates(info: object) -> bool:
    """Return whether instances of a class may have elements: a named tuple, or a class with unknown base classes."""
    return not isinstance(info, ClassInfo) or info.named or info.opaque


def keys(ctx: Interpreter, mapping: Obj, carriers: Nodes) -> Value:
    """Return the keys of a mapping; constant keys depend on no data."""
    stored = ctx.store.get((mapping, KEYS))
    if stored is not None:
        return join(arrive(ctx, stored, carriers), UNKNOWN)
    return _texts(ctx, mapping) if content(ctx, mapping) is BOTTOM else UNKNOWN


def _texts(ctx: Interpreter, mapping: Obj) -> Value:
    """Return a mapping's keys if all are known texts, such as the topics in a table."""
    ctx.store.look(mapping)
    names = [n for n in list(mapping.fields) if n.startswith("[")]
    ctx.graph.asked += len(names)
    held = [n for n in names if ctx.store.get((mapping, n)) is not None]
    if not 0 < len(held) <= MAX_TEXTS or not all(n.startswith(("['", '["')) for n in held):
        return UNKNOWN
    return Value(consts=frozenset(map(_text_of, held)))


@lru_cache(maxsize=4096)
def _text_of(field: str) -> object:
    """Return the text that is the key of an element.

    Each call of `literal_eval` leaves a reference cycle behind, and no collection frees it while an analysis runs.
    """
    return literal_eval(field[1:-1])


def arrive(ctx: Interpreter, value: Value, carriers: Nodes) -> Value:
    """Return a field's value after the carriers of the pointer have passed it on."""
    if not carriers:
        return value
    deps = ctx.graph.through(value.deps, carriers) | carriers
    return Value(deps, value.pts, value.consts)


def items_are_attributes(obj: Obj) -> bool:
    """Return whether an object also stands for its `vars()`, whose items are its attributes."""
    return attribute_of_item(obj, "name") == "name"


def attribute_of_item(obj: Obj, key: object) -> str:
    """Return the field that `vars(obj)[key]` accesses: for a dictionary, an element; else an attribute."""
    if (obj.kind == "closure" or obj.name == NAMESPACE) and isinstance(key, str):
        return key
    if obj.kind == "instance" and isinstance(key, str) and isinstance(obj.info, Obj):
        infos = [c.info for c in lineage(obj.info)]
        external = {e for i in infos if isinstance(i, ClassInfo) for e in i.external}
        if not any(e.rpartition(".")[2] in DICTIONARIES for e in external):
            return key
    return item_field(key)


def _binding(obj: Obj) -> str:
    """Return how a class attribute is bound: not at all, to the class, or to the instance."""
    if obj.kind != "closure":
        return "staticmethod"
    function = obj.info[0] if isinstance(obj.info, tuple) else None
    for decorator in function.decorators if isinstance(function, ir.Function) else ():
        if isinstance(decorator, ir.Name) and decorator.name in ("staticmethod", "classmethod"):
            return decorator.name
    return "method"
