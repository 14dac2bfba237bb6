"""What is inside objects, at any depth."""

from __future__ import annotations

from tarl_lint.definitions import FIELDS
from tarl_lint.valueflow.allocation import MAX_NESTING
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import ANY, HOLLOW
from tarl_lint.valueflow.storing import Storing
from tarl_lint.valueflow.values import NONE, ClassInfo, Nodes, Obj, Value


class Contents(Storing):
    """Collects the data inside objects."""

    def deep(self, objects: frozenset[Obj]) -> Nodes:
        """Return all nodes whose data is inside objects, as long as nothing is stored the same as before."""
        if len(objects) == 1:
            (obj,) = objects
            if not obj.laden:
                self.store.doubt(obj)
                return NONE
        now = (self.graph.grown, self.stack[-1] if self.stack else None)
        if self.store.looked != now:
            self.store.looked = now
            self.store.insides.clear()
        inside = self.store.insides.get(objects)
        if inside is not None:
            return inside
        known: dict[Obj, Nodes] = {}
        found = NONE
        for obj in in_order(objects):
            found |= self._deep(obj, known, 0)
        self.count(len(known))
        if self.graph.grown == now[0]:
            self.store.insides[objects] = found
        return found

    def _deep(self, obj: Obj, known: dict[Obj, Nodes], depth: int, *, counted: bool = False) -> Nodes:
        """Return what is inside one object. What holds itself is left out at the second time.

        `counted`: what may be anywhere in the object that it is part of was found there. Who comes to the part by
        another way asks again.
        """
        if obj.kind in HOLLOW or depth > MAX_NESTING:
            return NONE
        if not obj.laden:
            self.store.doubt(obj)
            return NONE
        inside = known.get(obj)
        if inside is not None:
            return inside
        known[obj] = NONE
        if obj.kind == "instance" and self._node_like(obj):
            return NONE
        self.store.look(obj)
        replaced = self.replaced(obj, self.defined(obj))
        found: set[int] = set()
        whole = not counted or ANY in obj.fields
        if not replaced and whole:
            found |= self.content(obj).deps
        for name in list(obj.fields):
            value = self.store.get((obj, name)) if name != ANY or not replaced else None
            if value is not None:
                found |= self.settled(value) if name.isidentifier() else value.deps
                if value.pts:
                    found |= self._behind(value, known, depth + 1)
        for name, sub in list(obj.subs.items()):
            if sub is not obj and self.store.get((obj, name)) is None:
                found |= self._deep(sub, known, depth + 1, counted=not replaced)
        inside = frozenset(found)
        if whole:
            known[obj] = inside
        else:
            del known[obj]
        return inside

    def defined(self, obj: Obj) -> str:
        """Return the name of a message's definition where that is known, of a message inside one too."""
        if obj.parent is None:
            return obj.defined
        outer = FIELDS.get(self.defined(obj.parent), {})
        return outer.get(obj.name, "")

    def replaced(self, obj: Obj, kind: str) -> bool:
        """Tell whether every field of a message, or of a copy of one, was overwritten in this run."""
        fields = FIELDS.get(kind)
        return fields is not None and all(
            self.written_here(obj, name)
            or (inner != "" and name in obj.subs and self.replaced(obj.subs[name], inner))
            for name, inner in fields.items()
        )

    def _behind(self, value: Value, known: dict[Obj, Nodes], depth: int) -> Nodes:
        """Return what is inside the objects that a field holds, as it arrives through the field."""
        inner = NONE
        for target in in_order(value.pts):
            if target.laden:
                inner |= self._deep(target, known, depth)
            elif target.kind not in HOLLOW:
                self.store.doubt(target)
        return self.graph.through(inner, value.deps) if inner else inner

    def _node_like(self, obj: Obj) -> bool:
        """Tell whether an instance is a program rather than data: passing it on passes no data."""
        info = obj.info.info if isinstance(obj.info, Obj) else None
        if not isinstance(info, ClassInfo):
            return False
        return info.opaque or any(self._is_self(f, obj) for f in self.stack if "self" in f.fields)

    def _is_self(self, frame: Frame, obj: Obj) -> bool:
        value = self.store.get((frame, "self"))
        return value is not None and obj in value.pts


def in_order(objects: frozenset[Obj]) -> list[Obj]:
    """Return objects in the order in which they were made: that of a set depends on where they are in memory."""
    return sorted(objects, key=lambda obj: obj.number) if len(objects) > 1 else list(objects)
