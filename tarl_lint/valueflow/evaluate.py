"""Expressions: what each may be."""

from __future__ import annotations

import builtins
from collections.abc import Callable, Mapping
from typing import Any

from tarl_lint.catalog import fact
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.displays import Displays
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import ANY
from tarl_lint.valueflow.values import (
    BOTTOM,
    NONE,
    UNKNOWN,
    Obj,
    Value,
    const,
    function_of,
    join,
    join_all,
    pointer,
)

BUILTINS = frozenset(dir(builtins))
DEFINITIONS = frozenset(["msg", "srv", "action"])  # modules of classes that definition files make


LOOKUP_ERRORS = ("KeyError", "IndexError", "LookupError")  # of an element that is not there


class Evaluation(Displays):
    """Evaluates expressions."""

    def evaluate(self, expr: ir.Expr, frame: Frame) -> Value:
        """Return what an expression may be."""
        value = EVALUATE[type(expr)](self, expr, frame)
        if self.probe is not None and frame.statement is not None:
            self.probe(self, frame, frame.statement, expr, value)
        return value

    def _constant(self, expr: ir.Const, frame: Frame) -> Value:  # noqa: ARG002 - one signature for all
        known: Value | None = expr.known
        if known is None:
            known = expr.known = const(expr.value)
        return known

    def _name(self, expr: ir.Name, frame: Frame) -> Value:
        value = self.store.get((self.holder(expr, frame), expr.name))
        if value is not None:
            return value
        if expr.scope == "local" and not frame.owner_class():
            return BOTTOM
        return self.global_name(expr.name, frame)

    def holder(self, expr: ir.Name, frame: Frame) -> Obj:
        """Return the object that holds a variable: an activation, a class being made, a module."""
        if expr.scope == "global":
            return frame.module
        if expr.scope == "local":
            return frame.owner_class() or frame
        holder: Frame | None = frame
        for _ in range(expr.level + (1 if frame.owner_class() else 0)):
            holder = holder.outer if holder is not None else None
        return holder or frame.module

    def global_name(self, name: str, frame: Frame) -> Value:
        """Return a name that the module itself does not bind: from `import *`, else a builtin."""
        value = self.store.get((frame.module, name))
        if value is None:
            value = self._opened(frame.module, name)
        if value is not BOTTOM:
            return value
        stars = [s for s in self.opened_by(frame.module) if s not in self.module_objects]
        for star in stars:
            if fact(f"{star}.{name}") is not None:
                return self.external(f"{star}.{name}")
        if name in BUILTINS:
            return self.external(f"builtins.{name}")
        return self.external(f"{_likely(stars, name)}.{name}") if stars else BOTTOM

    def external(self, qualified: str) -> Value:
        """Return a library's function, class or module."""
        return pointer(self.intern("ext", qualified, qualified))

    def _attribute(self, expr: ir.Attribute, frame: Frame) -> Value:
        base = self.evaluate(expr.base, frame)
        value = self.read(base, expr.name)
        for obj in value.pts:
            if obj.kind == "bound" and self.is_property(obj):
                call = ir.Call(expr, (), (), expr.pos, -expr.slot)
                if len(value.pts) == 1:
                    return self.call_object(obj, ([], {}), frame, call, base.deps)
                return self.call_value(value, ([], {}), frame, call)
        if value.consts == BOTTOM.consts and not value.pts:
            said = self.special(base, "__getattr__", [const(expr.name)], frame, expr.pos)
            return value if said is None else said
        return value

    def is_property(self, method: Obj) -> bool:
        """Tell whether a bound method is a property's getter."""
        function = function_of(method)
        return function is not None and any(
            (isinstance(d, ir.Name) and d.name in ("property", "cached_property"))
            or (isinstance(d, ir.Attribute) and d.name in ("cached_property", "getter"))
            for d in function.decorators
        )

    def _item(self, expr: ir.Item, frame: Frame) -> Value:
        base = self.evaluate(expr.base, frame)
        if isinstance(expr.index, ir.Slice):
            return self.sliced(base, expr.index, expr.pos, frame)
        index = self.evaluate(expr.index, frame)
        if (frame.tries or len(self.stack) > 1) and (decides := self.use(index)):
            for raises in LOOKUP_ERRORS:
                self.may_fail(decides, raises, frame, named=True)
        said = self.special(base, "__getitem__", [index], frame, expr.pos)
        return said if said is not None else self.read_item(base, index)

    def read_item(self, base: Value, index: Value) -> Value:
        """Return an element; a tainted index taints it."""
        extra = base.deps | self.use(index)
        if not base.pts:
            return Value(extra)
        result = Value(extra, consts=frozenset())
        for obj in base.pts:
            if obj.kind == "class":
                result = join(result, self.arrive(self.member(obj, index), base.deps))
            elif index.consts and not index.pts:
                for key in index.consts:
                    result = join(result, self.arrive(self.element(obj, key), base.deps))
            else:
                found = self.read_any(obj)
                if found is BOTTOM and obj.kind == "mapping" and obj.info is not None:
                    found = self.missing(obj, ANY)
                result = join(result, self.arrive(found, base.deps))
        return Value(result.deps | extra, result.pts, result.consts)

    def member(self, cls: Obj, name: Value) -> Value:
        """Return what `Class[name]` may be: a member of an enumeration, any of them when the name is not known."""
        names = name.texts() or tuple(n for n in cls.fields if not n.startswith("_"))
        return join_all(v for n in names if not (v := self.read_field(cls, n)).pts & self.functions(cls))

    def functions(self, cls: Obj) -> frozenset[Obj]:
        """Return the functions that a class holds."""
        held = (self.store.get((cls, n)) for n in list(cls.fields))
        return frozenset(o for v in held if v is not None for o in v.pts if o.kind in ("closure", "bound"))

    def element(self, obj: Obj, key: object) -> Value:
        """Return one element by a constant index or key."""
        name = self.attribute_of_item(obj, key)
        if obj.kind == "sequence" and isinstance(key, int) and key < 0:
            known = self.unpacked(pointer(obj))
            return known[key] if known and -key <= len(known) else self.read_any(obj)
        if obj.kind == "sequence" and self.store.get((obj, name)) is None and self.content(obj) is BOTTOM:
            return BOTTOM
        value = self.read_field(obj, name)
        if value is BOTTOM and obj.kind == "mapping" and obj.info is not None:
            return self.missing(obj, name)
        return value

    def missing(self, mapping: Obj, name: str) -> Value:
        """Return what a mapping makes for a key that it does not have."""
        raise NotImplementedError

    def _slice(self, expr: ir.Slice, frame: Frame) -> Value:
        deps = NONE
        for part in expr.parts:
            deps |= self.use(self.evaluate(part, frame))
        return Value(deps)

    def _choice(self, expr: ir.Choice, frame: Frame) -> Value:
        test = self.evaluate(expr.test, frame)
        known, constant = test.constant()
        if known:
            return self.evaluate(expr.then if constant else expr.other, frame)
        guard = self.guard(self.truth(test, frame, expr.slot), frame, expr.slot)
        then = self.under_guard(expr.then, (guard, "then"), frame)
        other = self.under_guard(expr.other, (guard, "other"), frame)
        node = self.node(frame, ("choice", expr.slot), "condition")
        if self.kept(guard):
            self.graph.depend(node, (guard,))
        both = join(then, other)
        return Value(both.deps | self.kept(node), both.pts, both.consts)

    def under_guard(self, expr: ir.Expr, guard: tuple[int, str], frame: Frame) -> Value:
        """Evaluate an expression to which a decision leads."""
        self.guards.append(guard)
        value = self.evaluate(expr, frame)
        self.guards.pop()
        return value

    def _starred(self, expr: ir.Starred, frame: Frame) -> Value:
        return self.evaluate(expr.value, frame)

    def _walrus(self, expr: ir.Walrus, frame: Frame) -> Value:
        node = self.node(frame, ("walrus", expr.slot), "assign")
        value = self.carry(self.evaluate(expr.value, frame), node)
        self.assign(expr.target, value, frame)
        return value

    def _yield(self, expr: ir.Yield, frame: Frame) -> Value:
        value = self.evaluate(expr.value, frame)
        if expr.kind == "await":
            self.wait(frame)
            return value
        value = self.elements(value) if expr.kind == "from" else value
        value = self.carry(value, self.node(frame, ("yield", expr.pos), "return"))
        frame.yielded = join(frame.yielded, value)
        return UNKNOWN

    def _lambda(self, expr: ir.Lambda, frame: Frame) -> Value:
        return self.closure(expr.function, frame, expr.slot)

    def closure(self, function: ir.Function, frame: Frame, slot: object) -> Value:
        """Return a function object that remembers where it was made."""
        outer = frame.outer if frame.owner_class() else frame
        key = (function.module, frame.id, function.pos, slot, *frame.turn)
        obj = self.intern("closure", key, function.name)
        obj.info = (function, outer, frame.program, frame.owner_class())
        if outer is not None:
            around: Frame | None = outer
            while around is not None:
                around.captured = True
                around = around.outer
        for parameter in function.parameters:
            if parameter.default is not None:
                self.store.put((obj, parameter.name), self.default_value(parameter, obj, frame))
        return pointer(obj)

    def default_value(self, parameter: ir.Parameter, closure: Obj, frame: Frame) -> Value:
        """Return a parameter's default as a value made by the `def`."""
        assert parameter.default is not None  # noqa: S101 - asked before
        value = self.evaluate(parameter.default, frame)
        node = self.node(frame, ("default", closure.key, parameter.name), "assign")
        self.mark(node, parameter.default, value, frame)
        return self.carry(value, node)


def _likely(stars: list[str], name: str) -> str:
    """Return the module that a name most likely comes from: capitalised ones from messages, others not."""
    message = name[:1].isupper() and not name.isupper()
    likely = [s for s in stars if (s.rpartition(".")[2] in DEFINITIONS) is message]
    return (likely or stars)[-1]


EVALUATE: Mapping[type, Callable[[Any, Any, Frame], Value]] = {
    ir.Const: Evaluation._constant,
    ir.Name: Evaluation._name,
    ir.Attribute: Evaluation._attribute,
    ir.Item: Evaluation._item,
    ir.Slice: Evaluation._slice,
    ir.Call: lambda machine, expr, frame: machine.call(expr, frame),
    ir.Operation: Evaluation._operation,
    ir.Choice: Evaluation._choice,
    ir.SequenceDisplay: Evaluation._sequence,
    ir.MappingDisplay: Evaluation._mapping,
    ir.Comprehension: Evaluation._comprehension,
    ir.Starred: Evaluation._starred,
    ir.Walrus: Evaluation._walrus,
    ir.Yield: Evaluation._yield,
    ir.Lambda: Evaluation._lambda,
}
