"""Properties that are seen through their class: `Motor.speed.fset(motor, value)`."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.values import BOTTOM, Obj, Value, pointer

GETTERS: Final = frozenset(["fget", "__get__"])
PARTS: Final = GETTERS | {"fset", "__set__"}  # attributes of a property


def is_property(function: ir.Function) -> bool:
    """Return whether a decorator makes a property of a function."""
    return any(
        (isinstance(d, ir.Name) and d.name in ("property", "cached_property"))
        or (isinstance(d, ir.Attribute) and d.name in ("cached_property", "getter"))
        for d in function.decorators
    )


def part(ctx: Interpreter, getter: Obj, name: str) -> Value | None:
    """Return a property's getter or setter, if the getter is in a class; None for others."""
    function, _, _, owner = getter.info if isinstance(getter.info, tuple) else (None,) * 4
    if owner is None or (name == "__get__" and not is_property(function)):
        return None
    return pointer(getter) if name in GETTERS else ctx.store.get((owner, f"{getter.name}.setter")) or BOTTOM
