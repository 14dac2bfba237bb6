"""Instances of classes that the program passes to a library. The library may look them up: `app.query_one(MapView)`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory.values import BOTTOM, Obj, Value, join, lineage, pointer

INSTANCES: Final = "<instances>"  # field of a class: its instances, including the instances of its subclasses
# names of library methods that return an existing object of the class among their arguments
LOOKS_UP: Final = re.compile(r"(?:query|find|get|resolve|look_?up|locate|fetch|try_component)(?:_|[A-Z]|$)")


def note(ctx: Interpreter, obj: Obj, cls: Obj) -> None:
    """Record a new instance if a library may look up this instance."""
    for owner in lineage(cls):
        if owner in ctx.looked_up:
            _add(ctx, owner, obj)


def looked_up(ctx: Interpreter, name: str, values: Iterable[Value]) -> Value:
    """Return the instances that a library method of this name returns for the classes among its arguments."""
    found = BOTTOM
    if LOOKS_UP.match(name) is None:
        return found
    for cls in (o for value in values for o in value.objects if o.kind == "class"):
        found = join(found, of_class(ctx, cls))
    return found


def of_class(ctx: Interpreter, cls: Obj) -> Value:
    """Return the instances of an analysed class, including the instances of its subclasses."""
    if cls not in ctx.looked_up:
        ctx.looked_up.add(cls)
        for obj in [*ctx.objects.values()]:
            if obj.kind == "instance" and isinstance(obj.info, Obj) and cls in lineage(obj.info):
                _add(ctx, cls, obj)
    return ctx.store.get((cls, INSTANCES)) or BOTTOM


def _add(ctx: Interpreter, cls: Obj, obj: Obj) -> None:
    before = ctx.store.get((cls, INSTANCES)) or BOTTOM
    ctx.store.put((cls, INSTANCES), join(before, pointer(obj)))
