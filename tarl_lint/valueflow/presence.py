"""Whether anything is there: variables and fields that hold None until something is stored."""

from __future__ import annotations

from collections.abc import Iterator

from tarl_lint import catalog
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.combining import Combining
from tarl_lint.valueflow.heap import ANY
from tarl_lint.valueflow.machine import NONE_ONLY
from tarl_lint.valueflow.values import Frame, Key, Obj, Value, lineage


class Presence(Combining):
    """Knows where None stands for nothing yet, and where for what was found."""

    def only_presence(self, expr: ir.Operation, frame: Frame) -> bool:
        """Tell whether `x is None` asks if anything was stored in place of the None that was there at first.

        That a message has come is no data of it; what decided whether to store is.
        """
        first, second = expr.parts
        if not isinstance(second, ir.Const) or second.value is not None:
            return False
        keys = list(self._keys(first, frame))
        if isinstance(first, (ir.Item, ir.Call)):
            return (
                bool(keys)
                and not self._index_chosen(first, frame)
                and not any(k in self.optional for k in keys)
            )
        return any(k in self.vacant for k in keys) and not any(k in self.optional for k in keys)

    def note_absence(self, target: ir.Expr, source: ir.Expr, value: Value, frame: Frame) -> None:
        """Remember that a target gets None, or what may be None as well as something else."""
        if value.consts == NONE_ONLY and not value.pts:
            self.vacant.update(self._keys(target, frame))
        elif self._may_be_none(source, frame):
            self.optional.update(self._keys(target, frame))

    def note_result(self, call: ir.Call, returned: list[Value]) -> None:
        """Remember a call of a function that gives None beside other things."""
        without = [v.consts == NONE_ONLY and not v.pts for v in returned]
        if any(without) and not all(without):
            self.doubtful.add(call)

    def _may_be_none(self, expr: ir.Expr, frame: Frame) -> bool:
        if isinstance(expr, ir.Call):
            name = expr.function.name if isinstance(expr.function, (ir.Attribute, ir.Name)) else ""
            return expr in self.doubtful or name in catalog.MAY_BE_NONE
        if isinstance(expr, ir.Choice):
            return any(_none(arm) or self._may_be_none(arm, frame) for arm in (expr.then, expr.other))
        if isinstance(expr, (ir.Name, ir.Attribute)):
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
