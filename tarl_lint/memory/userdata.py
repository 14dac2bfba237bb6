"""Userdata of smach state machines, which the states share under remapped names."""

from __future__ import annotations

from collections.abc import Iterable

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import recency
from tarl_lint.memory.values import Obj, Value, pointer

VIEW = "view"  # kind of the object for a state's userdata: the shared fields under remapped names
MACHINE_FIELD = "userdata"  # attribute of a state machine that holds the shared fields


def userdata(ctx: Interpreter, state: Obj | None = None) -> Value:
    """Return the userdata of a state; without a state, the userdata of the machine."""
    if state is None:
        return pointer(recency.intern(ctx, "record", MACHINE_FIELD, MACHINE_FIELD))
    view = recency.intern(ctx, VIEW, (MACHINE_FIELD, state))
    if view.info is None:
        view.info = {}
    return pointer(view)


def rename(ctx: Interpreter, state: Obj, names: Iterable[tuple[str, str]]) -> None:
    """Record a state's remapping of names."""
    for view in userdata(ctx, state).objects:
        if isinstance(view.info, dict):
            before = dict(view.info)
            view.info.update(names)
            if view.info != before:
                view.changed()


def seen_through(ctx: Interpreter, view: Obj, name: str) -> tuple[Obj, str]:
    """Return the shared object that holds a state's field, and the name of the field there."""
    ctx.store.reads.look(view)
    names = view.info if isinstance(view.info, dict) else {}
    shared = next(iter(userdata(ctx).pts))
    return shared, str(names.get(name, name))
