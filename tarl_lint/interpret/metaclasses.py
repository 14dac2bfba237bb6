"""Metaclasses of the analysed files: `__new__` and `__init__` run for each class, and may register it."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import ClassInfo, Obj, Value, const, lineage, pointer

KINDS: Final = frozenset(["builtins.type", "abc.ABCMeta", "enum.EnumMeta", "enum.EnumType"])


def of(cls: Obj, given: Value | None) -> Obj | None:
    """Return the analysed metaclass of a class statement or its base class, or None."""
    named = next((o for o in given.objects if o.kind == "class"), None) if given is not None else None
    above = (base.info.metaclass for base in lineage(cls)[1:] if isinstance(base.info, ClassInfo))
    return named or next((one for one in above if one is not None), None)


def makes_classes(cls: Obj) -> bool:
    """Return whether a class is a metaclass."""
    infos = [one.info for one in lineage(cls)]
    return any(not KINDS.isdisjoint(info.external) for info in infos if isinstance(info, ClassInfo))


def apply(ctx: Interpreter, cls: Obj, metaclass: Obj, frame: Frame, pos: ir.Pos) -> None:
    """Call the `__new__` and `__init__` of a metaclass for a class; `super().__new__` returns this class."""
    bases = cls.info.bases if isinstance(cls.info, ClassInfo) else []
    listed = recency.intern(ctx, "sequence", ("bases of", cls.key))
    for number, base in enumerate(bases):
        ctx.store.put((listed, heap.item_field(number)), pointer(base))
    body = recency.intern(ctx, "mapping", ("body of", cls.key))
    ctx.store.look(cls)
    for name in list(cls.fields):
        held = ctx.store.get((cls, name))
        if held is not None:
            ctx.store.put((body, heap.item_field(name)), held)
    given = [const(cls.name), pointer(listed) if bases else const(()), pointer(body)]
    outside, ctx.class_made = ctx.class_made, cls
    for number, (name, first) in enumerate((("__new__", metaclass), ("__init__", cls))):
        for owner in lineage(metaclass):
            function = ctx.store.get((owner, name))
            if function is not None:
                call = ir.Call(ir.Const(None, pos), (), (), pos, -(number + 2))
                ctx.ops.call_value(ctx, function, ([pointer(first), *given], {}), frame, call)
                break
    ctx.class_made = outside
