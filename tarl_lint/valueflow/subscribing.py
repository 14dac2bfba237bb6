"""Subscriptions: where messages come in, and the callbacks that they go to."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from itertools import zip_longest
from typing import Final

from tarl_lint import catalog
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.activations import CALLABLE, ROOT_CALL
from tarl_lint.valueflow.bounds import MAX_ALIKE, MAX_GENERATIONS
from tarl_lint.valueflow.contents import in_order
from tarl_lint.valueflow.ends import Kind, Publisher, SourceRecord
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.graph import Place
from tarl_lint.valueflow.invocation import Invocation
from tarl_lint.valueflow.leftovers import together
from tarl_lint.valueflow.publishing import Sinks, type_names
from tarl_lint.valueflow.states import LATER
from tarl_lint.valueflow.store import Root
from tarl_lint.valueflow.values import BOTTOM, UNKNOWN, Obj, Value, function_of, join, join_all, pointer

KINDS: Final[Mapping[str, Kind]] = {"service": "service", "action": "action", "transform": "transform"}
NOTHING: Final[Mapping[str, Value]] = {}
Fresh = Sequence[tuple[Obj, str, Value]]  # objects that a call brings anew, with a field and what it is


class Sources(Sinks):
    """Records sources."""

    def source(self, it: Invocation, callback: Value) -> SourceRecord:
        """Record a subscription at the outermost call that supplies its callback."""
        place, pos, statement, via = it.frame, it.call.pos, it.frame.statement, []
        while place.caller is not None and place.call is not None and _supplied(place, callback):
            via.append((place.program.path, pos))
            statement = place.call
            pos = self.call_position(place)
            place = place.caller
        key = (place.program.path, pos)
        record = self.sources.get(key)
        if record is None:
            assert statement is not None  # noqa: S101 - a call stands in a statement
            record = SourceRecord(
                *key, it.fact.api, self.modules[key[0]].name, self.qualname(place), statement, place
            )
            record.kind = KINDS.get(it.fact.kind, "topic")
            self.sources[key] = record
        record.via.update(via)
        record.topics.update(self.topics(it))
        record.types.update(type_names(it.argument(it.fact.type)))
        return record

    def call_position(self, frame: Frame) -> ir.Pos:
        """Return where the call stands that entered a frame."""
        assert frame.call is not None  # noqa: S101 - asked before
        return frame.call_pos or frame.call.pos

    def _subscribe(self, it: Invocation) -> Value:
        callback = it.argument(it.fact.callback)
        record = self.source(it, callback)
        extra = it.argument(it.fact.extra)
        passed = [extra] if extra is not BOTTOM else []
        self.connect(record, callback, passed)
        self._forward(record, callback, it)
        return self.handle(it.frame, it.call)

    def _forward(self, record: SourceRecord, callback: Value, it: Invocation) -> None:
        """Where the callback is a method of no class of ours, as `other.publish`, call it where it is registered."""
        for target in in_order(callback.pts):
            if target.kind == "method":
                obj = self._received(record, it.frame, ("forward", it.call.slot, target.key))
                self.call_object(target, ([pointer(obj)], {}), it.frame, it.call)

    def _received(self, record: SourceRecord, frame: Frame, slot: Hashable) -> Obj:
        """Return the message object that arrives at a frame's current statement."""
        obj = record.messages.get((frame.id, slot))
        if obj is None:
            obj = record.messages[frame.id, slot] = Obj("message", (record.path, record.pos, frame.id, slot))
            obj.info = self.node(frame, ("receive", slot), "receive")
            record.nodes.add(obj.info)
            self.graph.begin(obj.info)
        return obj

    def _configured_source(self, it: Invocation) -> Value:
        """Subscribe when one of the arguments is a function, else return the message."""
        given = [*it.arguments[0], *it.arguments[1].values()]
        callbacks = [v for v in given if any(o.kind in ("closure", "bound", "partial") for o in v.pts)]
        if not callbacks:
            return self.receive(it)
        self.connect(self.source(it, callbacks[0]), callbacks[0], [])
        return self.handle(it.frame, it.call)

    def handle(self, frame: Frame, call: ir.Call) -> Value:
        """Return the object that a registration gives back."""
        return pointer(self.allocate("lib", frame, ("made", call.slot)))

    def connect(self, record: SourceRecord, callback: Value, extra: Sequence[Value]) -> None:
        """Run a callback whenever a message of the source arrives."""
        for target in callback.pts:
            if (target.kind in CALLABLE and target.kind != "method") or target.kind == "instance":
                message = self.message(record, target)
                self.call_when(
                    ("callback", record.path, record.pos), target, [pointer(message), *extra], "callback"
                )

    def message(self, record: SourceRecord, target: Obj) -> Obj:
        """Return the message object that a source hands to a callback."""
        obj = record.messages.get(target.key)
        if obj is None:
            obj = record.messages[target.key] = Obj("message", (record.path, record.pos, target.key))
            obj.defined = next(iter(record.types)) if len(record.types) == 1 else ""
            frame = self.described(target)
            place = Place(frame or record.frame, None, "receive", (frame or record.frame).function.pos)
            node = self.graph.node(("receive", obj.key), place, frozenset())
            obj.info = node
            record.nodes.add(node)
            self.graph.begin(node)
            record.callbacks.add(frame.function.qualname if frame is not None else target.name)
        return obj

    def described(self, target: Obj) -> Frame | None:
        """Return a frame that stands for a callback's function, whoever calls it."""
        while target.kind in ("bound", "partial", "instance"):
            if target.kind == "bound" and isinstance(target.info, tuple):
                target = target.info[0]
                continue
            if target.kind == "partial" and isinstance(target.info, tuple):
                inner: frozenset[Obj] = target.info[0].pts
            else:
                inner = self.read_field(target, "__call__").pts
            if len(inner) != 1:
                return None
            target = next(iter(inner))
        if target.kind != "closure" or not isinstance(target.info, tuple):
            return None
        function, _, program, _ = target.info
        return Frame(("described", target.key), -1, function, program, self.module_objects[program.name])

    def receive(self, it: Invocation) -> Value:
        """Return the message that a waiting call gives."""
        obj = self._received(self.source(it, BOTTOM), it.frame, it.call.slot)
        self._clear(obj)
        return pointer(obj)

    def filter(self, it: Invocation) -> Value:
        """Return a subscriber of message_filters: rospy's starts with the topic, rclpy's with the node."""
        first = it.arguments[0][0] if it.arguments[0] else BOTTOM
        if len(it.arguments[0]) > 2 and not first.texts() and not it.argument(it.fact.type).texts():
            it.fact = catalog.FILTER_WITH_NODE
        record = self.source(it, BOTTOM)
        obj = self.intern("filter", (record.path, record.pos))
        obj.info = record
        return pointer(obj)

    def synchronizer(self, it: Invocation) -> Value:
        """Return a synchroniser of several subscribers."""
        given = it.argument(it.fact.topic)
        obj = self.intern("synchronizer", (it.frame.id, it.statement, it.call.slot, *it.frame.turn))
        parts = self.unpacked(given)
        several = parts is None and all(o.kind == "sequence" for o in given.pts)
        if parts is None:
            parts = [self.elements(given)] if several else [given]
        obj.info = (parts, (it.frame.program.path, it.call.pos), several)
        return pointer(obj)

    def register_filter(self, target: Obj | None, it: Invocation) -> Value:
        """Run a callback with one message of each subscriber."""
        if target is None:
            return UNKNOWN
        places = {(it.frame.program.path, it.call.pos)}
        parts: Sequence[Value] = [pointer(target)]
        several = False
        if target.kind == "synchronizer" and isinstance(target.info, tuple):
            parts = target.info[0]
            places.add(target.info[1])
            several = target.info[2]
        callback = it.argument((0, "cb"))
        extra = it.arguments[0][1:]
        for function in callback.pts:
            if function.kind in CALLABLE:
                messages = [self._filtered(part, function, places) for part in parts]
                key = ("filter", it.frame.program.path, it.call.pos)
                named = {"*": join_all([*messages, *extra])} if several else {}
                values = [] if several else [*messages, *extra]
                self.call_when(key, function, values, "callback", named=named)
        return UNKNOWN

    def _filtered(self, part: Value, function: Obj, places: set[tuple[str, ir.Pos]]) -> Value:
        """Return the message that a subscriber of message_filters hands on."""
        message = BOTTOM
        for subscriber in part.pts:
            if isinstance(subscriber.info, SourceRecord):
                subscriber.info.registered |= places
                message = join(message, pointer(self.message(subscriber.info, function)))
        return message

    def call_when(
        self,
        key: Hashable,
        target: Obj,
        values: Sequence[Value],
        kind: str,
        fresh: Fresh = (),
        answer: Publisher | None = None,
        named: Mapping[str, Value] = NOTHING,
        program: str = "",
    ) -> None:
        """Run a function on its own with these arguments; `answer` takes what it returns."""
        root = Root((key, target.kind, target.key), kind, target.name, kind == "thread", function_of(target))
        root.maker = self.store.root
        root.program = program or root.maker.program
        if root.key not in self.roots and self._too_many(root):
            return
        before = self.passed.get(root.key, [])
        values = [join(a, b) for a, b in zip_longest(before, values, fillvalue=BOTTOM)]
        news = bool(before) and values != before
        self.passed[root.key] = values
        self.given |= together([target, *(o for v in (*values, *named.values()) for o in v.pts)])

        def run(root: Root) -> None:
            frame = self.root_frame(root)
            frame.answer = answer
            self.delivered = frozenset(
                o for v in (*values, *named.values()) for o in v.pts if o.kind == "message"
            )
            for obj, name, value in fresh:
                self._clear(obj)
                self.store.put((obj, name), value)
            self.call_object(target, (list(values), dict(named)), frame, ROOT_CALL)

        self.add_root(root, run, news=news)

    def _too_many(self, root: Root) -> bool:
        """Tell whether a function runs on its own often enough: for itself, or for other objects of a class."""
        if root.function is None:
            return False
        if root.generations() > MAX_GENERATIONS:
            return True
        if not _for_each_object(root):
            return False
        alike = [r for r, _ in self.roots.values() if r.function is root.function and _for_each_object(r)]
        return len(alike) >= MAX_ALIKE

    def root_frame(self, root: Root) -> Frame:
        """Return the frame that stands for ROS itself, calling."""
        raise NotImplementedError

    def call_later(self, target: Obj, values: Sequence[Value]) -> None:
        """Have a function run on its own; of other arguments than these nothing is known."""
        self.call_when("later", target, values, "callback")


def _for_each_object(root: Root) -> bool:
    """Tell whether a thread or a framework runs something, which it does for each object of a class."""
    return root.kind == "thread" or (isinstance(root.key, tuple) and root.key[0] == "framework")


def _supplied(frame: Frame, callback: Value) -> bool:
    """Tell whether a function's caller hands in the callback."""
    wanted = {o for o in callback.pts if o.kind in CALLABLE}
    for target in tuple(wanted):
        wanted |= _wrapped(target, frame)
    return bool(wanted) and any(wanted & v.pts for v in frame.arguments)


def _wrapped(target: Obj, frame: Frame) -> set[Obj]:
    """Return the functions that a helper, this one or one called from here, was given to make a callback around."""
    if target.kind == "partial" and isinstance(target.info, tuple):
        return {o for o in target.info[0].pts if o.kind in CALLABLE}
    maker = target.info[1] if target.kind == "closure" and isinstance(target.info, tuple) else None
    if not isinstance(maker, Frame) or frame not in (maker, maker.caller):
        return set()
    return {o for value in maker.arguments for o in value.pts if o.kind in LATER}
