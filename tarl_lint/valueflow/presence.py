"""Whether anything is there: variables and fields that hold None until something is stored."""

from __future__ import annotations

from collections.abc import Iterator

from tarl_lint import catalog
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.combining import Combining
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import ANY, item_field
from tarl_lint.valueflow.machine import NONE_ONLY
from tarl_lint.valueflow.values import Key, Nodes, Obj, Value, lineage

RETURNED = "<return>"  # stands for what a function gives back
COPIED = (ir.Name, ir.Attribute, ir.Item, ir.Call)  # expressions that may be another's value


class Presence(Combining):
    """Knows where None stands for nothing yet, and where for what was found."""

    def only_presence(self, expr: ir.Operation, frame: Frame) -> Nodes | None:
        """Return what decides on `x is None` where it asks if anything was stored, None where it asks for data.

        That a message has come is no data of it; what decided whether to store is.
        """
        first, second = expr.parts
        if not isinstance(second, ir.Const) or second.value is not None:
            return None
        return self._absence(first, frame)

    def _absence(self, expr: ir.Expr, frame: Frame) -> Nodes | None:
        """Return what decided whether anything is there, None where that may be data."""
        if isinstance(expr, ir.Call) and expr in self.came_out:
            return None if expr in self.doubtful else frozenset(self.came_out[expr])
        keys = list(self._keys(expr, frame))
        if any(k in self.optional for k in keys):
            return None
        if isinstance(expr, (ir.Item, ir.Call)):
            known = bool(keys) and not self._index_chosen(expr, frame)
        else:
            known = any(k in self.vacant for k in keys)
        return frozenset(n for k in keys for n in self.came.get(k, ())) if known else None

    def note_absence(self, target: ir.Expr, source: ir.Expr, value: Value, frame: Frame) -> None:
        """Remember that a target gets None, or what may be None as well as something else."""
        if value.consts == NONE_ONLY and not value.pts:
            self.vacant.update(self._keys(target, frame))
        elif self._holds_data(value) and (decides := self._absence(source, frame)) is not None:
            self._note_copy(list(self._keys(target, frame)), value, decides, frame, target.pos)
        elif self._may_be_none(source, frame):
            self.optional.update(self._keys(target, frame))

    def note_passed(self, key: Key, source: ir.Expr, value: Value, frame: Frame) -> None:
        """Remember where a value is held that is None only as long as nothing has come."""
        if isinstance(source, COPIED) and self._holds_data(value):
            decides = self._absence(source, frame)
            if decides is not None:
                self._note_copy([key], value, decides, frame, source.pos)

    def note_taken(self, target: ir.Expr, held: Value, number: int, value: Value, frame: Frame) -> None:
        """Remember the same of a target that gets an element of a sequence."""
        keys = [(o, item_field(number)) for o in held.pts if o.kind == "sequence"]
        if any(k in self.vacant for k in keys):
            decides = frozenset(n for k in keys for n in self.came.get(k, ()))
            self._note_copy(list(self._keys(target, frame)), value, decides, frame, target.pos)

    def _note_copy(self, keys: list[Key], value: Value, decides: Nodes, frame: Frame, pos: ir.Pos) -> None:
        there = self.node(frame, ("came", pos), "condition")
        self.graph.choice(value.deps, there)
        self.graph.flow(decides, there)
        for key in keys:
            self.vacant.add(key)
            self.came.setdefault(key, set()).add(there)

    def _holds_data(self, value: Value) -> bool:
        return bool(value.deps) or any(o.laden for o in value.pts)

    def note_result(self, call: ir.Call, returned: list[Value], frame: Frame) -> None:
        """Remember a call of a function that gives None beside other things, or only as long as nothing has come."""
        without = [v.consts == NONE_ONLY and not v.pts for v in returned]
        if any(without) and not all(without):
            self.doubtful.add(call)
        elif (frame, RETURNED) in self.vacant:
            self.came_out.setdefault(call, set()).update(self.came.get((frame, RETURNED), ()))

    def _may_be_none(self, expr: ir.Expr, frame: Frame) -> bool:
        if isinstance(expr, ir.Call):
            name = expr.function.name if isinstance(expr.function, (ir.Attribute, ir.Name)) else ""
            return expr in self.doubtful or name in catalog.MAY_BE_NONE
        if isinstance(expr, ir.Choice):
            return any(_none(arm) or self._may_be_none(arm, frame) for arm in (expr.then, expr.other))
        if isinstance(expr, (ir.Name, ir.Attribute)) and self.optional:
            return any(k in self.optional for k in self._keys(expr, frame))
        return False

    def _keys(self, expr: ir.Expr, frame: Frame) -> Iterator[Key]:
        """Yield where a variable or a field of a variable is stored; a class stands for its instances too."""
        if isinstance(expr, ir.Name):
            yield self.holder(expr, frame), expr.name
        elif isinstance(expr, ir.Attribute) and isinstance(expr.base, (ir.Name, ir.Attribute, ir.Item)):
            for base in self.evaluate(expr.base, frame).pts:
                for owner in (base, *_classes(base)):
                    yield owner, expr.name
        elif isinstance(expr, ir.Item):
            yield from self._elements(expr.base, frame)
        elif isinstance(expr, ir.Call) and isinstance(expr.function, ir.Attribute) and _gets(expr):
            yield from self._elements(expr.function.base, frame)

    def _elements(self, container: ir.Expr, frame: Frame) -> Iterator[Key]:
        """Yield where the elements of a container of ours are stored: None in one of them may be in any."""
        held = self.evaluate(container, frame).pts if isinstance(container, (ir.Name, ir.Attribute)) else ()
        if all(o.kind in ("sequence", "mapping") for o in held):
            for obj in held:
                yield obj, ANY

    def _index_chosen(self, expr: ir.Item | ir.Call, frame: Frame) -> bool:
        """Tell whether data chooses the element that is asked for."""
        index = expr.index if isinstance(expr, ir.Item) else expr.arguments[0]
        if not isinstance(index, (ir.Const, ir.Name, ir.Attribute)):
            return True
        key = self.evaluate(index, frame)
        return bool(key.deps or key.pts)


def _classes(obj: Obj) -> list[Obj]:
    return lineage(obj.info) if obj.kind == "instance" and isinstance(obj.info, Obj) else []


def _gets(expr: ir.Call) -> bool:
    return (
        isinstance(expr.function, ir.Attribute) and expr.function.name == "get" and len(expr.arguments) == 1
    )


def _none(expr: ir.Expr) -> bool:
    return isinstance(expr, ir.Const) and expr.value is None
