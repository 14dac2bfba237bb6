"""State machines of smach: the userdata that their states share, under the names that each state has for them."""

from __future__ import annotations

from collections.abc import Iterable

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import recency
from tarl_lint.memory.values import Obj, Value, pointer

VIEW = "view"  # the kind of what a state is handed: the shared fields under names of its own
MACHINE_FIELD = "userdata"  # the attribute of a state machine that holds the shared fields


def userdata(ctx: Interpreter, state: Obj | None = None) -> Value:
    """Return the userdata as a state sees it, without one as the machine does."""
    if state is None:
        return pointer(recency.intern(ctx, "record", MACHINE_FIELD, MACHINE_FIELD))
    view = recency.intern(ctx, VIEW, (MACHINE_FIELD, state))
    if view.info is None:
        view.info = {}
    return pointer(view)


def rename(ctx: Interpreter, state: Obj, names: Iterable[tuple[str, str]]) -> None:
    """Remember what a state's own names stand for."""
    for view in userdata(ctx, state).pts:
        if isinstance(view.info, dict):
            before = dict(view.info)
            view.info.update(names)
            view.stamp += view.info != before


def seen_through(ctx: Interpreter, view: Obj, name: str) -> tuple[Obj, str]:
    """Return the shared object and the name there of a field that a state sees."""
    ctx.store.reads.look(view)
    names = view.info if isinstance(view.info, dict) else {}
    shared = next(iter(userdata(ctx).pts))
    return shared, str(names.get(name, name))
