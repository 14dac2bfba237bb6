"""What the catalog's calls do: sources, sinks, publishers, timers, parameters."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence

from tarl_lint import catalog
from tarl_lint.catalog import Fact
from tarl_lint.valueflow import ir
from tarl_lint.valueflow.calls import CALLABLE, ROOT_CALL
from tarl_lint.valueflow.graph import Place
from tarl_lint.valueflow.library import Library
from tarl_lint.valueflow.machine import Arguments, Publisher, SinkRecord, SourceRecord
from tarl_lint.valueflow.store import Root
from tarl_lint.valueflow.values import BOTTOM, NONE, UNKNOWN, Frame, Obj, Value, join, pointer


class Ros(Library):
    """Performs the calls that the catalog knows."""

    def ros_call(
        self, fact: Fact, qualified: str, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        """Do what the catalog says about a call. Of a method, the first argument is the receiver."""
        receiver = BOTTOM
        if qualified in catalog.METHODS:
            receiver, arguments = arguments[0][0], (arguments[0][1:], arguments[1])
        return ACTIONS[fact.kind](self, fact, receiver, arguments, frame, call)

    # --- publishers and sinks -----------------------------------------------------------------------------

    def publisher(
        self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:  # noqa: ARG002
        statement = frame.statement.id if frame.statement is not None else -1
        obj = self.intern("publisher", (frame.id, statement, call.slot))
        info = obj.info if isinstance(obj.info, Publisher) else Publisher(api=fact.api)
        obj.info = info
        info.topics.update(argument(arguments, fact.topic).texts())
        info.types.update(type_names(argument(arguments, fact.type)))
        return pointer(obj)

    def publish(self, target: Obj | None, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Record a sink: everything inside the message reaches it, and whether it is reached at all."""
        if target is None or not isinstance(target.info, Publisher):
            return UNKNOWN
        info = target.info
        key = (frame.program.path, call.pos)
        api = "rospy.Publisher.publish" if info.api.startswith("rospy") else "rclpy.Publisher.publish"
        record = self.sinks.get(key)
        if record is None:
            record = SinkRecord(*key, api, frame.program.name, self.qualname(frame))
            self.sinks[key] = record
        record.topics |= info.topics
        record.types |= info.types
        node = self.node(frame, ("publish", call.slot), "publish")
        self.graph.flow(self.all_used(arguments), node)
        if frame.statement is not None:
            self.under(frame, frame.statement, node)
        record.nodes.add(node)
        return UNKNOWN

    def under(self, frame: Frame, statement: ir.Stmt, node: int) -> None:
        """Let a node depend on the conditions that decide whether its statement runs, in callers too."""
        control = self.control(frame)
        for branch in control.direct.get(statement.id, ()):
            decision, _ = self.branch(frame, branch)
            self.graph.control[node].add(decision)
            self._reached(frame, branch[0], node)
        if statement.id in control.always:
            self._entered(frame, node)

    def _reached(self, frame: Frame, number: int, node: int) -> None:
        """Let a node depend on what decides whether a condition is evaluated."""
        place = self.graph.places[self.branch(frame, (number, ""))[0]]
        if place.statement is None:
            return
        key = (frame.id, number, "reached")
        if key not in self.graph.numbers:
            waypoint = self.graph.node(key, place, frozenset())
            self.under(frame, place.statement, waypoint)
        waypoint = self.graph.numbers[key]
        if waypoint != node:
            self.graph.control[node].add(waypoint)

    def _entered(self, frame: Frame, node: int) -> None:
        """Let a node depend on what decides whether its function is called."""
        caller, call = frame.caller, frame.call
        if caller is None or call is None:
            return
        key = (frame.id, "entered")
        if key not in self.graph.numbers:
            waypoint = self.graph.node(key, Place(caller, call, "call", call.pos), frozenset())
            self.under(caller, call, waypoint)
        self.graph.control[node].add(self.graph.numbers[key])

    def qualname(self, frame: Frame) -> str:
        """Return the qualified name of the function (or class body) that a frame runs."""
        return frame.function.qualname

    # --- sources ------------------------------------------------------------------------------------------

    def source(
        self, fact: Fact, arguments: Arguments, callback: Value, frame: Frame, call: ir.Call
    ) -> SourceRecord:
        """Record a subscription at the outermost call that supplies its callback."""
        place, pos, statement, via = frame, call.pos, frame.statement, []
        while place.caller is not None and place.call is not None and _supplied(place, callback):
            via.append((place.program.path, pos))
            statement = place.call
            pos = self.call_position(place)
            place = place.caller
        key = (place.program.path, pos)
        record = self.sources.get(key)
        if record is None:
            assert statement is not None  # noqa: S101 - a call stands in a statement
            record = SourceRecord(*key, fact.api, place.program.name, self.qualname(place), statement, place)
            self.sources[key] = record
        record.via.update(via)
        record.topics.update(argument(arguments, fact.topic).texts())
        record.types.update(type_names(argument(arguments, fact.type)))
        return record

    def call_position(self, frame: Frame) -> ir.Pos:
        """Return where the call stands that entered a frame."""
        assert frame.call is not None  # noqa: S101 - asked before
        return frame.call_pos or frame.call.pos

    def subscribe(
        self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:  # noqa: ARG002
        callback = argument(arguments, fact.callback)
        record = self.source(fact, arguments, callback, frame, call)
        extra = argument(arguments, fact.extra)
        passed = [extra] if extra is not BOTTOM else []
        self.connect(record, callback, passed)
        return self.handle(frame, call)

    def handle(self, frame: Frame, call: ir.Call) -> Value:
        """Return the object that a registration gives back."""
        return pointer(self.allocate("lib", frame, ("made", call.slot)))

    def connect(self, record: SourceRecord, callback: Value, extra: Sequence[Value]) -> None:
        """Run a callback whenever a message of the source arrives."""
        for target in callback.pts:
            if target.kind in CALLABLE or target.kind == "instance":
                message = self.message(record, target)
                self.call_when(
                    ("callback", record.path, record.pos), target, [pointer(message), *extra], "callback"
                )

    def message(self, record: SourceRecord, target: Obj) -> Obj:
        """Return the message object that a source hands to a callback."""
        obj = record.messages.get(target.key)
        if obj is None:
            obj = record.messages[target.key] = Obj("message", (record.path, record.pos, target.key))
            frame = self.described(target)
            place = Place(frame or record.frame, None, "receive", (frame or record.frame).function.pos)
            node = self.graph.node(("receive", obj.key), place, NONE)
            obj.info = node
            record.nodes.add(node)
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

    def receive(
        self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:  # noqa: ARG002
        """Return the message that a waiting call gives."""
        record = self.source(fact, arguments, BOTTOM, frame, call)
        key = (frame.id, call.slot)
        obj = record.messages.get(key)
        if obj is None:
            obj = record.messages[key] = Obj("message", (record.path, record.pos, key))
            node = self.node(frame, ("receive", call.slot), "receive")
            obj.info = node
            record.nodes.add(node)
        self._clear(obj)
        return pointer(obj)

    def filter(self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        """Return a subscriber of message_filters: rospy's starts with the topic, rclpy's with the node."""
        first = arguments[0][0] if arguments[0] else BOTTOM
        if len(arguments[0]) > 2 and not first.texts() and not argument(arguments, fact.type).texts():
            fact = catalog.FILTER_WITH_NODE
        record = self.source(fact, arguments, BOTTOM, frame, call)
        obj = self.intern("filter", (record.path, record.pos))
        obj.info = record
        return pointer(obj)

    def synchronizer(
        self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:  # noqa: ARG002
        """Return a synchroniser of several subscribers."""
        given = argument(arguments, fact.topic)
        statement = frame.statement.id if frame.statement is not None else -1
        obj = self.intern("synchronizer", (frame.id, statement, call.slot))
        parts = self._unpacked(given)
        if parts is None:
            parts = [self.elements(given)] if all(o.kind == "sequence" for o in given.pts) else [given]
        obj.info = (parts, (frame.program.path, call.pos))
        return pointer(obj)

    def register_filter(self, target: Obj | None, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:
        """Run a callback with one message of each subscriber."""
        if target is None:
            return UNKNOWN
        places = {(frame.program.path, call.pos)}
        parts: Sequence[Value] = [pointer(target)]
        if target.kind == "synchronizer" and isinstance(target.info, tuple):
            parts = target.info[0]
            places.add(target.info[1])
        callback = argument(arguments, (0, "cb"))
        extra = arguments[0][1:]
        for function in callback.pts:
            if function.kind not in CALLABLE:
                continue
            messages: list[Value] = []
            for part in parts:
                message = BOTTOM
                for subscriber in part.pts:
                    if isinstance(subscriber.info, SourceRecord):
                        subscriber.info.registered |= places
                        message = join(message, pointer(self.message(subscriber.info, function)))
                messages.append(message)
            self.call_when(
                ("filter", frame.program.path, call.pos), function, [*messages, *extra], "callback"
            )
        return UNKNOWN

    # --- what runs on its own -----------------------------------------------------------------------------

    def call_when(self, key: Hashable, target: Obj, values: Sequence[Value], kind: str) -> None:
        """Run a function on its own with these arguments."""
        root = Root((key, target.kind, target.key), kind, target.name, once=kind == "thread")

        def run(root: Root) -> None:
            frame = self.root_frame(root)
            self.call_object(target, (list(values), {}), frame, ROOT_CALL)

        self.add_root(root, run)

    def root_frame(self, root: Root) -> Frame:
        """Return the frame that stands for ROS itself, calling."""
        raise NotImplementedError

    def call_later(self, target: Obj, frame: Frame) -> None:  # noqa: ARG002
        """Have a function run on its own, with arguments of which nothing is known."""
        self.call_when("later", target, [], "callback")

    def timer(self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        for target in argument(arguments, fact.callback).pts:
            self.call_when((fact.kind, frame.program.path, call.pos), target, [], "callback")
        return self.handle(frame, call)

    def thread(self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        given = argument(arguments, fact.extra)
        values = self._unpacked(given) or []
        for target in argument(arguments, fact.callback).pts:
            self.call_when((fact.kind, frame.program.path, call.pos), target, values, "thread")
        return self.handle(frame, call)

    # --- values -------------------------------------------------------------------------------------------

    def partial(
        self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:  # noqa: ARG002
        statement = frame.statement.id if frame.statement is not None else -1
        obj = self.intern("partial", (frame.id, statement, call.slot))
        plain, named = arguments
        if not plain:
            return UNKNOWN
        obj.info = (plain[0], plain[1:], named)
        obj.name = next((t.name for t in plain[0].pts), "")
        return pointer(obj)

    def copied(self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call) -> Value:  # noqa: ARG002
        return self.copy_of(arguments[0][0], frame, call) if arguments[0] else UNKNOWN

    def parameter(
        self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:  # noqa: ARG002
        """Return a parameter's value: its default, as far as is known here."""
        default = argument(arguments, fact.extra)
        if default is BOTTOM:
            node = self.node(frame, ("parameter", call.slot), "assign")
            self.graph.literals[node] = (None, call.pos, frame.program.path)
            return Value(frozenset([node]))
        expr = call.arguments[1] if len(call.arguments) > 1 else dict(call.keywords).get(fact.extra[1])
        return self._default_of(default, expr, frame, ("parameter", call.slot))

    def _default_of(self, default: Value, expr: ir.Expr | None, frame: Frame, slot: Hashable) -> Value:
        node = self.node(frame, slot, "assign")
        if expr is not None:
            self.mark(node, expr, default, frame)
        self.graph.flow(default.deps, node)
        return Value(frozenset([node]))

    def declare(
        self, fact: Fact, receiver: Value, arguments: Arguments, frame: Frame, call: ir.Call
    ) -> Value:
        """Remember a declared parameter's default under the node and its name."""
        default = argument(arguments, fact.extra)
        expr = call.arguments[1] if len(call.arguments) > 1 else dict(call.keywords).get(fact.extra[1])
        value = (
            UNKNOWN if default is BOTTOM else self._default_of(default, expr, frame, ("parameter", call.slot))
        )
        found = self._parameter_object(receiver, argument(arguments, fact.topic))
        for obj in found.pts:
            self.store.put((obj, "value"), value)
        return found

    def parameter_object(
        self,
        fact: Fact,
        receiver: Value,
        arguments: Arguments,
        frame: Frame,
        call: ir.Call,  # noqa: ARG002
    ) -> Value:
        return self._parameter_object(receiver, argument(arguments, fact.topic))

    def _parameter_object(self, receiver: Value, name: Value) -> Value:
        keys = [(o.key, text) for o in receiver.pts for text in name.texts()]
        return Value(pts=frozenset(self.intern("parameter", key, str(key[1])) for key in keys))


def argument(arguments: Arguments, which: tuple[int, str]) -> Value:
    """Return an argument by position or keyword, BOTTOM where it is not given."""
    number, name = which
    plain, named = arguments
    if 0 <= number < len(plain):
        return plain[number]
    return named.get(name, BOTTOM)


def type_names(value: Value) -> list[str]:
    """Return the names of message types: the last part."""
    return [o.name.rpartition(".")[2] for o in value.pts if o.kind in ("ext", "class")]


def _supplied(frame: Frame, callback: Value) -> bool:
    """Tell whether a function's caller hands in the callback."""
    wanted = {o for o in callback.pts if o.kind in CALLABLE}
    return bool(wanted) and any(wanted & v.pts for v in frame.arguments)


ACTIONS: Mapping[str, Callable[..., Value]] = {
    "publisher": Ros.publisher,
    "subscribe": Ros.subscribe,
    "receive": Ros.receive,
    "filter": Ros.filter,
    "synchronizer": Ros.synchronizer,
    "timer": Ros.timer,
    "service": Ros.timer,
    "call later": Ros.timer,
    "thread": Ros.thread,
    "partial": Ros.partial,
    "copy": Ros.copied,
    "parameter": Ros.parameter,
    "declare": Ros.declare,
    "parameter object": Ros.parameter_object,
}
