"""Calls: which function is meant, what goes in and what comes out."""

from __future__ import annotations

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.activations import CALLABLE, Activations
from tarl_lint.valueflow.contents import in_order
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.invocation import Arguments
from tarl_lint.valueflow.values import BOTTOM, NONE, Nodes, Obj, Value, join, join_all, pointer

MAX_ALIKE = 12  # objects of libraries whose methods are called one by one; of more, all at once


class Calls(Activations):
    """Resolves and performs calls."""

    def call(self, expr: ir.Call, frame: Frame) -> Value:
        """Evaluate a call expression."""
        if isinstance(expr.function, ir.Attribute):
            base = self.evaluate(expr.function.base, frame)
            return self._call_attribute(expr, expr.function, base, self.arguments(expr, frame), frame)
        function = self.evaluate(expr.function, frame)
        return self.call_value(function, self.arguments(expr, frame), frame, expr)

    def arguments(self, expr: ir.Call, frame: Frame) -> Arguments:
        """Evaluate arguments; `*` and `**` among the keywords hold what was unpacked but not told apart."""
        plain: list[Value] = []
        named: dict[str, Value] = {}
        for argument in expr.arguments:
            value = self.evaluate(argument, frame)
            if isinstance(argument, ir.Starred):
                known = self.one_by_one(value)
                if known is None:
                    named["*"] = join(named.get("*", BOTTOM), self.elements(value))
                else:
                    plain.extend(known)
            else:
                plain.append(value)
        for name, argument in expr.keywords:
            value = self.evaluate(argument, frame)
            if name is None:
                named["**"] = join(named.get("**", BOTTOM), value)
            else:
                named[name] = value
        return plain, named

    def one_by_one(self, value: Value) -> list[Value] | None:
        """Return what `*value` passes, argument by argument; of several sequences those of one length are joined."""
        ways = [self.unpacked(Value(value.deps, frozenset([o]))) for o in in_order(value.pts)]
        lengths = {-1 if way is None else len(way) for way in ways}
        if -1 in lengths or len(lengths) != 1:
            return None
        return [join_all(parts) for parts in zip(*(way for way in ways if way is not None), strict=True)]

    def _call_attribute(
        self, expr: ir.Call, function: ir.Attribute, base: Value, arguments: Arguments, frame: Frame
    ) -> Value:
        """Call a method on everything the receiver may be."""
        if self.nothing_yet(base):
            return BOTTOM
        if not base.pts:
            return self.call_method(base, None, function.name, arguments, frame, expr)
        targets: list[tuple[Obj, Value]] = []
        for obj in in_order(base.pts):
            member = self.read_field(obj, function.name) if obj.kind != "ext" else BOTTOM
            targets.append((obj, member))
        if len(targets) == 1:
            return self._call_member(base, *targets[0], function.name, arguments, frame, expr)
        result, deltas = BOTTOM, []
        guard = self.guard(base.deps, frame, ("dispatch", expr.slot))
        alike = frozenset(o for o, m in targets if o.kind == "lib" and not self._held_by(o, m, function.name))
        if len(alike) > MAX_ALIKE:
            targets = [(o, m) for o, m in targets if o not in alike]
        for number, (obj, member) in enumerate(targets):
            self.store.push()
            self.guards.append((guard, str(number)))
            value = self._call_member(base, obj, member, function.name, arguments, frame, expr)
            self.guards.pop()
            result = join(result, value)
            deltas.append(self.store.pop())
        if len(alike) > MAX_ALIKE:
            self.store.push()
            receivers = Value(base.deps, alike)
            first = in_order(alike)[0]
            result = join(result, self.call_method(receivers, first, function.name, arguments, frame, expr))
            deltas.append(self.store.pop())
        self.merge(deltas)
        return result

    def _call_member(
        self,
        base: Value,
        obj: Obj,
        member: Value,
        name: str,
        arguments: Arguments,
        frame: Frame,
        expr: ir.Call,
    ) -> Value:
        if obj.kind == "ext":
            return self.call_library(f"{obj.name}.{name}", arguments, frame, expr)
        callables = self._held_by(obj, member, name)
        if len(callables) == 1 and (method := next(iter(callables))).kind == "bound":
            return self.call_object(method, arguments, frame, expr, base.deps)
        if callables:
            return self.call_value(Value(member.deps, callables), arguments, frame, expr)
        if obj.kind == "instance" and (made := self.made_by_library(obj, name)).pts:
            return self.call_value(self.arrive(made, base.deps), arguments, frame, expr)
        return self.call_method(Value(base.deps, frozenset([obj])), obj, name, arguments, frame, expr)

    def made_by_library(self, obj: Obj, name: str) -> Value:
        """Return the objects of libraries that were stored in an attribute: to be called as functions are."""
        stored = self.store.get((obj, name))
        pts = frozenset(o for o in stored.pts if o.kind == "lib") if stored is not None else frozenset[Obj]()
        return Value(stored.deps if stored is not None else NONE, pts)

    def _held_by(self, obj: Obj, member: Value, name: str) -> frozenset[Obj]:
        """Return the functions that an object holds as an attribute, not methods of its own that are not ours."""
        return frozenset(o for o in member.pts if self.callable_held(o) and o.info != (obj, name))

    def callable_held(self, obj: Obj) -> bool:
        """Tell whether what an attribute holds can be called: a function, or an object whose class says how."""
        if obj.kind == "instance":
            return any(o.kind in CALLABLE for o in self.read_field(obj, "__call__").pts)
        return obj.kind in CALLABLE

    def call_value(self, function: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Call whatever a value may be; what is not known passes its arguments on."""
        targets = in_order(function.pts)
        if self.nothing_yet(function):
            return BOTTOM
        if not targets:
            return Value(function.deps | self.all_used(arguments))
        if len(targets) == 1:
            return self.call_object(targets[0], arguments, frame, call)
        result, deltas = BOTTOM, []
        guard = self.guard(function.deps, frame, ("dispatch", call.slot))
        for number, target in enumerate(targets):
            self.store.push()
            self.guards.append((guard, str(number)))
            result = join(result, self.call_object(target, arguments, frame, call))
            self.guards.pop()
            deltas.append(self.store.pop())
        self.merge(deltas)
        return result

    def call_object(
        self, target: Obj, arguments: Arguments, frame: Frame, call: ir.Call, carriers: Nodes = NONE
    ) -> Value:
        """Call one object; a method's receiver is what `carriers` handed on, which may have been chosen by data."""
        kind = target.kind
        if qualified := self.named_by_settings(target):
            return self.call_library(qualified, arguments, frame, call)
        if kind == "closure":
            return self.invoke(target, arguments, frame, call)
        if kind == "bound" and isinstance(target.info, tuple):
            closure, receiver, owner = target.info
            plain, named = arguments
            return self.invoke(
                closure, ([Value(carriers, frozenset([receiver])), *plain], named), frame, call, owner
            )
        if kind == "class":
            return self.instantiate(target, arguments, frame, call)
        if kind == "ext":
            return self.call_library(target.name, arguments, frame, call)
        if kind == "partial" and isinstance(target.info, tuple):
            function, plain, named = target.info
            return self.call_value(
                function, ([*plain, *arguments[0]], {**named, **arguments[1]}), frame, call
            )
        if kind == "method" and isinstance(target.info, tuple):
            owner, name = target.info
            return self.call_method(pointer(owner), owner, name, arguments, frame, call)
        if kind == "weak" and isinstance(target.info, Value):
            return target.info
        if kind == "instance":
            member = self.read_field(target, "__call__")
            if any(o.kind in CALLABLE for o in member.pts):
                return self.call_value(member, arguments, frame, call)
        return self.call_method(pointer(target), target, "__call__", arguments, frame, call)
