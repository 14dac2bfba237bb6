"""Branches, loops and handlers: several continuations of one state."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.valueflow import ir
from tarl_lint.valueflow.bounds import MAX_STATEMENTS
from tarl_lint.valueflow.control import taken
from tarl_lint.valueflow.frames import Attempt, Frame
from tarl_lint.valueflow.raising import Raising
from tarl_lint.valueflow.store import Delta
from tarl_lint.valueflow.values import BOTTOM, UNKNOWN, Value

MAX_TURNS = 4  # elements of a loop that are told apart
MAX_PASSES = 12  # over a loop's body; a safety net, since the values that can arise are finite


class Branches(Raising):
    """Executes what has statements inside."""

    def decide(self, test: ir.Expr, s: ir.Stmt, frame: Frame) -> bool | None:
        """Evaluate a condition; return which way it goes when a constant tells."""
        node = self.condition(frame, s)
        value = self.evaluate(test, frame)
        frame.statement = s
        self.graph.flow(self.truth(value, frame, "test"), node)
        known, constant = value.constant()
        if value.consts and not value.pts and not known:
            ways = {bool(c) for c in value.consts}
            return ways.pop() if len(ways) == 1 else None
        return bool(constant) if known else None

    def _if(self, s: ir.If, frame: Frame) -> bool:
        way = self.decide(s.test, s, frame)
        if way is not None:
            return self.block(s.body if way else s.orelse, frame)
        goes_on: list[Delta] = []
        for body in (s.body, s.orelse):
            self.store.push()
            if self.block(body, frame):
                goes_on.append(self.store.pop())
            else:
                self.store.pop()
        if goes_on:
            self.merge(goes_on)
        return bool(goes_on)

    def loop(self, s: ir.Loop, frame: Frame) -> bool:
        """Repeat the body until the state at its head changes no more."""
        source = self.evaluate(s.source, frame) if s.target is not None else BOTTOM
        if s.target is not None and (elements := self._told_apart(source)):
            return self._turns(s, s.target, source, elements, frame)
        depth = len(self.store.layers)
        head: Delta = {}
        for _ in range(MAX_PASSES):
            self.store.push(head)
            table: dict[str, list[Delta]] = {"break": [], "continue": []}
            frame.jumps.append((depth, table))
            enters, leaves = self._loop_head(s, source, frame)
            done = [self.store.since(depth)] if leaves else []
            backs: list[Delta] = []
            if enters:
                if self.block(s.body, frame):
                    backs.append(self.store.since(depth))
                backs += table["continue"]
            frame.jumps.pop()
            self.store.cut(depth)
            again = self.joined([head, *backs]) if backs else head
            if again == head:
                break
            if self.spent > MAX_STATEMENTS:
                self.cut[self.program] = None
                break  # loops in loops in loops take as many passes as all of theirs multiplied
            head = again
        return self._loop_end(s, done, table["break"], frame)

    def _told_apart(self, source: Value) -> list[Value]:
        """Return the elements that a loop goes over one by one: a few, known, with data in them."""
        elements = self.unpacked(source) or []
        if not 1 < len(elements) <= MAX_TURNS:
            return []
        laden = any(v.deps or any(o.laden or o.kind == "message" for o in v.pts) for v in elements)
        return elements if laden else []

    def _turns(
        self, s: ir.Loop, target: ir.Expr, source: Value, elements: Sequence[Value], frame: Frame
    ) -> bool:
        """Execute the body once for each element."""
        depth, before = len(self.store.layers), frame.turn
        broken: list[Delta] = []
        self._length(source, self.condition(frame, s))
        done: Delta | None = {}
        for number, element in enumerate(elements):
            self.store.push(done)
            table: dict[str, list[Delta]] = {"break": broken, "continue": []}
            frame.jumps.append((depth, table))
            frame.turn = (*before, -1 - s.id, number)
            frame.statement = s
            self.bind_target(target, element, frame, "element", s.source)
            ends = [self.store.since(depth)] if self.block(s.body, frame) else []
            ends += table["continue"]
            frame.jumps.pop()
            self.store.cut(depth)
            done = self.joined(ends) if ends else None
            if done is None:
                break
        frame.turn = before
        return self._loop_end(s, [done] if done is not None else [], broken, frame)

    def _loop_head(self, s: ir.Loop, source: Value, frame: Frame) -> tuple[bool, bool]:
        """Evaluate the condition or bind the next element; tell whether the body and the end are reached."""
        frame.statement = s
        if self.watch is not None:
            self.watch(frame, s)
        if frame.root_waits and s.target is None:
            self.wait(frame)
        if s.target is None:
            way = self.decide(s.source, s, frame)
            return way is not False, way is not True and not s.endless
        node = self.condition(frame, s)
        self._length(source, node)
        element = self.iterated(source, s.source, frame)
        self.bind_target(s.target, element, frame, "element", s.source)
        return True, True

    def _length(self, source: Value, node: int) -> None:
        """How often a loop runs depends on a container's length: on what chose to add elements, not on them."""
        ours = frozenset(filter(self.sized, source.pts))
        self.graph.flow(self.length(source), node)
        self.graph.choice(self.placed(ours), node)

    def _loop_end(self, s: ir.Loop, done: list[Delta], broken: list[Delta], frame: Frame) -> bool:
        if done and s.orelse:
            self.store.push(done[0])
            depth = len(self.store.layers) - 1
            done = [self.store.since(depth)] if self.block(s.orelse, frame) else []
            self.store.cut(depth)
        if not done and not broken:
            return False
        self.merge([*done, *broken])
        return True

    def _try(self, s: ir.Try, frame: Frame) -> bool:
        """A handler can be entered from before and after every statement of the body."""
        depth = len(self.store.layers)
        self.condition(frame, s)
        self.store.push()
        states: list[Delta] = [{}]
        attempt = Attempt(depth, states, bool(s.handlers), BOTTOM, _taken(s))
        frame.tries.append(attempt)
        goes_on = True
        for statement in s.body:
            goes_on = self.block([statement], frame)
            states.append(self.store.since(depth)) if s.handlers and goes_on else None
            if not goes_on:
                break
        frame.tries.pop()
        ends: list[Delta] = []
        if goes_on and self.block(s.orelse, frame):
            ends.append(self.store.since(depth))
        self.store.cut(depth)
        if s.handlers:
            ends += self._handlers(s, states, attempt.raised, frame)
        if not ends:
            if s.final:
                self.store.push(self.joined(states))
                self.block(s.final, frame)
                self.store.cut(depth)
            return False
        self.merge(ends)
        return self.block(s.final, frame)

    def _handlers(self, s: ir.Try, states: list[Delta], raised: Value, frame: Frame) -> list[Delta]:
        depth = len(self.store.layers)
        start = self.joined(states)
        ends: list[Delta] = []
        for _, name, body in s.handlers:
            self.store.push(start)
            if name is not None:
                self.assign(name, raised if raised.deps or raised.pts else UNKNOWN, frame)
            if self.block(body, frame):
                ends.append(self.store.since(depth))
            self.store.cut(depth)
        return ends

    def _with(self, s: ir.With, frame: Frame) -> bool:
        managers: list[Value] = []
        for number, (context, target) in enumerate(s.items):
            value = self.evaluate(context, frame)
            managers.append(value)
            frame.statement = s
            entered = self.special(value, "__enter__", (), frame, s.pos)
            value = value if entered is None else entered
            if target is not None:
                self.bind_target(target, value, frame, f"with{number}", context)
        goes_on = self.block(s.body, frame)
        frame.statement = s
        for manager in reversed(managers if goes_on else ()):
            self.special(manager, "__exit__", [UNKNOWN] * 3, frame, s.pos)
        return goes_on


def _taken(s: ir.Try) -> frozenset[str]:
    """Return the names of the exceptions that a statement handles, none when it handles any."""
    each = [taken(types) for types, _, _ in s.handlers]
    return frozenset().union(*each) if all(each) else frozenset()
