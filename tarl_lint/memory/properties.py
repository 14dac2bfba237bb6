"""Properties that are seen through their class: `Motor.speed.fset(motor, value)`."""

from __future__ import annotations

from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory.values import BOTTOM, Obj, Value, pointer

GETTERS: Final = frozenset(["fget", "__get__"])
PARTS: Final = GETTERS | {"fset", "__set__"}  # attributes of a property


def part(ctx: Interpreter, getter: Obj, name: str) -> Value | None:
    """Return the getter or setter of the property whose getter is a function in a class; None for other functions."""
    owner = getter.info[3] if isinstance(getter.info, tuple) else None
    if owner is None:
        return None
    return pointer(getter) if name in GETTERS else ctx.store.get((owner, f"{getter.name}.setter")) or BOTTOM
