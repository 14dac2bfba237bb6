"""Attributes that code of the class handles: setters of properties, `__setattr__`, and descriptors."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import dunder_methods
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, joins
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.store import Delta
from tarl_lint.memory.values import BOTTOM, Obj, Value, certain_pointer, const, join, lineage, pointer

METHODS: Final = frozenset(["__get__", "__set__", "__set_name__", "__setattr__", "__getattr__"])


def note(ctx: Interpreter, name: str) -> None:
    """Record that a class defines a method.

    Attributes of classes are searched for descriptors only if such a method is recorded.
    """
    if name in METHODS:
        ctx.nullness.setters.add(name)


def read(ctx: Interpreter, base: Value, value: Value, name: str, frame: Frame, pos: ir.Pos) -> Value | None:
    """Return an attribute's value from its descriptor; None if no class has one.

    `value` is the attribute without descriptors.
    """
    found = None
    for obj in base.objects if _used(ctx, "__get__") else ():
        held = ctx.store.get((obj, name))
        for descriptor in _descriptors(ctx, obj, name):
            if held is None or descriptor in held.pts:
                given = [certain_pointer(obj), pointer(obj.info)] if isinstance(obj.info, Obj) else []
                said = _call(ctx, descriptor, "__get__", given, frame, pos)
                if said is not None:
                    value = Value(value.deps, value.pts - {descriptor}, value.consts)
                    found = join(found or BOTTOM, said)
    return None if found is None else join(found, value) if value.pts else found


def entry(ctx: Interpreter, obj: Obj, name: str) -> Value:
    """Return `vars(obj)[name]`, without a descriptor that the class holds under this name."""
    value = heap.read_field(ctx, obj, name)
    if not value.pts or not _used(ctx, "__get__"):
        return value
    return Value(value.deps, value.pts.difference(_descriptors(ctx, obj, name)), value.consts)


def computed(ctx: Interpreter, base: Value, name: str, frame: Frame, pos: ir.Pos) -> Value | None:
    """Return an attribute that no object has, from `__getattr__` of the class; None without such a method."""
    if not _used(ctx, "__getattr__"):
        return None
    return dunder_methods.special(ctx, base, "__getattr__", [const(name)], frame, pos)


def write(ctx: Interpreter, base: Value, name: str, value: Value, frame: Frame, pos: ir.Pos) -> bool:
    """Pass a value to `__setattr__`, a property or a descriptor; return whether there is any."""
    given = [const(name), value]
    done = _used(ctx, "__setattr__") and (
        dunder_methods.special(ctx, base, "__setattr__", given, frame, pos) is not None
    )
    if _used(ctx, name):
        done |= _set_property(ctx, base, name, value, frame, pos)
    for obj in base.objects if _used(ctx, "__set__") else ():
        for descriptor in _descriptors(ctx, obj, name):
            given = [certain_pointer(obj), value]
            done |= _call(ctx, descriptor, "__set__", given, frame, pos) is not None
    return done


def write_some(ctx: Interpreter, base: Value, value: Value, frame: Frame, pos: ir.Pos) -> None:
    """Store a value in an attribute of unknown name: any setter or descriptor of the class may receive the value."""
    deltas: list[Delta] = [{}]
    for obj in base.objects:
        for owner in lineage(obj.info) if obj.kind == "instance" and isinstance(obj.info, Obj) else ():
            ctx.store.reads.look(owner)
            for name in [n.removesuffix(".setter") for n in owner.fields if _may_set(ctx, owner, n)]:
                ctx.store.push()
                write(ctx, pointer(obj), name, value, frame, pos)
                deltas.append(ctx.store.pop())
    if len(deltas) > 1:
        joins.merge(ctx, deltas)


def _may_set(ctx: Interpreter, owner: Obj, field: str) -> bool:
    """Return whether an attribute of a class is the setter of a property, or a descriptor."""
    if field.endswith(".setter"):
        return True
    held = ctx.store.get((owner, field)) if _used(ctx, "__set__") else None
    classes = [o.info for o in held.objects if o.kind == "instance"] if held is not None else []
    return any(
        ctx.store.get((c, "__set__")) is not None
        for cls in classes
        if isinstance(cls, Obj)
        for c in lineage(cls)
    )


def _set_property(ctx: Interpreter, base: Value, name: str, value: Value, frame: Frame, pos: ir.Pos) -> bool:
    """Call the setters of a property; return whether a class has one."""
    done = False
    for obj in base.objects:
        cls = obj.info if obj.kind == "instance" else None
        setter = heap.through_class(ctx, obj, cls, f"{name}.setter") if isinstance(cls, Obj) else None
        if setter is not None:
            call = ir.Call(ir.Const(None, pos), (), (), pos, dunder_methods.slot("__set__", pos))
            ctx.ops.call_value(ctx, setter, ([value], {}), frame, call)
            done = True
    return done


def name_all(ctx: Interpreter, cls: Obj, frame: Frame, pos: ir.Pos) -> None:
    """Call `__set_name__` of the descriptors in a new class."""
    ctx.store.reads.look(cls)
    for name in list(cls.fields) if _used(ctx, "__set_name__") else ():
        held = ctx.store.get((cls, name))
        for descriptor in held.objects if held is not None else ():
            if descriptor.kind == "instance":
                given = [pointer(cls), const(name)]
                dunder_methods.special(ctx, pointer(descriptor), "__set_name__", given, frame, pos)


def _used(ctx: Interpreter, name: str) -> bool:
    ctx.store.reads.ask(ctx.nullness.setters.__contains__, name)
    return name in ctx.nullness.setters


def _descriptors(ctx: Interpreter, obj: Obj, name: str) -> list[Obj]:
    """Return the objects that an instance's class holds under a name."""
    for owner in lineage(obj.info) if obj.kind == "instance" and isinstance(obj.info, Obj) else ():
        held = ctx.store.get((owner, name))
        if held is not None:
            return [o for o in held.objects if o.kind in ("instance", "property")]
    return []


def _call(
    ctx: Interpreter, descriptor: Obj, name: str, given: list[Value], frame: Frame, pos: ir.Pos
) -> Value | None:
    """Call a descriptor's `__get__` or `__set__`, or a property's function; None without it."""
    if not isinstance(descriptor.info, tuple):
        return dunder_methods.special(ctx, pointer(descriptor), name, given, frame, pos)
    ctx.store.reads.look(descriptor)
    getter, setter = descriptor.info
    function, passed = (getter, given[:1]) if name == "__get__" else (setter, given)
    if function is BOTTOM:
        return None
    call = ir.Call(ir.Const(None, pos), (), (), pos, dunder_methods.slot(name, pos))
    found: Value = ctx.ops.call_value(ctx, function, (passed, {}), frame, call)
    return found
