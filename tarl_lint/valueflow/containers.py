"""Containers of the standard library: what goes in comes out again."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from typing import Any

from tarl_lint import catalog
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.heap import ANY, LENGTH, SENT, item_field
from tarl_lint.valueflow.invocation import Arguments, Invocation
from tarl_lint.valueflow.iterating import Iterating
from tarl_lint.valueflow.values import (
    BOTTOM,
    NONE,
    UNKNOWN,
    Nodes,
    Obj,
    Value,
    const,
    join,
    join_all,
    pointer,
)

QUEUES = frozenset(
    f"{module}.{name}"
    for module in ("queue", "Queue", "asyncio", "multiprocessing")
    for name in ("Queue", "LifoQueue", "PriorityQueue", "SimpleQueue", "JoinableQueue")
)
FLAG = "<flag>"  # the field of an event that says whether it is set
FLAGGING = frozenset(["set", "clear"])
IN_ORDER = frozenset(["list", "tuple", "deque", "iter", "reversed"])  # keep their argument's elements apart
CONTAINERS = frozenset(["list", "tuple", "set", "frozenset", "sorted", "reversed", "iter", "deque"])


class Containers(Iterating):
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
        if name in FLAGGING and not plain:
            self._flag(base, name, frame, call)
        if name in catalog.DEVICE_WRITERS and all(map(is_device, base.pts)):
            self._transmit(base, plain, frame, call)
            return
        if name == "clear":
            for obj in base.pts if len(base.pts) == 1 else ():
                self.empty(obj)
            self.shorten(base, frame, call)
        elif name == "setdefault" and len(plain) > 1:
            news = self.through_statement(plain[1], frame, call)
            for obj in base.pts:
                for key in plain[0].consts or (None,):
                    self.weaken(obj, ANY if key is None else item_field(key), news)
        elif name == "sort":
            order = self.ordered_by(self.elements(base), Invocation(name, base, arguments, frame, call))
            self._insert(base, [order] if "key" in named else [], frame, call)
        elif name == "update" and base.pts:
            self._update(base, plain, named, frame, call)
        elif name in ("extend", "extendleft"):
            for obj in base.pts if plain else ():
                self.lengthen(obj, plain[0])
            self._insert(base, [self.elements(v) for v in plain], frame, call)
        else:
            self._insert(base, plain[-1:] if name == "insert" else plain, frame, call)

    def _flag(self, base: Value, name: str, frame: Frame, call: ir.Call) -> None:
        """Set or clear an event of a library: whoever asks it learns what decided that."""
        events = Value(base.deps, frozenset(o for o in base.pts if o.kind == "lib"))
        self.write_field(events, FLAG, self.through_statement(const(name == "set"), frame, call))

    def _transmit(self, base: Value, plain: list[Value], frame: Frame, call: ir.Call) -> None:
        """Send something through a port, file or socket: it holds that, but does not give it back when read."""
        news = self.through_statement(join_all(plain), frame, call) if plain else BOTTOM
        for obj in base.pts if news is not BOTTOM else ():
            self.weaken(obj, SENT, news)

    def received(self, base: Value, arguments: Arguments) -> Nodes:
        """Return what reading from a port, file or socket uses: not what was sent there."""
        deps = base.deps | self.all_used(arguments)
        for obj in base.pts:
            deps |= self.content(obj).deps
        return deps

    def _update(
        self, base: Value, plain: list[Value], named: Mapping[str, Value], frame: Frame, call: ir.Call
    ) -> None:
        for number, value in enumerate(plain):
            news = self.through_statement(value, frame, call, number)
            for obj in base.pts:
                if obj.kind == "sequence":
                    self.add_element(pointer(obj), self.elements(news))
                elif obj.kind == "mapping":
                    self.entries(obj, news)
                elif obj.kind in ("lib", "instance"):
                    self.absorb(obj, news)
        for name, value in named.items():
            news = self.through_statement(value, frame, call, name)
            for obj in base.pts:
                self.weaken(obj, self.attribute_of_item(obj, name), news)

    def entries(self, obj: Obj, value: Value) -> None:
        """Take over the entries of a mapping, or of a sequence of pairs."""
        raise NotImplementedError

    def _insert(self, base: Value, values: list[Value], frame: Frame, call: ir.Call) -> None:
        news = join_all(values)
        if news is BOTTOM:
            return
        function = call.function
        news = self.through_statement(news, frame, call)
        self.change(base, news, [function.base] if isinstance(function, ir.Attribute) else [], frame)

    def through_statement(self, value: Value, frame: Frame, call: ir.Call, number: Hashable = 0) -> Value:
        """Let a value that a call stores pass through the calling statement."""
        if frame.statement is None:
            return value
        return self.carry(value, self.node(frame, ("stored", call.slot, number), "call"))

    def _read_get(self, it: Invocation) -> Value:
        plain = it.arguments[0]
        if not plain:
            return self.elements_of_any(it.base)
        result = self.read_item(it.base, plain[0])
        return join(result, plain[1]) if len(plain) > 1 else result

    def _take_out(self, it: Invocation) -> Value:
        """Return an element that is no longer there afterwards."""
        result = self._read_get(it)
        self.shorten(it.base, it.frame, it.call)
        return result

    def _removed(self, it: Invocation) -> Value:
        self.shorten(it.base, it.frame, it.call)
        return UNKNOWN

    def shorten(self, base: Value, frame: Frame, call: ir.Call) -> None:
        """Let the length of containers depend on what decided to take something out."""
        ours = [o for o in base.pts if o.kind in ("sequence", "mapping")]
        kept = self.kept(self.node(frame, ("taken", call.slot), "call")) if ours else NONE
        for obj in ours if kept else ():
            self.decide_length(obj, kept)

    def _write_entry(self, it: Invocation) -> Value:
        """Store an element as `x[key] = value` does."""
        plain = it.arguments[0]
        if len(plain) == 2:
            self.write_item(it.base, plain[0], self.through_statement(plain[1], it.frame, it.call))
        return UNKNOWN

    def elements_of_any(self, base: Value) -> Value:
        """Return any element, also of a mapping."""
        return join_all(self.arrive(self.read_any(o), base.deps) for o in base.pts)

    def _read_values(self, it: Invocation) -> Value:
        return self.listed(self.elements_of_any(it.base), self.length(it.base), it)

    def _read_keys(self, it: Invocation) -> Value:
        return self.listed(self.elements(it.base), self.length(it.base), it)

    def _read_pairs(self, it: Invocation) -> Value:
        keys = join_all(self.elements(Value(it.base.deps, frozenset([o]))) for o in it.base.pts)
        return self.pairs([keys, self.elements_of_any(it.base)], it.frame, it.call, self.length(it.base))

    def _new_container(self, it: Invocation) -> Value:
        given = [v for v in it.arguments[0][:1] if v is not BOTTOM]
        known = self.unpacked(given[0]) if given and it.name in IN_ORDER else None
        known = known[::-1] if known is not None and it.name == "reversed" else known
        element = self.ordered_by(join_all(self.elements(v) for v in given), it)
        length = self.length(given[0]) if given else NONE
        obj = self.allocate("sequence", it.frame, ("display", it.call.slot))
        if known is not None:
            for number, value in enumerate(known):
                self.store.put((obj, item_field(number)), value)
        elif given:
            self.add_element(pointer(obj), element)
        self.store.put((obj, LENGTH), Value(length))
        return pointer(obj)

    def _counted(self, it: Invocation) -> Value:
        """Return `len(x)`: data of what the length is made of, choice of what decided to add elements."""
        deps = self.lengths(it.arguments[0])
        ours = [o for value in it.arguments[0] for o in value.pts if self.sized(o)]
        node = self.node(it.frame, ("length", it.call.slot), "call")
        self.graph.choice(self.placed(frozenset(ours)), node)
        if self.graph.control[node]:
            self.graph.counts.setdefault(node, set()).update(self.made_of(Value(pts=frozenset(ours))))
        return Value(deps | self.kept(node))

    def made_of(self, value: Value) -> Nodes:
        """Return what elements are made from, of our own objects not what they hold."""
        found = self.elements_of_any(value)
        return self.use(Value(found.deps, frozenset(o for o in found.pts if o.kind != "instance")))

    def _read_length(self, it: Invocation) -> Value:
        """Return what a queue says about how much is in it."""
        return self._counted(replace(it, arguments=([it.base], {})))

    def _new_queue(self, it: Invocation) -> Value:
        return pointer(self.allocate("sequence", it.frame, ("display", it.call.slot)))

    def _chosen(self, it: Invocation) -> Value:
        plain = it.arguments[0]
        values = [self.elements(plain[0])] if len(plain) == 1 else plain
        result = self.ordered_by(join_all(values), it)
        return Value(result.deps | self.all_used(it.arguments), result.pts)


def is_device(obj: Obj) -> bool:
    """Tell whether reading an object of a library gives other things than what was written to it."""
    return obj.kind == "lib" and not obj.name.startswith("io.")


READERS: Mapping[str, Callable[..., Value]] = {
    "get": Containers._read_get,
    "__getitem__": Containers._read_get,
    "__setitem__": Containers._write_entry,
    **dict.fromkeys(("pop", "popleft", "get_nowait", "popitem"), Containers._take_out),
    **dict.fromkeys(("remove", "discard"), Containers._removed),
    "next": Containers._read_get,
    **dict.fromkeys(("qsize", "empty", "full"), Containers._read_length),
    "values": Containers._read_values,
    "itervalues": Containers._read_values,
    "keys": Containers._read_keys,
    "iterkeys": Containers._read_keys,
    "items": Containers._read_pairs,
    "iteritems": Containers._read_pairs,
}
