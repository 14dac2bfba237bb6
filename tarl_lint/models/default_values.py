"""Lists and mappings that are the defaults of parameters: on the robot, their entries may have other values."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.symbolic_names import with_default
from tarl_lint.memory.values import Value, pointer

# maximum number of entries that are copied from a default, over all levels of nesting
MAX_ENTRIES: Final = 64
CONTAINERS: Final = frozenset(["sequence", "mapping"])


def replaceable(ctx: Interpreter, default: Value, frame: Frame, slot: Hashable) -> Value | None:
    """Return a copy of a list or mapping whose texts are defaults; the actual texts are unknown.

    Numbers in the copy are unknown. Return None for other values, and for empty and large containers.
    """
    copied = _Copy(ctx, frame)
    found = copied.value(default, ("default", slot)) if default.pts else None
    return found if found is not None and copied.count <= MAX_ENTRIES else None


class _Copy:
    """A copy of nested containers, with the number of entries so far."""

    def __init__(self, ctx: Interpreter, frame: Frame) -> None:
        self.ctx = ctx
        self.frame = frame
        self.count = 0

    def value(self, value: Value, slot: Hashable) -> Value | None:
        if not value.pts:
            return Value(value.deps, consts=with_default(value))
        (obj,) = value.pts if len(value.pts) == 1 else (None,)
        if obj is None or obj.kind not in CONTAINERS:
            return None
        self.ctx.store.look(obj)
        entries = [(n, v) for n in list(obj.fields) if (v := self.ctx.store.get((obj, n))) is not None]
        entries = [(name, held) for name, held in entries if name.startswith("[")]
        self.count += len(entries)
        if not entries or self.count > MAX_ENTRIES:
            return None
        made = recency.allocate(self.ctx, obj.kind, self.frame, slot)
        for name, held in entries:
            inner = self.value(held, (slot, name))
            if inner is None:
                return None
            self.ctx.store.put((made, name), inner)
        return pointer(made, value.deps)
