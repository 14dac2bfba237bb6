"""Context managers made from generators, which `ir/context_managers.py` divides at their `yield`, and `ExitStack`."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret import dunder_methods
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.context_managers import LEAVE
from tarl_lint.memory import heap
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, join, join_all

ENTERING: Final = ("__enter__", "__aenter__")
LEAVING: Final = ("__exit__", "__aexit__")
_GIVEN, _REST = item_field(0), item_field(1)


def entered(ctx: Interpreter, manager: Value) -> tuple[Value, Value]:
    """Return the value that `with` binds, and the functions that run after its body.

    For other managers, the value is the manager itself.
    """
    if not manager.pts or any(o.kind != "sequence" for o in manager.pts):
        return manager, BOTTOM
    value, rest = BOTTOM, BOTTOM
    for obj in manager.objects:
        later = _rest(ctx, obj)
        if later is not None:
            rest = join(rest, later)
            value = join(value, heap.arrive(ctx, ctx.store.get((obj, _GIVEN)) or BOTTOM, manager.deps))
        elif obj.name == heap.GENERATOR:
            value = join(value, heap.elements(ctx, Value(manager.deps, frozenset([obj]))))
        else:
            return manager, BOTTOM
    return value, rest


def rest_of(ctx: Interpreter, value: Value) -> Value:
    """Return the functions that run after the bodies of the `with` statements of managers."""
    found = BOTTOM
    for obj in value.objects:
        if obj.kind == "sequence" and (later := _rest(ctx, obj)) is not None:
            found = join(found, later)
    return found


def _rest(ctx: Interpreter, obj: Obj) -> Value | None:
    stored = ctx.store.get((obj, _REST))
    if stored is None or not stored.pts or any(o.name != LEAVE for o in stored.pts):
        return None
    return stored


def put_on_stack(ctx: Interpreter, it: Invocation) -> Value:
    """Return the result of `stack.enter_context(manager)`; the stack keeps the functions that run after the body."""
    manager = it.arguments[0][0] if it.arguments[0] else UNKNOWN
    value, rest = entered(ctx, manager)
    for number, obj in enumerate(o for o in manager.objects if o.kind == "instance"):
        one, pos = Value(manager.deps, frozenset([obj])), it.call.inner(number).pos
        said = [dunder_methods.special(ctx, one, name, (), it.frame, pos) for name in ENTERING]
        value = join_all([value, *(found for found in said if found is not None)])
        leaving = [heap.read_field(ctx, obj, name) for name in LEAVING]
        rest = join_all([rest, *(found for found in leaving if found.pts)])
    for obj in it.base.objects if rest.pts else ():
        before = ctx.store.get((obj, LEAVE)) or BOTTOM
        ctx.store.put((obj, LEAVE), join(before, rest))
    return value


def kept_on_stack(ctx: Interpreter, stack: Value) -> Value:
    """Return the functions that run when a `with` leaves an `ExitStack`."""
    kept = (ctx.store.get((obj, LEAVE)) for obj in stack.objects if obj.kind == "lib")
    return join_all([one for one in kept if one is not None])


def leave(ctx: Interpreter, rest: Value, frame: Frame, pos: ir.Pos, number: int) -> None:
    """Run the part of each generator that follows its `yield`."""
    if rest.pts:
        call = ir.Call(ir.Const(None, pos), (), (), pos, dunder_methods.slot(LEAVE, pos) - number)
        ctx.ops.call_value(ctx, rest, ([], {}), frame, call)
