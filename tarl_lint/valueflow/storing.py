"""Stores into fields and elements."""

from __future__ import annotations

from tarl_lint.valueflow.heap import ANY, HOLLOW, KEYS, RENAMING, Heap, item_field
from tarl_lint.valueflow.values import Obj, Value, join

MAX_KEYS = 8  # of a mapping, one of which a store may be for


class Storing(Heap):
    """Writes fields and elements, for certain where it is one object and one place."""

    def write_field(self, base: Value, name: str, value: Value) -> None:
        """Store into a field; for certain when there is only one object that it can be."""
        certain = len(base.pts) == 1
        for held in base.pts:
            if held.kind in ("bound", "ext", "method"):
                continue
            obj, field = self.renamed(held, name) if held.kind in RENAMING else (held, name)
            for attributes in self.replaced_attributes(obj):
                self.weaken(attributes, item_field(field), value)
            if certain and not obj.many:
                self.store.put((obj, field), value)
            else:
                self.weaken(obj, field, value)

    def weaken(self, obj: Obj, name: str, value: Value) -> None:
        """Store into a field of one of several objects."""
        before = self.store.get((obj, name))
        if before is None:
            before = self.default(obj, name)
        self.store.put((obj, name), join(before, value))

    def add_element(self, base: Value, value: Value) -> None:
        """Store into an element that is not known."""
        for obj in base.pts:
            if obj.kind in HOLLOW:
                continue
            before = self.content(obj)
            self.store.put((obj, ANY), join(before, value))
            for name in list(obj.fields):
                if name.startswith("["):
                    known = self.store.get((obj, name))
                    if known is not None:
                        self.store.put((obj, name), join(known, value))

    def write_item(self, base: Value, index: Value, value: Value) -> None:
        """Store into an element."""
        keys = self.use(index)
        for obj in base.pts if keys else ():
            if obj.kind == "mapping":
                self.weaken(obj, KEYS, Value(keys))
        if index.consts is None or not index.consts or len(index.consts) > 1:
            self._write_some(base, index, value)
            return
        key = next(iter(index.consts))
        if isinstance(key, int) and key < 0 and any(o.kind == "sequence" for o in base.pts):
            key = self.from_end(base, key)
            if key < 0:
                self.add_element(base, value)
                return
        fields = {self.attribute_of_item(obj, key) for obj in base.pts}
        for field in sorted(fields):
            kin = frozenset(o for o in base.pts if self.attribute_of_item(o, key) == field)
            self.write_field(base if kin == base.pts else Value(base.deps, kin), field, value)

    def _write_some(self, base: Value, index: Value, value: Value) -> None:
        """Store into one of several elements: of mappings those of known keys, else any."""
        known = sorted(index.consts or (), key=repr) if len(index.consts or ()) <= MAX_KEYS else []
        mappings = frozenset(o for o in base.pts if o.kind == "mapping" and known and not index.pts)
        for obj in sorted(mappings, key=lambda o: o.number):
            for key in known:
                self.weaken(obj, self.attribute_of_item(obj, key), value)
        self.add_element(Value(base.deps, base.pts - mappings), value)

    def from_end(self, base: Value, key: int) -> int:
        """Return a negative index counted from the start, where the length is known."""
        known = self.unpacked(base)
        return key + len(known) if known and -key <= len(known) else key

    def unpacked(self, value: Value) -> list[Value] | None:
        """Return the elements of a sequence whose elements are known one by one."""
        raise NotImplementedError
