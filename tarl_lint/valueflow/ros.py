"""What the catalog's calls do: sources, sinks, publishers, timers, parameters."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.frames import Frame
from tarl_lint.valueflow.invocation import Invocation
from tarl_lint.valueflow.serving import Serving
from tarl_lint.valueflow.values import BOTTOM, UNKNOWN, Value, join, pointer


class Ros(Serving):
    """Performs the calls that the catalog knows."""

    def ros_call(self, it: Invocation) -> Value:
        """Do what the catalog says about a call."""
        action = ACTIONS.get(it.fact.kind)
        return action(self, it) if action is not None else UNKNOWN  # a callback of what nothing is known of

    def _timer(self, it: Invocation) -> Value:
        for target in it.argument(it.fact.callback).pts:
            self.call_when((it.fact.kind, it.frame.program.path, it.call.pos), target, [], "callback")
        return self.handle(it.frame, it.call)

    def _done(self, it: Invocation) -> Value:
        """Run a callback on a future, with the future."""
        future = self.through_statement(it.base, it.frame, it.call, "future")
        for target in it.argument(it.fact.callback).pts:
            self.call_when(("done", it.frame.program.path, it.call.pos), target, [future], "callback")
        return UNKNOWN

    def _thread(self, it: Invocation) -> Value:
        given = it.argument(it.fact.extra)
        values = self.unpacked(given) or []
        for target in it.argument(it.fact.callback).pts:
            self.call_when((it.fact.kind, it.frame.program.path, it.call.pos), target, values, "thread")
        return self.handle(it.frame, it.call)

    # --- values -------------------------------------------------------------------------------------------

    def _partial(self, it: Invocation) -> Value:
        obj = self.intern("partial", (it.frame.id, it.statement, it.call.slot, *it.frame.turn))
        plain, named = it.arguments
        if not plain:
            return UNKNOWN
        obj.info = (plain[0], plain[1:], named)
        obj.name = next((t.name for t in plain[0].pts), "")
        return pointer(obj)

    def _copied(self, it: Invocation) -> Value:
        given = [*it.arguments[0], *it.arguments[1].values()]
        if not given:
            return UNKNOWN
        copied = self.deep_copy if it.fact.api == "copy.deepcopy" else self.copy_of
        return copied(given[0], it.frame, it.call.slot)

    def parameter(self, it: Invocation) -> Value:
        """Return a parameter's value: its default, as far as is known here."""
        default = it.argument(it.fact.extra)
        if default is BOTTOM:
            node = self.node(it.frame, ("parameter", it.call.slot), "assign")
            self.graph.parameters.add(node)
            self.graph.literals[node] = (None, it.call.pos, it.frame.program.path)
            return Value(self.kept(node))
        expr = _default(it)
        return self._default_of(default, expr, it.frame, ("parameter", it.call.slot))

    def _default_of(self, default: Value, expr: ir.Expr | None, frame: Frame, slot: Hashable) -> Value:
        node = self.node(frame, slot, "assign")
        self.graph.parameters.add(node)
        if expr is not None:
            self.mark(node, expr, default, frame)
        self.graph.flow(default.deps, node)
        return Value(self.kept(node))

    def declare(self, it: Invocation) -> Value:
        """Remember a declared parameter's default under the node and its name."""
        default = it.argument(it.fact.extra)
        expr = _default(it)
        value = (
            UNKNOWN
            if default is BOTTOM
            else self._default_of(default, expr, it.frame, ("parameter", it.call.slot))
        )
        found = self._parameters(it.base, it.argument(it.fact.topic))
        for obj in found.pts:
            self.store.put((obj, "value"), value)
        return found

    def declare_all(self, it: Invocation) -> Value:
        """Remember the defaults of several declared parameters: tuples of a name and a default."""
        prefix = it.argument(it.fact.topic).texts()
        for number, entry in enumerate(self.unpacked(it.argument(it.fact.extra)) or ()):
            parts = self.unpacked(entry) or []
            names = [
                f"{p}.{t}" if p else t for p in prefix or ("",) for t in (parts[0].texts() if parts else ())
            ]
            if len(parts) < 2:
                continue
            value = self._default_of(parts[1], None, it.frame, ("parameter", it.call.slot, number))
            for obj in self._parameters(it.base, Value(consts=frozenset(names))).pts:
                self.store.put((obj, "value"), value)
        return UNKNOWN

    def parameter_or(self, it: Invocation) -> Value:
        """Return a parameter, or the one given instead."""
        found = self._parameters(it.base, it.argument(it.fact.topic))
        return join(found, it.argument(it.fact.extra))

    def _parameter_object(self, it: Invocation) -> Value:
        return self._parameters(it.base, it.argument(it.fact.topic))

    def _parameters(self, receiver: Value, name: Value) -> Value:
        keys = [(o.key, text) for o in receiver.pts for text in name.texts()]
        return Value(pts=frozenset(self.intern("parameter", key, str(key[1])) for key in keys))


ACTIONS: Mapping[str, Callable[..., Value]] = {
    "publisher": Ros._publisher,
    "subscribe": Ros._subscribe,
    "receive": Ros.receive,
    "configured": Ros._configured_source,
    "filter": Ros.filter,
    "synchronizer": Ros.synchronizer,
    "timer": Ros._timer,
    "service": Ros._service,
    "action": Ros._action,
    "transform": Ros._transform,
    "call later": Ros._timer,
    "done": Ros._done,
    "thread": Ros._thread,
    "partial": Ros._partial,
    "copy": Ros._copied,
    "parameter": Ros.parameter,
    "declare": Ros.declare,
    "declare all": Ros.declare_all,
    "parameter object": Ros._parameter_object,
    "parameter or": Ros.parameter_or,
}


def _default(it: Invocation) -> ir.Expr | None:
    """Return the expression that gives a parameter's default."""
    if len(it.call.arguments) > 1:
        return it.call.arguments[1]
    return next((e for name, e in it.call.keywords if name == it.fact.extra[1]), None)
