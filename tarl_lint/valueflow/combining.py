"""Containers made of containers: concatenation, repetition, union, slices; and what decides how long they are."""

from __future__ import annotations

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import ANY, KEYS, LENGTH, SENT, item_field
from tarl_lint.valueflow.special import Special
from tarl_lint.valueflow.values import ABSENT, BOTTOM, NONE, UNKNOWN, Nodes, Obj, Value, join_all, pointer

MAX_KNOWN = 16  # elements of a made sequence that are told apart
COMBINING = frozenset(["+", "*", "|", "-", "&"])


class Combining(Special):
    """Makes containers of containers."""

    def combined(self, expr: ir.Operation, values: list[Value], frame: Frame) -> Value | None:
        """Return the new container that an operator makes of containers, None where there are none."""
        kinds = [{o.kind for o in v.pts} for v in values]
        if expr.operator == "*" and {"sequence"} in kinds:
            return self.repeated(expr, values, frame)
        if kinds == [{"sequence"}, {"sequence"}]:
            return self.concatenated(expr, values, frame)
        if kinds == [{"mapping"}, {"mapping"}]:
            obj = self.allocate("mapping", frame, ("combined", expr.pos))
            for value in values:
                self.absorb(obj, value)
            return Value(values[0].deps | values[1].deps, frozenset([obj]))
        return None

    def repeated(self, expr: ir.Operation, values: list[Value], frame: Frame) -> Value:
        """Return `[x] * n`."""
        several = next(v for v in values if v.pts)
        count = self.use(next((v for v in values if v is not several), UNKNOWN))
        element, length = self.elements(several), self.length(several)
        obj = self.allocate("sequence", frame, ("combined", expr.pos))
        self.add_element(pointer(obj), element)
        self.store.put((obj, LENGTH), Value(length | count))
        return Value(several.deps, frozenset([obj]))

    def concatenated(self, expr: ir.Operation, values: list[Value], frame: Frame) -> Value:
        """Return `a + b`; elements are told apart where both are known one by one."""
        known = [self.unpacked(v) for v in values]
        element = join_all(self.elements(v) for v in values)
        length = self.length(values[0]) | self.length(values[1])
        obj = self.allocate("sequence", frame, ("combined", expr.pos))
        exact = [e for part in known if part is not None for e in part]
        if None in known or len(exact) > MAX_KNOWN or expr.operator != "+":
            self.add_element(pointer(obj), element)
        else:
            for number, value in enumerate(exact):
                self.store.put((obj, item_field(number)), value)
        self.store.put((obj, LENGTH), Value(length))
        return Value(values[0].deps | values[1].deps, frozenset([obj]))

    def grown(self, name: str, values: list[Value]) -> Value:
        """Return what `a += b` or `a |= b` leaves in a container."""
        first, second = values
        for obj in first.pts:
            if obj.kind == "mapping" and name == "|=":
                self.absorb(obj, second)
            else:
                self.add_element(pointer(obj), self.elements(second))
                self.lengthen(obj, second)
        return Value(first.deps | second.deps, first.pts)

    def sliced(self, base: Value, index: ir.Slice, pos: ir.Pos, frame: Frame) -> Value:
        """Return `base[a:b]`: of sequences a new one, of others what their elements are."""
        bounds = [self.evaluate(part, frame) for part in index.parts]
        extra = NONE
        for bound in bounds:
            extra |= self.use(bound)
        ours = frozenset(o for o in base.pts if o.kind == "sequence")
        if not ours or ours != base.pts:
            return self.read_item(base, Value(extra))
        element = self.elements(Value(pts=ours))
        length = self.length(Value(pts=ours)) | extra
        obj = self.allocate("sequence", frame, ("slice", pos))
        self.add_element(pointer(obj), Value(element.deps | extra, element.pts, element.consts))
        self.store.put((obj, LENGTH), Value(length))
        return Value(base.deps, frozenset([obj]))

    def read_item(self, base: Value, index: Value) -> Value:
        """Return an element."""
        raise NotImplementedError

    def unpacked(self, value: Value) -> list[Value] | None:
        """Return the elements of a sequence whose elements are known one by one."""
        if len(value.pts) != 1:
            return None
        obj = next(iter(value.pts))
        if obj.kind != "sequence" or self.content(obj) is not BOTTOM:
            return None
        found: list[Value] = []
        while (stored := self.store.get((obj, item_field(len(found))))) is not None:
            found.append(self.arrive(stored, value.deps))
        return found

    def absorb(self, obj: Obj, value: Value) -> None:
        """Copy the elements of what a value may be into an object."""
        for source in value.pts:
            self.store.look(source)
            for name in list(source.fields):
                stored = self.store.get((source, name))
                if stored is not None and (name.startswith("[") or name in (ANY, KEYS, LENGTH)):
                    field = self.attribute_of_item(obj, name[2:-2]) if name.startswith("['") else name
                    self.weaken(obj, field, self.arrive(stored, value.deps))
            content = self.content(source)
            if content.deps and self.store.get((source, ANY)) is None:
                self.add_element(pointer(obj), content)
        if not value.pts and value.deps:
            self.add_element(pointer(obj), Value(value.deps))

    def empty(self, obj: Obj) -> None:
        """Take everything out of a container."""
        for name in list(obj.fields):
            if name.startswith("[") or name in (ANY, KEYS, LENGTH):
                self.store.put((obj, name), ABSENT)

    # --- lengths ------------------------------------------------------------------------------------------

    def length(self, value: Value) -> Nodes:
        """Return the nodes that a value's length is data of: of our containers not their elements."""
        deps = value.deps
        for obj in value.pts:
            if self.sized(obj):
                stored = self.store.get((obj, LENGTH))
                made = stored.deps if stored is not None else NONE
                if obj.parent is not None:
                    made |= self.content(obj.parent).deps
                deps |= self.graph.through(made, value.deps)
            elif SENT in obj.fields:
                deps |= self.content(obj).deps
            else:
                deps |= self.use(Value(value.deps, frozenset([obj])))
        return deps

    def sized(self, obj: Obj) -> bool:
        """Tell whether an object has elements that say nothing of how many there are: ours, and arrays of messages."""
        if obj.kind in ("sequence", "mapping"):
            return True
        return obj.parent is not None and (ANY in obj.fields or any(n.startswith("[") for n in obj.subs))

    def placed(self, objects: frozenset[Obj]) -> Nodes:
        """Return the nodes that put elements into containers, whatever was stored inside the elements later."""
        found: set[int] = set()
        for obj in objects:
            self.store.look(obj)
            found |= self.content(obj).deps
            for name in list(obj.fields):
                if name.startswith("[") or name in (KEYS, LENGTH):
                    value = self.store.get((obj, name))
                    found |= value.deps if value is not None else NONE
        return frozenset(found)

    def lengthen(self, obj: Obj, value: Value) -> None:
        """Let an object's length depend on that of a value whose elements it takes over."""
        length = self.length(value)
        if length:
            self.decide_length(obj, length)

    def decide_length(self, obj: Obj, deps: Nodes) -> None:
        """Let an object's length depend on more than before."""
        before = self.store.get((obj, LENGTH))
        self.store.put((obj, LENGTH), Value(deps | (before.deps if before is not None else NONE)))
