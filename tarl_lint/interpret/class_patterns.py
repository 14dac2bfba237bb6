"""Class patterns of `match`: the parts that the subpatterns without a name get, as in `case Turn(angle)`."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap, record_fields
from tarl_lint.memory.values import BOTTOM, Obj, Value, join, lineage, pointer

MATCHED: Final = "__match_args__"
# classes whose only subpattern gets the whole object, as in `case float(number)`
WHOLE: Final = frozenset(
    f"builtins.{kind.__name__}"
    for kind in (bool, bytearray, bytes, dict, float, frozenset, int, list, set, str, tuple)
)


def part(ctx: Interpreter, value: Value, classes: Value, number: int) -> Value:
    """Return the object's part for the subpattern with a number; all its data if unknown."""
    if classes.pts and all(c.name in WHOLE for c in classes.pts):
        return value
    found = Value(value.deps, consts=BOTTOM.consts) if value.pts else Value(value.deps)
    for obj in value.objects:
        names = _names(ctx, obj.info) if obj.kind == "instance" and isinstance(obj.info, Obj) else []
        if number < len(names):
            found = join(found, heap.arrive(ctx, heap.read_field(ctx, obj, names[number]), value.deps))
        else:
            found = join(found, Value(ctx.use(pointer(obj, value.deps))))
    return found


def _names(ctx: Interpreter, cls: Obj) -> list[str]:
    """Return the attributes that subpatterns match in order: `__match_args__`, or the fields of a dataclass."""
    for owner in lineage(cls):
        told = ctx.store.get((owner, MATCHED))
        if told is not None:
            return [text for one in ctx.ops.unpacked(ctx, told) or () for text in one.texts()[:1]]
    return record_fields.positional(ctx, cls)
