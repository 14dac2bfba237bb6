"""The names of attributes in objects: `"x" in vars(obj)`."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import NONE, Nodes, Obj, Value, join_all


def contains(ctx: Interpreter, holder: Value, name: Value, frame: Frame, slot: Hashable) -> Value | None:
    """Return `name in vars(obj)`, which depends on the conditions under which the program stores the attribute.

    Return None if an object may have elements of another kind.
    """
    if not holder.pts or not all(heap.is_namespace(ctx, obj) for obj in holder.pts):
        return None
    for obj in holder.objects:
        ctx.store.look(obj)
    names = name.texts() or {
        n for obj in holder.objects for n in [*obj.fields, heap.ANY] if not n.startswith("<")
    }
    decides = existence(ctx, holder.objects, sorted(names), frame, slot) or NONE
    return Value(holder.deps | ctx.use(name) | decides)


def existence(
    ctx: Interpreter, objects: Sequence[Obj], names: Sequence[str], frame: Frame, slot: Hashable
) -> Nodes | None:
    """Return the node of the conditions under which attributes are stored in objects; None if they never are."""
    held = [ctx.store.get((obj, name)) for obj in objects for name in names]
    stored = [value for value in held if value is not None]
    if not stored:
        return None
    node = ctx.node(frame, ("has", slot), "condition")
    ctx.graph.choice(join_all(stored).deps, node)
    return ctx.kept(node)
