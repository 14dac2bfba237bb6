"""Taking values apart: unpacking with a star, iterating over objects of ours."""

from __future__ import annotations

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.activations import CALLABLE
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import item_field
from tarl_lint.valueflow.invocation import Arguments
from tarl_lint.valueflow.ros import Ros
from tarl_lint.valueflow.values import BOTTOM, Obj, Value, const, join, pointer

ITERATED = -2  # slots of the calls that a loop makes
NEXT = -3


ITERATING = frozenset(
    f"builtins.{name}"
    for name in (
        "list", "tuple", "set", "frozenset", "sorted", "iter", "sum", "min", "max", "any", "all", "enumerate", "zip",
        "map", "filter",
    )
) | {"collections.deque", "numpy.array", "numpy.asarray"}  # fmt: skip


class Taking(Ros):
    """Gives the parts of values."""

    def call_library(self, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Call a function or class of a library; those that go over objects of ours ask these for iterators."""
        if qualified in ITERATING:
            arguments = [self._gone_over(v, frame, call) for v in arguments[0]], arguments[1]
        return super().call_library(qualified, arguments, frame, call)

    def _gone_over(self, value: Value, frame: Frame, call: ir.Call) -> Value:
        if not any(o.kind == "instance" and self._iterator(o) is not BOTTOM for o in value.pts):
            return value
        given = self.iterated(value, ir.Const(None, call.pos), frame)
        return self.listed_parts(given, frame, f"{call.slot}")

    def parts(self, value: Value, count: int, starred: int | None, frame: Frame, slot: str) -> list[Value]:
        """Return what each of several targets gets; the starred one gets a sequence."""
        if any(o.kind == "instance" and self._iterator(o) is not BOTTOM for o in value.pts):
            given = self.iterated(value, ir.Const(None, frame.function.pos), frame)
            value = self.listed_parts(given, frame, slot)
        if starred is None:
            return [self.read_item(value, const(n)) for n in range(count)]
        rest = self.allocate("sequence", frame, ("rest", slot))
        known = self.unpacked(value)
        after = count - starred - 1
        if known is None or len(known) < count - 1:
            element = self.elements(value)
            self.add_element(pointer(rest), element)
            first = [self.read_item(value, const(n)) for n in range(starred)]
            return [*first, pointer(rest), *([element] * after)]
        end = len(known) - after
        for number, part in enumerate(known[starred:end]):
            self.store.put((rest, item_field(number)), part)
        return [*known[:starred], pointer(rest), *known[end:]]

    def listed_parts(self, element: Value, frame: Frame, slot: str) -> Value:
        """Return a sequence of what an object of ours gives when it is taken apart."""
        obj = self.allocate("sequence", frame, ("parts", slot))
        self.add_element(pointer(obj), element)
        return pointer(obj, element.deps)

    def iterated(self, source: Value, expr: ir.Expr, frame: Frame) -> Value:
        """Return what a loop over a value gives; objects of ours are asked for it."""
        ours = {o: m for o in source.pts if o.kind == "instance" and (m := self._iterator(o)) is not BOTTOM}
        if not ours:
            return self.elements(source)
        rest = source.pts - frozenset(ours)
        result = self.elements(Value(source.deps, rest)) if rest or source.deps else BOTTOM
        for obj, method in sorted(ours.items(), key=lambda item: str(item[0].key)):
            made = self.call_value(method, ([], {}), frame, ir.Call(expr, (), (), expr.pos, ITERATED))
            for iterator in sorted(made.pts, key=lambda o: str(o.key)):
                following = self._method(iterator, "__next__") if iterator.kind == "instance" else BOTTOM
                if following is BOTTOM:
                    result = join(result, self.elements(Value(made.deps, frozenset([iterator]))))
                else:
                    call = ir.Call(expr, (), (), expr.pos, NEXT)
                    result = join(result, self.call_value(following, ([], {}), frame, call))
            if not made.pts:
                result = join(result, Value(self.deep(frozenset([obj]))))
        return result

    def _iterator(self, obj: Obj) -> Value:
        return self._method(obj, "__iter__")

    def _method(self, obj: Obj, name: str) -> Value:
        """Return a method of ours, BOTTOM where there is none."""
        member = self.read_field(obj, name)
        callables = frozenset(o for o in member.pts if o.kind in CALLABLE)
        return Value(member.deps, callables) if callables else BOTTOM
