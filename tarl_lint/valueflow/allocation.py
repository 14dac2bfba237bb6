"""Objects: one per key, the newest of an allocation site apart from the older ones."""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.machine import Machine
from tarl_lint.valueflow.store import BORN
from tarl_lint.valueflow.values import ABSENT, BOTTOM, Obj, Value, join

MAX_NESTING = 7


class Allocation(Machine):
    """Makes objects."""

    def intern(self, kind: str, key: Hashable, name: str = "") -> Obj:
        """Return the object with this key, made at the first time."""
        found = self.objects.get((kind, key))
        if found is None:
            found = self.objects[kind, key] = Obj(kind, key, name)
        return found

    def allocate(self, kind: str, frame: Frame, slot: Hashable) -> Obj:
        """Return the newest object of an allocation site; what it stood for until now becomes the older ones."""
        statement = frame.statement
        key = (frame.id, statement.id if statement is not None else -1, slot, *frame.turn)
        obj = self.objects.get((kind, key))
        if obj is None:
            obj = self.objects[kind, key] = Obj(kind, key)
            self.store.put((obj, BORN), BOTTOM)
            return obj
        if kind == "lib" and obj.fields:
            self._age(obj)
        self._clear(obj)
        self.store.put((obj, BORN), BOTTOM)
        return obj

    def _age(self, obj: Obj) -> None:
        """Where the former object is still held, let it be one of the older ones."""
        holders = [k for k in obj.holders if k[0] is not obj and self._holds(k, obj)]
        if not holders:
            return
        older = self.objects.get(("lib", (obj.key, "older")))
        if older is None:
            older = self.objects["lib", (obj.key, "older")] = Obj("lib", (obj.key, "older"))
            older.many = True
        self._copy_fields(obj, older)
        self.graph.asked += len(obj.holders)
        without: dict[frozenset[Obj], frozenset[Obj]] = {}  # many hold the same objects
        for key in holders:
            value = self.store.get(key)
            if value is not None:
                pts = without.get(value.pts)
                if pts is None:
                    pts = without[value.pts] = (value.pts - {obj}) | {older}
                self.store.put(key, Value(value.deps, pts, value.consts))

    def _holds(self, key: tuple[Obj, str], obj: Obj) -> bool:
        value = self.store.get(key)
        return value is not None and obj in value.pts

    def _copy_fields(self, obj: Obj, older: Obj, depth: int = 0) -> None:
        for name in list(obj.fields):
            value = self.store.get((obj, name))
            if value is not None:
                before = self.store.get((older, name))
                self.store.put((older, name), value if before is None else join(before, value))
        if depth < MAX_NESTING:
            for name, sub in list(obj.subs.items()):
                self._copy_fields(sub, older.sub(name), depth + 1)

    def _clear(self, obj: Obj, depth: int = 0) -> None:
        for name in list(obj.fields):
            self.store.put((obj, name), ABSENT)
        if depth < MAX_NESTING:
            for sub in list(obj.subs.values()):
                if sub is not obj:
                    self._clear(sub, depth + 1)
