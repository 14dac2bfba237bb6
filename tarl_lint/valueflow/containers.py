"""Containers of the standard library: what goes in comes out again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.calls import Calls
from tarl_lint.valueflow.heap import ANY, item_field
from tarl_lint.valueflow.machine import Arguments, Invocation
from tarl_lint.valueflow.values import (
    BOTTOM,
    UNKNOWN,
    Frame,
    Value,
    join,
    join_all,
    pointer,
)

CONTAINERS = frozenset(["list", "tuple", "set", "frozenset", "sorted", "reversed", "iter", "deque"])


class Containers(Calls):
    """Calls methods and constructors of containers."""

    def change(self, value: Value, news: Value, exprs: Any, frame: Frame) -> None:
        """Add data to an object, or to the variable that holds it when there is no object."""
        if value.pts:
            self.add_element(value, news)
        elif exprs:
            self.assign_fallback(exprs[0], news, frame)

    def mutate(self, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
        """Store arguments in the receiver."""
        plain, named = arguments
        if name in ("extend", "extendleft", "update"):
            for obj in base.pts:
                if name == "update" and obj.kind in ("mapping", "lib"):
                    for value in plain:
                        self.absorb(obj, value)
            news = join_all([self.elements(v) for v in plain] if name != "update" else [])
            for name_, value in named.items():
                self.write_field(base, item_field(name_), value)
        elif name == "setdefault" and len(plain) > 1:
            for obj in base.pts:
                for key in plain[0].consts or (None,):
                    self.weaken(obj, ANY if key is None else item_field(key), plain[1])
            return
        else:
            news = join_all(plain[-1:] if name == "insert" else plain)
        if news is BOTTOM or (name == "update" and base.pts):
            return
        function = call.function
        news = self.through_statement(news, frame, call)
        self.change(base, news, [function.base] if isinstance(function, ir.Attribute) else [], frame)

    def through_statement(self, value: Value, frame: Frame, call: ir.Call) -> Value:
        """Let a value that a call stores pass through the calling statement."""
        if frame.statement is None:
            return value
        return self.carry(value, self.node(frame, ("stored", call.slot), "call"))

    def _read_get(self, it: Invocation) -> Value:
        plain = it.arguments[0]
        if not plain:
            return self.elements_of_any(it.base)
        result = self.read_item(it.base, plain[0])
        return join(result, plain[1]) if len(plain) > 1 else result

    def elements_of_any(self, base: Value) -> Value:
        """Return any element, also of a mapping."""
        return join_all(self.arrive(self.read_any(o), base.deps) for o in base.pts)

    def _read_values(self, it: Invocation) -> Value:
        obj = self.allocate("sequence", it.frame, ("values", it.call.slot))
        self.add_element(pointer(obj), self.elements_of_any(it.base))
        return pointer(obj)

    def _read_pairs(self, it: Invocation) -> Value:
        return self.pairs([UNKNOWN, self.elements_of_any(it.base)], it.frame, it.call)

    def pairs(self, parts: list[Value], frame: Frame, call: ir.Call) -> Value:
        """Return a sequence of tuples."""
        pair = self.allocate("sequence", frame, ("pair", call.slot))
        for number, part in enumerate(parts):
            self.store.put((pair, item_field(number)), part)
        obj = self.allocate("sequence", frame, ("pairs", call.slot))
        self.add_element(pointer(obj), pointer(pair))
        return pointer(obj)

    def _read_copy(self, it: Invocation) -> Value:
        return self.copy_of(it.base, it.frame, it.call)

    def copy_of(self, value: Value, frame: Frame, call: ir.Call) -> Value:
        """Return a new object with the same fields."""
        if not value.pts:
            return value
        kinds = {o.kind for o in value.pts} & {"sequence", "mapping"}
        obj = self.allocate(kinds.pop() if kinds else "lib", frame, ("copy", call.slot))
        content = BOTTOM
        for source in value.pts:
            self._copy_fields(source, obj)
            content = join(content, self.content(source))
        if content is not BOTTOM:
            self.store.put((obj, ANY), content)
        return Value(value.deps, frozenset([obj]))

    def _new_container(self, it: Invocation) -> Value:
        obj = self.allocate("sequence", it.frame, ("display", it.call.slot))
        for value in it.arguments[0][:1]:
            self.add_element(pointer(obj), self.elements(value)) if value is not BOTTOM else None
        return pointer(obj)

    def _new_mapping(self, it: Invocation) -> Value:
        obj = self.allocate("mapping", it.frame, ("display", it.call.slot))
        for value in it.arguments[0]:
            if value.pts and all(o.kind != "closure" and o.kind != "ext" for o in value.pts):
                self.absorb(obj, value)
        for key, value in it.arguments[1].items():
            self.store.put((obj, item_field(key)), value)
        return pointer(obj)

    def _zipped(self, it: Invocation) -> Value:
        parts = [self.elements(v) for v in it.arguments[0]]
        return self.pairs([UNKNOWN, *parts] if it.name == "enumerate" else parts, it.frame, it.call)

    def _mapped(self, it: Invocation) -> Value:
        function, *rest = it.arguments[0] or [UNKNOWN]
        parts = [self.elements(v) for v in rest]
        result = self.call_value(function, (parts, {}), it.frame, it.call)
        obj = self.allocate("sequence", it.frame, ("values", it.call.slot))
        self.add_element(pointer(obj), result if it.name == "map" else join_all(parts))
        return pointer(obj)

    def _chosen(self, it: Invocation) -> Value:
        plain = it.arguments[0]
        values = [self.elements(plain[0])] if len(plain) == 1 else plain
        result = join_all(values)
        return Value(result.deps | self.all_used(it.arguments), result.pts)


READERS: Mapping[str, Callable[..., Value]] = {
    "get": Containers._read_get,
    "pop": Containers._read_get,
    "popleft": Containers._read_get,
    "get_nowait": Containers._read_get,
    "popitem": Containers._read_get,
    "next": Containers._read_get,
    "values": Containers._read_values,
    "itervalues": Containers._read_values,
    "items": Containers._read_pairs,
    "iteritems": Containers._read_pairs,
    "copy": Containers._read_copy,
}
