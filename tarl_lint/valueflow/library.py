"""Calls into libraries: arguments pass to results unless something better is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from tarl_lint import catalog
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.calls import Calls
from tarl_lint.valueflow.heap import ANY, item_field
from tarl_lint.valueflow.machine import Arguments
from tarl_lint.valueflow.values import (
    BOTTOM,
    NONE,
    UNKNOWN,
    Frame,
    Obj,
    Value,
    join,
    join_all,
    lineage,
    pointer,
)

CONTAINERS = frozenset(["list", "tuple", "set", "frozenset", "sorted", "reversed", "iter", "deque"])


class Library(Calls):
    """Performs calls of functions, classes and methods that are not analysed."""

    def call_library(self, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Call a function or class of a library."""
        if qualified in self.config.sanitizers:
            return UNKNOWN
        if qualified in catalog.WAITS:
            self.wait(frame)
        fact = catalog.fact(qualified)
        if fact is not None:
            return self.ros_call(fact, qualified, arguments, frame, call)
        name = qualified.removeprefix("builtins.").removeprefix("collections.")
        special = BUILTIN.get(name)
        if special is not None:
            return special(self, name, arguments, frame, call)
        return self.generic(qualified, arguments, frame, call)

    def generic(self, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Pass the arguments on to the result; write the argument that the catalog says is written."""
        name = qualified.rpartition(".")[2]
        deps = self.all_used(arguments)
        self.call_back(arguments, frame)
        written = catalog.ARGUMENT_WRITERS.get(qualified)
        if written is not None and written < len(arguments[0]):
            self.change(arguments[0][written], Value(deps), call.arguments[written:], frame)
        if catalog.scalar(qualified):
            same = qualified == "builtins.float" and len(arguments[0]) == 1
            return Value(deps, arguments[0][0].pts if same else frozenset())
        return self.new_object(arguments, deps, frame, call, fields=name[:1].isupper())

    def new_object(
        self, arguments: Arguments, deps: frozenset[int], frame: Frame, call: ir.Call, *, fields: bool
    ) -> Value:
        """Return a new object of a library; keywords of a class are its fields."""
        obj = self.allocate("lib", frame, ("made", call.slot))
        where = pointer(obj)
        plain, named = arguments
        if fields:
            rest = NONE
            for value in plain:
                rest |= self.use(value)
            for name, value in named.items():
                if name in ("*", "**"):
                    rest |= self.use(value)
                else:
                    self.store.put((obj, name), value)
            deps = rest
        if deps:
            self.store.put((obj, ANY), Value(deps))
        return where

    def call_back(self, arguments: Arguments, frame: Frame) -> None:
        """Functions handed to a library may be called by it at any time."""
        for value in (*arguments[0], *arguments[1].values()):
            for target in value.pts:
                if target.kind in ("closure", "bound", "partial"):
                    self.call_later(target, frame)

    def call_later(self, target: Obj, frame: Frame) -> None:
        """Have a function run on its own, with arguments of which nothing is known."""
        raise NotImplementedError

    def change(self, value: Value, news: Value, exprs: Any, frame: Frame) -> None:
        """Add data to an object, or to the variable that holds it when there is no object."""
        if value.pts:
            self.add_element(value, news)
        elif exprs:
            self.assign_fallback(exprs[0], news, frame)

    # --- methods ------------------------------------------------------------------------------------------

    def call_method(
        self, base: Value, target: Obj | None, name: str, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        """Call a method of an object that is not a class of ours."""
        kind = target.kind if target is not None else ""
        if kind == "publisher" and name == "publish":
            return self.publish(target, arguments, frame, call)
        if name == "registerCallback" and kind in ("filter", "synchronizer"):
            return self.register_filter(target, arguments, frame, call)
        if kind == "parameter":
            return base if name == "get_parameter_value" else UNKNOWN
        fact = catalog.METHODS.get(name)
        if fact is not None and kind not in ("sequence", "mapping"):
            return self.ros_call(fact, name, ([base, *arguments[0]], arguments[1]), frame, call)
        if name in catalog.LOGGING:
            return UNKNOWN
        if name in catalog.WAITING_METHODS and base.consts is None:
            self.wait(frame)
        if name in catalog.MUTATORS and base.consts is None:
            self.mutate(base, name, arguments, frame, call)
            return self.read_any(target) if name == "setdefault" and target is not None else UNKNOWN
        if name in READERS and base.pts:
            return READERS[name](self, base, arguments, frame, call)
        return self._unknown_method(base, name, arguments, frame, call)

    def publish(self, target: Obj | None, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Record a sink."""
        raise NotImplementedError

    def register_filter(self, target: Obj | None, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Register a callback of message_filters."""
        raise NotImplementedError

    def _unknown_method(
        self, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        self.call_back(arguments, frame)
        if isinstance(call.function, ir.Attribute) and name == "format":
            return Value(self.use(base) | self.all_used(arguments), consts=self._format(base, arguments))
        deps = self.use(base) | self.all_used(arguments)
        if not deps and not base.pts:
            return UNKNOWN
        return self.new_object(arguments, deps, frame, call, fields=False)

    def _format(self, base: Value, arguments: Arguments) -> frozenset[object] | None:
        known, text = base.constant()
        constants = [v.constant() for v in arguments[0]]
        named = {k: v.constant() for k, v in arguments[1].items()}
        if not known or not isinstance(text, str) or not all(k for k, _ in (*constants, *named.values())):
            return None
        try:
            return frozenset(
                [text.format(*(c for _, c in constants), **{k: c for k, (_, c) in named.items()})]
            )
        except Exception:  # noqa: BLE001 - a format that fails makes no text
            return None

    def mutate(self, base: Value, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> None:
        """Store arguments in the receiver."""
        plain, named = arguments
        if name in ("extend", "extendleft", "update"):
            for obj in base.pts:
                if name == "update" and obj.kind in ("mapping", "lib"):
                    for value in plain:
                        self.absorb(obj, value)
            news = join_all([self.elements(v) for v in plain] if name != "update" else [])
            for key, value in named.items():
                self.write_field(base, item_field(key), value)
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

    # --- containers ---------------------------------------------------------------------------------------

    def read_get(self, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        plain = arguments[0]
        if not plain:
            return self.elements_of_any(base)
        result = self.read_item(base, plain[0])
        return join(result, plain[1]) if len(plain) > 1 else result

    def elements_of_any(self, base: Value) -> Value:
        """Return any element, also of a mapping."""
        return join_all(self.arrive(self.read_any(o), base.deps) for o in base.pts)

    def read_values(self, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        obj = self.allocate("sequence", frame, ("values", call.slot))
        self.add_element(pointer(obj), self.elements_of_any(base))
        return pointer(obj)

    def read_pairs(self, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        return self.pairs([UNKNOWN, self.elements_of_any(base)], frame, call)

    def pairs(self, parts: list[Value], frame: Frame, call: ir.Call) -> Value:
        """Return a sequence of tuples."""
        pair = self.allocate("sequence", frame, ("pair", call.slot))
        for number, part in enumerate(parts):
            self.store.put((pair, item_field(number)), part)
        obj = self.allocate("sequence", frame, ("pairs", call.slot))
        self.add_element(pointer(obj), pointer(pair))
        return pointer(obj)

    def read_copy(self, base: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        return self.copy_of(base, frame, call)

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

    # --- builtins -----------------------------------------------------------------------------------------

    def new_container(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        obj = self.allocate("sequence", frame, ("display", call.slot))
        for value in arguments[0][:1]:
            self.add_element(pointer(obj), self.elements(value)) if value is not BOTTOM else None
        return pointer(obj)

    def new_mapping(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        obj = self.allocate("mapping", frame, ("display", call.slot))
        for value in arguments[0]:
            if value.pts and all(o.kind != "closure" and o.kind != "ext" for o in value.pts):
                self.absorb(obj, value)
        for key, value in arguments[1].items():
            self.store.put((obj, item_field(key)), value)
        return pointer(obj)

    def zipped(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        parts = [self.elements(v) for v in arguments[0]]
        return self.pairs([UNKNOWN, *parts] if name == "enumerate" else parts, frame, call)

    def mapped(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        function, *rest = arguments[0] or [UNKNOWN]
        parts = [self.elements(v) for v in rest]
        result = self.call_value(function, (parts, {}), frame, call)
        obj = self.allocate("sequence", frame, ("values", call.slot))
        self.add_element(pointer(obj), result if name == "map" else join_all(parts))
        return pointer(obj)

    def chosen(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        plain = arguments[0]
        values = [self.elements(plain[0])] if len(plain) == 1 else plain
        result = join_all(values)
        return Value(result.deps | self.all_used(arguments), result.pts)

    def get_attribute(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        plain = arguments[0]
        names = plain[1].texts() if len(plain) > 1 else ()
        if not names:
            return self.generic(name, arguments, frame, call)
        return join_all([self.read(plain[0], n) for n in names] + plain[2:])

    def set_attribute(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        plain = arguments[0]
        if len(plain) == 3:
            value = self.through_statement(plain[2], frame, call)
            for field in plain[1].texts():
                self.write_field(plain[0], field, value)
        return UNKNOWN

    def parent(self, name: str, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        """Return what `super()` gives: the object, seen from its class on."""
        receiver = frame
        while receiver.owner is None and receiver.outer is not None:
            receiver = receiver.outer
        parameters = receiver.function.parameters
        this = self.store.get((receiver, parameters[0].name)) if parameters else None
        if this is None or receiver.owner is None:
            return UNKNOWN
        found = []
        for obj in this.pts:
            view = self.intern("super", (receiver.owner.key, obj))
            view.info = (receiver.owner, obj)
            found.append(view)
        return Value(pts=frozenset(found))

    def default(self, obj: Obj, name: str) -> Value:
        """Return a field to which nothing was stored, also through `super()` and of parameters."""
        if obj.kind == "super" and isinstance(obj.info, tuple):
            owner, this = obj.info
            cls = this.info if this.kind == "instance" else this
            order = lineage(cls) if isinstance(cls, Obj) else []
            after = order[order.index(owner) + 1 :] if owner in order else []
            for base in after:
                value = self.store.get((base, name))
                if value is not None:
                    return self.bind(value, this, base)
            return BOTTOM
        if obj.kind == "parameter":
            return self.store.get((obj, "value")) or UNKNOWN if name in catalog.PARAMETER_VALUES else UNKNOWN
        return super().default(obj, name)


READERS: Mapping[str, Callable[..., Value]] = {
    "get": Library.read_get,
    "pop": Library.read_get,
    "popleft": Library.read_get,
    "get_nowait": Library.read_get,
    "popitem": Library.read_get,
    "next": Library.read_get,
    "values": Library.read_values,
    "itervalues": Library.read_values,
    "items": Library.read_pairs,
    "iteritems": Library.read_pairs,
    "copy": Library.read_copy,
}

BUILTIN: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(CONTAINERS, Library.new_container),
    "dict": Library.new_mapping,
    "OrderedDict": Library.new_mapping,
    "defaultdict": Library.new_mapping,
    "enumerate": Library.zipped,
    "zip": Library.zipped,
    "map": Library.mapped,
    "filter": Library.mapped,
    "min": Library.chosen,
    "max": Library.chosen,
    "next": Library.chosen,
    "getattr": Library.get_attribute,
    "setattr": Library.set_attribute,
    "super": Library.parent,
}
