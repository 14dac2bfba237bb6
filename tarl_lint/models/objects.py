"""Builtins that return objects and classes: `type`, `super`, weak references; values of unset fields."""

from __future__ import annotations

from tarl_lint import catalog
from tarl_lint.interpret import call_contexts, descriptors, metaclasses
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.memory import heap, recency, userdata
from tarl_lint.memory.userdata import MACHINE_FIELD
from tarl_lint.memory.values import BOTTOM, BY_CLASS, UNKNOWN, Obj, Value, lineage, pointer
from tarl_lint.models import command_line, containers, sizes


def blank_object(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `object.__new__(cls)`."""
    classes = [o for v in it.arguments[0][:1] for o in v.pts if o.kind == "class"]
    if ctx.class_made is not None and any(map(metaclasses.makes_classes, classes)):
        return pointer(ctx.class_made)
    return Value(pts=frozenset(call_contexts.blank_instance(ctx, c, it.frame, it.call) for c in classes))


def namespace(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `SimpleNamespace(...)`: an object with the keyword arguments as attributes."""
    plain, named = it.arguments
    obj = recency.allocate(ctx, "lib", it.frame, ("made", it.call.slot))
    obj.name, obj.info = heap.NAMESPACE, BY_CLASS
    for value in (*plain, *(value for name, value in named.items() if name == "**")):
        sizes.absorb(ctx, obj, value)
    for name, value in named.items():
        if name != "**":
            ctx.store.put((obj, name), value)
    return pointer(obj)


def weak_reference(ctx: Interpreter, it: Invocation) -> Value:
    """Return a weak reference, which returns its referent when called."""
    obj = recency.allocate(ctx, "weak", it.frame, ("made", it.call.slot))
    obj.describe(it.arguments[0][0] if it.arguments[0] else UNKNOWN)
    return pointer(obj)


def same(ctx: Interpreter, it: Invocation) -> Value:  # noqa: ARG001 - shared signature
    """Return the first argument unchanged."""
    return it.arguments[0][0] if it.arguments[0] else UNKNOWN


def type_of(ctx: Interpreter, it: Invocation) -> Value:  # noqa: ARG001 - shared signature
    """Return the class of analysed objects, which depends on what chose the object; a type is not data."""
    given = it.arguments[0][0] if it.arguments[0] else UNKNOWN
    classes = [o.info for o in given.pts if o.kind == "instance"]
    found = frozenset(c for c in classes if isinstance(c, Obj))
    return Value(given.deps, found) if found else UNKNOWN


def property_of(ctx: Interpreter, it: Invocation) -> Value:
    """Return the property that a call of `property(getter, setter)` makes."""
    plain, named = it.arguments
    obj = recency.intern(ctx, "property", (it.frame.id, it.statement, it.call.slot), "property")
    getter = plain[0] if plain else named.get("fget", BOTTOM)
    obj.describe((getter, plain[1] if len(plain) > 1 else named.get("fset", BOTTOM)))
    for name in ("__get__", "__set__"):
        descriptors.note(ctx, name)
    return pointer(obj)


def parent(ctx: Interpreter, it: Invocation) -> Value:
    """Return the value of `super()` or `super(cls, self)`: the object or class; look-ups begin after a class."""
    receiver = it.frame
    while receiver.owner is None and receiver.outer is not None:
        receiver = receiver.outer
    parameters = receiver.function.parameters
    this = ctx.store.get((receiver, parameters[0].name)) if parameters else None
    if this is None or receiver.owner is None:
        return UNKNOWN
    given = [o for v in it.arguments[0][:1] for o in v.pts if o.kind == "class"]
    owner = given[0] if len(given) == 1 else receiver.owner
    found = []
    seen = it.arguments[0][1].objects if len(it.arguments[0]) > 1 else ()
    for obj in seen if seen and all(o.kind == "class" for o in seen) else this.objects:
        view = recency.intern(ctx, "super", (owner.key, obj))
        view.info = (owner, obj)
        found.append(view)
    return Value(pts=frozenset(found))


def default(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return the value of an unset field; this includes fields of `super()` and of parameters."""
    if obj.kind == "super" and isinstance(obj.info, tuple):
        owner, this = obj.info
        cls = this.info if this.kind == "instance" else this
        order = lineage(cls) if isinstance(cls, Obj) else []
        after = order[order.index(owner) + 1 :] if owner in order else []
        for base in after:
            value = ctx.store.get((base, name))
            if value is not None:
                seen = heap.bind_class if this.kind == "class" else heap.bind
                return seen(ctx, value, this, base)
        return BOTTOM
    if obj.name in containers.PROCESSES and name in containers.STREAMS:
        # all streams share one object, which represents the process: data written to one stream may be read from
        # another stream
        return pointer(obj)
    if obj.kind == "ext" and name == "argv" and obj.name == "sys" and ctx.command_line:
        return command_line.arguments(ctx)
    if obj.kind == "lib" and name == MACHINE_FIELD:
        return userdata.userdata(ctx)
    if obj.kind == "parameter" and name == "name":
        return Value(consts=frozenset([obj.name]))
    if obj.kind == "parameter":
        return ctx.store.get((obj, "value")) or UNKNOWN if name in catalog.PARAMETER_VALUES else UNKNOWN
    return heap.default(ctx, obj, name)
