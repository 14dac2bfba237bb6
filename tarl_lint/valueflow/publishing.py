"""Publishers and publish calls."""

from __future__ import annotations

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.ends import Publisher, SinkRecord
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.graph import Place
from tarl_lint.valueflow.invocation import Invocation
from tarl_lint.valueflow.library import Library
from tarl_lint.valueflow.values import UNKNOWN, Value, pointer


class Sinks(Library):
    """Records sinks."""

    def _publisher(self, it: Invocation) -> Value:
        obj = self.intern("publisher", (it.frame.id, it.statement, it.call.slot, *it.frame.turn))
        info = obj.info
        if not isinstance(info, Publisher):
            info = Publisher(api=it.fact.api, path=it.frame.program.path, pos=it.call.pos)
        obj.info = info
        info.topics.update(self.topics(it))
        info.types.update(type_names(it.argument(it.fact.type)))
        return pointer(obj)

    def topics(self, it: Invocation) -> list[str]:
        """Return the names that a registration's topic may have, as they are when launched."""
        names = self.config.launched
        return [names.get(text.lstrip("/"), text) for text in it.argument(it.fact.topic).texts()]

    def send(self, it: Invocation, info: Publisher) -> Value:
        """Record a sink: everything inside the message reaches it, and whether it is reached at all."""
        frame, call = it.frame, it.call
        key = (frame.program.path, call.pos)
        record = self.sinks.get(key)
        if record is None:
            record = SinkRecord(*key, _api(info, it), self.modules[key[0]].name, self.qualname(frame))
            record.kind = info.kind
            self.sinks[key] = record
        record.topics |= info.topics
        record.types |= info.types
        record.publishers.add((info.path, info.pos))
        info.used = True
        node = self.node(frame, ("publish", call.slot), "publish")
        self.graph.flow(self.all_used(it.arguments), node)
        self.graph.choice(it.base.deps, node)
        self.graph.depend(node, it.base.deps)  # which publisher it is
        self.graph.depend(node, [n for n, _ in self.guards])
        if frame.statement is not None:
            self.under(frame, frame.statement, node)
        record.nodes.add(node)
        return UNKNOWN

    def under(self, frame: Frame, statement: ir.Stmt, node: int) -> None:
        """Let a node depend on the conditions that decide whether its statement runs, in callers too."""
        control = self.control(frame)
        for branch in control.direct.get(statement.id, ()):
            decision, _ = self.branch(frame, branch)
            self.graph.depend(node, (decision,))
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
            self.graph.depend(node, (waypoint,))

    def _entered(self, frame: Frame, node: int) -> None:
        """Let a node depend on what decides whether its function is called."""
        caller, call = frame.caller, frame.call
        if caller is None or call is None:
            return
        key = (frame.id, "entered")
        if key not in self.graph.numbers:
            waypoint = self.graph.node(key, Place(caller, call, "call", call.pos), frozenset())
            self.under(caller, call, waypoint)
            self.graph.depend(waypoint, [n for n, _ in frame.guards])
        self.graph.depend(node, (self.graph.numbers[key],))

    def qualname(self, frame: Frame) -> str:
        """Return the qualified name of the function (or class body) that a frame runs."""
        return frame.function.qualname


def type_names(value: Value) -> list[str]:
    """Return the names of message types: the last part."""
    return [o.name.rpartition(".")[2] for o in value.pts if o.kind in ("ext", "class")]


def _api(info: Publisher, it: Invocation) -> str:
    """Name the call that sends, by who made the sender."""
    if info.kind != "topic":
        return f"{info.api}.{it.name}"
    library = info.api.partition(".")[0]
    return f"{library}.Publisher.publish" if library in ("rospy", "rclpy") else info.api
