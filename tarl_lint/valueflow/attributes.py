"""Attributes by names that are values: `getattr` and `setattr`."""

from __future__ import annotations

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import item_field
from tarl_lint.valueflow.invocation import Arguments, Invocation
from tarl_lint.valueflow.texts import Texts
from tarl_lint.valueflow.values import BOTTOM, UNKNOWN, Obj, Value, join_all, lineage, pointer


class Attributes(Texts):
    """Reads and writes attributes by their names."""

    def generic(self, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Call a function of a library of which nothing is known."""
        raise NotImplementedError

    def get_attribute(self, it: Invocation) -> Value:
        """Return an attribute, by a name that is known or begins with something known."""
        plain = it.arguments[0]
        names = plain[1].texts() if len(plain) > 1 else ()
        if not names and len(it.call.arguments) > 1:
            return self._method_by_beginning(it) or self.generic(it.name, it.arguments, it.frame, it.call)
        return join_all([self.read(plain[0], n) for n in names] + plain[2:])

    def _method_by_beginning(self, it: Invocation) -> Value | None:
        """Return the methods that `getattr(self, "do_" + verb)` may mean, None where nothing tells."""
        start, (holder, name, *rest) = _beginning(it.call.arguments[1]), it.arguments[0]
        found = BOTTOM
        for obj in holder.pts if len(start) > 1 else ():
            for cls in lineage(obj.info) if obj.kind == "instance" and isinstance(obj.info, Obj) else ():
                for member in [n for n in cls.fields if n.startswith(start)]:
                    found = join_all([found, self.read_field(obj, member)])
        if not found.pts:
            return None
        decides = self.use(name)
        return Value(found.deps | decides, join_all([found, *rest]).pts)

    def getter(self, it: Invocation) -> Value:
        """Return the function that `attrgetter(...)` or `itemgetter(...)` makes."""
        obj = self.intern("partial", (it.frame.id, it.statement, it.call.slot, *it.frame.turn), it.name)
        obj.info = (self.external(f"{it.name}.<made>"), it.arguments[0], {})
        return pointer(obj)

    def get_named(self, it: Invocation) -> Value:
        """Return what a function made by `attrgetter` or `itemgetter` gives: several things as a tuple."""
        *keys, given = it.arguments[0] or [UNKNOWN]
        found = [self._by_path(given, k) if "attr" in it.name else self.read_item(given, k) for k in keys]
        if len(found) == 1:
            return found[0]
        obj = self.allocate("sequence", it.frame, ("display", it.call.slot, it.name))
        for number, value in enumerate(found):
            self.store.put((obj, item_field(number)), value)
        return pointer(obj)

    def _by_path(self, value: Value, name: Value) -> Value:
        for part in (name.texts() or ("",))[0].split("."):
            value = self.read(value, part)
        return value

    def set_attribute(self, it: Invocation) -> Value:
        """Store into the attribute that is named, into any where no name is known."""
        plain = it.arguments[0]
        if len(plain) == 3:
            value = self.through_statement(plain[2], it.frame, it.call)
            for field in plain[1].texts():
                self.write_field(plain[0], field, value)
            if not plain[1].texts():
                self.add_element(plain[0], value)
        return UNKNOWN


def _beginning(expr: ir.Expr) -> str:
    """Return the text that a text made at run time begins with."""
    while isinstance(expr, ir.Operation) and expr.parts and expr.operator in ("+", "text", "%"):
        expr = expr.parts[0]
    if (
        isinstance(expr, ir.Call)
        and isinstance(expr.function, ir.Attribute)
        and expr.function.name == "format"
    ):
        expr = expr.function.base
    text = expr.value if isinstance(expr, ir.Const) else ""
    return text.partition("%")[0].partition("{")[0] if isinstance(text, str) else ""
