"""Expressions: what each may be."""

from __future__ import annotations

import builtins
import operator
from collections.abc import Callable, Mapping
from typing import Any

from tarl_lint.catalog import fact
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.heap import ANY, Heap, item_field
from tarl_lint.valueflow.values import (
    BOTTOM,
    NONE,
    UNKNOWN,
    ClassInfo,
    Frame,
    Nodes,
    Obj,
    Value,
    const,
    join,
    pointer,
)

FOLDED: Mapping[str, Callable[..., object]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "%": operator.mod,
    "neg": operator.neg,
    "not": operator.not_,
    "==": operator.eq,
    "!=": operator.ne,
    "is": lambda a, b: a is b or a == b,
    "is not": lambda a, b: not (a is b or a == b),
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
BUILTINS = frozenset(dir(builtins))
MAX_TEXT = 300


class Evaluation(Heap):
    """Evaluates expressions."""

    def evaluate(self, expr: ir.Expr, frame: Frame) -> Value:
        """Return what an expression may be."""
        value = EVALUATE[type(expr)](self, expr, frame)
        if self.probe is not None and frame.statement is not None:
            self.probe(self, frame, frame.statement, expr, value)
        return value

    def constant(self, expr: ir.Const, frame: Frame) -> Value:  # noqa: ARG002 - one signature for all
        return const(expr.value)

    def name(self, expr: ir.Name, frame: Frame) -> Value:
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
        stars = [s for s in frame.program.stars if s not in self.module_objects]
        for star in stars:
            if fact(f"{star}.{name}") is not None:
                return self.external(f"{star}.{name}")
        if name in BUILTINS:
            return self.external(f"builtins.{name}")
        return self.external(f"{stars[-1]}.{name}") if stars else BOTTOM

    def external(self, qualified: str) -> Value:
        """Return a library's function, class or module."""
        return pointer(self.intern("ext", qualified, qualified))

    def attribute(self, expr: ir.Attribute, frame: Frame) -> Value:
        base = self.evaluate(expr.base, frame)
        value = self.read(base, expr.name)
        for obj in value.pts:
            if obj.kind == "bound" and self.is_property(obj):
                call = ir.Call(expr, (), (), expr.pos, -expr.slot)
                return self.call_value(value, ([], {}), frame, call)
        return value

    def is_property(self, method: Obj) -> bool:
        """Tell whether a bound method is a property's getter."""
        closure = method.info[0] if isinstance(method.info, tuple) else None
        function = closure.info[0] if isinstance(closure, Obj) and isinstance(closure.info, tuple) else None
        return isinstance(function, ir.Function) and any(
            (isinstance(d, ir.Name) and d.name in ("property", "cached_property"))
            or (isinstance(d, ir.Attribute) and d.name in ("cached_property", "getter"))
            for d in function.decorators
        )

    def item(self, expr: ir.Item, frame: Frame) -> Value:
        base = self.evaluate(expr.base, frame)
        index = self.evaluate(expr.index, frame)
        return self.read_item(base, index)

    def read_item(self, base: Value, index: Value) -> Value:
        """Return an element; a tainted index taints it."""
        extra = base.deps | self.use(index)
        if not base.pts:
            return Value(extra)
        result = Value(extra, consts=frozenset())
        for obj in base.pts:
            if index.consts and not index.pts:
                for key in index.consts:
                    result = join(result, self.arrive(self.element(obj, key), base.deps))
            else:
                result = join(result, self.arrive(self.read_any(obj), base.deps))
        return Value(result.deps | extra, result.pts, result.consts)

    def element(self, obj: Obj, key: object) -> Value:
        """Return one element by a constant index or key."""
        name = item_field(key)
        if obj.kind in ("sequence",) and isinstance(key, int) and key < 0:
            return self.read_any(obj)
        if obj.kind == "sequence" and self.store.get((obj, name)) is None and self.content(obj) is BOTTOM:
            return BOTTOM
        return self.read_field(obj, name)

    def slice(self, expr: ir.Slice, frame: Frame) -> Value:
        deps = NONE
        for part in expr.parts:
            deps |= self.use(self.evaluate(part, frame))
        return Value(deps)

    def operation(self, expr: ir.Operation, frame: Frame) -> Value:
        values = [self.evaluate(p, frame) for p in expr.parts]
        if expr.operator in ("or", "and"):
            return self.boolean(expr.operator, values)
        if expr.operator == "+=" and values[0].pts:
            self.add_element(values[0], self.elements(values[1]))
            return Value(values[0].deps | values[1].deps, values[0].pts)
        deps = NONE
        for value in values:
            deps |= self.tested(expr.operator, value)
        return Value(deps, consts=self.fold(expr.operator, values))

    def tested(self, name: str, value: Value) -> Nodes:
        """Return the nodes whose data an operator uses. Whether a message is there at all is not data of it."""
        if name in ("is", "is not"):
            return self.use(Value(value.deps, frozenset(o for o in value.pts if o.kind != "message")))
        return self.truth(value) if name == "not" else self.use(value)

    def truth(self, value: Value) -> Nodes:
        """Return the nodes that decide whether a value counts as true: a whole message always does."""
        kept = frozenset(o for o in value.pts if o.kind != "message" or o.parent is not None)
        return self.use(value if len(kept) == len(value.pts) else Value(value.deps, kept))

    def boolean(self, name: str, values: list[Value]) -> Value:
        """Return what `a or b` may be: one of them, decided by the former."""
        result, deps = BOTTOM, NONE
        for value in values:
            known, constant = value.constant()
            decided = known and not value.deps and bool(constant) is (name == "or")
            passed = known and not value.deps and not decided and value is not values[-1]
            deps |= self.truth(value)
            if not passed:
                result = join(result, value)
            if decided:
                break
        return Value(result.deps | deps, result.pts, result.consts)

    def fold(self, name: str, values: list[Value]) -> frozenset[object] | None:
        """Return the constants that an operator makes of constants."""
        if name == "text":
            return self._fold_text(values)
        function = FOLDED.get(name)
        if function is None or any(v.pts for v in values):
            return None if any(v.pts or v.consts is None for v in values) or function is None else frozenset()
        constants: list[Any] = []
        for value in values:
            known, constant = value.constant()
            if not known:
                return None
            constants.append(constant)
        try:
            result = function(*constants)
        except Exception:  # noqa: BLE001 - whatever the operands do, the result is then not known
            return None
        return None if isinstance(result, (str, bytes)) and len(result) > MAX_TEXT else frozenset([result])

    def _fold_text(self, values: list[Value]) -> frozenset[object] | None:
        texts = [""]
        for value in values:
            if not value.consts or value.pts:
                return None
            texts = [t + str(c) for t in texts for c in sorted(value.consts, key=str)]
            if len(texts) > 4 or len(texts[0]) > MAX_TEXT:
                return None
        return frozenset(texts)

    def choice(self, expr: ir.Choice, frame: Frame) -> Value:
        test = self.evaluate(expr.test, frame)
        known, constant = test.constant()
        if known and not test.deps:
            return self.evaluate(expr.then if constant else expr.other, frame)
        then, other = self.evaluate(expr.then, frame), self.evaluate(expr.other, frame)
        node = self.node(frame, ("choice", expr.slot), "condition")
        self.graph.control[node].update(self.use(test))
        both = join(then, other)
        return Value(both.deps | {node}, both.pts, both.consts)

    def sequence(self, expr: ir.Sequence_, frame: Frame) -> Value:
        obj = self.allocate("sequence", frame, ("display", expr.slot))
        items = [(i, self.evaluate(i.value if isinstance(i, ir.Starred) else i, frame)) for i in expr.items]
        where = pointer(obj)
        exact = True
        for number, (item, value) in enumerate(items):
            value = self.entry(item, value, frame, (expr.slot, number))
            if isinstance(item, ir.Starred):
                exact = False
                self.add_element(where, self.elements(value))
            elif exact:
                self.store.put((obj, item_field(number)), value)
            else:
                self.add_element(where, value)
        return where

    def mapping(self, expr: ir.Mapping_, frame: Frame) -> Value:
        obj = self.allocate("mapping", frame, ("display", expr.slot))
        where = pointer(obj)
        for key, item in expr.items:
            value = self.entry(item, self.evaluate(item, frame), frame, (expr.slot, item.pos))
            if key is None:
                self.absorb(obj, value)
            else:
                self.write_item(where, self.evaluate(key, frame), value)
        return where

    def entry(self, expr: ir.Expr, value: Value, frame: Frame, slot: object) -> Value:
        """Return an element of a display; numbers get a node of their own, so that they are found again."""
        if not isinstance(expr, ir.Const) or not isinstance(expr.value, (int, float)):
            return value
        node = self.node(frame, ("entry", slot), "assign")
        self.mark(node, expr, value, frame)
        return self.carry(value, node)

    def absorb(self, obj: Obj, value: Value) -> None:
        """Copy the elements of what a value may be into an object."""
        for source in value.pts:
            for name in list(source.fields):
                stored = self.store.get((source, name))
                if stored is not None and (name.startswith("[") or name == ANY):
                    self.weaken(obj, name, self.arrive(stored, value.deps))
            content = self.content(source)
            if content.deps and self.store.get((source, ANY)) is None:
                self.add_element(pointer(obj), content)
        if not value.pts and value.deps:
            self.add_element(pointer(obj), Value(value.deps))

    def elements(self, value: Value) -> Value:
        """Return what iterating over a value gives."""
        if not value.pts:
            return Value(value.deps)
        result = Value(value.deps, consts=frozenset())
        for obj in value.pts:
            if obj.kind == "instance":
                result = join(result, Value(self.deep(frozenset([obj]))))
            elif obj.kind == "mapping":
                result = join(result, UNKNOWN)  # its keys
            else:
                result = join(result, self.arrive(self.read_any(obj), value.deps))
        return result

    def comprehension(self, expr: ir.Comprehension, frame: Frame) -> Value:
        kind = "mapping" if expr.key is not None else "sequence"
        obj = self.allocate(kind, frame, ("display", expr.slot))
        deps = NONE
        for target, source, conditions in expr.loops:
            self.assign(target, self.elements(self.evaluate(source, frame)), frame)
            for condition in conditions:
                deps |= self.use(self.evaluate(condition, frame))
        element = self.evaluate(expr.element, frame)
        if deps:
            node = self.node(frame, ("filter", expr.slot), "condition")
            self.graph.control[node].update(deps)
            element = Value(element.deps | {node}, element.pts, element.consts)
        if expr.key is not None:
            self.write_item(pointer(obj), self.evaluate(expr.key, frame), element)
        else:
            self.add_element(pointer(obj), element)
        return pointer(obj)

    def starred(self, expr: ir.Starred, frame: Frame) -> Value:
        return self.evaluate(expr.value, frame)

    def walrus(self, expr: ir.Walrus, frame: Frame) -> Value:
        node = self.node(frame, ("walrus", expr.slot), "assign")
        value = self.carry(self.evaluate(expr.value, frame), node)
        self.assign(expr.target, value, frame)
        return value

    def yield_(self, expr: ir.Yield, frame: Frame) -> Value:
        value = self.evaluate(expr.value, frame)
        if expr.kind == "await":
            self.wait(frame)
            return value
        frame.yielded = join(frame.yielded, self.elements(value) if expr.kind == "from" else value)
        return UNKNOWN

    def lambda_(self, expr: ir.Lambda, frame: Frame) -> Value:
        return self.closure(expr.function, frame, expr.slot)

    def closure(self, function: ir.Function, frame: Frame, slot: object) -> Value:
        """Return a function object that remembers where it was made."""
        outer = frame.outer if frame.owner_class() else frame
        obj = self.intern("closure", (function.module, frame.id, function.pos, slot), function.name)
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

    def mark(self, node: int, expr: ir.Expr, value: Value, frame: Frame) -> None:
        """Note that a node is a constant, or passes on another unchanged."""
        known, constant = value.constant()
        if isinstance(expr, (ir.Name, ir.Attribute, ir.Item)) or _conversion(expr):
            self.graph.copies.add(node)
        elif known and isinstance(constant, (bool, int, float)):
            self.graph.literals[node] = (constant, expr.pos, frame.program.path)

    def class_of(self, obj: Obj) -> ClassInfo | None:
        """Return the class of an instance or class object."""
        cls = obj.info if obj.kind == "instance" else obj
        info = cls.info if isinstance(cls, Obj) else None
        return info if isinstance(info, ClassInfo) else None


def _conversion(expr: ir.Expr) -> bool:
    """Tell whether an expression is `float(x)`, which leaves the number what it is."""
    return isinstance(expr, ir.Call) and isinstance(expr.function, ir.Name) and expr.function.name == "float"


EVALUATE: Mapping[type, Callable[[Any, Any, Frame], Value]] = {
    ir.Const: Evaluation.constant,
    ir.Name: Evaluation.name,
    ir.Attribute: Evaluation.attribute,
    ir.Item: Evaluation.item,
    ir.Slice: Evaluation.slice,
    ir.Call: lambda machine, expr, frame: machine.call(expr, frame),
    ir.Operation: Evaluation.operation,
    ir.Choice: Evaluation.choice,
    ir.Sequence_: Evaluation.sequence,
    ir.Mapping_: Evaluation.mapping,
    ir.Comprehension: Evaluation.comprehension,
    ir.Starred: Evaluation.starred,
    ir.Walrus: Evaluation.walrus,
    ir.Yield: Evaluation.yield_,
    ir.Lambda: Evaluation.lambda_,
}
